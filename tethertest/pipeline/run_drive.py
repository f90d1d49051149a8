"""The drive of a run: its frequency, and its crank's angle where the motion was measured."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Final

from tethertest.records.channel import Channel, ConditionedRun, Window
from tethertest.records.lines import DriveFit
from tethertest.spectra import fit_drive
from tethertest.spectra.crank_angle import CrankAngle, crank_angle

#: the sensor that measures the bottom motion
MOTION: Final = "heave"
#: kinds that no drive moves: smoothed by the instrument they would pass for the most exact channels
SLOW_KINDS: Final = frozenset(["temperature", "count", "other"])


def drive_channels(measured: ConditionedRun, wanted: Sequence[Channel] = ()) -> list[Channel]:
    """Return the channels that tell a run's drive: its motion, else its tensions, else those wanted.

    Parameters
    ----------
    measured : ConditionedRun
        The run.
    wanted : sequence of Channel, optional
        Those that are analysed; all of the run's where empty.
    """
    heave = measured.channel(MOTION)
    if heave is not None:
        return [heave]
    among = list(wanted or measured.channels)
    mechanical = [channel for channel in among if channel.kind not in SLOW_KINDS]
    return [channel for channel in among if channel.kind == "tension"] or mechanical or among


def run_drive(
    measured: ConditionedRun, channels: Sequence[Channel], window: Window, nominal: float
) -> DriveFit:
    """Return a run's drive as its channels show it, the drift of their clocks in the standard error.

    Parameters
    ----------
    measured : ConditionedRun
        The run, with its clocks.
    channels : sequence of Channel
        As `drive_channels` returns them.
    window : Window
        The steady part.
    nominal : float
        Frequency as set [Hz].

    Raises
    ------
    DataError
        No drive near its nominal frequency.
    """
    fit = fit_drive(channels, window, nominal)
    clocks = {clock.clock: clock.drift_error for clock in measured.clocks}
    drift_error = max(clocks.get(c.source.clock, 0.0) if c.source else 0.0 for c in channels)
    return replace(fit, standard_error=math.hypot(fit.standard_error, drift_error * fit.frequency))


def run_crank(measured: ConditionedRun, window: Window, drive: DriveFit) -> CrankAngle | None:
    """Return the crank's angle by the measured motion, or nothing where that does not tell it clearly.

    Without it a channel whose own order 1 wanders is put on the clock of that.
    """
    heave = measured.channel(MOTION)
    if heave is None:
        return None
    crank = crank_angle(heave, window, drive)
    return crank if crank.clear else None
