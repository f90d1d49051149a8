"""How the base moves: a crank-slider with ramps, a gear error, and taps by hand."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

ROD_RATIO = 0.25
REST_ANGLE = -0.5 * math.pi
TAP_WIDTH = 0.06


@dataclass(frozen=True)
class Tap:
    """A knock on the base plate: a sine-squared pulse.

    Parameters
    ----------
    start, height : float
        When it begins, in s, and how high it lifts the base, in m.
    """

    start: float
    height: float

    def displacement(self, time: Floats) -> Floats:
        """Return the base's height in m due to this tap."""
        phase = np.clip((time - self.start) / TAP_WIDTH, 0.0, 1.0)
        return np.asarray(self.height * np.sin(np.pi * phase) ** 2)


@dataclass(frozen=True)
class Drive:
    """The crank: still, ramped up, steady, ramped down, still again at its home mark.

    Parameters
    ----------
    frequency, radius : float
        Crank speed in Hz and radius in m; zero frequency is no drive.
    start, ramp_up, stop, ramp_down : float
        When the crank starts, how long its speed rises, when the speed begins to fall and how
        long that takes, in s.
    gear_error : float
        Amplitude in m of a displacement at half the crank's speed.
    """

    frequency: float = 0.0
    radius: float = 0.0
    start: float = 0.0
    ramp_up: float = 8.0
    stop: float = 0.0
    ramp_down: float = 8.0
    gear_error: float = 0.0

    def turned(self, time: Floats) -> Floats:
        """Return the angle the crank has turned since rest, in rad."""
        up = self.ramp_up * _ramp_area(np.clip((time - self.start) / self.ramp_up, 0.0, 1.0))
        steady = np.clip(time, self.start + self.ramp_up, self.stop) - self.start - self.ramp_up
        down = np.clip((time - self.stop) / self.ramp_down, 0.0, 1.0)
        falling = self.ramp_down * (down - _ramp_area(down))
        return np.asarray(2.0 * np.pi * self.frequency * (up + steady + falling))

    def displacement(self, time: Floats) -> Floats:
        """Return the base's height in m, zero at rest."""
        if self.frequency == 0.0:
            return np.zeros_like(time)
        turned = self.turned(time)
        slider = _slider(REST_ANGLE + turned) - _slider(np.array(REST_ANGLE))
        return np.asarray(self.radius * slider + self.gear_error * np.sin(0.5 * turned))


@dataclass(frozen=True)
class BaseMotion:
    """The crank's motion and the taps on top of it."""

    drive: Drive
    taps: tuple[Tap, ...]

    def __call__(self, time: Floats) -> Floats:
        """Return the base's height in m at the times given."""
        height = self.drive.displacement(np.asarray(time, dtype=float))
        for tap in self.taps:
            height = height + tap.displacement(time)
        return height


def _ramp_area(progress: Floats) -> Floats:
    """Integral of the speed ramp r^3 (10 - 15 r + 6 r^2) from zero."""
    return np.asarray(progress**4 * (2.5 - 3.0 * progress + progress**2))


def _slider(angle: Floats) -> Floats:
    """Slider height over the radius at a crank angle."""
    swing = np.sqrt(1.0 - (ROD_RATIO * np.sin(angle)) ** 2)
    return np.asarray(np.cos(angle) + swing / ROD_RATIO)
