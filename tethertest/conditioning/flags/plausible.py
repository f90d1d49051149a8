"""What no sensor writes: dead channels, stamps in another unit of time, values far beyond the range."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from tethertest.conditioning.flags.limits import sensor_of
from tethertest.errors import DataError
from tethertest.records.channel import Channel, Finding, Flag, Severity, Window
from tethertest.records.rig import Rig, sensor_range

#: a log is at most so many times faster or slower than its instrument: milliseconds read as seconds are not
RATE_FACTOR = 50.0
#: a channel with more than this share of its samples beyond the range has another unit or another sensor
BEYOND_SHARE = 0.5
#: a hole in the bottom motion is bridged by a straight line: over this share of a drive period that changes
#: the tension by some 5 %
LONGEST_HOLE = 0.05
#: kinds without which nothing can be compared; a dead grating is one of several and is left out
NEEDED = ("tension", "displacement")


def check_rate(channel: Channel, rig: Rig) -> None:
    """Refuse a log whose rate its instrument cannot have.

    Raises
    ------
    DataError
        The rate differs from the instrument's by more than `RATE_FACTOR`.
    """
    source = channel.source
    instrument = next((item for item in rig.instrument if source and item.name == source.clock), None)
    if instrument is None or 1.0 / RATE_FACTOR <= channel.rate / instrument.rate <= RATE_FACTOR:
        return
    message = (
        f"channel {channel.name!r} has {channel.rate:.4g} samples per second by its stamps, and instrument "
        f"{instrument.name!r} of the rig logs {instrument.rate:.4g}"
    )
    remedy = "export the log again with its time in seconds, or correct the instrument's rate in the rig file"
    raise DataError(message, remedy, path=source.file if source else None)


def check_alive(channel: Channel) -> None:
    """Refuse a load cell or an encoder of which no sample can be used.

    Raises
    ------
    DataError
        With what is wrong with the samples.
    """
    if channel.kind not in NEEDED or channel.usable.any():
        return
    counts = channel.flag_counts()
    why = ", ".join(f"{count} {name.replace('_', ' ')}" for name, count in counts.items())
    message = f"no sample of {channel.name!r} can be used: {why}"
    remedy = (
        "look at the sensor and its cable and export the log again; to report the other channels, leave this "
        "one out of run.toml"
    )
    raise DataError(message, remedy, path=channel.source.file if channel.source else None)


def check_range(channel: Channel, rig: Rig) -> None:
    """Refuse a channel that is mostly beyond its sensor's range: its unit or its calibration is wrong.

    Parameters
    ----------
    channel : Channel
        With `Flag.OUT_OF_RANGE` about a believable zero.
    rig : Rig
        Its sensor.

    Raises
    ------
    DataError
        More than `BEYOND_SHARE` of the samples are flagged.
    """
    share = float(np.mean((channel.flags & np.uint16(Flag.OUT_OF_RANGE)) != 0))
    if share <= BEYOND_SHARE:
        return
    low, high = sensor_range(sensor_of(rig, channel))
    source = channel.source
    unit = f" as {source.unit_as_written}" if source and source.unit_as_written else ""
    message = (
        f"{share:.0%} of {channel.name!r}, logged{unit}, lies beyond its range of {low:g} to {high:g} "
        f"{channel.unit}"
    )
    remedy = (
        "correct the unit (units under its [[log]]), the sensor in channels, or the sensor's range and "
        "calibration in the rig file"
    )
    raise DataError(message, remedy, path=source.file if source else None)


def hole_findings(
    channels: Sequence[Channel], steady: Window | None, frequency: float | None
) -> list[Finding]:
    """Return a fatal finding for each hole in the bottom motion that is too long to be bridged.

    Parameters
    ----------
    channels : sequence of Channel
        On the run's clock, with all flags.
    steady : Window or None
        Only holes in it count.
    frequency : float or None
        Drive frequency [Hz].
    """
    if steady is None or frequency is None:
        return []
    found: list[Finding] = []
    for channel in channels:
        if channel.kind != "displacement":
            continue
        time = channel.time[channel.usable]
        longest = LONGEST_HOLE / frequency + 1.0 / channel.rate
        for index in np.flatnonzero(np.diff(time) > longest):
            start, stop = float(time[index]), float(time[index + 1])
            if stop <= steady.start or start >= steady.stop:
                continue
            hole = f"{start:.3f} s to {stop:.3f} s"
            text = (
                f"the replay needs its samples from {hole}, and none is usable; set [windows] steady beside"
            )
            found.append(Finding(channel.name, "motion_hole", text, Severity.FATAL, ((start, stop),)))
    return found
