"""Order tracking: the angle the crank has turned, from a measured motion, as the clock of a channel."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from tethertest.records.arrays import FloatArray, frozen
from tethertest.records.channel import Channel, Window
from tethertest.records.lines import DriveFit
from tethertest.signal.filters import moving_mean
from tethertest.signal.noise import white_noise
from tethertest.spectra.regression import TREND_DEGREE

#: cycles over which the phase is measured: one for a motion, whose whole orders then drop out; two for a
#: response, so that a line at half the drive drops out as well and is not followed as wander
CYCLES_OF_MOTION: Final = 1.0
CYCLES_OF_RESPONSE: Final = 2.0
#: passes; each recovers most of the wander that the mean over whole cycles left of the one before
PASSES: Final = 2
#: a motion with more than this at half the drive, relative, is measured over two cycles as well
LARGEST_HALF_ORDER: Final = 0.01
#: orders fitted beside the drift, 1/2 and 1 first, and samples per cycle that this takes
ORDERS_OF_LEVEL: Final = (0.5, 1.0, 1.5, 2.0, 3.0)
SAMPLES_PER_CYCLE: Final = 40.0
#: cycles without a sample after which the speed in between is not known
LONGEST_HOLE: Final = 0.5
#: wander below this phase [rad, root mean square] leaves side lines below a hundredth of the drive
SMALLEST_WANDER: Final = 0.01
#: and it must stand this far above what noise feigns
WANDER_RATIO: Final = 3.0


@dataclass(frozen=True, slots=True, eq=False)
class CrankAngle:
    """The drive's phase over time within a window, against steady turning."""

    channel: str  #: it was measured in
    window: Window
    frequency: float  #: mean over the window [Hz]
    time: FloatArray  #: (n,) [s]
    turned: FloatArray  #: (n,) [s] time at which a steady crank would have come as far
    wander: float  #: root mean square of the phase against steady turning [rad]
    noise: float  #: of it, what the channel's noise feigns [rad]
    speed_variation: float  #: root mean square of the speed over its mean, less one
    hole: float = 0.0  #: longest time without a usable sample [cycles]

    @property
    def clear(self) -> bool:
        """The channel would show a wander that matters, all through the window."""
        return WANDER_RATIO * self.noise <= SMALLEST_WANDER and self.hole <= LONGEST_HOLE

    @property
    def varies(self) -> bool:
        """The speed varies by more than noise and by enough to smear the orders."""
        return self.wander > max(SMALLEST_WANDER, WANDER_RATIO * self.noise)

    def steadied(self, channel: Channel) -> Channel:
        """Return the part of a channel within the window, on the clock of a steadily turning crank."""
        part = channel.between(self.window.start, self.window.stop)
        # beyond the crank's first and last sample the channel goes on at the mean speed
        time = part.time + np.interp(part.time, self.time, self.turned - self.time)
        step = f"crank angle of {self.channel!r} as the clock, speed varies by {self.speed_variation:.2g}"
        return part.with_time(time, step)


def crank_angle(channel: Channel, window: Window, drive: DriveFit) -> CrankAngle:
    """Return the crank's angle from a motion, or from a response where no motion was measured.

    The series is demodulated at the drive frequency over whole cycles, put on the clock found, and
    demodulated again for what was left.

    Parameters
    ----------
    channel : Channel
        The bottom displacement, whose phase is the crank's; or a tension, whose phase follows the crank's as
        long as its speed changes slowly against the rig's own decay.
    window : Window
        The steady part.
    drive : DriveFit
        Mean frequency in the window.

    Returns
    -------
    CrankAngle
        At even times in the window, as many as the channel has at its rate.

    References
    ----------
    K. R. Fyfe, E. D. S. Munck, Mech. Syst. Signal Process. 11 (1997) 187-205 (computed order tracking).
    """
    part, frequency = channel.between(window.start, window.stop), drive.frequency
    first, last = float(part.time[0]), float(part.time[-1])
    # means over whole cycles count samples, so that these must stand evenly where the log lacks rows
    time = np.linspace(first, last, max(2, round((last - first) * part.rate) + 1))
    usable = part.usable
    seen, values = part.time[usable], part.values[usable]
    fitted = _Fitted.to(seen, values, frequency)
    # holes are bridged by what the orders leave: a straight line through half a cycle would turn the phase
    logged = fitted.orders(time) + np.interp(time, seen, values - fitted.orders(seen))
    alone = channel.kind == "displacement" and fitted.half < LARGEST_HALF_ORDER
    length = (CYCLES_OF_MOTION if alone else CYCLES_OF_RESPONSE) / frequency * part.rate
    turned, amplitude = time.copy(), 0.0
    for _ in range(PASSES):
        # on the clock found so far the drift is known better
        steadied = logged - _Fitted.to(turned, logged, frequency).level(turned)
        carrier = np.exp(-2j * np.pi * frequency * (turned - window.start))
        vector = 2.0 * moving_mean(steadied * carrier, length)
        amplitude = float(np.median(np.abs(vector)))
        phase = _with_held_ends(np.unwrap(np.angle(vector)), 0.5 * length)
        # mean phase and mean speed belong to the fit of the drive, not to the wander
        phase -= np.polynomial.Polynomial.fit(time, phase, 1)(time)
        turned = turned + phase / (2.0 * np.pi * frequency)
    strayed = 2.0 * np.pi * frequency * (turned - time)
    noise = white_noise(values) * np.sqrt(2.0 / length) / max(amplitude, 1e-300)
    # a speed is the slope over a cycle: shorter differences show the ripple within it
    cycle = max(1, min(round(part.rate / frequency), time.size // 2))
    speed = (turned[cycle:] - turned[:-cycle]) / (time[cycle:] - time[:-cycle]) - 1.0
    hole = float(np.max(np.diff(np.concatenate(([first], seen, [last])))))
    return CrankAngle(
        channel.name,
        replace(window),
        frequency,
        frozen(time),
        frozen(_rising(turned)),
        float(np.sqrt(np.mean(strayed**2))),
        float(noise),
        float(np.std(speed)) if speed.size else 0.0,
        hole * frequency,
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Fitted:
    """Level, drift and orders of the drive, fitted together.

    A mean over whole cycles is not blind to a drift; and a drift fitted alone takes a share of the cycles, a
    few per cent at the ends, so that the phase would seem to swing.
    """

    frequency: float  #: [Hz]
    span: tuple[float, float]  #: of the times [s]
    coefficients: FloatArray  #: of the drift, then of the cosines and sines of `ORDERS_OF_LEVEL`

    @classmethod
    def to(cls, time: FloatArray, values: FloatArray, frequency: float) -> _Fitted:
        """Return the fit to a few dozen samples per cycle (n,)."""
        span = (float(time[0]), float(time[-1]))
        cycles = max(1.0, (span[1] - span[0]) * frequency)
        every = slice(None, None, max(1, int(time.size / (SAMPLES_PER_CYCLE * cycles))))
        empty = cls(frequency, span, np.zeros(0))
        columns = np.hstack((empty._drift(time[every]), empty._cycles(time[every])))
        found = np.linalg.lstsq(columns, values[every], rcond=None)[0]
        return replace(empty, coefficients=np.asarray(found, dtype=np.float64))

    @property
    def half(self) -> float:
        """Amplitude of order 1/2 over that of order 1."""
        amplitudes = np.hypot(*self.coefficients[TREND_DEGREE + 1 :].reshape(2, -1))
        return float(amplitudes[0] / max(amplitudes[1], 1e-300))

    def level(self, time: FloatArray) -> FloatArray:
        """Return level and drift (n,)."""
        level: FloatArray = self._drift(time) @ self.coefficients[: TREND_DEGREE + 1]
        return level

    def orders(self, time: FloatArray) -> FloatArray:
        """Return the orders together (n,)."""
        orders: FloatArray = self._cycles(time) @ self.coefficients[TREND_DEGREE + 1 :]
        return orders

    def _drift(self, time: FloatArray) -> FloatArray:
        middle, half = 0.5 * sum(self.span), 0.5 * (self.span[1] - self.span[0])
        return np.asarray(np.polynomial.chebyshev.chebvander((time - middle) / half, TREND_DEGREE))

    def _cycles(self, time: FloatArray) -> FloatArray:
        angle = 2.0 * np.pi * self.frequency * time[:, None] * np.array(ORDERS_OF_LEVEL)
        return np.hstack((np.cos(angle), np.sin(angle)))


def _with_held_ends(phase: FloatArray, half: float) -> FloatArray:
    """Return a phase whose ends, measured over less than whole cycles, keep the nearest whole one."""
    edge = min(int(np.ceil(half)), (phase.size - 1) // 2)
    held: FloatArray = np.pad(phase[edge : phase.size - edge], edge, mode="edge")
    return held


def _rising(turned: FloatArray) -> FloatArray:
    """Return the clock without steps back, which noise makes where a crank all but stops."""
    least = 1e-3 * float(np.median(np.diff(turned)))
    steps = np.maximum(np.diff(turned, prepend=turned[0] - least), least)
    steps[0] = 0.0
    rising: FloatArray = turned[0] + np.cumsum(steps)
    return rising
