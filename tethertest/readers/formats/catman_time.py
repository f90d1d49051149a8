"""Time of every channel of a catman export: its time channel, or its own ``dt``."""

from __future__ import annotations

from typing import Final

import numpy as np
import numpy.typing as npt

from tethertest.errors import FileFormatError
from tethertest.readers.formats.catman_header import Header
from tethertest.readers.text.table import Rows
from tethertest.readers.timeunits import SECONDS
from tethertest.records.arrays import FloatArray

#: names of time channels, by the language of catman
_TIME_NAMES: Final = ("time", "zeit", "temps", "tiempo", "tempo", "时间")
#: a time channel may step this far from ``dt``, relative
_STEP_TOLERANCE: Final = 1e-3

#: rows that a channel fills, and their times [s]
Filled = tuple[npt.NDArray[np.int64], FloatArray]


def is_time(header: Header, column: int) -> bool:
    """Return whether a column is a time channel."""
    named = header.names[column].lower().startswith(_TIME_NAMES)
    return named and header.units[column].lower() in SECONDS


def channel_times(
    header: Header, numbers: dict[int, FloatArray], rows: Rows, rate: float | None
) -> tuple[dict[int, Filled], list[str]]:
    """Return which rows each channel fills and when, and remarks.

    Parameters
    ----------
    header : Header
        Names, units and ``dt`` of the columns.
    numbers : dict
        (n,) values by column.
    rows : Rows
        For messages.
    rate : float or None
        Rate of all channels [Hz] that the run file states: ``dt`` is then not looked at.

    Raises
    ------
    FileFormatError
        A value has no time, a time channel does not step by ``dt``, or a channel has neither.
    """
    intervals = header.intervals if rate is None else (1.0 / rate,) * len(header.names)
    result: dict[int, Filled] = {}
    remarks: list[str] = []
    time: FloatArray | None = None
    for column, name in enumerate(header.names):
        values = numbers[column]
        if is_time(header, column):
            time = values * SECONDS[header.units[column].lower()]
            if rate is None:
                _check_step(header, column, time, rows)
            continue
        if time is not None:
            where = np.flatnonzero(np.isfinite(time))
            lonely = np.isnan(time) & np.isfinite(values)
            if np.any(lonely):
                message = f"channel {name!r} has a value where its time channel is blank"
                line = int(rows.lines[np.argmax(lonely)])
                raise FileFormatError(message, "export the log again from catman", path=rows.path, line=line)
            result[column] = where, time[where]
        else:
            result[column] = _by_interval(header, column, intervals, numbers, rows)
    if rate is not None and time is None:
        remarks.append(f"time is the row at the {rate:g} Hz that the run file states")
    return result, remarks


def _check_step(header: Header, column: int, time: FloatArray, rows: Rows) -> None:
    stated, steps = header.intervals[column], np.diff(time)
    steps = steps[np.isfinite(steps)]
    if stated is None or not steps.size:
        return
    usual = float(np.median(steps))
    if abs(usual - stated) > _STEP_TOLERANCE * stated:
        message = (
            f"dt states {1e3 * stated:g} ms between samples, the channel {header.names[column]!r} steps by "
            f"{1e3 * usual:g} ms"
        )
        remedy = "export the log again; where its time channel is right, set rate for this log in run.toml"
        raise FileFormatError(message, remedy, path=rows.path, line=header.interval_line)


def _by_interval(
    header: Header,
    column: int,
    intervals: tuple[float | None, ...],
    numbers: dict[int, FloatArray],
    rows: Rows,
) -> Filled:
    """Return place times ``dt``; slower channels stand packed at the top, or in every n-th row."""
    name, interval = header.names[column], intervals[column]
    if interval is None:
        message = f"channel {name!r} has neither a time channel nor dt"
        raise FileFormatError(
            message, "export the log with its time channel", path=rows.path, line=header.names_line
        )
    fastest = min(item for item in intervals if item is not None)
    place = np.arange(len(rows.lines), dtype=np.int64)
    if interval == fastest:
        return place, np.asarray(interval * place, dtype=np.float64)
    filled = np.flatnonzero(np.isfinite(numbers[column])).astype(np.int64)
    ratio = interval / fastest
    packed = filled.size and filled[-1] == filled.size - 1
    if packed and abs(filled.size - place.size / ratio) <= 1.0:
        return filled, np.asarray(interval * filled, dtype=np.float64)
    if filled.size and np.array_equal(filled, np.rint(np.arange(filled.size) * ratio)):
        return filled, np.asarray(interval * np.arange(filled.size), dtype=np.float64)
    message = (
        f"channel {name!r} has {filled.size} values in {place.size} rows, its dt of "
        f"{1e3 * interval:g} ms asks for "
        f"{place.size / ratio:.0f}"
    )
    remedy = "export the log with a time channel for each rate"
    raise FileFormatError(message, remedy, path=rows.path, line=header.interval_line)
