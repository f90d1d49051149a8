"""What the lists of a TDMS file say of its channels, before their samples are read."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, TypeAlias

import numpy as np

from tethertest.errors import FileFormatError
from tethertest.readers.channels import unique_names
from tethertest.records.arrays import FloatArray

#: sampling interval above which a property is damaged: a day [s]
_LONGEST: Final = 86400.0
_EPOCH = np.datetime64(0, "ns")
Key: TypeAlias = tuple[str, str]  # group and channel


@dataclass(frozen=True, slots=True)
class Source:
    """One channel and where its time comes from."""

    key: Key
    name: str
    unit: str
    clock: Key | None  #: channel of the group that is its time
    offset: float  #: [s] of its first sample, without a clock
    increment: float  #: [s]

    def time(self, begin: int, end: int) -> FloatArray:
        """Return the time of some of its samples."""
        time = np.arange(begin, end, dtype=np.float64)
        time *= self.increment
        time += self.offset
        return time


@dataclass(frozen=True, slots=True)
class Plan:
    """What the file's own lists say of its channels."""

    sources: tuple[Source, ...]
    lengths: dict[Key, int]  #: of every channel that is read
    origins: dict[Key, np.datetime64]  #: first stamp of clocks of stamps
    start: np.datetime64 | None
    rate: float | None
    remarks: tuple[str, ...]

    def ready(self, held: dict[Key, list[FloatArray]]) -> list[int]:
        """Return how many samples of each channel are at hand together with their time."""
        counts = {key: sum(map(len, parts)) for key, parts in held.items()}
        for source in self.sources:
            if source.clock is not None:
                counts[source.clock] = min(counts[source.clock], counts[source.key])
        return [counts[source.clock or source.key] for source in self.sources]


def planned(path: Path, file: Any) -> Plan:
    """Return what is to be read from an opened file.

    Raises
    ------
    FileFormatError
        The file holds no data, or a channel has no time.
    """
    found = [channel for group in file.groups() for channel in group.channels()]
    clocks = {group.name: _time_channel(group) for group in file.groups()}
    remarks: list[str] = []
    data = []
    for channel in found:
        if channel is clocks[channel.group_name]:
            continue
        if channel.data_type is None or not _is_numeric(channel):
            remarks.append(f"channel {channel.name!r} holds no numbers and is left out")
        else:
            data.append(channel)
    if not any(len(channel) for channel in data):
        message = "the log has no data: it is empty or was cut"
        raise FileFormatError(message, "copy the whole file from the logger again", path=path)
    starts = [_start(channel, clocks[channel.group_name]) for channel in data]
    known = [start for start in starts if start is not None]
    first = min(known) if known else None
    repeated = Counter(channel.name for channel in data)
    names, renamed = unique_names(
        f"{channel.group_name}/{channel.name}" if repeated[channel.name] > 1 else channel.name
        for channel in data
    )
    sources = []
    lengths: dict[Key, int] = {}
    origins: dict[Key, np.datetime64] = {}
    for channel, name, start in zip(data, names, starts, strict=True):
        clock = clocks[channel.group_name]
        source = _source(path, channel, clock, name, start, first)
        sources.append(source)
        lengths[source.key] = len(channel)
        if source.clock is not None and clock is not None:
            lengths[source.clock] = len(clock)
            if clock.dtype.kind == "M" and len(clock):
                origins[source.clock] = clock[0]
    remarks += [f"channel {name!r} has no samples" for channel, name in zip(data, names, strict=True)
                if not len(channel)]  # fmt: skip
    rates = {1.0 / increment for channel in data if (increment := _increment(channel)) > 0}
    if len(rates) > 1:
        remarks.append(
            f"the channels have {len(rates)} rates: {', '.join(f'{rate:g} Hz' for rate in sorted(rates))}"
        )
    rate = rates.pop() if len(rates) == 1 else None
    return Plan(tuple(sources), lengths, origins, first, rate, (*renamed, *remarks))


def _source(
    path: Path, channel: Any, clock: Any | None, name: str, start: np.datetime64 | None,
    first: np.datetime64 | None,
) -> Source:  # fmt: skip
    key = (channel.group_name, channel.name)
    unit = str(channel.properties.get("unit_string", "")).strip()
    if clock is not None:
        if len(clock) != len(channel):
            message = (
                f"channel {channel.name!r} has {len(channel)} samples, "
                f"its time {clock.name!r} has {len(clock)}"
            )
            raise FileFormatError(message, "export the log again", path=path)
        return Source(key, name, unit, (clock.group_name, clock.name), 0.0, 0.0)
    increment = _increment(channel)
    if increment <= 0 and len(channel):
        message = f"channel {channel.name!r} has neither wf_increment nor a time channel"
        raise FileFormatError(message, "log it as a waveform, or export it with a time channel", path=path)
    shift = 0.0 if start is None or first is None else float((start - first) / np.timedelta64(1, "s"))
    offset = shift + float(channel.properties.get("wf_start_offset", 0.0))
    return Source(key, name, unit, None, offset, increment)


def _is_numeric(channel: Any) -> bool:
    return np.issubdtype(channel.dtype, np.number) and not np.issubdtype(channel.dtype, np.complexfloating)


def _time_channel(group: Any) -> Any | None:
    """Return the group's channel of stamps or seconds, if its other channels are no waveforms."""
    if any(_increment(channel) > 0 for channel in group.channels()):
        return None
    stamped = [channel for channel in group.channels() if channel.dtype.kind == "M"]
    named = [
        channel
        for channel in group.channels()
        if _is_numeric(channel) and channel.name.strip().lower() in {"time", "t", "timestamp", "x_value"}
    ]
    return next(iter([*stamped, *named]), None)


def _increment(channel: Any) -> float:
    increment = float(channel.properties.get("wf_increment", 0.0))
    return increment if increment <= _LONGEST else 0.0


def _start(channel: Any, clock: Any | None) -> np.datetime64 | None:
    """Return the channel's first instant, UTC."""
    if clock is not None:
        stamped = clock.dtype.kind == "M" and len(clock) > 0
        return clock[0].astype("datetime64[ns]") if stamped else None
    stamp = channel.properties.get("wf_start_time")
    if stamp is None:
        return None
    stamp = np.datetime64(stamp).astype("datetime64[ns]")
    # a waveform without a clock has LabVIEW's zero, 1904
    return stamp if stamp > _EPOCH else None
