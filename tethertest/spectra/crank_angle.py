"""Order tracking: the angle the crank has turned, from a measured motion, as the clock of a channel."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from tethertest.records.arrays import FloatArray, frozen
from tethertest.records.channel import Channel, Window
from tethertest.records.lines import DriveFit
from tethertest.signal.filters import filled, moving_mean
from tethertest.signal.noise import white_noise
from tethertest.spectra.regression import TREND_DEGREE

#: cycles over which the phase is measured: one for a motion, whose whole orders then drop out; two for a
#: response, so that a line at half the drive drops out as well and is not followed as wander
CYCLES_OF_MOTION: Final = 1.0
CYCLES_OF_RESPONSE: Final = 2.0
#: passes; each recovers most of the wander that the mean over whole cycles left of the one before
PASSES: Final = 2
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

    @property
    def varies(self) -> bool:
        """The speed varies by more than noise and by enough to smear the orders."""
        return self.wander > max(SMALLEST_WANDER, WANDER_RATIO * self.noise)

    def steadied(self, channel: Channel) -> Channel:
        """Return the part of a channel within the window, on the clock of a steadily turning crank."""
        part = channel.between(self.window.start, self.window.stop)
        time = np.interp(part.time, self.time, self.turned)
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
        At the channel's own times in the window.

    References
    ----------
    K. R. Fyfe, E. D. S. Munck, Mech. Syst. Signal Process. 11 (1997) 187-205 (computed order tracking).
    """
    part = channel.between(window.start, window.stop)
    values, time, frequency = filled(part), np.asarray(part.time), drive.frequency
    cycles = CYCLES_OF_MOTION if channel.kind == "displacement" else CYCLES_OF_RESPONSE
    length = cycles / frequency * part.rate
    # a mean over whole cycles is blind to the level, but not to its drift
    values = values - np.polynomial.Polynomial.fit(time, values, TREND_DEGREE)(time)
    turned, amplitude = time.copy(), 0.0
    for _ in range(PASSES):
        carrier = np.exp(-2j * np.pi * frequency * (turned - window.start))
        vector = 2.0 * moving_mean(values * carrier, length)
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
    return CrankAngle(
        channel.name,
        replace(window),
        frequency,
        frozen(time),
        frozen(_rising(turned)),
        float(np.sqrt(np.mean(strayed**2))),
        float(noise),
        float(np.std(speed)) if speed.size else 0.0,
    )


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
