"""What the cable's own inertia puts between two places of it, by the best that is known of its motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tethertest.conditioning.rig_priors import RigPriors
from tethertest.conditioning.stated import (
    STATED_AMPLITUDE,
    bottom_displacement,
    moves_otherwise,
    stated_amplitude,
)
from tethertest.records.channel import Channel, Window
from tethertest.records.run import Run

#: a motion is measured where at least this share of the window's samples may be used
ENOUGH = 0.5


@dataclass(frozen=True, slots=True)
class Inertia:
    """The force that the cable's mass makes between its ends, and why it is not better known."""

    force: float  #: standard deviation in the window [N]
    doubt: str = ""  #: empty where the motion was measured and is as stated


@dataclass(frozen=True, slots=True)
class _Motion:
    """How far the bottom moves."""

    size: float  #: standard deviation [m]
    doubt: str = ""


def cable_inertia(run: Run, channels: Sequence[Channel], window: Window, priors: RigPriors) -> Inertia:
    """Return what the cable's own inertia adds between its ends while it follows the drive.

    The motion is the measured one; where the run file states another, the larger of both, as either may be
    wrong; where none was measured, what the run file states, and as much more as is believed of a statement;
    where it states none, what the smallest tension asks of the rig.

    Parameters
    ----------
    run : Run
        Drive as stated; mass of the cable; platform.
    channels : sequence of Channel
        Conditioned displacements [m] and tensions [N] on one clock.
    window : Window
        Where tensions are compared.
    priors : RigPriors
        Frequency of the drive [Hz]; the run file's where it has none. How tension answers motion.
    """
    frequency = priors.drive_frequency or run.file.drive.frequency
    if frequency is None:
        return Inertia(0.0, "no drive frequency is known, so nothing is allowed for the cable's inertia")
    motion = _measured(run, channels, window) or _unmeasured(run, channels, window, frequency, priors)
    weight = run.rig.cable.mass_per_length * run.rig.cable.length
    return Inertia(weight * (2.0 * np.pi * frequency) ** 2 * motion.size, motion.doubt)


def _measured(run: Run, channels: Sequence[Channel], window: Window) -> _Motion | None:
    heave = bottom_displacement(channels)
    size = None if heave is None else _deviation(heave, window)
    if heave is None or size is None:
        return None
    otherwise, stated = moves_otherwise(run, heave, window), stated_amplitude(run)
    if otherwise is None or stated is None:
        return _Motion(size)
    return _Motion(max(size, stated / np.sqrt(2.0)), otherwise)


def _unmeasured(
    run: Run, channels: Sequence[Channel], window: Window, frequency: float, priors: RigPriors
) -> _Motion:
    unseen = "no bottom motion was measured: the cable's inertia is by"
    stated = stated_amplitude(run)
    if stated is not None:
        size = (1.0 + STATED_AMPLITUDE) * stated / np.sqrt(2.0)
        return _Motion(size, f"{unseen} the {stated:.4g} m under [drive] of run.toml")
    over = priors.tension_over_motion
    sizes = [
        tension / over(frequency, channel.at)
        for channel in channels
        if over is not None and channel.kind == "tension" and channel.at is not None
        if (tension := _deviation(channel, window)) is not None
    ]
    return _Motion(min(sizes, default=0.0), f"{unseen} what the tension asks of the platform")


def _deviation(channel: Channel, window: Window) -> float | None:
    """Return the standard deviation of usable samples, None where there are too few."""
    part = channel.between(window.start, window.stop)
    usable = part.usable
    if np.count_nonzero(usable) < max(1.0, ENOUGH * window.length * channel.rate):
        return None
    return float(np.std(part.values[usable]))
