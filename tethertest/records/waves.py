"""Waves up and down the cable, order by order, and where the tension is largest."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from tethertest.records.channel import Side

Interval = tuple[float, float]
#: above this ratio of energies the standing part has more energy than the travelling one: the weaker wave and
#: as much of the stronger make the standing part, 2 E2 against E1 - E2
STANDING: Final = 1.0 / 3.0


@dataclass(frozen=True, slots=True)
class OrderWaves:
    """The up- and the down-going wave of one order of the drive; amplitudes are peaks of cosines [N].

    Where `refused` says why, the numbers are only what a calculation gave and mean nothing.
    """

    order: str
    frequency: float  #: [Hz]
    up: float  #: amplitude of the wave going up [N]
    up_interval: Interval
    down: float  #: amplitude of the wave going down [N]
    down_interval: Interval
    energy_ratio: float  #: energy of the weaker wave over that of the stronger, 0 travelling to 1 standing
    energy_ratio_interval: Interval
    standing_wave_ratio: float  #: largest over smallest amplitude along an endless cable; may be infinite
    power: float  #: mean power carried upwards [W]
    power_interval: Interval
    refused: str = ""

    @property
    def is_standing(self) -> bool | None:
        """True where standing, False where travelling, None where the interval does not settle it."""
        low, high = self.energy_ratio_interval
        if low > STANDING:
            return True
        return False if high < STANDING else None


@dataclass(frozen=True, slots=True)
class Waves:
    """Waves of one cable, seen at one section or by several sensors."""

    source: Side
    section: str  #: what they rest on
    at: float  #: fraction of the length from the bottom that the phases refer to
    orders: tuple[OrderWaves, ...]


@dataclass(frozen=True, slots=True)
class LargestTension:
    """Where along the cable and when tension is largest."""

    at: float  #: fraction of the length from the bottom
    time: float  #: [s]
    value: float  #: [N]
    at_interval: Interval  #: fractions where the largest tension comes within the stated error of it
    bottom: float  #: largest tension at the bottom [N]
    top: float  #: largest tension at the top [N]
    over_rest: float  #: largest tension less that of the same place at rest [N]
    over_rest_at: float  #: and its place: by its weight alone an upright cable's tension is largest on top
    over_rest_time: float  #: [s]
