"""From the cells of a log's time to seconds, block by block, on one scale for the whole log."""

from __future__ import annotations

import datetime as dt
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final, TypeAlias

import numpy as np
import numpy.typing as npt

from tethertest.errors import FileFormatError
from tethertest.readers.tables.containers.table import toml_text
from tethertest.readers.tables.text.stamps import (
    Characters,
    Integers,
    StampParts,
    Stamps,
    parse_stamps,
    settle_order,
    split_stamps,
    stamp_kind,
    time_zone_of,
)
from tethertest.readers.tables.time_search import TableHead, TimeChoice, refuse_serial_days, summed
from tethertest.readers.tables.time_units import (
    CLOCK_UNIT,
    SECONDS,
    SECONDS_PER_DAY,
    calendar_start,
    epoch_start,
    is_time_unit,
    subsecond_unit,
    unit_in_name,
)
from tethertest.records.arrays import FloatArray
from tethertest.records.run import Log

#: a comment that states when the recording began
STATED_START: Final = re.compile(r"start(?:\s*time|ed)?(?:\s+at)?\s*[:=]\s*(.+)", re.IGNORECASE)
Numbers: TypeAlias = npt.NDArray[Any]
_HALF_DAY: Final = 43_200.0  #: [s]
#: decimals that matter of a count since 1970, by its seconds per count: a nanosecond
_DECIMALS: Final = {1.0: 9, 1e-3: 6, 1e-6: 3, 1e-9: 0}
#: and of a count of days: less than a tenth of a microsecond
_DAY_DECIMALS: Final = 12


def _none() -> Numbers:
    return np.empty(0)


@dataclass(frozen=True, slots=True)
class Counting:
    """What a column of numbers counts."""

    factor: float  #: seconds per count
    decimals: int | None  #: of a count that matter, where the time counts from the first row
    start: dt.datetime | None = None
    date_order: str = ""
    has_date: bool = True  #: it is no time of day
    remarks: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class TimeCells:
    """The time of the rows of one block as it is written."""

    lines: Integers  #: (n,) place of each row in the file, for messages
    numbers: Numbers = field(default_factory=_none)  #: (n,) of a counter
    exact: Numbers = field(
        default_factory=_none
    )  #: (n,) the counter without rounding, as far as the file has it
    ticks_per_count: float = 1.0  #: of `exact`
    stamps: Sequence[Characters] = ()  #: of each column (n, bytes), zero behind the end of a stamp
    fraction: Numbers | None = None  #: (n,) of a second, as the file counts it


@dataclass(frozen=True, slots=True)
class TimeScale:
    """What turns the time of any row into seconds; it is settled by the beginning of the log."""

    path: Path
    choice: TimeChoice
    counting: Counting | None
    fraction_factor: float = 0.0  #: seconds per count of the fraction
    origin: Any = 0  #: the first count, exact, or nanoseconds of the first stamp
    fraction_origin: float = 0.0  #: [s]
    start: dt.datetime | None = None
    date_order: str = ""
    long_first: bool = False  #: the dates begin with a year of four digits
    remarks: tuple[str, ...] = ()

    @property
    def dateless(self) -> bool:
        """Whether the time is a time of day."""
        if self.choice.rate is not None:
            return False
        return not self.date_order if self.counting is None else not self.counting.has_date

    def seconds(self, cells: TimeCells, row: int = 0) -> FloatArray:
        """Return the time of the rows of a block.

        Parameters
        ----------
        cells : TimeCells
            The block.
        row : int
            Rows before the block.

        Returns
        -------
        (n,) float64
            [s], rounded once: counters since 1970 and stamps are subtracted as they are written.

        Raises
        ------
        FileFormatError
            A row has no time, or its stamp is none or of another kind than the first.
        """
        if self.choice.rate is not None:
            return np.arange(row, row + len(cells.lines), dtype=np.float64) / self.choice.rate
        if self.counting is None:
            seconds: FloatArray = (self._nanoseconds(cells) - self.origin) / 1e9
        else:
            seconds = self._counted(cells, self.counting)
        if cells.fraction is None:
            return seconds
        fraction = _fraction(cells, self.fraction_factor, self.path)
        return np.asarray(seconds + (fraction - self.fraction_origin), dtype=np.float64)

    def _counted(self, cells: TimeCells, counting: Counting) -> FloatArray:
        _refuse_blank(~np.isfinite(cells.numbers), self.path, cells.lines)
        if counting.decimals is None:
            return scaled(np.asarray(cells.numbers, dtype=np.float64), counting.factor)
        since = np.asarray(cells.exact - self.origin, dtype=np.float64)
        return scaled(since, counting.factor, cells.ticks_per_count)

    def _nanoseconds(self, cells: TimeCells) -> Integers:
        parts = stamp_parts(cells, self.path)
        if parts.dated != bool(self.date_order):
            message = "some stamps have a date and some have none"
            line = int(cells.lines[0])
            raise FileFormatError(message, "export the log again with full stamps", path=self.path, line=line)
        mixed = parts.long_first != self.long_first
        if parts.dated and np.any(mixed):
            message = "the year stands first in some stamps and not in others"
            line = int(cells.lines[np.argmax(mixed)])
            raise FileFormatError(message, "export the log again with full stamps", path=self.path, line=line)
        return parts.nanoseconds(self.date_order, self.path, cells.lines)


class Midnights:
    """Times of day without a date, told on over midnight."""

    def __init__(self) -> None:
        self._last: float | None = None
        self._days = 0

    def passed(self, time: FloatArray) -> FloatArray:
        """Return the next times with a day added at every step back of more than half a day."""
        if not time.size:
            return time
        before = time[0] if self._last is None else self._last
        back = np.diff(time, prepend=before) < -_HALF_DAY
        days = self._days + np.cumsum(back)
        self._last, self._days = float(time[-1]), int(days[-1])
        return np.asarray(time + 2.0 * _HALF_DAY * days, dtype=np.float64)


def scaled(counts: FloatArray, factor: float, ticks_per_count: float = 1.0) -> FloatArray:
    """Return counts in seconds, rounded once: 1000 is exact in binary and 0.001 is not."""
    if factor >= 1.0:
        return np.asarray(counts * factor / ticks_per_count, dtype=np.float64)
    return np.asarray(counts / (round(1.0 / factor) * ticks_per_count), dtype=np.float64)


def stamp_parts(cells: TimeCells, path: Path) -> StampParts:
    """Split the stamps of a block; a date and a time in two columns are one stamp.

    Raises
    ------
    FileFormatError
        A stamp is blank or none.
    """
    columns = []
    for column in cells.stamps:
        _refuse_blank(column[:, 0] == 0, path, cells.lines)
        longest = int(np.flatnonzero(column.any(axis=0))[-1]) + 1
        columns.append(np.ascontiguousarray(column[:, :longest]))
    together = columns[0]
    if len(columns) == 2:
        first, second = (column.view(f"S{column.shape[1]}")[:, 0] for column in columns)
        joined = np.strings.add(np.strings.add(first, b" "), second)
        together = joined.view(np.uint8).reshape(joined.size, joined.itemsize)
    return split_stamps(together, path, cells.lines)


def counting_of(table: TableHead, choice: TimeChoice, settings: Log) -> Counting | None:
    """Return what the numbers of the time count, by their unit and the first of them; None for stamps.

    Raises
    ------
    FileFormatError
        The unit is none of time, or leaves no date; numbers without a unit may be days.
    """
    if not choice.columns or table.columns[choice.columns[0]].is_text:
        return None
    column = table.columns[choice.columns[0]]
    set_unit = settings.units.get(column.name, "")
    unit = set_unit or column.unit or unit_in_name(column.name)
    if not unit and is_time_unit(table.facts.time_unit):
        unit = table.facts.time_unit
    numbers = summed([table.columns[place].numbers() for place in choice.columns])
    # a row without a time is refused when it is read
    first = float(numbers[0]) if numbers.size and np.isfinite(numbers[0]) else 0.0
    if unit == CLOCK_UNIT:
        return Counting(SECONDS_PER_DAY, _DAY_DECIMALS, has_date=False)
    try:
        calendar = calendar_start(first, unit)
    except (OverflowError, ValueError) as error:
        problem = f"the time column {column.name!r} begins with {first:g}, which is no day of {unit!r}"
        remedy = "correct units for the time"
        raise table.error(problem, remedy, "units", line=table.first_line) from error
    if calendar is not None:
        start = calendar.replace(tzinfo=time_zone_of(settings.time_zone, table.path))
        remark = f"the time counts days, as {unit} does"
        return Counting(SECONDS_PER_DAY, _DAY_DECIMALS, start, remarks=(remark,))
    epoch = epoch_start(first, unit)
    if epoch is not None:
        begin, factor, remark = epoch
        return Counting(factor, _DECIMALS[factor], begin, remarks=(remark,))
    remarks: tuple[str, ...] = ()
    if not unit:
        refuse_serial_days(table, column)
        remarks = (f"the time {column.name!r} has no unit and is taken as seconds",)
    elif unit.strip().lower() not in SECONDS:
        problem = f"the time column {column.name!r} has the unit {unit!r}, expected s, ms, us, min or h"
        raise table.error(
            problem, f'set units = {{ {toml_text(column.name)} = "s" }} if it counts seconds', "units"
        )
    stated, order = _stated_start(table, settings)
    return Counting(SECONDS.get(unit.strip().lower(), 1.0), None, stated, order, remarks=remarks)


def _stated_start(table: TableHead, settings: Log) -> tuple[dt.datetime | None, str]:
    """Return the start that a comment above the data states."""
    zone = time_zone_of(settings.time_zone, table.path)
    for text in table.comments:
        match = STATED_START.fullmatch(text)
        if match and stamp_kind(match[1]) is not None:  # not such as "start: cold"
            stamps = parse_stamps([match[1]], table.path, [1], settings.date_order)
            return stamps.start(zone), stamps.date_order
    return None, ""


def settle_scale(
    table: TableHead,
    choice: TimeChoice,
    counting: Counting | None,
    settings: Log,
    first: TimeCells,
    later: Iterable[TimeCells] = (),
) -> TimeScale:
    """Settle what the beginning of a log shows of its time.

    Parameters
    ----------
    table, choice, counting : TableHead, TimeChoice, Counting
        Where the time is, and what its numbers count.
    settings : Log
        Its `date_order` and `time_zone` are used.
    first, later : TimeCells, iterable of TimeCells
        The first block that has rows, and those behind it: they are read only while the order of day and
        month is open.

    Raises
    ------
    FileFormatError
        The first row has no time, or the whole log leaves the order of its dates open.
    """
    path = table.path
    if choice.rate is not None:
        return TimeScale(path, choice, None, remarks=choice.remarks)
    factor = since = 0.0
    if choice.fraction is not None:
        column = table.columns[choice.fraction]
        factor = SECONDS[subsecond_unit(column.name, column.unit)]
        since = float(_fraction(first, factor, path)[0])
    late = dt.timedelta(microseconds=round(since * 1e6))
    if counting is not None:
        _refuse_blank(~np.isfinite(first.numbers[:1]), path, first.lines)
        counts_from_first = counting.decimals is not None
        return TimeScale(
            path, choice, counting, factor,
            first.exact[0] if counts_from_first else 0,
            since if counts_from_first else 0.0,
            None if counting.start is None else counting.start + (late if counts_from_first else 0 * late),
            counting.date_order,
            remarks=(*choice.remarks, *counting.remarks),
        )  # fmt: skip
    parts = stamp_parts(first, path)
    order = ""
    if parts.dated:
        blocks = (stamp_parts(block, path) for block in later)
        order = settle_order(_chained(parts, blocks), settings.date_order, path, int(first.lines[0]))
    nanoseconds = parts.nanoseconds(order, path, first.lines)
    stamps = Stamps(nanoseconds, order, int(parts.zone[0]) if parts.zoned else None)
    start = stamps.start(time_zone_of(settings.time_zone, path))
    return TimeScale(
        path, choice, None, factor, int(nanoseconds[0]), since,
        None if start is None else start + late, order, bool(parts.long_first[0]), choice.remarks,
    )  # fmt: skip


def _fraction(cells: TimeCells, factor: float, path: Path) -> FloatArray:
    """Return the fractions of a second [s] of the rows."""
    assert cells.fraction is not None
    _refuse_blank(~np.isfinite(cells.fraction), path, cells.lines)
    fraction = scaled(np.asarray(cells.fraction, dtype=np.float64), factor)
    wrong = (fraction < 0.0) | (fraction >= 1.0)
    if np.any(wrong):
        row = int(np.argmax(wrong))
        message = f"the fraction of a second is {fraction[row]:g} s, expected less than 1"
        remedy = "export the time in one column"
        raise FileFormatError(message, remedy, path=path, line=int(cells.lines[row]))
    return fraction


def _chained(first: StampParts, later: Iterable[StampParts]) -> Iterable[StampParts]:
    yield first
    yield from later


def _refuse_blank(blank: npt.NDArray[np.bool_], path: Path, lines: Integers) -> None:
    if np.any(blank):
        message = "the row has no time"
        line = int(lines[np.argmax(blank)])
        raise FileFormatError(message, "export the log again", path=path, line=line)
