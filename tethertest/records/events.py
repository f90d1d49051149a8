"""What happens at a time or place in a record: snaps, fronts, load cycles, extremes."""

from __future__ import annotations

from dataclasses import dataclass

#: 95 % interval
Interval = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Snap:
    """A re-tightening after slack, and the peak it leads to."""

    channel: str
    start: float  #: [s], tension leaves zero
    peak_time: float  #: [s]
    peak: float  #: largest tension [N]
    peak_interval: Interval  #: [N], from noise and calibration
    rise_time: float  #: [s], from 10 to 90 % of the peak
    rise_resolved: bool  #: False where fewer than two sampling intervals lie between the two levels
    impulse: float  #: [N s], from the start until tension first falls below half the peak
    front: float  #: steepest rise before the peak: the largest increase within one round trip of a wave [N]
    speed: float | None  #: relative speed of the two sides if the front starts at the sensor [m/s]
    speed_interval: Interval | None  #: [m/s]
    arrived_speed: float | None  #: of the front if it arrives from elsewhere at a rigid end: half of `speed`


@dataclass(frozen=True, slots=True)
class Front:
    """The onset of a wave at one sensor."""

    channel: str
    at: float  #: fraction of the cable's length from the bottom
    time: float  #: [s]
    interval: Interval  #: [s]; holds the onset of a jump, a ramp or a parabola


@dataclass(frozen=True, slots=True)
class WaveSpeed:
    """A speed from fronts at several sensors."""

    kind: str  #: "axial" or "transverse"
    fronts: tuple[Front, ...]
    speed: float  #: [m/s]
    interval: Interval  #: [m/s]; infinite above where the fronts may have come at once
    implied: str  #: "axial_stiffness" or "tension"
    value: float  #: [N]
    value_interval: Interval  #: [N]


@dataclass(frozen=True, slots=True)
class Extremes:
    """Largest and smallest usable value of a channel in its window."""

    maximum: float
    maximum_time: float  #: [s]
    minimum: float
    minimum_time: float  #: [s]


@dataclass(frozen=True, slots=True)
class Cycle:
    """One load cycle of a rainflow count."""

    range: float
    mean: float
    count: float  #: 1, or 0.5 of a half cycle


@dataclass(frozen=True, slots=True)
class CycleCount:
    """A rainflow count and what it amounts to."""

    cycles: tuple[Cycle, ...]  #: by falling range
    smallest: float  #: ranges below this are noise and left out
    exponent: float  #: slope of the S-N curve
    equivalent_range: float  #: of equally many cycles of one range that do the same damage

    @property
    def number(self) -> float:
        """Cycles, halves counted as such."""
        return sum(cycle.count for cycle in self.cycles)
