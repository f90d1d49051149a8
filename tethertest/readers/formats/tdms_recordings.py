"""TDMS files to which another recording was appended: what a later segment says anew of a channel."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np

from tethertest.errors import FileFormatError

_EPOCH: Final = np.datetime64(0, "ns")
#: sampling interval above which a property is damaged: a day [s]
_LONGEST: Final = 86400.0
#: a recording that begins within this part of a sampling interval of where the last one ended goes on
_GOES_ON: Final = 0.5
#: properties that say when a channel was recorded
TIME: Final = ("wf_start_time", "wf_increment", "wf_start_offset", "wf_xname", "wf_xunit_string")
#: beginnings of properties that say what its numbers are: one channel has one of each
MEANING: Final = ("unit_string", "NI_Unit", "NI_Scal", "NI_Number_Of_Scales", "wf_xname", "wf_xunit_string")


@dataclass(frozen=True, slots=True)
class Recording:
    """Samples of one channel that were taken in one go."""

    first: int  #: sample of the channel
    start: np.datetime64 | None  #: UTC, where it is known
    increment: float  #: [s], 0 where there is none


def recordings(path: Path, file: Any, channel: Any) -> tuple[Recording, ...]:
    """Return the recordings that a channel consists of; one, if the file says nothing else.

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
        return (_recording(0, channel.properties),)
    (_, before), *later = said
    for first, known in later:
        _refuse_other_meaning(path, channel.name, first, before, known)
    found: list[Recording] = []
    for first, known in said:
        item = _recording(first, known)
        if found and _goes_on(found[-1], item):
            continue
        found.append(item)
    if len({item.start is None for item in found}) > 1:
        message = f"channel {channel.name!r} has {len(found)} recordings, and not all say when they began"
        raise FileFormatError(message, "save each recording in a file of its own", path=path)
    return tuple(found)


def _recording(first: int, properties: Any) -> Recording:
    increment = float(properties.get("wf_increment", 0.0))
    stamp = properties.get("wf_start_time")
    if stamp is not None:
        stamp = np.datetime64(stamp.as_datetime64() if hasattr(stamp, "as_datetime64") else stamp)
        stamp = stamp.astype("datetime64[ns]")
    # a waveform without a clock has LabVIEW's zero, 1904
    known = stamp if stamp is not None and stamp > _EPOCH else None
    return Recording(first, known, increment if increment <= _LONGEST else 0.0)


def _goes_on(earlier: Recording, later: Recording) -> bool:
    if later.increment != earlier.increment:
        return False
    if earlier.start is None or later.start is None:
        return earlier.start is later.start
    apart = float((later.start - earlier.start) / np.timedelta64(1, "s"))
    expected = (later.first - earlier.first) * earlier.increment
    return later.start == earlier.start or abs(apart - expected) <= _GOES_ON * earlier.increment


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
