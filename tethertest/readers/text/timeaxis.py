"""Which column of an unknown text log is its time, and what it counts."""

from __future__ import annotations

import datetime as dt
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np

from tethertest.errors import FileFormatError
from tethertest.readers.text.layout import Layout
from tethertest.readers.text.stamps import parse_stamps, time_zone_of
from tethertest.readers.text.table import Columns, Rows
from tethertest.records.arrays import FloatArray
from tethertest.records.run import Log

_NAMES: Final = frozenset([
    "time", "timestamp", "time stamp", "datetime", "date time", "date", "x_value", "elapsed",
    "elapsed time", "relative time", "epoch", "unix", "unix time", "seconds", "sec", "zeit",
    "temps", "tiempo", "tempo", "时间", "采样时间", "时刻",
])  # fmt: skip
_NAME_WITH_UNIT = re.compile(r"(?:time|t|elapsed|timestamp|epoch)[_ ](s|sec|ms|us|min|h)", re.IGNORECASE)
_SECONDS: Final = {
    "s": 1.0, "sec": 1.0, "second": 1.0, "seconds": 1.0, "秒": 1.0, "ms": 1e-3, "毫秒": 1e-3,
    "us": 1e-6, "µs": 1e-6, "μs": 1e-6, "ns": 1e-9, "min": 60.0, "分": 60.0, "h": 3600.0, "hr": 3600.0,
}  # fmt: skip
#: seconds since 1970 of the years 1979 to 2065; other counters are told by their size in this unit
_EPOCH: Final = (3e8, 3e9)
#: a LabVIEW counter of seconds starts in 1904, this many seconds before 1970
_LABVIEW_EPOCH: Final = 2_082_844_800
_START = re.compile(r"start(?:\s*time|ed)?(?:\s+at)?\s*[:=]\s*(.+)", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class TimeColumns:
    """The columns that hold the time: one counter, or one or two of stamps."""

    stamps: tuple[int, ...]  #: date and time, or one column
    counter: int | None
    remark: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class TimeAxis:
    """Time of every row."""

    time: FloatArray  #: (n,) [s] since `start`
    start: dt.datetime | None
    date_order: str
    remarks: tuple[str, ...]


def columns_named_time(layout: Layout) -> list[int]:
    """Return the columns whose name says that they are the time; a T may be a temperature."""
    found = []
    for column, (name, unit) in enumerate(zip(layout.names, layout.units, strict=True)):
        letter = (name == "t" and not unit) or (name in {"t", "T"} and unit.lower() in _SECONDS)
        if letter or name.lower() in _NAMES or _NAME_WITH_UNIT.fullmatch(name):
            found.append(column)
    return found


def find_time(layout: Layout, path: Path) -> TimeColumns:
    """Choose the time column by name, stamps, unit, then place.

    Raises
    ------
    FileFormatError
        No column can be the time.
    """
    named = columns_named_time(layout)
    of_kind = {
        kind: [column for column, found in enumerate(layout.kinds) if found == kind]
        for kind in ("number", "datetime", "date", "time", "text")
    }
    for column in named:
        if layout.kinds[column] == "number":
            return TimeColumns((), column)
    if of_kind["datetime"]:
        return TimeColumns((of_kind["datetime"][0],), None)
    if of_kind["date"] and of_kind["time"]:
        return TimeColumns((of_kind["date"][0], of_kind["time"][0]), None)
    if of_kind["time"]:
        return TimeColumns((of_kind["time"][0],), None, "the stamps have a time of day but no date")
    for column in of_kind["number"]:
        if layout.units[column].lower() in _SECONDS:
            return TimeColumns((), column)
    wrong = next((column for column in named if layout.kinds[column] == "text"), None)
    if wrong is not None:
        message = f"the time column {layout.names[wrong]!r} holds text, expected seconds or stamps"
        raise FileFormatError(
            message, "export the log again with full stamps or seconds", path=path, line=layout.first_line
        )
    if layout.kinds[0] == "number" and (not layout.names[0] or layout.header_line is None):
        return TimeColumns((), 0, "the first column has no name and is taken as the time in seconds")
    message = f"found no time column among {', '.join(repr(name) for name in layout.names[:8])}"
    remedy = "export the log with its time; its column is called time or timestamp, or has the unit s"
    raise FileFormatError(message, remedy, path=path, line=layout.header_line)


def read_time(
    rows: Rows, columns: Columns, layout: Layout, chosen: TimeColumns, settings: Log | None
) -> TimeAxis:
    """Turn the chosen columns into seconds.

    Raises
    ------
    FileFormatError
        A cell of the time is blank or unreadable, its unit is unknown, or its date can be read two ways.
    """
    zone = time_zone_of(settings.time_zone if settings is not None else None, rows.path)
    order = settings.date_order if settings is not None else None
    remarks = (chosen.remark,) if chosen.remark else ()
    if chosen.counter is None:
        parts = [columns.texts[column] for column in chosen.stamps]
        for part in parts:
            if "" in part:
                raise _blank_time(rows, part.index(""))
        cells = parts[0] if len(parts) == 1 else [" ".join(pair) for pair in zip(*parts, strict=True)]
        stamps = parse_stamps(cells, rows.path, rows.lines, order)
        return TimeAxis(stamps.seconds(), stamps.start(zone), stamps.date_order, remarks)
    values = columns.numbers[chosen.counter]
    holes = np.isnan(values)
    if np.any(holes):
        raise _blank_time(rows, int(np.argmax(holes)))
    name, unit = layout.names[chosen.counter], layout.units[chosen.counter]
    if settings is not None and name in settings.units:
        unit = settings.units[name]
    suffix = _NAME_WITH_UNIT.fullmatch(name)
    unit = unit or (suffix[1] if suffix else "")
    epoch = _epoch_start(values, unit)
    if epoch is not None:
        start, factor, remark = epoch
        time = (values - values[0]) * factor
        return TimeAxis(time, start, "", (*remarks, remark))
    if not unit:
        remarks = (*remarks, f"the time {name!r} has no unit and is taken as seconds")
    elif unit.lower() not in _SECONDS:
        message = f"the time column {name!r} has the unit {unit!r}, expected s, ms, us, min or h"
        remedy = f'set units = {{ "{name}" = "s" }} for this log in run.toml if it counts seconds'
        raise FileFormatError(message, remedy, path=rows.path, line=layout.header_line)
    start_time, date_order = _start_from_comments(rows.path, layout, order, zone)
    return TimeAxis(values * _SECONDS.get(unit.lower(), 1.0), start_time, date_order, remarks)


def _blank_time(rows: Rows, row: int) -> FileFormatError:
    message = "the row has no time"
    return FileFormatError(message, "export the log again", path=rows.path, line=int(rows.lines[row]))


def _epoch_start(values: FloatArray, unit: str) -> tuple[dt.datetime, float, str] | None:
    """Recognise counters since 1970 or 1904 by their size."""
    first = float(values[0])
    written = _SECONDS.get(unit.lower())
    for name in ("s", "ms", "us", "ns"):
        factor = _SECONDS[name]
        if written not in {None, factor}:
            continue
        seconds = first * factor
        zero = _LABVIEW_EPOCH if name == "s" and seconds >= _EPOCH[1] else 0
        if _EPOCH[0] <= seconds - zero < _EPOCH[1]:
            start = dt.datetime(1970, 1, 1, tzinfo=dt.UTC) + dt.timedelta(seconds=seconds - zero)
            return start, factor, f"the time counts {name} since {1904 if zero else 1970}, UTC"
    return None


def _start_from_comments(
    path: Path, layout: Layout, order: str | None, zone: dt.tzinfo | None
) -> tuple[dt.datetime | None, str]:
    for text in layout.comments:
        match = _START.fullmatch(text)
        if match:
            stamps = parse_stamps([match[1]], path, [1], order)
            return stamps.start(zone), stamps.date_order
    return None, ""
