"""Where the time of a TDMS channel comes from: its waveform, or a channel of its group."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, TypeAlias

import numpy as np

from tethertest.errors import FileFormatError
from tethertest.readers.timeunits import SECONDS, epoch_start
from tethertest.records.arrays import FloatArray

Key: TypeAlias = tuple[str, str]  # group and channel
#: a channel that is a group's time, without a unit that says so
_TIME_NAMES: Final = frozenset(["time", "t", "timestamp", "x_value"])


@dataclass(frozen=True, slots=True)
class Piece:
    """Samples that follow one another in even steps."""

    first: int  #: sample of the channel
    offset: float  #: [s] of that sample
    increment: float  #: [s]


@dataclass(frozen=True, slots=True)
class Clock:
    """A channel that is the time of its group, and what it counts."""

    key: Key
    start: np.datetime64 | None  #: its first sample, UTC, where it is an instant
    origin: Any  #: what is taken off its samples: the first stamp or count, 0 for plain seconds
    factor: float  #: seconds per count, for numbers
    remarks: tuple[str, ...] = ()
    offset: float = 0.0  #: from the log's start to `start` [s]

    def seconds(self, values: Any) -> FloatArray:
        """Return samples of it as seconds since the log's start."""
        since = values - self.origin
        seconds = since / np.timedelta64(1, "s") if since.dtype.kind == "m" else since * self.factor
        return np.asarray(seconds + self.offset, dtype=np.float64)


def piecewise(pieces: tuple[Piece, ...], begin: int, end: int) -> FloatArray:
    """Return the time of the samples of a waveform from `begin` up to `end` [s]."""
    time = np.arange(begin, end, dtype=np.float64)
    ends = (*(piece.first for piece in pieces[1:]), end)
    for piece, stop in zip(pieces, ends, strict=True):
        part = time[max(piece.first - begin, 0) : max(stop - begin, 0)]
        part -= piece.first
        part *= piece.increment
        part += piece.offset
    return time


def time_channel(group: Any) -> Any | None:
    """Return the group's channel of stamps or seconds, if its other channels are no waveforms."""
    if any(float(channel.properties.get("wf_increment", 0.0)) > 0 for channel in group.channels()):
        return None
    stamped = [channel for channel in group.channels() if channel.dtype.kind == "M"]
    named = [
        channel
        for channel in group.channels()
        if np.issubdtype(channel.dtype, np.number) and channel.name.strip().lower() in _TIME_NAMES
    ]
    return next(iter([*stamped, *named]), None)


def clock_of(path: Path, channel: Any) -> Clock:
    """Return what a group's time channel counts.

    Parameters
    ----------
    path : Path
        For messages.
    channel : nptdms.TdmsChannel
        Of stamps or numbers.

    Raises
    ------
    FileFormatError
        Its unit is none of time.
    """
    key = (channel.group_name, channel.name)
    first: Any = 0.0
    if len(channel):
        first = channel[0]
    if channel.dtype.kind == "M":
        return Clock(key, first.astype("datetime64[ns]") if len(channel) else None, first, 1.0)
    unit = str(channel.properties.get("unit_string", "")).strip()
    epoch = epoch_start(float(first), unit)
    if epoch is not None:
        start, factor, remark = epoch
        instant = np.datetime64(start.replace(tzinfo=None), "ns")
        return Clock(key, instant, first, factor, (f"channel {channel.name!r}: {remark}",))
    if not unit:
        return Clock(key, None, 0, 1.0, (f"the time {channel.name!r} has no unit and is taken as seconds",))
    if unit.lower() not in SECONDS:
        message = f"the time channel {channel.name!r} has the unit {unit!r}, expected s, ms, us, min or h"
        raise FileFormatError(message, "correct its unit_string, or export the log as text", path=path)
    return Clock(key, None, 0, SECONDS[unit.lower()])


def abscissa(properties: Any) -> tuple[float, str]:
    """Return the seconds per unit of a waveform's abscissa, and what it is where that is no time."""
    name = str(properties.get("wf_xname", "")).strip()
    unit = str(properties.get("wf_xunit_string", "")).strip()
    if unit.lower() in SECONDS and not name.lower().startswith("freq"):
        return SECONDS[unit.lower()], ""
    if unit or name.lower().startswith("freq"):
        return 0.0, f"{name or 'an abscissa'} [{unit or '?'}]"
    return 1.0, ""
