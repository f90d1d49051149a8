"""Which column of a table is its time, and what it counts: as run.toml says, else only on clear evidence."""

from __future__ import annotations

import datetime as dt
from dataclasses import dataclass, replace

import numpy as np

from tethertest.errors import FileFormatError
from tethertest.readers.containers.table import Column, Numbers, Table, listed, toml_text
from tethertest.readers.text.stamps import parse_stamps, stamp_kind, time_zone_of
from tethertest.readers.timeunits import (
    CALENDARS,
    SECONDS,
    SECONDS_PER_DAY,
    calendar_start,
    epoch_start,
    is_time_name,
    is_time_unit,
    unit_in_name,
)
from tethertest.records.arrays import FloatArray
from tethertest.records.run import Log

#: a time may differ from the step that the file states by this part of it: decimals are rounded
_STEP_TOLERANCE = 0.01
#: of a time without a name, this part of the steps must lie within a tenth of the usual one
_EVEN_STEPS = 0.9
_EVEN_WITHIN = 0.1
#: times of day as spreadsheets hold them: parts of a day
CLOCK_UNIT = "day"


@dataclass(frozen=True, slots=True, eq=False)
class Axis:
    """The time of every row."""

    time: FloatArray  #: (n,) [s] since `start`, or as the column counts
    start: dt.datetime | None
    used: frozenset[str]  #: columns that are the time, and no channels
    date_order: str = ""
    rate: float | None = None  #: [Hz], where run.toml or the file states it
    remarks: tuple[str, ...] = ()


def time_axis(table: Table, settings: Log) -> Axis:
    """Find the time of a table.

    Parameters
    ----------
    table : Table
        With its final names.
    settings : Log
        Its `time` names the column, its `rate` stands where there is none; without them the time is a column
        that is called so, that holds stamps, that has a unit of time, or that increases in even steps.

    Raises
    ------
    FileFormatError
        The column named is not there, no column or more than one can be the time, or its cells are no time.
    """
    if settings.rate is not None:
        return _counted(table, 1.0 / settings.rate, settings.rate, f"rate = {settings.rate:g} Hz in run.toml")
    if settings.time is not None:
        column = table.column(settings.time)
        if column is None:
            message = f"run.toml says time = {toml_text(settings.time)}, which the table does not have"
            raise table.error(message, f"use one of {listed(table.names)}")
        return _read(table, column, settings, ())
    found, remarks = _found(table)
    if isinstance(found, float):
        return _counted(table, found, 1.0 / found, table.facts.source)
    axis = _read(table, found, settings, remarks)
    step = table.facts.step
    usual = float(np.median(np.diff(axis.time))) if axis.time.size > 1 else None
    if step is None or usual is None or abs(usual - step) <= _STEP_TOLERANCE * step:
        return axis
    remark = f"the file says {table.facts.source}, but its time steps by {usual:g} s"
    return replace(axis, remarks=(*axis.remarks, remark))


def _counted(table: Table, step: float, rate: float, source: str) -> Axis:
    remarks = [f"the time is counted from {source}"]
    named = [column.name for column in table.columns if is_time_name(column.name, column.unit)]
    remarks += [f"column {name!r} is not used as the time" for name in named]
    time = np.arange(table.length, dtype=np.float64) * step
    return Axis(time, None, frozenset(), rate=rate, remarks=tuple(remarks))


def _found(table: Table) -> tuple[Column | float, tuple[str, ...]]:
    """Return the column that is evidently the time, or the step that the file states; and remarks."""
    named = [column for column in table.columns if is_time_name(column.name, column.unit)]
    days = [column for column in named if _is_days(column, column.unit)]
    if len(named) == 2 and len(days) == 1 and any(map(_is_clock, named)):
        return days[0], ()
    if len(named) == 1:
        return named[0], ()
    if not named:
        for candidates in (
            [column for column in table.columns if _is_stamped(column, {"datetime"})],
            [column for column in table.columns if _is_calendar(column.unit)],
            [column for column in table.columns if column.unit.lower() in SECONDS],
        ):
            if len(candidates) == 1:
                return candidates[0], (f"column {candidates[0].name!r} is taken as the time by its content",)
            named = named or candidates
    if not named:
        column, remark = _increasing(table)
        if column is not None:
            return column, (remark,)
        if table.facts.step is not None and not remark:
            return table.facts.step, ()
        problem = remark or "found no evident time among the columns"
        raise _undecided(table, f"{problem}: {listed(table.names)}", table.names)
    names = [column.name for column in named]
    raise _undecided(table, f"more than one column may be the time: {listed(names)}", names)


def _undecided(table: Table, problem: str, names: list[str]) -> FileFormatError:
    lines = " or ".join(f"time = {toml_text(name)}" for name in names[:4])
    remedy = f'write for this log in run.toml: {lines}, or rate = "100 Hz" if the log has no time'
    return table.error(problem, remedy)


def _is_calendar(unit: str) -> bool:
    return unit.strip().lower() in CALENDARS


def _is_stamped(column: Column, kinds: set[str]) -> bool:
    if not isinstance(column.cells, list):
        return False
    filled = [cell for cell in column.cells[:200] if cell]
    return bool(filled) and all(stamp_kind(cell) in kinds for cell in filled)


def _is_days(column: Column, unit: str) -> bool:
    """Return whether a column holds dates without a time of day."""
    if isinstance(column.cells, list):
        return _is_stamped(column, {"date"})
    return _is_calendar(unit) and bool(np.all(column.cells == np.floor(column.cells)))


def _is_clock(column: Column) -> bool:
    """Return whether a column holds times of day without a date."""
    if isinstance(column.cells, list):
        return _is_stamped(column, {"time"})
    return column.unit == CLOCK_UNIT and bool(np.all((column.cells >= 0.0) & (column.cells < 1.0)))


def _clock_of(table: Table, column: Column) -> Column | None:
    """Return the one column of times of day that belongs to a column of dates.

    Raises
    ------
    FileFormatError
        There are several.
    """
    is_text = isinstance(column.cells, list)
    clocks = [
        other for other in table.columns if isinstance(other.cells, list) == is_text and _is_clock(other)
    ]
    if len(clocks) > 1:
        names = listed(clock.name for clock in clocks)
        message = f"the dates {column.name!r} stand beside more than one time of day: {names}"
        raise table.error(message, "leave out the others when the log is exported")
    return clocks[0] if clocks else None


def _increasing(table: Table) -> tuple[Column | None, str]:
    """Return a nameless column that increases as a time does, and a remark; or what speaks against it."""
    if table.named:
        return None, ""
    rising = []
    for column in table.columns:
        if not isinstance(column.cells, list) and len(column.cells) > 2:
            steps = np.diff(column.cells.astype(np.float64))
            if np.all(steps > 0):
                rising.append((column, steps))
    if not rising:
        return None, ""
    if len(rising) > 1 or rising[0][0] is not table.columns[0]:
        names = listed(column.name for column, _ in rising)
        return None, f"no single first column increases strictly, but {names} do"
    column, steps = rising[0]
    usual = float(np.median(steps))
    stated = table.facts.step
    factor = SECONDS.get(table.facts.time_unit.lower(), 1.0)
    if stated is not None:
        if abs(usual * factor - stated) > _STEP_TOLERANCE * stated:
            return None, f"{column.name!r} steps by {usual:g}, but the file says {table.facts.source}"
        return column, f"{column.name!r} increases in the steps that the file states ({table.facts.source})"
    even = np.mean(np.abs(steps - usual) <= _EVEN_WITHIN * usual)
    if even < _EVEN_STEPS:
        return None, f"{column.name!r} increases strictly, but in uneven steps"
    if usual == 1.0 and np.all(column.cells == np.floor(column.cells)):
        return None, f"{column.name!r} counts by ones: seconds or line numbers"
    return column, f"{column.name!r} alone increases strictly, by {usual:g}: it is taken as the time"


def _read(table: Table, column: Column, settings: Log, remarks: tuple[str, ...]) -> Axis:
    zone = time_zone_of(settings.time_zone, table.path)
    unit = settings.units.get(column.name, column.unit)
    if isinstance(column.cells, list):
        return _stamped(table, column, settings, zone, remarks)
    unit = unit or unit_in_name(column.name)
    if not unit and is_time_unit(table.facts.time_unit):
        unit = table.facts.time_unit
    values, used = column.cells, frozenset({column.name})
    if _is_days(column, unit):
        clock = _clock_of(table, column)
        if clock is not None and not isinstance(clock.cells, list):
            values, used = values + clock.cells, used | {clock.name}
    _refuse_holes(table, column.name, values)
    first = float(values[0]) if values.size else 0.0
    if _is_calendar(unit):
        return _of_calendar(table, values, unit, zone, used, remarks)
    epoch = epoch_start(first, unit) if values.size else None
    if epoch is not None:
        start, factor, remark = epoch
        return Axis(_since_first(values) * factor, start, used, remarks=(*remarks, remark))
    if not unit:
        remarks = (*remarks, f"the time {column.name!r} has no unit and is taken as seconds")
    elif unit.strip().lower() not in SECONDS:
        message = f"the time column {column.name!r} has the unit {unit!r}, expected s, ms, us, min or h"
        remedy = (
            f'set units = {{ {toml_text(column.name)} = "s" }} for this log in run.toml if it counts seconds'
        )
        raise table.error(message, remedy)
    time: FloatArray = values.astype(np.float64) * SECONDS.get(unit.strip().lower(), 1.0)
    return Axis(time, None, used, remarks=remarks)


def _stamped(
    table: Table, column: Column, settings: Log, zone: dt.tzinfo | None, remarks: tuple[str, ...]
) -> Axis:
    cells = list(column.cells)
    used = {column.name}
    if _is_days(column, ""):
        clock = _clock_of(table, column)
        if clock is None:
            message = f"the time {column.name!r} holds dates without a time of day"
            raise table.error(message, "name the column of full stamps as time, or export the log with it")
        cells = [f"{day} {time}" for day, time in zip(cells, clock.cells, strict=True)]
        used.add(clock.name)
    for row, cell in enumerate(cells):
        if not cell.strip():
            message = f"the time {column.name!r} is blank"
            raise table.error(message, "export the log again", row)
    order = settings.date_order
    try:
        stamps = parse_stamps(cells, table.path, range(len(cells)), order)
    except FileFormatError as error:
        raise table.error(error.problem, error.remedy, error.line) from error
    return Axis(stamps.seconds(), stamps.start(zone), frozenset(used), stamps.date_order, remarks=remarks)


def _of_calendar(
    table: Table, values: Numbers, unit: str, zone: dt.tzinfo | None, used: frozenset[str],
    remarks: tuple[str, ...],
) -> Axis:  # fmt: skip
    try:
        start = calendar_start(float(values[0]), unit)
    except (OverflowError, ValueError) as error:
        message = f"found {float(values[0]):g} as a date, expected a count of days in {unit!r}"
        raise table.error(message, "correct units for the time of this log in run.toml", 0) from error
    finest = float(np.spacing(np.max(np.abs(values)))) * SECONDS_PER_DAY
    remark = f"the time counts days ({unit}), which resolves {finest:.1g} s"
    time = _since_first(values) * SECONDS_PER_DAY
    return Axis(time, None if start is None else start.replace(tzinfo=zone), used, remarks=(*remarks, remark))


def _since_first(values: Numbers) -> FloatArray:
    """Return differences to the first value; whole numbers are subtracted as such, without rounding."""
    if values.dtype.kind == "u" and values.dtype.itemsize == 8:
        values = values.astype(np.int64) if np.all(values < 2**63) else values.astype(np.float64)
    elif values.dtype.kind in "iu":
        values = values.astype(np.int64)
    since: FloatArray = (values - values[0]).astype(np.float64)
    return since


def _refuse_holes(table: Table, name: str, values: Numbers) -> None:
    bad = ~np.isfinite(values)
    if np.any(bad):
        message = f"the time {name!r} is no number"
        raise table.error(message, "export the log again", int(np.argmax(bad)))
