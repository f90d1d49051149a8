"""From counters and stamps to seconds, block by block, on one scale for the whole log."""

from __future__ import annotations

import datetime as dt
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
import numpy.typing as npt

from tethertest.errors import FileFormatError
from tethertest.readers.text.blocks import Characters, Integers, Parsed
from tethertest.readers.text.stamps import StampParts, Stamps, settle_order, split_stamps
from tethertest.readers.text.timeaxis import Counter, TimeColumns
from tethertest.records.arrays import FloatArray

_HALF_DAY: Final = 43_200.0  #: [s]


@dataclass(frozen=True, slots=True)
class TimeScale:
    """What turns the time of any row into seconds; it is settled by the beginning of the log."""

    path: Path
    chosen: TimeColumns
    place: int  #: of the counter among the numbers
    counter: Counter | None
    origin: int  #: first tick, or nanoseconds of the first stamp
    start: dt.datetime | None
    date_order: str
    long_first: bool  #: the dates begin with a year of four digits
    remarks: tuple[str, ...]

    @property
    def dateless(self) -> bool:
        """Whether the time is a time of day."""
        return self.chosen.rate is None and self.counter is None and not self.date_order

    def seconds(self, parsed: Parsed, lines: Integers, row: int) -> FloatArray:
        """Return the time of the rows of a block.

        Parameters
        ----------
        parsed : Parsed
            The block.
        lines : (n,) int64
            Lines of its rows in the file, from 1.
        row : int
            Rows before the block.

        Returns
        -------
        (n,) float64
            [s], rounded once: counters since 1970 and stamps are subtracted as whole numbers.

        Raises
        ------
        FileFormatError
            A row has no time, or its stamp is none or of another kind than the first.
        """
        if self.chosen.rate is not None:
            return np.arange(row, row + len(lines), dtype=np.float64) / self.chosen.rate
        if self.counter is None:
            seconds: FloatArray = (self._nanoseconds(parsed, lines) - self.origin) / 1e9
            return seconds
        values = parsed.numbers[self.place]
        _refuse_blank(np.isnan(values), self.path, lines)
        if self.counter.decimals is None:
            factor = self.counter.factor
            # the reciprocal is a whole number, and 0.001 is not: dividing rounds once
            scaled = values * factor if factor >= 1.0 else values / float(round(1.0 / factor))
            return np.asarray(scaled, dtype=np.float64)
        numerator, denominator = self.counter.seconds_per_tick
        return np.asarray((parsed.ticks - self.origin) * numerator / denominator, dtype=np.float64)

    def _nanoseconds(self, parsed: Parsed, lines: Integers) -> Integers:
        parts = stamp_parts(parsed.stamps, self.path, lines)
        if parts.dated != bool(self.date_order):
            message = "some stamps have a date and some have none"
            line = int(lines[0])
            raise FileFormatError(message, "export the log again with full stamps", path=self.path, line=line)
        mixed = parts.long_first != self.long_first
        if parts.dated and np.any(mixed):
            message = "the year stands first in some stamps and not in others"
            line = int(lines[np.argmax(mixed)])
            raise FileFormatError(message, "export the log again with full stamps", path=self.path, line=line)
        return parts.nanoseconds(self.date_order, self.path, lines)


class Midnights:
    """Times of day without a date, told on over midnight."""

    def __init__(self) -> None:
        self._last: float | None = None
        self._days = 0

    def passed(self, time: FloatArray) -> FloatArray:
        """Return the next times with a day added at every step back of more than half a day."""
        before = time[0] if self._last is None else self._last
        back = np.diff(time, prepend=before) < -_HALF_DAY
        days = self._days + np.cumsum(back)
        self._last, self._days = float(time[-1]), int(days[-1])
        return np.asarray(time + 2.0 * _HALF_DAY * days, dtype=np.float64)


def stamp_parts(stamps: Characters, path: Path, lines: Integers) -> StampParts:
    """Split the stamps of a block; a date and a time in two columns are one stamp.

    Raises
    ------
    FileFormatError
        A stamp is blank or none.
    """
    columns = []
    for column in stamps:
        _refuse_blank(column[:, 0] == 0, path, lines)
        longest = int(np.flatnonzero(column.any(axis=0))[-1]) + 1
        columns.append(np.ascontiguousarray(column[:, :longest]))
    together = columns[0]
    if len(columns) == 2:
        first, second = (column.view(f"S{column.shape[1]}")[:, 0] for column in columns)
        joined = np.strings.add(np.strings.add(first, b" "), second)
        together = joined.view(np.uint8).reshape(joined.size, joined.itemsize)
    return split_stamps(together, path, lines)


def settle_scale(
    path: Path,
    chosen: TimeColumns,
    counter: Counter | None,
    place: int,
    first: tuple[Parsed, Integers],
    later: Iterable[tuple[Parsed, Integers]],
    order: str | None,
    zone: dt.tzinfo | None,
) -> TimeScale:
    """Settle what the beginning of a log shows of its time.

    Parameters
    ----------
    path : Path
        The log.
    chosen, counter, place : TimeColumns, Counter, int
        Where the time is, and what a counter counts.
    first, later : tuple, iterable of tuple
        The first block that has rows, and those behind it: they are read only while the order of day and
        month is open.
    order, zone : str, tzinfo
        `date_order` and `time_zone` of the settings.

    Raises
    ------
    FileFormatError
        The first row has no time, or the whole log leaves the order of its dates open.
    """
    parsed, lines = first
    if counter is not None:
        origin = int(parsed.ticks[0]) if counter.decimals is not None else 0
        remarks = (*chosen.remarks, *counter.remarks)
        return TimeScale(
            path, chosen, place, counter, origin, counter.start, counter.date_order, False, remarks
        )
    if chosen.rate is not None:
        return TimeScale(path, chosen, place, None, 0, None, "", False, chosen.remarks)
    parts = stamp_parts(parsed.stamps, path, lines)
    date_order = ""
    if parts.dated:
        blocks = (stamp_parts(block.stamps, path, its_lines) for block, its_lines in later)
        date_order = settle_order(_chained(parts, blocks), order, path, int(lines[0]))
    nanoseconds = parts.nanoseconds(date_order, path, lines)
    stamps = Stamps(nanoseconds, date_order, int(parts.zone[0]) if parts.zoned else None)
    start = stamps.start(zone)
    long_first = bool(parts.long_first[0])
    return TimeScale(
        path, chosen, place, None, int(nanoseconds[0]), start, date_order, long_first, chosen.remarks
    )


def _chained(first: StampParts, later: Iterable[StampParts]) -> Iterable[StampParts]:
    yield first
    yield from later


def _refuse_blank(blank: npt.NDArray[np.bool_], path: Path, lines: Integers) -> None:
    if np.any(blank):
        message = "the row has no time"
        line = int(lines[np.argmax(blank)])
        raise FileFormatError(message, "export the log again", path=path, line=line)
