"""What the lists of a TDMS file say of its channels, before their samples are read."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from tethertest.errors import FileFormatError
from tethertest.readers.channels import unique_names
from tethertest.readers.formats.tdms_time import (
    Clock,
    Key,
    Piece,
    Recording,
    abscissa,
    clock_of,
    piecewise,
    recordings,
    time_channel,
)
from tethertest.records.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class Source:
    """One channel and where its time comes from."""

    key: Key
    name: str
    unit: str
    clock: Key | None  #: channel of the group that is its time
    pieces: tuple[Piece, ...] = ()  #: without a clock

    def time(self, begin: int, end: int) -> FloatArray:
        """Return the time of some of its samples, which have no clock."""
        return piecewise(self.pieces, begin, end)


@dataclass(frozen=True, slots=True)
class Plan:
    """What the file's own lists say of its channels."""

    sources: tuple[Source, ...]
    lengths: dict[Key, int]  #: of every channel that is read
    clocks: dict[Key, Clock]  #: channels that are a time
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
        The file holds no data, a channel has no time, or changes its meaning.
    """
    times = {group.name: time_channel(group) for group in file.groups()}
    data, remarks = _with_numbers(file, times)
    if not any(len(channel) for channel in data):
        message = "; ".join(["the log has no data: it is empty or was cut", *remarks])
        raise FileFormatError(message, "copy the whole file from the logger again", path=path)
    taken: dict[str, Clock] = {}
    for group, time in times.items():
        if time is not None:
            recordings(path, file, time)  # it has one unit throughout
            taken[group] = clock_of(path, time)
    recorded, doubts = zip(*(recordings(path, file, channel) for channel in data), strict=True)
    instants = [clock.start for clock in taken.values()]
    instants += [item.start for parts, channel in zip(recorded, data, strict=True)
                 if channel.group_name not in taken for item in parts]  # fmt: skip
    known = [instant for instant in instants if instant is not None]
    start = min(known) if known else None
    clocks = {
        group: replace(clock, offset=0.0 if clock.start is None else _seconds(start, clock.start))
        for group, clock in taken.items()
    }
    repeated = Counter(channel.name for channel in data)
    names, renamed = unique_names(
        f"{channel.group_name}/{channel.name}" if repeated[channel.name] > 1 else channel.name
        for channel in data
    )
    sources = []
    for channel, name, parts in zip(data, names, recorded, strict=True):
        sources.append(
            _source(
                path, channel, clocks.get(channel.group_name), times[channel.group_name], name, parts, start
            )
        )
        if not len(channel):
            remarks.append(f"channel {name!r} has no samples")
        elif not sources[-1].clock and len(parts) > 1:
            remarks.append(_appended(name, parts))
    lengths = {source.key: len(channel) for source, channel in zip(sources, data, strict=True)}
    lengths |= {source.clock: lengths[source.key] for source in sources if source.clock is not None}
    rates = sorted(
        {1.0 / piece.increment for source in sources for piece in source.pieces if piece.increment}
    )
    if len(rates) > 1:
        remarks.append(f"the channels have {len(rates)} rates: {', '.join(f'{rate:g} Hz' for rate in rates)}")
    said = (remark for clock in clocks.values() for remark in clock.remarks)
    return Plan(
        tuple(sources),
        lengths,
        {clock.key: clock for clock in clocks.values()},
        start,
        rates[0] if len(rates) == 1 else None,
        (*renamed, *remarks, *filter(None, doubts), *said),
    )


def _with_numbers(file: Any, times: dict[str, Any | None]) -> tuple[list[Any], list[str]]:
    """Return the channels of numbers over time, and a remark on each other one."""
    data, remarks = [], []
    for channel in (channel for group in file.groups() for channel in group.channels()):
        if channel is times[channel.group_name]:
            continue
        _, other = abscissa(channel.properties)
        if channel.data_type is None or not _is_numeric(channel):
            remarks.append(f"channel {channel.name!r} holds no numbers and is left out")
        elif other:
            remarks.append(f"channel {channel.name!r} stands over {other}, not over time, and is left out")
        else:
            data.append(channel)
    return data, remarks


def _source(
    path: Path,
    channel: Any,
    clock: Clock | None,
    time: Any,
    name: str,
    parts: tuple[Recording, ...],
    start: np.datetime64 | None,
) -> Source:
    key = (channel.group_name, channel.name)
    unit = str(channel.properties.get("unit_string", "")).strip()
    if clock is not None:
        if len(time) != len(channel):
            message = (
                f"channel {channel.name!r} has {len(channel)} samples, its time {time.name!r} has {len(time)}"
            )
            raise FileFormatError(message, "export the log again", path=path)
        return Source(key, name, unit, clock.key)
    if len(channel) and any(part.increment <= 0 for part in parts):
        message = f"channel {channel.name!r} has neither wf_increment nor a time channel"
        raise FileFormatError(message, "log it as a waveform, or export it with a time channel", path=path)
    factor, _ = abscissa(channel.properties)
    late = factor * float(channel.properties.get("wf_start_offset", 0.0))
    pieces: list[Piece] = []
    for part in parts:
        offset = late if part.start is None else late + _seconds(start, part.start)
        if part.start is None and pieces:  # another rate, and nobody says since when
            last = pieces[-1]
            offset = last.offset + (part.first - last.first) * last.increment
        pieces.append(Piece(part.first, offset, part.increment))
    return Source(key, name, unit, None, tuple(pieces))


def _seconds(start: np.datetime64 | None, instant: np.datetime64) -> float:
    return 0.0 if start is None else float((instant - start) / np.timedelta64(1, "s"))


def _appended(name: str, parts: tuple[Recording, ...]) -> str:
    begun = [f"sample {part.first + 1}" + ("" if part.start is None else f" at {str(part.start)[:23]} UTC")
             for part in parts[1:4]]  # fmt: skip
    more = f" and {len(parts) - 4} more" if len(parts) > 4 else ""
    return f"channel {name!r} holds {len(parts)} recordings; others begin with {', '.join(begun)}{more}"


def _is_numeric(channel: Any) -> bool:
    return np.issubdtype(channel.dtype, np.number) and not np.issubdtype(channel.dtype, np.complexfloating)
