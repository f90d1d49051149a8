"""HBM/HBK catman ASCII exports: ``HBM_CATMAN_DATAFILE``, a header of rows per channel, then numbers."""

from __future__ import annotations

from pathlib import Path
from typing import Final

import numpy as np
import numpy.typing as npt

from tethertest.errors import FileFormatError
from tethertest.readers.channels import raw_channel, unique_names, with_units
from tethertest.readers.formats.catman_header import MARK, Header, read_header
from tethertest.readers.tables.text.columns import read_columns
from tethertest.readers.tables.text.document import Head, read_document
from tethertest.readers.tables.text.rows import followed_lines
from tethertest.readers.tables.text.stamps import Stamps, parse_stamps, time_zone_of
from tethertest.readers.tables.text.table import Rows, check_widths, find_rows
from tethertest.readers.tables.time_units import SECONDS
from tethertest.records.arrays import FloatArray
from tethertest.records.channel import RawLog
from tethertest.records.run import DEFAULT, Log

NAME = "catman"
#: keys of a log in run.toml that it takes
USES = frozenset(["encoding", "decimal", "date_order", "time_zone", "units", "rate"])
#: cells of a cut row that its message shows
_CELLS_SHOWN: Final = 4
#: names of time channels, by the language of catman
_TIME_NAMES: Final = ("time", "zeit", "temps", "tiempo", "tempo", "时间")
#: a time channel may step this far from ``dt``, relative
_STEP_TOLERANCE: Final = 1e-3
#: rows that a channel fills, and their times [s]
_Filled = tuple[npt.NDArray[np.int64], FloatArray]


def sniff(head: Head) -> str | None:
    """Claim files whose first line begins with ``HBM_CATMAN_DATAFILE``."""
    if head.lines and head.lines[0].startswith(MARK):
        return f"the first line begins with {MARK!r}"
    return None


def read(path: Path, settings: Log = DEFAULT) -> RawLog:
    """Read a catman ASCII export.

    Parameters
    ----------
    path : Path
        The log, plain or in gzip or zip.
    settings : Log
        Settings of the run file: encoding, decimal, date_order, time_zone, rate, units.

    Returns
    -------
    RawLog
        A channel's time is the time channel left of it, or its place times its ``dt``, counted from the first
        ``T0``; names lose their ``CH=n``.

    Raises
    ------
    FileFormatError
        The header is incomplete or contradicts itself or the rows, a row is cut, or the number of rows is not
        the one that ``MAXLINES`` states.
    """
    document = read_document(path, settings.encoding)
    header = read_header(document)
    text = document.from_line(header.first_line)
    rows = find_rows(
        path, text, header.first_line, header.separator, _decimal(text, header.separator, settings)
    )
    width = len(header.names)
    _check_rows(rows, width, header)
    columns = read_columns(rows, width, header.names, unused={width})
    stamps = _starts(path, header, settings)
    zone = time_zone_of(settings.time_zone, path)
    names, renamed = unique_names(header.names)
    times, remarks = _channel_times(header, columns.numbers, rows, settings.rate)
    shift = np.zeros(width) if stamps is None else stamps.seconds()
    channels = []
    for column, (name, unit) in enumerate(zip(names, header.units, strict=True)):
        if not _is_time(header, column):
            where, time = times[column]
            channels.append(raw_channel(name, unit, time + shift[column], columns.numbers[column][where]))
    if not channels:
        message = "the log has a time but no channels"
        raise FileFormatError(
            message, "choose the file that holds the data", path=path, line=header.names_line
        )
    if np.any(shift != 0.0):
        remarks.append(f"the channels start up to {np.ptp(shift):g} s apart, by their T0")
    intervals = {interval for interval in header.intervals if interval is not None}
    return RawLog(
        path=path,
        format=NAME,
        start=None if stamps is None else stamps.start(zone),
        channels=with_units(path, channels, settings, names),
        encoding=document.encoding,
        decimal=rows.decimal,
        separator=header.separator,
        date_order="" if stamps is None else stamps.date_order,
        row_lines=tuple(followed_lines(rows.lines)),
        header_line=header.names_line,
        rate=1.0 / intervals.pop() if len(intervals) == 1 else None,
        remarks=(*renamed, *columns.remarks, *remarks),
    )


def _decimal(text: bytes, separator: str, settings: Log) -> str:
    """Find the decimal sign: catman writes no thousands, so a comma between tabs is one."""
    if settings.decimal is not None:
        return settings.decimal
    return "," if separator != "," and b"," in text else "."


def _check_rows(rows: Rows, width: int, header: Header) -> None:
    """Refuse rows that are cut or ragged, and another number of rows than ``MAXLINES`` states.

    Raises
    ------
    FileFormatError
        Names the line, what stands there, and how many whole rows there are.
    """
    stated, found = header.stated_rows, len(rows.lines)
    of_stated = "" if stated is None else f" of the {stated} that MAXLINES states"
    remedy = "copy the whole file from the logger again, or export it again from catman"
    whole = int(np.count_nonzero((rows.counts == width) | (rows.counts == width + 1)))
    if rows.counts[-1] < width and whole == found - 1:
        cells = [cell.decode() for cell in rows.body.rstrip(b"\n").rpartition(b"\n")[2].split(b"\t")]
        shown = rows.separator.join(cells).split(rows.separator)[:_CELLS_SHOWN]
        more = ", ..." if rows.counts[-1] > _CELLS_SHOWN else ""
        message = (
            f"the last row is cut: found {rows.counts[-1]} of {width} columns "
            f"({', '.join(shown)}{more}); before it "
            f"the log has {whole} whole rows{of_stated}"
        )
        limit = "" if stated is None else f" and set MAXLINES to {whole}"
        remedy = f"{remedy}; to use the {whole} whole rows, delete this one{limit} in a copy of the log"
        raise FileFormatError(message, remedy, path=rows.path, line=int(rows.lines[-1]))
    check_widths(rows, width, width + 1 if rows.counts[0] > width else width)
    if stated is not None and found != stated:
        what = "the log is cut" if found < stated else "the log has more rows than its header states"
        message = f"{what}: MAXLINES states {stated} rows, found {found}"
        limit = f"; if these rows are all, set MAXLINES to {found} in a copy of the log"
        raise FileFormatError(
            message, remedy + limit, path=rows.path, line=int(rows.lines[min(found, stated) - 1])
        )


def _starts(path: Path, header: Header, settings: Log) -> Stamps | None:
    """Return T0 of every column; a date with slashes is read as the plainly written one, if there is one."""
    texts = [text or header.starts[0] for text in header.starts]
    if not texts[0]:
        return None
    order: str | None = settings.date_order
    lines = [header.start_line] * len(texts)
    if order is None and header.date is not None and "/" in texts[0]:
        _year, month, day = header.date
        numbers = [int(part) for part in texts[0].split()[0].split("/") if part.isdigit()]
        for possible, parts in (("dmy", [day, month]), ("mdy", [month, day])):
            if numbers[:2] == parts and day != month:
                order = possible
    return parse_stamps(texts, path, lines, order)


def _is_time(header: Header, column: int) -> bool:
    """Return whether a column is a time channel."""
    named = header.names[column].lower().startswith(_TIME_NAMES)
    return named and header.units[column].lower() in SECONDS


def _channel_times(
    header: Header, numbers: dict[int, FloatArray], rows: Rows, rate: float | None
) -> tuple[dict[int, _Filled], list[str]]:
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
    result: dict[int, _Filled] = {}
    remarks: list[str] = []
    time: FloatArray | None = None
    for column, name in enumerate(header.names):
        values = numbers[column]
        if _is_time(header, column):
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
) -> _Filled:
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
