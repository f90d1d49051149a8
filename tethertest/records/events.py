"""What happens at a time or place in a record: snaps, fronts, load cycles, extremes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from tethertest.records.described import Doc

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

    channel: Annotated[str, Doc("sensor of the rig")]
    at: Annotated[float, Doc("fraction of the cable's length from the bottom")]
    time: Annotated[float, Doc("of the onset [s]")]
    interval: Annotated[Interval, Doc("holds the onset of a jump, a ramp or a parabola [s]")]


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

    maximum: Annotated[float, Doc("largest usable value, in the channel's unit")]
    maximum_time: Annotated[float, Doc("[s]")]
    minimum: Annotated[float, Doc("smallest usable value, in the channel's unit")]
    minimum_time: Annotated[float, Doc("[s]")]


@dataclass(frozen=True, slots=True)
class Cycle:
    """One load cycle of a rainflow count."""

    range: Annotated[float, Doc("largest less smallest value, in the channel's unit")]
    mean: Annotated[float, Doc("middle of the range")]
    count: Annotated[float, Doc("1, or 0.5 of a half cycle")]


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
