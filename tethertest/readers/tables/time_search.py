"""Which column of a log is its time: one search for text, sheets and trees alike.

A table is shown by the beginning of its columns, since a long text is never held as a whole.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from tethertest.errors import FileFormatError
from tethertest.readers.calibration import COLUMNS as CALIBRATION_COLUMNS
from tethertest.readers.tables.containers.table import listed, toml_text
from tethertest.readers.tables.text.cells import column_kind
from tethertest.readers.tables.text.layout import SHOWN_ROWS
from tethertest.readers.tables.time_units import (
    CALENDARS,
    CLOCK_UNIT,
    NO_FACTS,
    SECONDS,
    SECONDS_PER_DAY,
    Facts,
    is_time_name,
    subsecond_unit,
    unit_in_name,
)
from tethertest.records.arrays import FloatArray
from tethertest.records.run import Log

_FRACTION: Final = re.compile(r"[.,]\d+\D*$")
_HALF_DAY: Final = re.compile(r"[AP]\.?M\.?|上午|下午", re.IGNORECASE)
#: a time goes forward in nearly all of its steps
_FORWARD: Final = 0.9
#: of a time without a name, this part of the steps must lie within a tenth of the usual one
_EVEN_STEPS, _EVEN_WITHIN = 0.9, 0.1
#: a time may differ from the step that the file states by this part of it: decimals are rounded
STEP_TOLERANCE: Final = 0.01
#: days that a date of 1970 to 2100 has in a spreadsheet, and steps [1] that are rather days than seconds
_SERIAL_DAYS: Final = (25_569.0, 73_050.0)
_SERIAL_STEP: Final = 1e-4
#: a second, as whole seconds are told in days that are rounded to float64
_WHOLE_SECOND: Final = 1e-3


@dataclass(frozen=True, slots=True, eq=False)
class ColumnHead:
    """The beginning of one column."""

    name: str
    unit: str  #: as the file writes it
    cells: Sequence[str] | npt.NDArray[Any]  #: the first rows, as text or as numbers
    kind: str  #: see `column_kind`; a number shown as a date or a time of day is of that kind
    written: str  #: name in the file, where a name that stands twice was changed

    @property
    def is_text(self) -> bool:
        """Whether the cells are stamps or words, and no numbers."""
        return self.kind not in {"number", "blank"} and not isinstance(self.cells, np.ndarray)

    def numbers(self) -> FloatArray:
        """Return the cells as numbers, NaN where one is none."""
        if isinstance(self.cells, np.ndarray):
            return np.asarray(self.cells, dtype=np.float64)
        values = np.full(len(self.cells), np.nan)
        for row, cell in enumerate(self.cells):
            with suppress(ValueError):
                values[row] = float(cell.replace(",", "."))
        return values

    def steps(self) -> FloatArray:
        """Return the steps between those cells that are numbers."""
        values = self.numbers()
        return np.diff(values[np.isfinite(values)])


@dataclass(frozen=True, slots=True, eq=False)
class TableHead:
    """What the search is shown of a table."""

    path: Path
    columns: tuple[ColumnHead, ...]
    named: bool  #: the names are the file's own, or run.toml's
    facts: Facts = NO_FACTS
    header_line: int | None = None  #: in a text, for messages
    first_line: int | None = None  #: of the data of a text
    comments: tuple[str, ...] = ()  #: above the data of a text

    @property
    def names(self) -> list[str]:
        """Names of the columns."""
        return [column.name for column in self.columns]

    def error(self, problem: str, remedy: str, *keys: str, line: int | None = None) -> FileFormatError:
        """Return an error of the header, or of a line."""
        return FileFormatError(problem, remedy, path=self.path, line=line or self.header_line, keys=keys)


@dataclass(frozen=True, slots=True)
class TimeChoice:
    """What the time comes from: columns, or a step that is stated."""

    columns: tuple[int, ...] = ()  #: one, or the date and the time of day
    fraction: int | None = None  #: column of the fraction of a second that the others leave out
    rate: float | None = None  #: [Hz] that is stated, where no column is the time
    remarks: tuple[str, ...] = ()

    @property
    def used(self) -> frozenset[int]:
        """Columns that are the time, and no channels."""
        return frozenset(self.columns if self.fraction is None else (*self.columns, self.fraction))


def kind_of(cells: Sequence[str] | npt.NDArray[Any], unit: str) -> str:
    """Return the kind of a column of a container, as `column_kind` does for a text.

    Numbers that are written as text are text there, and numbers may be shown as dates or as times of day.
    """
    if not isinstance(cells, np.ndarray):
        kind = column_kind(cells[:SHOWN_ROWS])
        return "text" if kind == "number" else kind
    filled = cells[np.isfinite(cells)]
    if filled.size == 0:
        return "blank"
    if unit == CLOCK_UNIT:
        return "time"
    if unit.strip().lower() in CALENDARS:
        return "date" if np.all(filled == np.floor(filled)) else "datetime"
    return "number"


def no_channels(table: TableHead) -> dict[int, str]:
    """Return what those columns hold that cannot be channels, by their places."""
    found = {}
    for place, column in enumerate(table.columns):
        if column.kind in {"datetime", "date", "time"}:
            found[place] = "stamps"
        elif column.kind == "text":
            is_written = not isinstance(column.cells, np.ndarray) and column_kind(column.cells) == "number"
            found[place] = "numbers written as text" if is_written else "text"
        elif column.kind == "blank" and _is_named(table, place):
            found[place] = "nothing at its beginning"
    return found


def find_time(table: TableHead, settings: Log) -> TimeChoice:
    """Choose the time as the settings say, else by name, stamps, unit, then place.

    Raises
    ------
    FileFormatError
        No column can be the time, or not the one that the settings name; more than one may be it; or a part
        of it stands in another column and cannot be put together.
    """
    if settings.rate is not None:
        return _counted(table, settings.rate, f"the rate {settings.rate:g} Hz that is set")
    if settings.time is not None:
        chosen = _wanted(table, settings.time)
    else:
        chosen = _evident(table) or _first_column(table)
        if chosen.columns:
            _refuse_second_clock(table, chosen)
            chosen = _with_fraction(table, chosen)
    for column in chosen.columns:
        _refuse_repeated_name(table, column)
    return chosen


def _counted(table: TableHead, rate: float, source: str) -> TimeChoice:
    remarks = [f"the time is counted from {source}"]
    named = [column.name for column in table.columns if is_time_name(column.name, column.unit)]
    remarks += [f"column {name!r} is not used as the time" for name in named]
    return TimeChoice(rate=rate, remarks=tuple(remarks))


def _wanted(table: TableHead, name: str) -> TimeChoice:
    if name not in table.names:
        problem = f"time = {toml_text(name)} is set, which the table does not have"
        raise table.error(problem, f"use one of {listed(table.names)}", "time")
    place = table.names.index(name)
    column = table.columns[place]
    if column.kind == "date":
        return _dated(table, [place]) or TimeChoice((place,))
    if column.kind in {"text", "blank"}:
        raise _text_as_time(table, column)
    return TimeChoice((place,))


def _evident(table: TableHead) -> TimeChoice | None:
    """Return the time by name, stamps or unit; None where nothing of these speaks for a column."""
    of_kind = {
        kind: [place for place, column in enumerate(table.columns) if column.kind == kind]
        for kind in ("number", "datetime", "date", "time")
    }
    numbers = [place for place in of_kind["number"] if _is_named(table, place)]
    if numbers:
        return TimeChoice((_only(table, numbers),))
    if of_kind["datetime"]:
        return TimeChoice((_only(table, _named_first(table, of_kind["datetime"])),))
    if of_kind["date"] and (dated := _dated(table, of_kind["date"])):
        return dated
    if of_kind["time"]:
        remark = "the stamps have a time of day but no date; a step back of half a day is midnight"
        place = _only(table, _named_first(table, of_kind["time"]))
        return TimeChoice((place,), remarks=(remark,))
    counters = [place for place in of_kind["number"] if _counts_time(table.columns[place])]
    if counters:
        place = _only(table, counters)
        remark = f"column {table.columns[place].name!r} is taken as the time by its unit"
        return TimeChoice((place,), remarks=(remark,))
    if of_kind["date"]:
        names = listed(table.columns[place].name for place in of_kind["date"])
        problem = f"the log has dates without a time of day: {names}"
        raise table.error(problem, "export the log with full stamps")
    return None


def _is_named(table: TableHead, place: int) -> bool:
    return is_time_name(table.columns[place].name, table.columns[place].unit)


def _named_first(table: TableHead, places: list[int]) -> list[int]:
    return [place for place in places if _is_named(table, place)] or places


def _counts_time(column: ColumnHead) -> bool:
    """Return whether a column of numbers has a unit of time and goes forward; a delay does not."""
    unit = column.unit.strip().lower() or unit_in_name(column.name)
    return unit in SECONDS and _goes_forward(column.steps())


def _goes_forward(steps: FloatArray) -> bool:
    return bool(np.any(steps > 0)) and float(np.mean(steps >= 0)) >= _FORWARD


def _dated(table: TableHead, dates: list[int]) -> TimeChoice | None:
    """Return the one column of dates with the one of times of day, both stamps or both numbers."""
    date = _only(table, _named_first(table, dates))
    clocks = [
        place
        for place, column in enumerate(table.columns)
        if column.kind == "time" and column.is_text == table.columns[date].is_text
    ]
    if not clocks:
        return None
    return TimeChoice((date, _only(table, _named_first(table, clocks))))


def _only(table: TableHead, places: list[int]) -> int:
    """Return the one place; refuse to choose among columns that may each be the time."""
    if len(places) == 1:
        return places[0]
    names = [table.columns[place].name for place in places]
    problem = f"more than one column may be the time: {listed(names)}"
    lines = " or ".join(f"time = {toml_text(name)}" for name in names[:4])
    remedy = f"set {lines}; if each belongs to channels of its own, export them as logs of their own"
    raise table.error(problem, remedy, "time")


def _refuse_second_clock(table: TableHead, chosen: TimeChoice) -> None:
    """Refuse a second column that counts time in other steps: some channels may belong to it."""
    (place, *_), (main, *_) = chosen.columns, [table.columns[place] for place in chosen.columns]
    if main.kind != "number" or not main.steps().size:
        return
    usual = float(np.median(main.steps())) * _seconds_of(main)
    for other, column in enumerate(table.columns):
        unit = column.unit.strip().lower()
        if other == place or column.kind != "number" or unit not in SECONDS:
            continue
        steps = column.steps() * _seconds_of(column)
        if steps.size > 1 and np.all(steps > 0) and abs(np.median(steps) - usual) > STEP_TOLERANCE * usual:
            _only(table, [place, other])


def _seconds_of(column: ColumnHead) -> float:
    """Return the seconds of one count of a column."""
    return SECONDS.get(column.unit.strip().lower() or unit_in_name(column.name), 1.0)


def _refuse_repeated_name(table: TableHead, place: int) -> None:
    """Refuse a second column of the time's name: what stands behind it has a time of its own."""
    name = table.columns[place].written
    again = [
        number
        for number, column in enumerate(table.columns, start=1)
        if column.written == name and number != place + 1
    ]
    if again:
        shown = ", ".join(map(str, again))
        problem = f"the name {name!r} of the time in column {place + 1} also stands over column {shown}: "
        problem += "two tables side by side"
        remedy = "export each table by itself, or pass over the names with skip_rows and give columns"
        raise table.error(problem, remedy, "skip_rows", "columns")


def _with_fraction(table: TableHead, chosen: TimeChoice) -> TimeChoice:
    """Return the time with the fraction of a second that stands in another column.

    Raises
    ------
    FileFormatError
        The values leave open whether a column is that fraction, or a column holds AM and PM.
    """
    own = [table.columns[place] for place in chosen.columns]
    shown = " and ".join(repr(column.name) for column in own)
    found: list[int] = []
    for place, column in enumerate(table.columns):
        if place in chosen.columns:
            continue
        first = str(column.cells[0]).strip() if len(column.cells) else ""
        if own[0].is_text and column.kind == "text" and _HALF_DAY.fullmatch(first):
            problem = f"column {column.name!r} holds AM and PM apart from the time {shown}"
            raise table.error(problem, "export the time with them in one column, or with hours from 0 to 23")
        if column.kind == "number" and subsecond_unit(column.name, column.unit) and _is_whole(own):
            found.append(place)
    if not found:
        return chosen
    name = table.columns[found[0]].name
    unit = subsecond_unit(name, table.columns[found[0]].unit)
    if len(found) == 1 and _completes(own, table.columns[found[0]]):
        remark = f"column {name!r} is the fraction of a second [{unit}] that the time {shown} leaves out"
        return TimeChoice(chosen.columns, found[0], remarks=(*chosen.remarks, remark))
    problem = f"column {name!r} looks like the fraction of a second that the time {shown} leaves out"
    remedy = (
        'export both as one column, or set rate = "100 Hz" if rows are even in time, or '
        f"time = {toml_text(own[-1].name)} if {name!r} has nothing to do with it"
    )
    raise table.error(problem, remedy, "rate", "time")


def _is_whole(own: list[ColumnHead]) -> bool:
    """Return whether a time counts whole seconds."""
    if own[0].is_text:
        return not any(_FRACTION.search(cell) for column in own for cell in column.cells)
    values = summed([column.numbers() for column in own])
    if own[0].kind != "number":
        values = values * SECONDS_PER_DAY
        return not np.any(np.abs(values - np.round(values)) > _WHOLE_SECOND)
    return _seconds_of(own[0]) == 1.0 and bool(np.all(values == np.floor(values)))


def _completes(own: list[ColumnHead], column: ColumnHead) -> bool:
    """Return whether a column bears out that it is the fraction of a second of a time.

    It lies within a second, and with it the time goes forward in more even steps; a column that has nothing
    to do with the time makes them less even.
    """
    fraction = column.numbers() * SECONDS[subsecond_unit(column.name, column.unit)]
    seconds = _whole_seconds(own)
    if fraction.size != seconds.size or fraction.size < 3 or np.any((fraction < 0.0) | (fraction >= 1.0)):
        return False
    if not np.any(np.nan_to_num(fraction)):
        return True
    known = np.isfinite(seconds + fraction)
    seconds, fraction = seconds[known], fraction[known]
    steps = np.diff(seconds + fraction)
    return bool(np.mean(steps > 0.0) >= _FORWARD and np.std(steps) < np.std(np.diff(seconds)))


def summed(parts: Sequence[npt.NDArray[Any]]) -> npt.NDArray[Any]:
    """Return one column of numbers, or the days of dates with their times of day."""
    return parts[0] if len(parts) == 1 else parts[0] + parts[1]


def _whole_seconds(own: list[ColumnHead]) -> FloatArray:
    """Return the time of the first rows in seconds; steps alone matter."""
    if not own[0].is_text:
        scale = 1.0 if own[0].kind == "number" else SECONDS_PER_DAY
        return np.asarray(summed([column.numbers() for column in own]) * scale)
    # the digits of the clock are enough: over midnight one step is wrong, and few of 200 are
    clocks = [re.findall(r"(\d+):(\d\d)(?::(\d\d))?", cell) for cell in own[-1].cells]
    parts = [[int(part or 0) for part in clock[0]] for clock in clocks if clock]
    return np.asarray([hour * 3600.0 + minute * 60.0 + second for hour, minute, second in parts])


def _first_column(table: TableHead) -> TimeChoice:
    """Return the time of a table whose columns have no such names: the first, if it alone looks like one."""
    wrong = next(
        (
            column
            for place, column in enumerate(table.columns)
            if column.kind in {"text", "blank"} and _is_named(table, place)
        ),
        None,
    )
    if wrong is not None and wrong.kind == "text":
        raise _text_as_time(table, wrong)
    step, source = table.facts.step, table.facts.source
    first = table.columns[0]
    if first.kind == "number" and (not first.name or not table.named):
        steps = first.steps()
        if _counts_rows(first) and step is None:
            problem = "the first column has no name and counts the rows, or whole seconds"
            remedy = 'set rate = "100 Hz", or what it was ("1 Hz" if it counts seconds)'
            raise table.error(problem, remedy, "rate", line=table.first_line)
        if steps.size and np.mean(steps > 0) >= _FORWARD:
            _refuse_rival(table, steps)
            remark = "the first column has no name and is taken as the time in seconds"
            if step is not None:
                usual = float(np.median(steps)) * SECONDS.get(table.facts.time_unit.strip().lower(), 1.0)
                if abs(usual - step) > STEP_TOLERANCE * step:
                    problem = (
                        f"the first column has no name and steps by {usual:g}, but the file says {source}"
                    )
                    raise table.error(problem, _time_or_rate(table), "time", "rate")
                remark = f"the first column has no name and steps as the file says ({source}): it is the time"
            return TimeChoice((0,), remarks=(remark,))
    if step is not None:
        return _counted(table, 1.0 / step, source)
    problem = f"found no time column among {listed(table.names)}"
    if tuple(name.lower() for name in table.names[:2]) == CALIBRATION_COLUMNS:
        problem += ": it is a calibration of a load cell, not a log"
        raise table.error(problem, "name it in the rig file, as log under calibration of the sensor")
    raise table.error(problem, _time_or_rate(table), "time", "rate")


def _refuse_rival(table: TableHead, steps: FloatArray) -> None:
    """Refuse a first column without a name that is no more a time than another: both rise, neither evenly."""
    usual = np.median(steps)
    if np.mean(np.abs(steps - usual) <= _EVEN_WITHIN * usual) >= _EVEN_STEPS:
        return
    rising = [0]
    for place, column in enumerate(table.columns[1:], start=1):
        others = column.steps() if column.kind == "number" else np.zeros(0)
        if others.size and np.all(others > 0):
            rising.append(place)
    _only(table, rising)


def _time_or_rate(table: TableHead) -> str:
    """Return the remedy of a log without a time; a column that does not go forward is not offered."""
    forward = [
        column.name
        for column in table.columns
        if column.kind == "number" and _goes_forward(column.steps()) and not _counts_rows(column)
    ]
    time = f"time = {toml_text(forward[0])} if that column is the time, or " if forward else ""
    return f'set {time}rate = "100 Hz" if rows are even in time; else export the log again with its time'


def _counts_rows(column: ColumnHead) -> bool:
    """Return whether the numbers are whole, each one more than the one before."""
    values = column.numbers()
    return values.size > 1 and bool(np.all(np.diff(values) == 1.0) and values[0] == np.floor(values[0]))


def refuse_serial_days(table: TableHead, column: ColumnHead) -> None:
    """Refuse a time without a unit whose numbers are rather a spreadsheet's days than seconds.

    Raises
    ------
    FileFormatError
        As seconds they would have steps of less than 0.1 ms and begin between 7 and 21 hours.
    """
    values, steps = column.numbers(), column.steps()
    if steps.size < 2 or not _SERIAL_DAYS[0] <= values[0] <= _SERIAL_DAYS[1]:
        return
    step = float(np.median(steps))
    if 0.0 < step < _SERIAL_STEP:
        problem = (
            f"the time {column.name!r} has no unit; from {values[0]:.10g} in steps of {step:.3g} it may "
            "count days as a spreadsheet does, or seconds"
        )
        remedy = f'set units = {{ {toml_text(column.name)} = "excel" }}, or "s" if it counts seconds'
        raise table.error(problem, remedy, "units", line=table.first_line)


def _text_as_time(table: TableHead, column: ColumnHead) -> FileFormatError:
    holds = "nothing" if column.kind == "blank" else "text"
    problem = f"the time column {column.name!r} holds {holds}, expected seconds or stamps"
    return table.error(problem, "export the log again with full stamps or seconds", line=table.first_line)
