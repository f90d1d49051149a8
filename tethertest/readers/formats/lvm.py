"""LabVIEW measurement files (text): ``LabVIEW Measurement``, keys, then one or more segments.

References
----------
National Instruments, "Specification for the LabVIEW Measurement File (.lvm)".
"""

from __future__ import annotations

import datetime as dt
from pathlib import Path
from typing import Final

import numpy as np

from tethertest.errors import FileFormatError
from tethertest.readers.channels import raw_channel, unique_names, with_units
from tethertest.readers.formats.lvm_segments import Segment, find_segments
from tethertest.readers.tables.text.columns import read_columns
from tethertest.readers.tables.text.document import Document, Head, read_document
from tethertest.readers.tables.text.stamps import parse_stamps, time_zone_of
from tethertest.readers.tables.text.table import check_widths, find_rows
from tethertest.records.arrays import FloatArray
from tethertest.records.channel import RawChannel, RawLog
from tethertest.records.run import DEFAULT, Log

NAME = "lvm"
#: keys of a log in run.toml that it takes
USES = frozenset(["encoding", "decimal", "separator", "date_order", "time_zone", "units"])
#: an X column whose steps vary by less than this share is one of even samples, else Delta_X means nothing
_UNEVEN: Final = 0.2
#: X values are seconds, from the start or since 1904
_LATEST: Final = 1e11
#: X values above this count from 1904, not from the segment's start [s]
_ABSOLUTE: Final = 1e9
#: share by which even steps may differ from Delta_X: both are rounded as they are written
_OTHER: Final = 0.01
_SEPARATORS = {"tab": "\t", "comma": ",", "semicolon": ";"}


def sniff(head: Head) -> str | None:
    """Claim files whose first line is ``LabVIEW Measurement``."""
    if head.lines and head.lines[0].startswith("LabVIEW Measurement"):
        return "the first line is 'LabVIEW Measurement'"
    return None


def read(path: Path, settings: Log = DEFAULT) -> RawLog:
    """Read a LabVIEW measurement file.

    Parameters
    ----------
    path : Path
        The log, plain or in gzip or zip.
    settings : Log
        Settings of the run file: encoding, decimal, separator, date_order, time_zone, units.

    Returns
    -------
    RawLog
        Each segment starts at its own stamp; text events of the comment column are remarks.

    Raises
    ------
    FileFormatError
        The header is cut, a segment has fewer rows than it states, or a row is cut.
    """
    document = read_document(path, settings.encoding)
    header, separator, decimal = _file_header(document, settings)
    segments = find_segments(document, separator, header)
    zone = time_zone_of(settings.time_zone, path)
    order = settings.date_order
    first = segments[0]
    names, remarks = unique_names(first.names)
    notes = list(remarks)
    if not header.get("Decimal_Separator") and settings.decimal is None:
        sign = {".": "point", ",": "comma"}[decimal]
        notes.append(f"the header states no Decimal_Separator; the numbers have a decimal {sign}")
    start, date_order, zero = None, "", None
    pieces: dict[int, list[tuple[FloatArray, FloatArray]]] = {column: [] for column in range(len(names))}
    for number, segment in enumerate(segments, start=1):
        if segment.names != first.names:
            message = f"segment {number} has the channels {segment.names}, the first one has {first.names}"
            raise FileFormatError(message, "split the log at this line", path=path, line=segment.names_line)
        _refuse_other_units(path, number, segment, first)
        starts = [_start(path, segment, channel, order, zone) for channel in range(len(names))]
        if start is None and starts[0] is not None:
            start, date_order = starts[0]
        columns, events = _read_segment(document, segment, separator, decimal)
        notes.extend(events)
        for channel, (time, values) in enumerate(columns):
            began = starts[channel]
            shift = (began[0] - start).total_seconds() if began is not None and start is not None else 0.0
            if time.size and time[0] > _ABSOLUTE:
                zero = float(time[0]) if zero is None else zero
                shift = -zero
            pieces[channel].append((time + shift, values))
    if zero is not None:
        notes.append(
            "X counts seconds since 1904: the time counts from its first value, which resolves 0.5 us"
        )
    if len(segments) > 1:
        notes.append(
            f"the file holds {len(segments)} segments, each with its own start; between them is a gap"
        )
    channels = [_joined(name, first.units[i], pieces[i]) for i, name in enumerate(names)]
    notes.extend(
        f"channel {channel.name!r} has no samples" for channel in channels if not channel.values.size
    )
    if not any(channel.values.size for channel in channels):
        message = "the log has a header but no data rows"
        raise FileFormatError(message, "choose another file", path=path, line=first.names_line)
    interval = first.intervals[0]
    return RawLog(
        path=path,
        format=NAME,
        start=start,
        channels=with_units(path, channels, settings),
        encoding=document.encoding,
        decimal=decimal,
        separator=separator,
        date_order=date_order,
        header_line=first.names_line,
        rate=1.0 / interval if interval > 0 else None,
        remarks=tuple(notes),
    )


def _refuse_other_units(path: Path, number: int, segment: Segment, first: Segment) -> None:
    for name, unit, before in zip(segment.names, segment.units, first.units, strict=True):
        if unit != before:
            message = (
                f"segment {number} has {name!r} in {unit or 'no unit'}, the first one in {before or 'none'}"
            )
            raise FileFormatError(message, "split the log at this line", path=path, line=segment.names_line)


def _file_header(document: Document, settings: Log) -> tuple[dict[str, str], str, str]:
    """Return the keys of the file header, the separator and the decimal sign."""
    lines = document.lines(200)
    separator = next(
        (line[len(key) :][:1] for line in lines for key in ("Writer_Version",) if line.startswith(key)), ""
    )
    separator = separator or "\t"
    keys: dict[str, str] = {}
    for line in lines:
        if line.startswith("***End_of_Header***"):
            break
        key, _, value = line.partition(separator)
        keys[key.strip()] = value.strip(separator + " ")
    else:
        message = "the file header has no end"
        raise FileFormatError(
            message, "copy the whole file from the logger again", path=document.path, line=1
        )
    separator = _SEPARATORS.get(keys.get("Separator", "").lower(), separator)
    decimal = keys.get("Decimal_Separator", "")
    if settings.separator is not None:
        separator = _SEPARATORS.get(settings.separator.lower(), settings.separator)
    if settings.decimal is not None:
        decimal = settings.decimal
    return keys, separator, decimal if decimal in {".", ","} else _decimal_by_content(document, separator)


def _decimal_by_content(document: Document, separator: str) -> str:
    """Find the decimal sign in the last lines: the header's own times may use another one."""
    if separator == ",":
        return "."
    cells = [cell for line in document.body.split(b"\n")[-50:] for cell in line.split(separator.encode())]
    numbers = [cell.strip() for cell in cells if cell.strip()[:1] in b"+-0123456789" and cell.strip()]
    return "," if sum(b"," in cell for cell in numbers) > sum(b"." in cell for cell in numbers) else "."


def _start(
    path: Path, segment: Segment, channel: int, order: str | None, zone: dt.tzinfo | None
) -> tuple[dt.datetime, str] | None:
    text = segment.starts[channel]
    if not text:
        return None
    stamps = parse_stamps([text], path, [segment.first_line], order)
    start = stamps.start(zone)
    return None if start is None else (start, stamps.date_order)


def _read_segment(
    document: Document, segment: Segment, separator: str, decimal: str
) -> tuple[list[tuple[FloatArray, FloatArray]], list[str]]:
    """Return time and values of every channel, and the text events."""
    count = len(segment.names)
    if not segment.rows.strip():
        return [(np.empty(0), np.empty(0)) for _ in range(count)], []
    path, width = document.path, segment.width
    rows = find_rows(path, segment.rows, segment.first_line, separator, decimal)
    check_widths(rows, width - 1 if segment.comment else width, width)
    stated = max(segment.samples)
    if segment.counts_rows and len(rows.lines) != stated:
        message = f"the segment states {stated} samples and has {len(rows.lines)} rows"
        remedy = "copy the whole file from the logger again"
        raise FileFormatError(message, remedy, path=path, line=int(rows.lines[-1]))
    names = [*(segment.column_names), "Comment"][:width]
    comment = width - 1
    texts = {comment} if segment.comment else set()
    unused = {0} if segment.x_columns == "no" else set()
    columns = read_columns(rows, width, names, texts=texts, unused=unused)
    events = [
        f"line {rows.lines[row]}: {cell.strip()}"
        for row, cell in enumerate(columns.texts.get(comment, []))
        if cell.strip()
    ]
    result = []
    for channel in range(count):
        place = 2 * channel if segment.x_columns == "multi" else 0
        values = columns.numbers[place + 1 if segment.x_columns == "multi" else channel + 1]
        size = _filled_size(values, segment.samples[channel])
        if segment.counts_rows and size != segment.samples[channel]:
            message = f"channel {segment.names[channel]!r} has values in {size} rows, the segment states "
            message += f"{segment.samples[channel]} samples of it"
            remedy = "copy the whole file from the logger again"
            raise FileFormatError(message, remedy, path=path, line=segment.names_line)
        written = columns.numbers.get(place)
        time = segment.time(channel, size) if written is None else written[:size]
        wrong = ~(np.abs(time) < _LATEST)
        if np.any(wrong):
            line = int(rows.lines[np.argmax(wrong)])
            message = f"the row has no X value that is a time in seconds: {time[np.argmax(wrong)]:g}"
            raise FileFormatError(message, "export the log again", path=path, line=line)
        if size > 1:
            _check_interval(path, segment, channel, time)
        result.append((time, values[:size]))
    return result, [*columns.remarks, *events]


def _check_interval(path: Path, segment: Segment, channel: int, time: FloatArray) -> None:
    """Hold what the header states as the sampling interval against the times."""
    stated = segment.intervals[channel]
    steps = np.diff(time)
    step = float(np.median(steps))
    if segment.x_columns == "no" and not stated > 0:
        message = f"Delta_X is {stated:g} and there is no X column: the samples have no time"
    elif (
        stated > 0
        and step > 0
        and float(np.ptp(steps)) < _UNEVEN * step
        and abs(step - stated) > _OTHER * stated
    ):
        message = f"Delta_X is {stated:g} for {segment.names[channel]!r}, its X column steps by {step:g}"
    else:
        return
    remedy = "correct Delta_X or the X column in a copy of the log, by the setting of the logger"
    raise FileFormatError(message, remedy, path=path, line=segment.names_line)


def _filled_size(values: FloatArray, stated: int) -> int:
    """Return how many rows belong to a channel: a shorter one leaves its last cells blank."""
    if stated < len(values) and bool(np.all(np.isnan(values[stated:]))):
        return stated
    return len(values)


def _joined(name: str, unit: str, pieces: list[tuple[FloatArray, FloatArray]]) -> RawChannel:
    time = np.concatenate([time for time, _ in pieces])
    return raw_channel(name, unit, time, np.concatenate([values for _, values in pieces]))
