"""Random drives: a crank with harmonics that starts, stops or never does either, and knocks on the base."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from tethertest.records.arrays import FloatArray

Transients = Literal["start and stop", "start", "stop", "taps", "knocks alone", "none"]

#: how often what chooses the cycle is there; runs with taps start and stop too
SHARES: dict[Transients, float] = {
    "start and stop": 0.35,
    "start": 0.12,
    "stop": 0.12,
    "taps": 0.2,
    "knocks alone": 0.06,
    "none": 0.15,
}
#: length of a knock [s]
TAP_LENGTH = 0.06
#: the drive turns long before and after a record that holds no start and no stop [s]
LONG = 100.0


@dataclass(frozen=True, slots=True)
class RandomMotion:
    """A crank that turns between two ramps of its speed."""

    frequency: float  #: [Hz]
    radius: float  #: [m]
    rod_ratio: float
    third: float  #: amplitude of the third order over the first: speed ripple, play
    start: float  #: when it starts [s]; long before the record where the record holds no start
    ramp_up: float  #: [s]
    stop: float  #: when it begins to stop [s]; long after the record where the record holds no stop
    ramp_down: float  #: [s]
    taps: tuple[tuple[float, float], ...]  #: time [s] and lift [m]

    def __call__(self, time: FloatArray) -> FloatArray:
        """Return the base's height [m]."""
        turned = _ramped(time - self.start, self.ramp_up) - _ramped(time - self.stop, self.ramp_down)
        angle = 2.0 * np.pi * self.frequency * turned
        ratio = self.rod_ratio
        rod = np.sqrt(1.0 - (ratio * np.sin(angle)) ** 2) / ratio if ratio > 0.0 else 0.0
        third = self.third * np.cos(3.0 * angle + 1.0)
        height = np.asarray(self.radius * (np.cos(angle) + rod + third), dtype=np.float64)
        for when, lift in self.taps:
            height += lift * np.sin(np.pi * np.clip((time - when) / TAP_LENGTH, 0.0, 1.0)) ** 2
        return height


def _ramped(time: FloatArray, length: float) -> FloatArray:
    """Return the integral of a speed that rises smoothly from 0 to 1 within `length`."""
    part = np.clip(time / length, 0.0, 1.0)
    return length * part**4 * (2.5 - 3.0 * part + part**2) + np.clip(time - length, 0.0, None)


def drawn_motion(
    random: np.random.Generator, transients: Transients, frequency: float, length: float
) -> RandomMotion:
    """Return a random motion.

    Parameters
    ----------
    random : numpy.random.Generator
    transients : str
        What the record holds besides the steady drive.
    frequency : float
        Of the drive [Hz].
    length : float
        Of the run [s].
    """
    has_start = transients in ("start and stop", "start", "taps")
    has_stop = transients in ("start and stop", "stop", "taps")
    start = random.uniform(5.0, 8.0) if has_start else -LONG - random.uniform(0.0, 10.0)
    ramps = random.uniform(2.0, 5.0, 2)
    stop = length - random.uniform(6.0, 9.0) - ramps[1] if has_stop else length + LONG
    taps: list[tuple[float, float]] = []
    if transients in ("taps", "knocks alone"):
        for low, high in ((1.8, 3.2), (length - 4.3, length - 2.7)):
            first = random.uniform(low, high)
            taps += [(when, random.uniform(3e-4, 7e-4)) for when in (first, first + 0.9)]
    if transients == "knocks alone":
        start, stop = length + LONG, length + 2.0 * LONG
    radius = float(np.exp(random.uniform(np.log(0.01), np.log(0.1))))
    return RandomMotion(
        frequency, radius, float(random.uniform(0.0, 0.25)), float(random.uniform(0.0, 0.02)),
        start, ramps[0], stop, ramps[1], tuple(taps),
    )  # fmt: skip
