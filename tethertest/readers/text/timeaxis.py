"""Which column of an unknown text log is its time, and what it counts."""

from __future__ import annotations

import datetime as dt
import re
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Final

from tethertest.errors import FileFormatError
from tethertest.readers.calibration import COLUMNS as CALIBRATION_COLUMNS
from tethertest.readers.text.layout import Layout
from tethertest.readers.text.stamps import parse_stamps, stamp_kind
from tethertest.readers.timeunits import SECONDS, calendar_start, epoch_start, is_time_name, unit_in_name
from tethertest.records.run import Log

#: a comment that states when the recording began
STATED_START = re.compile(r"start(?:\s*time|ed)?(?:\s+at)?\s*[:=]\s*(.+)", re.IGNORECASE)
#: a column of fractions of a second beside stamps or seconds, such as ``ms`` or ``header.stamp.nsecs``
_SUBSECOND = re.compile(
    r"(?:ms|us|µs|ns|毫秒|(?:.*(?:time|stamp|date|tv)[_. ])?(?:m|u|n|milli|micro|nano)(?:s|secs?|seconds?))",
    re.IGNORECASE,
)
_FRACTION = re.compile(r"[.,]\d+\D*$")
_HALF_DAY = re.compile(r"[AP]\.?M\.?|上午|下午", re.IGNORECASE)
#: a first column without a name is the time only if nearly all of its steps go up
_RISING_STEPS: Final = 0.9
#: a tick of a counter since 1970 is a nanosecond, of one in days less than a tenth of a microsecond
_DECIMALS: Final = {1.0: 9, 1e-3: 6, 1e-6: 3, 1e-9: 0}
_DAY_DECIMALS: Final = 12


@dataclass(frozen=True, slots=True)
class TimeColumns:
    """What the time comes from: a counter, one or two columns of stamps, or the rate that run.toml gives."""

    stamps: tuple[int, ...] = ()  #: date and time, or one column
    counter: int | None = None
    rate: float | None = None  #: [Hz]
    remarks: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Counter:
    """What a column of numbers counts."""

    factor: float  #: seconds per count, for numbers that are kept as written
    decimals: int | None  #: of a tick, where the time counts from the first row
    seconds_per_tick: tuple[float, float]  #: numerator and denominator, each exact
    start: dt.datetime | None
    date_order: str
    remarks: tuple[str, ...]


def columns_named_time(layout: Layout) -> list[int]:
    """Return the columns whose name says that they are the time; a T may be a temperature."""
    named = enumerate(zip(layout.names, layout.units, strict=True))
    return [column for column, (name, unit) in named if is_time_name(name, unit)]


def find_time(layout: Layout, path: Path, settings: Log) -> TimeColumns:
    """Choose the time as run.toml says, else by name, stamps, unit, then place.

    Raises
    ------
    FileFormatError
        No column can be the time, or not the one that run.toml names.
    """
    named = columns_named_time(layout)
    if settings.rate is not None:
        remarks = [f"the time is counted from rate = {settings.rate:g} Hz in run.toml"]
        remarks += [f"column {layout.names[column]!r} is not used as the time" for column in named]
        return TimeColumns(rate=settings.rate, remarks=tuple(remarks))
    of_kind = {
        kind: [column for column, found in enumerate(layout.kinds) if found == kind]
        for kind in ("number", "datetime", "date", "time", "text")
    }
    if settings.time is not None:
        return _wanted(layout, path, settings.time, of_kind["time"])
    chosen = _evident(layout, path, [column for column in named if layout.kinds[column] == "number"], of_kind)
    if chosen is not None:
        refuse_parts_elsewhere(layout, path, chosen)
        return chosen
    wrong = next((column for column in named if layout.kinds[column] == "text"), None)
    if wrong is not None:
        raise _text_as_time(layout, path, wrong)
    nameless = not layout.names[0] or (layout.header_line is None and layout.numbered)
    if layout.kinds[0] == "number" and nameless and _counts_rows(layout.first_column):
        message = "the first column has no name and counts the rows, or whole seconds"
        remedy = (
            'write for this log in run.toml: rate = "100 Hz", or what it was ("1 Hz" if it counts seconds)'
        )
        raise FileFormatError(message, remedy, path=path, line=layout.first_line)
    if layout.kinds[0] == "number" and nameless and _rises(layout.first_column):
        remark = "the first column has no name and is taken as the time in seconds"
        return TimeColumns(counter=0, remarks=(remark,))
    raise _no_time(layout, path)


def _evident(
    layout: Layout, path: Path, counters: list[int], of_kind: dict[str, list[int]]
) -> TimeColumns | None:
    """Return the time by name, stamps or unit; None where nothing of these speaks for a column."""
    if counters:
        _refuse_several(layout, path, counters)
        return TimeColumns(counter=counters[0])
    if of_kind["datetime"]:
        _refuse_several(layout, path, of_kind["datetime"])
        return TimeColumns((of_kind["datetime"][0],))
    if of_kind["date"] and of_kind["time"]:
        return TimeColumns((of_kind["date"][0], of_kind["time"][0]))
    if of_kind["time"]:
        remark = "the stamps have a time of day but no date; a step back of half a day is midnight"
        return TimeColumns((of_kind["time"][0],), remarks=(remark,))
    counters = [column for column in of_kind["number"] if layout.units[column].lower() in SECONDS]
    if counters:
        _refuse_several(layout, path, counters)
        remark = f"column {layout.names[counters[0]]!r} is taken as the time by its unit"
        return TimeColumns(counter=counters[0], remarks=(remark,))
    return None


def _refuse_several(layout: Layout, path: Path, columns: list[int]) -> None:
    """Refuse to choose among columns that may each be the time, of all or of some channels."""
    if len(columns) > 1:
        names = [layout.names[column] for column in columns]
        message = f"more than one column may be the time: {', '.join(map(repr, names))}"
        lines = " or ".join(f'time = "{name}"' for name in names[:4])
        remedy = (
            f"write for this log in run.toml: {lines}; if each belongs to channels of its own, "
            "export them as logs of their own"
        )
        raise FileFormatError(message, remedy, path=path, line=layout.header_line)


def refuse_parts_elsewhere(layout: Layout, path: Path, chosen: TimeColumns) -> None:
    """Refuse a time of which another column has a part: the fraction of a second, or AM and PM.

    Raises
    ------
    FileFormatError
        Such a column stands beside the time.
    """
    own = (*chosen.stamps, *(() if chosen.counter is None else (chosen.counter,)))
    shown = " and ".join(repr(layout.names[column]) for column in own)
    cells = [layout.first_cells[column] for column in own] + (list(layout.first_column) if 0 in own else [])
    is_whole = not any(_FRACTION.search(cell) for cell in cells)
    for column, (name, kind) in enumerate(zip(layout.names, layout.kinds, strict=True)):
        if column in own:
            continue
        if chosen.stamps and kind == "text" and _HALF_DAY.fullmatch(layout.first_cells[column].strip()):
            message = f"column {name!r} holds AM and PM apart from the time {shown}"
            remedy = "export the time with them in one column, or with hours from 0 to 23"
        elif is_whole and kind == "number" and _SUBSECOND.fullmatch(name.strip()):
            message = f"column {name!r} looks like the fraction of a second that the time {shown} leaves out"
            remedy = (
                'export both as one column, or write for this log in run.toml: rate = "100 Hz" if rows are '
                f'even in time, or time = "{layout.names[own[-1]]}" if {name!r} has nothing to do with it'
            )
        else:
            continue
        raise FileFormatError(message, remedy, path=path, line=layout.header_line)


def _wanted(layout: Layout, path: Path, name: str, clocks: list[int]) -> TimeColumns:
    if name not in layout.names:
        message = f"run.toml says time = {name!r}, which the log does not have"
        remedy = f"use one of {', '.join(repr(known) for known in layout.names[:8])}"
        raise FileFormatError(message, remedy, path=path, line=layout.header_line)
    column = layout.names.index(name)
    kind = layout.kinds[column]
    if kind == "number":
        return TimeColumns(counter=column)
    if kind == "date" and clocks:
        return TimeColumns((column, clocks[0]))
    if kind in {"datetime", "date", "time"}:
        return TimeColumns((column,))
    raise _text_as_time(layout, path, column)


def _rises(cells: tuple[str, ...]) -> bool:
    numbers = []
    for cell in cells:
        try:
            numbers.append(float(cell.replace(",", ".")))
        except ValueError:
            continue
    steps = [later > earlier for earlier, later in pairwise(numbers)]
    return sum(steps) >= _RISING_STEPS * len(steps)


def _counts_rows(cells: tuple[str, ...]) -> bool:
    """Return whether the cells are whole numbers, each one more than the one before."""
    if len(cells) < 2 or not all(cell.isdecimal() for cell in cells):
        return False
    return all(later - earlier == 1 for earlier, later in pairwise(map(int, cells)))


def _text_as_time(layout: Layout, path: Path, column: int) -> FileFormatError:
    holds = "nothing" if layout.kinds[column] == "blank" else "text"
    message = f"the time column {layout.names[column]!r} holds {holds}, expected seconds or stamps"
    remedy = "export the log again with full stamps or seconds"
    return FileFormatError(message, remedy, path=path, line=layout.first_line)


def _no_time(layout: Layout, path: Path) -> FileFormatError:
    message = f"found no time column among {', '.join(repr(name) for name in layout.names[:8])}"
    if tuple(name.lower() for name in layout.names[:2]) == CALIBRATION_COLUMNS:
        message += ": it is a calibration of a load cell, not a log"
        remedy = "name it in the rig file, as log under calibration of the sensor"
        return FileFormatError(message, remedy, path=path, line=layout.header_line)
    lines = (
        f'time = "{layout.names[0]}" if that column is the time, or rate = "100 Hz" if rows are even in time'
    )
    remedy = f"write for this log in run.toml: {lines}; else export it again with its time"
    return FileFormatError(message, remedy, path=path, line=layout.header_line)


def read_counter(layout: Layout, column: int, path: Path, settings: Log, zone: dt.tzinfo | None) -> Counter:
    """Return what the time column counts, by its unit and by the size of its first number.

    Raises
    ------
    FileFormatError
        Its unit is none of time.
    """
    name, unit = layout.names[column], layout.units[column]
    written = settings.units.get(name)
    unit = written or unit or unit_in_name(name)
    try:
        first = float(layout.first_cells[column].replace(",", "."))
    except ValueError:  # a row without a time is refused when it is read
        first = 0.0
    try:
        calendar = calendar_start(first, unit) if written else None
    except OverflowError as error:
        message = f"the time column {name!r} begins with {first:g}, which is no day of {unit!r}"
        remedy = "correct the unit of the time for this log in run.toml"
        raise FileFormatError(message, remedy, path=path, line=layout.first_line) from error
    if calendar is not None:
        remark = f"the time counts days, as {unit} does"
        scale = (86400.0, 10.0**_DAY_DECIMALS)
        return Counter(86400.0, _DAY_DECIMALS, scale, calendar.replace(tzinfo=zone), "", (remark,))
    epoch = epoch_start(first, unit)
    if epoch is not None:
        start, factor, remark = epoch
        return Counter(factor, _DECIMALS[factor], (1.0, 1e9), start, "", (remark,))
    remarks: tuple[str, ...] = ()
    if not unit:
        remarks = (f"the time {name!r} has no unit and is taken as seconds",)
    elif unit.strip().lower() not in SECONDS:
        message = f"the time column {name!r} has the unit {unit!r}, expected s, ms, us, min or h"
        remedy = f'set units = {{ "{name}" = "s" }} for this log in run.toml if it counts seconds'
        raise FileFormatError(message, remedy, path=path, line=layout.header_line)
    order = settings.date_order
    start_time, date_order = _start_from_comments(path, layout, order, zone)
    factor = SECONDS.get(unit.strip().lower(), 1.0)
    return Counter(factor, None, (0.0, 1.0), start_time, date_order, remarks)


def _start_from_comments(
    path: Path, layout: Layout, order: str | None, zone: dt.tzinfo | None
) -> tuple[dt.datetime | None, str]:
    for text in layout.comments:
        match = STATED_START.fullmatch(text)
        if match and stamp_kind(match[1]) is not None:  # not such as "start: cold"
            stamps = parse_stamps([match[1]], path, [1], order)
            return stamps.start(zone), stamps.date_order
    return None, ""
