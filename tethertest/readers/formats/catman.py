"""HBM/HBK catman ASCII exports: ``HBM_CATMAN_DATAFILE``, a header of rows per channel, then numbers."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np

from tethertest.errors import FileFormatError
from tethertest.readers.channels import raw_channel, unique_names, with_units
from tethertest.readers.text.document import Document, Head, file_sha256, read_document
from tethertest.readers.text.stamps import Stamps, parse_stamps, time_zone_of
from tethertest.readers.text.table import check_widths, find_rows, is_number, read_columns
from tethertest.records.channel import RawChannel, RawLog
from tethertest.records.run import Log

NAME = "catman"
_MARK: Final = "HBM_CATMAN_DATAFILE"
_CHANNEL_NUMBER = re.compile(r"\s*CH=\d+\s*$")
_INTERVAL = re.compile(r"dt\s*=\s*([\d.,]+)\s*(s|ms|us|µs)", re.IGNORECASE)
_SECONDS: Final = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "µs": 1e-6}
_HEADER_LINES: Final = 200


@dataclass(frozen=True, slots=True)
class _Header:
    names: tuple[str, ...]
    units: tuple[str, ...]
    start: str  #: text behind "T0 =", "" where absent
    interval: float | None  #: [s]
    separator: str
    stated_rows: int | None
    names_line: int
    first_line: int


def sniff(head: Head) -> str | None:
    """Claim files whose first line begins with ``HBM_CATMAN_DATAFILE``."""
    if head.lines and head.lines[0].startswith(_MARK):
        return f"the first line begins with {_MARK!r}"
    return None


def read(path: Path, settings: Log | None = None) -> RawLog:
    """Read a catman ASCII export.

    Parameters
    ----------
    path : Path
        The log, plain or in gzip or zip.
    settings : Log, optional
        Settings of the run file: encoding, decimal, date_order, time_zone, units.

    Returns
    -------
    RawLog
        A channel's time is the time channel left of it, or its place times ``dt``; names lose their ``CH=n``.

    Raises
    ------
    FileFormatError
        The header is incomplete, a row is cut, or there are fewer rows than ``MAXLINES`` states.
    """
    document = read_document(path, settings.encoding if settings is not None else None)
    header = _read_header(document)
    text = document.from_line(header.first_line)
    rows = find_rows(
        path, text, header.first_line, header.separator, _decimal(text, header.separator, settings)
    )
    width = len(header.names)
    check_widths(rows, width, width + 1 if rows.counts[0] > width else width)
    if header.stated_rows is not None and len(rows.lines) < header.stated_rows:
        message = f"the log is cut: MAXLINES states {header.stated_rows} rows, found {len(rows.lines)}"
        remedy = "copy the whole file from the logger again, or export it again from catman"
        raise FileFormatError(message, remedy, path=path, line=int(rows.lines[-1]))
    columns = read_columns(rows, width, header.names, unused={width})
    stamps = _start(path, header, settings)
    zone = time_zone_of(settings.time_zone if settings is not None else None, path)
    channels: list[RawChannel] = []
    names, renamed = unique_names(header.names)
    time = None if header.interval is None else header.interval * np.arange(len(rows.lines))
    for column, (name, unit) in enumerate(zip(names, header.units, strict=True)):
        values = columns.numbers[column]
        if name.lower().startswith("time") and unit == "s":
            time = values
            continue
        if time is None:
            message = f"channel {name!r} has neither a time channel nor dt"
            raise FileFormatError(
                message, "export the log with its time channel", path=path, line=header.names_line
            )
        logged = np.isfinite(time)
        channels.append(raw_channel(name, unit, time[logged], values[logged]))
    if not channels:
        message = "the log has a time but no channels"
        raise FileFormatError(
            message, "choose the file that holds the data", path=path, line=header.names_line
        )
    return RawLog(
        path=path,
        format=NAME,
        sha256=file_sha256(path),
        start=None if stamps is None else stamps.start(zone),
        channels=with_units(path, channels, settings, names),
        encoding=document.encoding,
        decimal=rows.decimal,
        separator=header.separator,
        date_order="" if stamps is None else stamps.date_order,
        header_line=header.names_line,
        rate=None if header.interval is None else 1.0 / header.interval,
        remarks=(*renamed, *columns.remarks),
    )


def _read_header(document: Document) -> _Header:
    lines = document.lines(_HEADER_LINES)
    keys = {
        key.strip(): value.strip() for key, sign, value in (line.partition(":") for line in lines[:8]) if sign
    }
    separator = chr(int(keys["SEPARATOR"])) if keys.get("SEPARATOR", "").isdigit() else "\t"
    names_at = next(
        (i for i, line in enumerate(lines[3:], start=3) if line.count(separator) and "CH=" in line), None
    )
    start_at = next((i for i, line in enumerate(lines) if line.startswith("T0")), None)
    first = _first_data_line(lines, separator, start_at)
    if names_at is None or first is None:
        missing = "names (CH=n)" if names_at is None else "data"
        message = f"the header of the catman file is incomplete: found no row of {missing}"
        raise FileFormatError(
            message, "copy the whole file from the logger again", path=document.path, line=len(lines)
        )
    written = [cell.strip() for cell in lines[names_at].split(separator)]
    stripped = [_CHANNEL_NUMBER.sub("", name) for name in written]
    units = [cell.strip() for cell in lines[names_at + 1].split(separator)]
    count = int(keys["CHANNELS"]) if keys.get("CHANNELS", "").isdigit() else len(written)
    if count != len(written):
        message = f"CHANNELS states {count} channels, the row of names has {len(written)}"
        raise FileFormatError(message, "export the log again", path=document.path, line=names_at + 1)
    interval = next((match for line in lines[:first] if (match := _INTERVAL.match(line))), None)
    start = "" if start_at is None else lines[start_at].split(separator)[0].partition("=")[2].strip()
    return _Header(
        names=tuple(stripped),
        units=tuple([*units, *[""] * count][:count]),
        start=start,
        interval=float(interval[1].replace(",", ".")) * _SECONDS[interval[2].lower()] if interval else None,
        separator=separator,
        stated_rows=int(keys["MAXLINES"]) if keys.get("MAXLINES", "").isdigit() else None,
        names_line=names_at + 1,
        first_line=first + 1,
    )


def _first_data_line(lines: list[str], separator: str, start_at: int | None) -> int | None:
    """Return the index of the first row of numbers behind the header rows."""
    for index in range(start_at if start_at is not None else 8, len(lines)):
        cells = [cell.strip() for cell in lines[index].split(separator)]
        filled = [cell for cell in cells if cell]
        if filled and all(is_number(cell, ".") or is_number(cell, ",") for cell in filled):
            return index
    return None


def _decimal(text: bytes, separator: str, settings: Log | None) -> str:
    """Find the decimal sign: catman writes no thousands, so a comma between tabs is one."""
    if settings is not None and settings.decimal is not None:
        return settings.decimal
    return "," if separator != "," and b"," in text[:20000] else "."


def _start(path: Path, header: _Header, settings: Log | None) -> Stamps | None:
    if not header.start:
        return None
    order = settings.date_order if settings is not None else None
    return parse_stamps([header.start], path, [header.names_line], order or "dmy")
