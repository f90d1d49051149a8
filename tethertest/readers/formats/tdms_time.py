"""Where the time of a TDMS channel comes from: its waveform, recorded once or more, or its group's clock."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any, Final, TypeAlias

import numpy as np

from tethertest.errors import FileFormatError
from tethertest.readers.tables.time_units import SECONDS, epoch_start
from tethertest.records.arrays import FloatArray

Key: TypeAlias = tuple[str, str]  # group and channel
#: a channel that is a group's time, without a unit that says so
_TIME_NAMES: Final = frozenset(["time", "t", "timestamp", "x_value"])
_EPOCH: Final = np.datetime64(0, "ns")
#: sampling interval above which a property is damaged: a day [s]
_LONGEST: Final = 86400.0
#: a recording that begins within this part of a sampling interval of where the last one ended goes on
_GOES_ON: Final = 0.5
#: segments that scatter by the computer's clock are as many at least, and this often the median jump at most
_FEWEST_STAMPS, _SCATTER = 4, 5.0
#: properties that say when a channel was recorded
TIME: Final = ("wf_start_time", "wf_increment", "wf_start_offset", "wf_xname", "wf_xunit_string")
#: beginnings of properties that say what its numbers are: one channel has one of each
MEANING: Final = ("unit_string", "NI_Unit", "NI_Scal", "NI_Number_Of_Scales", "wf_xname", "wf_xunit_string")


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


@dataclass(frozen=True, slots=True)
class Recording:
    """Samples of one channel that were taken in one go."""

    first: int  #: sample of the channel
    start: np.datetime64 | None  #: UTC, where it is known
    increment: float  #: [s], 0 where there is none


def recordings(path: Path, file: Any, channel: Any) -> tuple[tuple[Recording, ...], str]:
    """Return the recordings that a channel consists of, and a remark where their starts are uncertain.

    Parameters
    ----------
    path : Path
        For messages.
    file : FileWithHistory
        The opened file.
    channel : nptdms.TdmsChannel
        One of its channels, a waveform or without a time of its own.

    Raises
    ------
    FileFormatError
        Unit or scaling change, or only some of the recordings say when they began.
    """
    said = [(first, known) for first, known in file.history.get(channel.path, ()) if first < len(channel)]
    if len(said) < 2:
        return (_recording(0, channel.properties),), ""
    (_, before), *later = said
    for first, known in later:
        _refuse_other_meaning(path, channel.name, first, before, known)
    found, remark = _apart(channel.name, [_recording(first, known) for first, known in said])
    if len({item.start is None for item in found}) > 1:
        message = f"channel {channel.name!r} has {len(found)} recordings, and not all say when they began"
        raise FileFormatError(message, "save each recording in a file of its own", path=path)
    return tuple(found), remark


def _recording(first: int, properties: Any) -> Recording:
    increment = float(properties.get("wf_increment", 0.0))
    stamp = properties.get("wf_start_time")
    if stamp is not None:
        stamp = np.datetime64(stamp.as_datetime64() if hasattr(stamp, "as_datetime64") else stamp)
        stamp = stamp.astype("datetime64[ns]")
    # a waveform without a clock has LabVIEW's zero, 1904
    known = stamp if stamp is not None and stamp > _EPOCH else None
    factor, _ = abscissa(properties)
    return Recording(first, known, factor * increment if increment <= _LONGEST else 0.0)


def _apart(name: str, said: list[Recording]) -> tuple[list[Recording], str]:
    """Return what does not go on from what was said before it.

    A loop that stamps what it reads by the computer's clock scatters about the samples' own time, and some
    of its stamps lie before the end of what came before: a recording that was appended does not.
    """
    jumps = [_jump(earlier, later) for earlier, later in pairwise(said)]
    known = [jump for jump in jumps if jump is not None]
    is_scattered = len(known) >= _FEWEST_STAMPS and min(known) < 0.0
    scatter = _SCATTER * float(np.median(np.abs(known))) if is_scattered else 0.0
    found, largest = [said[0]], 0.0
    for (earlier, later), jump in zip(pairwise(said), jumps, strict=True):
        lasted = (later.first - earlier.first) * earlier.increment
        if jump is None or abs(jump) > max(_GOES_ON * earlier.increment, min(scatter, lasted)):
            found.append(later)
        else:
            largest = max(largest, abs(jump))
    if largest <= _GOES_ON * said[0].increment:
        return found, ""
    off = f"channel {name!r}: its segments are stamped up to {1e3 * largest:.3g} ms off even samples"
    return found, f"{off}: the stamps are of the computer's clock, and the samples are taken as even"


def _jump(earlier: Recording, later: Recording) -> float | None:
    """Return how much later than expected it begins [s]; None where it cannot go on."""
    if later.increment != earlier.increment or (earlier.start is None) != (later.start is None):
        return None
    if earlier.start is None or later.start is None or earlier.start == later.start:
        return 0.0
    apart = float((later.start - earlier.start) / np.timedelta64(1, "s"))
    return apart - (later.first - earlier.first) * earlier.increment


def _refuse_other_meaning(
    path: Path, name: str, first: int, before: dict[str, Any], known: dict[str, Any]
) -> None:
    for key, value in known.items():
        if key.startswith(MEANING) and key in before and before[key] != value:
            message = (
                f"channel {name!r} changes from sample {first + 1} on: {key} is {value!r}, "
                f"it was {before[key]!r}: one recording was appended to another"
            )
            raise FileFormatError(message, "save each recording in a file of its own", path=path)
