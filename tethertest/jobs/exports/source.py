"""What is exported: a run's conditioned channels, from memory or from a store, read block by block."""

from __future__ import annotations

import datetime as dt
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from tethertest.records.channel import Channel
from tethertest.store import StoreHeader
from tethertest.store.names import encoded

#: samples that are handled at once
BLOCK = 1 << 16


class Series(Protocol):
    """A channel whose samples are read when they are needed; `StoredSeries` is one."""

    @property
    def about(self) -> Channel:
        """The channel without samples."""

    @property
    def size(self) -> int:
        """Samples."""

    def read(self, start: int = 0, stop: int | None = None) -> Channel:
        """Return the channel with some of its samples."""


@dataclass(frozen=True, slots=True, eq=False)
class SeriesInMemory:
    """A channel that is in memory."""

    channel: Channel

    @property
    def about(self) -> Channel:
        """The channel without samples."""
        return self.read(0, 0)

    @property
    def size(self) -> int:
        """Samples."""
        return self.channel.time.size

    def read(self, start: int = 0, stop: int | None = None) -> Channel:
        """Return the channel with some of its samples."""
        part = slice(start, stop)
        channel = self.channel
        return replace(
            channel, time=channel.time[part], values=channel.values[part], flags=channel.flags[part]
        )


@dataclass(frozen=True, slots=True, eq=False)
class Exported:
    """A run to export."""

    run: str  #: its id
    title: str
    date: dt.datetime  #: time zero of all channels
    header: StoreHeader
    series: tuple[Series, ...]


@dataclass(frozen=True, slots=True, eq=False)
class TimeBase:
    """Channels that share every time stamp."""

    name: str  #: the clock's, numbered where it has several
    series: tuple[Series, ...]

    @property
    def size(self) -> int:
        """Samples of each channel."""
        return self.series[0].size

    def blocks(self) -> Iterator[tuple[Channel, ...]]:
        """Yield all channels, block by block."""
        for start in range(0, self.size, BLOCK):
            yield tuple(series.read(start, start + BLOCK) for series in self.series)


def time_bases(series: Sequence[Series]) -> tuple[TimeBase, ...]:
    """Return the channels grouped by their time stamps, in the order of their first channels."""
    groups: list[list[Series]] = []
    for one in series:
        home = next((group for group in groups if _same_times(group[0], one)), None)
        if home is None:
            groups.append([one])
        else:
            home.append(one)
    clocks = [encoded(group[0].about.source.clock if group[0].about.source else "time") for group in groups]
    before = [clocks[:number].count(clock) for number, clock in enumerate(clocks)]
    names = [f"{clock}-{count + 1}" if count else clock for clock, count in zip(clocks, before, strict=True)]
    return tuple(TimeBase(name, tuple(group)) for name, group in zip(names, groups, strict=True))


def _same_times(one: Series, other: Series) -> bool:
    return one.size == other.size and all(
        np.array_equal(one.read(start, start + BLOCK).time, other.read(start, start + BLOCK).time)
        for start in range(0, one.size, BLOCK)
    )
