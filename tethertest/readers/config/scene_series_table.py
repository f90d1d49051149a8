"""The columns of a series file by name, with the line of every row, whichever of them is the time."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from tethertest.errors import DataError, FileFormatError
from tethertest.readers.channels import unique_names
from tethertest.readers.registry import GENERIC, identified
from tethertest.readers.tables.text.columns import read_columns
from tethertest.readers.tables.text.document import read_document
from tethertest.readers.tables.text.layout import find_layout
from tethertest.readers.tables.text.stamps import parse_stamps
from tethertest.readers.tables.text.table import Rows, check_widths, find_rows
from tethertest.records.arrays import FloatArray
from tethertest.records.run import DEFAULT

#: what an instrument's own time axis is called, for logs that have no column of it
OWN_TIME = "time"
#: unit at the end of a column's name -> the unit; the longest that fits counts
_SUFFIXES = {
    "_m_s": "m/s", "_m/s": "m/s", "_km_h": "km/h", "_km/h": "km/h", "_kn": "knot", "_ft_s": "ft/s",
    "_mm": "mm", "_cm": "cm", "_um": "um", "_km": "km", "_m": "m", "_ft": "ft", "_in": "in",
    "_ms": "ms", "_us": "us", "_ns": "ns", "_s": "s", "_min": "min", "_h": "h",
}  # fmt: skip


@dataclass(frozen=True, slots=True, eq=False)
class Column:
    """One column of a series file."""

    name: str  #: as the file has it, without a unit in brackets
    unit: str  #: as written in brackets, in a row of units or at the end of the name; "" where nowhere
    values: FloatArray | None  #: (n,) NaN where blank; None where the column holds text

    @property
    def stem(self) -> str:
        """Name without the unit at its end."""
        return split_suffix(self.name)[0]


@dataclass(frozen=True, slots=True, eq=False)
class SeriesTable:
    """A series file as read."""

    path: Path
    columns: tuple[Column, ...]
    header_line: int | None  #: line of the names, from 1
    lines: npt.NDArray[np.int64] | None  #: (n,) line of each row, from 1; None where the file has no lines

    def column(self, name: str) -> Column | None:
        """Return the column of that name, with or without its unit in brackets."""
        for column in self.columns:
            if name in {column.name, f"{column.name} [{column.unit}]", f"{column.name} ({column.unit})"}:
                return column
        return None

    def names(self) -> str:
        """Return the names of all columns, for messages."""
        return ", ".join(column.name for column in self.columns)

    def error(self, problem: str, remedy: str, row: int | None = None) -> DataError:
        """Return an error about a row, counted from 0, or about the header."""
        if row is None:
            return DataError(problem, remedy, path=self.path, line=self.header_line)
        if self.lines is None:
            return DataError(f"row {row + 1}: {problem}", remedy, path=self.path)
        return DataError(problem, remedy, path=self.path, line=int(self.lines[row]))


def split_suffix(name: str) -> tuple[str, str]:
    """Split ``heave_mm`` into name and unit; the unit is "" where the name ends with none."""
    for suffix in sorted(_SUFFIXES, key=len, reverse=True):
        if len(name) > len(suffix) and name.lower().endswith(suffix):
            return name[: -len(suffix)], _SUFFIXES[suffix]
    return name, ""


def read_series_table(path: Path) -> SeriesTable:
    """Read a text table, or the channels of an instrument's log that share one clock.

    Raises
    ------
    FileFormatError
        The file is missing, empty, cut, ragged, binary or ambiguous.
    """
    try:
        reader, _ = identified(path)
        return _text_table(path) if reader is GENERIC else _instrument_table(path)
    except FileFormatError as error:
        if "run.toml" not in error.remedy:
            raise
        remedy = "write it as plain CSV: a row of names, a comma between cells, a point in numbers"
        raise FileFormatError(error.problem, remedy, path=error.path, line=error.line) from error


def _text_table(path: Path) -> SeriesTable:
    document = read_document(path)
    layout = find_layout(document, DEFAULT)
    names, _ = unique_names(layout.names)
    body = document.from_line(layout.first_line)
    rows = find_rows(path, body, layout.first_line, layout.separator, layout.decimal, quotes=True)
    if b"\n#" in rows.body:
        rows = rows.keep(np.array([not part.startswith(b"#") for part in rows.body.split(b"\n")[:-1]]))
    width = layout.width + int(rows.counts[0] > layout.width)  # rows may end with a separator
    check_widths(rows, layout.width, width)
    texts = {
        column for column, kind in enumerate(layout.kinds) if kind in {"text", "date", "time", "datetime"}
    }
    read = read_columns(rows, width, names, texts=texts | {layout.width})
    for row, cell in enumerate(read.texts.get(layout.width, [])):
        if cell.strip():
            message = f"found {cell!r} behind the last named column"
            remedy = "give every column a name"
            raise FileFormatError(message, remedy, path=path, line=int(rows.lines[row]))
    columns = []
    for index, name in enumerate(names):
        values = read.numbers.get(index)
        if layout.kinds[index] in {"datetime", "time"}:
            columns.append(Column(name, "s", _seconds(read.texts[index], rows)))
        else:
            columns.append(Column(name, layout.units[index] or split_suffix(name)[1], values))
    return SeriesTable(path, tuple(columns), layout.header_line, rows.lines)


def _seconds(cells: Collection[str], rows: Rows) -> FloatArray:
    """Return stamps as seconds since the first one."""
    stamps = list(cells)
    if "" in stamps:
        message = "the row has no time"
        line = int(rows.lines[stamps.index("")])
        raise FileFormatError(message, "fill it, or export the file again", path=rows.path, line=line)
    return parse_stamps(stamps, rows.path, rows.lines).seconds()


def _instrument_table(path: Path) -> SeriesTable:
    from tethertest.readers.registry import read_log

    log = read_log(path)
    time = log.channels[0].time
    shared = [channel for channel in log.channels if np.array_equal(channel.time, time)]
    columns = [Column(OWN_TIME, "s", time)]
    columns += [Column(c.name, c.unit or split_suffix(c.name)[1], c.values) for c in shared]
    return SeriesTable(path, tuple(columns), log.header_line, None)
