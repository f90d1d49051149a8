"""Campbell Scientific TOA5 tables: four header rows (environment, names, units, process), then records.

References
----------
Campbell Scientific, "LoggerNet Instruction Manual", appendix on table-oriented ASCII data files (TOA5).
"""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np

from tethertest.errors import FileFormatError
from tethertest.readers.channels import raw_channel, with_units
from tethertest.readers.tables.text.columns import read_columns
from tethertest.readers.tables.text.document import Document, Head, read_document
from tethertest.readers.tables.text.rows import followed_lines
from tethertest.readers.tables.text.stamps import parse_stamps, time_zone_of
from tethertest.readers.tables.text.table import check_widths, find_rows
from tethertest.records.arrays import FloatArray
from tethertest.records.channel import RawLog
from tethertest.records.run import DEFAULT, Log

NAME = "toa5"
#: keys of a log in run.toml that it takes
USES = frozenset(["encoding", "decimal", "date_order", "time_zone", "units"])
_MARK: Final = "TOA5"
_ROWS: Final = ("environment", "names", "units", "process")
#: what the environment row holds after the mark
_ENVIRONMENT: Final = ("station", "model", "serial number", "system", "program", "signature", "table")
#: processing that leaves a sample as it was measured
_SAMPLES: Final = frozenset(["", "smp", "sample"])
#: columns that are no channel: the stamp and the record's number
_STAMP, _RECORD, _RECORD_UNIT = "TIMESTAMP", "RECORD", "RN"
_NUMBER: Final = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")
_EXPORT: Final = "export the table again as TOA5 with its four header rows"


@dataclass(frozen=True, slots=True)
class _Header:
    environment: tuple[str, ...]
    names: tuple[str, ...]
    units: tuple[str, ...]
    process: tuple[str, ...]


def sniff(head: Head) -> str | None:
    """Claim files whose first cell is ``TOA5``, or that have its rows ``TIMESTAMP`` over ``TS``."""
    first, names, units = ([*(_cells(line) for line in head.lines[:3]), [], [], []])[:3]
    if first[:1] == [_MARK]:
        return f"the first cell is {_MARK!r}"
    if names[:1] == [_STAMP] and units[:1] == ["TS"]:
        return f"the second row begins with {_STAMP!r} and the third with 'TS', as in {_MARK}"
    return None


def read(path: Path, settings: Log = DEFAULT) -> RawLog:
    """Read a Campbell TOA5 table.

    Parameters
    ----------
    path : Path
        The log, plain or in gzip or zip.
    settings : Log
        Settings of the run file: encoding, decimal, date_order, time_zone, units.

    Returns
    -------
    RawLog
        Stamps as they are, those that repeat or go back included; ``"NAN"`` and ``"INF"`` are NaN.

    Raises
    ------
    FileFormatError
        The header is cut, its rows differ in length or repeat a name, a row is ragged or cut, or a date can
        be read two ways.
    """
    document = read_document(path, settings.encoding)
    header = _read_header(document)
    width = len(header.names)
    decimal = settings.decimal if settings.decimal is not None else "."
    rows = find_rows(path, document.from_line(5), 5, ",", decimal, quotes=True)
    check_widths(rows, width, width)
    record = next((column for column, name in enumerate(header.names) if name.upper() == _RECORD), None)
    texts = {column for column in range(width) if header.units[column].upper() == "TS"} | {0}
    columns = read_columns(rows, width, header.names, texts=texts)
    for column in texts - {0}:
        _refuse_numbers(path, header.names[column], columns.texts[column], rows.lines)
    order = settings.date_order
    stamps = parse_stamps(columns.texts[0], path, rows.lines, order)
    time = stamps.seconds()
    channels = [
        raw_channel(header.names[column], _unit(header.units[column]), time, columns.numbers[column])
        for column in range(width)
        if column not in texts and column != record
    ]
    if not channels:
        message = "the table has stamps but no channels"
        raise FileFormatError(message, "choose the table that holds the data", path=path, line=2)
    stamped = sorted(texts - {0})
    remarks = [
        *_environment_remarks(header),
        *(f"column {header.names[column]!r} holds stamps and is not a channel" for column in stamped),
        *columns.remarks,
        *_stamp_remarks(time, rows.lines),
        *([] if record is None else _record_remarks(columns.numbers[record], rows.lines)),
    ]
    return RawLog(
        path=path,
        format=NAME,
        start=stamps.start(time_zone_of(settings.time_zone, path)),
        channels=with_units(path, channels, settings),
        encoding=document.encoding,
        decimal=decimal,
        separator=",",
        date_order=stamps.date_order,
        row_lines=tuple(followed_lines(rows.lines)),
        header_line=2,
        remarks=tuple(remarks),
    )


def _unit(written: str) -> str:
    """Return a unit; ``RN`` marks numbers of records and is none, though it reads as ronnanewton."""
    return "" if written.upper() == _RECORD_UNIT else written


def _refuse_numbers(path: Path, name: str, cells: Sequence[str], lines: Sequence[int] | np.ndarray) -> None:
    """Refuse numbers under the unit of stamps: the rows of units and names do not belong together."""
    for row, cell in enumerate(cells):
        if _NUMBER.fullmatch(cell.strip()):
            message = f"column {name!r} has the unit TS, of stamps, and holds {cell.strip()!r}"
            raise FileFormatError(message, _EXPORT, path=path, line=int(lines[row]))


def _cells(line: str) -> list[str]:
    try:
        return [cell.strip() for cell in next(csv.reader([line], strict=False), [])]
    except csv.Error:  # a bare carriage return within a line: no row of cells
        return []


def _read_header(document: Document) -> _Header:
    path = document.path
    lines = document.lines(4)
    for number, what in enumerate(_ROWS, start=1):
        if len(lines) < number or not lines[number - 1].strip():
            message = f"the header is cut: found {number - 1} of 4 rows, expected a row of {what}"
            raise FileFormatError(message, _EXPORT, path=path, line=number)
    environment, names, units, process = (list(_cells(line)) for line in lines)
    if not environment or not names:
        row = 1 if not environment else 2
        message = f"the row of {_ROWS[row - 1]} has a stray carriage return or quote"
        raise FileFormatError(message, _EXPORT, path=path, line=row)
    for number, cells in ((3, units), (4, process)):
        if len(cells) != len(names):
            message = (
                f"the row of {_ROWS[number - 1]} has {len(cells)} cells, the row of names has {len(names)}"
            )
            raise FileFormatError(message, _EXPORT, path=path, line=number)
    if names[0].upper() != _STAMP:
        message = f"the first name is {names[0]!r}, expected {_STAMP!r}"
        raise FileFormatError(message, _EXPORT, path=path, line=2)
    for column, name in enumerate(names):
        if not name:
            message = f"column {column + 1} has no name"
            raise FileFormatError(message, _EXPORT, path=path, line=2)
        if '"' in name:
            message = f"found {name!r} in the row of names, expected a name in quotes"
            raise FileFormatError(message, _EXPORT, path=path, line=2)
        if name in names[:column]:
            first = names.index(name) + 1
            message = f"the name {name!r} stands over columns {first} and {column + 1}"
            remedy = (
                "give each field its own name in the logger's program, or rename one in a copy of the log"
            )
            raise FileFormatError(message, remedy, path=path, line=2)
    return _Header(tuple(environment), tuple(names), tuple(units), tuple(process))


def _environment_remarks(header: _Header) -> list[str]:
    remarks = []
    if header.environment[0] == _MARK:
        known = zip(_ENVIRONMENT, header.environment[1:], strict=False)
        remarks.append(", ".join(f"{what} {cell}" for what, cell in known if cell))
        if len(header.environment) != 1 + len(_ENVIRONMENT):
            remarks.append(
                f"the environment row has {len(header.environment)} cells, {_MARK} has "
                f"{1 + len(_ENVIRONMENT)}"
            )
    else:
        remarks.append(
            f"the first cell is {header.environment[0]!r}, not {_MARK!r}; the rows are those of {_MARK}"
        )
    pairs = zip(header.names, header.process, strict=True)
    processed = [f"{name} ({how})" for name, how in pairs if how.lower() not in _SAMPLES and name != _STAMP]
    if processed:
        remarks.append(f"no plain samples, but processed by the logger: {', '.join(processed)}")
    return [remark for remark in remarks if remark]


def _stamp_remarks(time: FloatArray, lines: Sequence[int] | np.ndarray) -> list[str]:
    remarks = []
    step = np.diff(time)
    for wrong, words in ((step == 0, "repeat the stamp before them"), (step < 0, "go back in time")):
        rows = np.flatnonzero(wrong)
        if rows.size:
            remarks.append(
                f"{rows.size} rows {words}, first in line {lines[rows[0] + 1]}; they are kept as they are"
            )
    return remarks


def _record_remarks(records: FloatArray, lines: Sequence[int] | np.ndarray) -> list[str]:
    remarks = []
    step = np.diff(records)
    lost = np.flatnonzero(step > 1)
    if lost.size:
        count = int(np.sum(step[lost] - 1))
        remarks.append(f"{count} records are missing, first before line {lines[lost[0] + 1]}")
    back = np.flatnonzero(step <= 0)
    if back.size:
        remarks.append(
            f"the record number does not increase {back.size} times, first in line {lines[back[0] + 1]}"
        )
    blank = int(np.count_nonzero(np.isnan(records)))
    if blank:
        remarks.append(f"{blank} rows have no record number")
    return remarks
