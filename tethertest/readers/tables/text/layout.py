"""Where the columns of an unknown text log are: separator, decimal sign, names, units and first data row."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Protocol

from tethertest.errors import FileFormatError
from tethertest.readers.guards.limits import COLUMNS
from tethertest.readers.tables.text.cells import (
    bare_unit,
    column_kind,
    is_datum,
    is_units_row,
    split_row,
    split_unit,
)
from tethertest.readers.tables.text.table import MISSING_TOKENS, SPACES, is_number
from tethertest.records.run import Log

_SEPARATORS: Final = ("\t", ";", ",", "|", SPACES)
#: what people write for a separator
SPELLINGS: Final = {
    "tab": "\t", "\\t": "\t", "comma": ",", "semicolon": ";", "space": SPACES, "spaces": SPACES, " ": SPACES,
}  # fmt: skip
_COMMENT: Final = ("#", "%", "//")
_SAMPLE_LINES: Final = 600
#: rows by which the kind of a column and the time are told
SHOWN_ROWS: Final = 200
#: characters of rows that say nothing: spreadsheets write them by the thousand behind the data
_EMPTY: Final = " \t\r\n;,|"
#: a line that spreadsheets write and read
_DIRECTIVE = re.compile(r"\s*sep=(.)\s*", re.IGNORECASE)
#: a group of three digits after a comma: a decimal part or a thousand
_GROUPED = re.compile(r"[-+]?[1-9]\d{0,2}(?:,\d{3})+")
_BOTH_SIGNS = re.compile(r"[-+]?\d{1,3}(?:([.,])\d{3})+(?!\1)[.,]\d+")


@dataclass(frozen=True, slots=True)
class Line:
    """One row of the beginning of the file, split."""

    number: int  #: from 1
    cells: list[str]


@dataclass(frozen=True, slots=True)
class Layout:
    """What was concluded from the content of a text log."""

    separator: str
    decimal: str
    header_line: int | None
    first_line: int  #: of the data
    width: int  #: columns that have a name
    names: tuple[str, ...]  #: without units
    units: tuple[str, ...]
    kinds: tuple[str, ...]  #: of the columns, see `column_kind`
    comments: tuple[str, ...]  #: comment lines above the data, without their sign
    numbered: bool  #: the file has no names and run.toml gives none
    first_cells: tuple[str, ...]  #: of the first data row
    heads: tuple[tuple[str, ...], ...]  #: the first cells of every column


class TextSource(Protocol):
    """A text log, in memory or on disk."""

    @property
    def path(self) -> Path:
        """The file."""
        ...

    def lines(self, count: int) -> list[str]:
        """Return the first `count` lines."""
        ...

    def bodies(self) -> Iterator[bytes]:
        """Yield the text from its start in pieces of whole rows, as UTF-8."""
        ...


def find_layout(source: TextSource, settings: Log) -> Layout:
    """Find the layout by content; settings of the run file come first.

    Raises
    ------
    FileFormatError
        There are no columns, the header does not fit the rows, or a decimal sign can be read two ways.
    """
    path = source.path
    skip = settings.skip_rows
    directive = _DIRECTIVE.fullmatch(source.lines(1)[0])
    if directive:
        skip = max(skip, 1)
    plain: list[tuple[int, str]] = []
    comments: list[tuple[int, str]] = []
    for number, text in enumerate(source.lines(skip + _SAMPLE_LINES), start=1):
        if number <= skip or not text.strip(_EMPTY):
            continue
        if text.lstrip().startswith(_COMMENT):
            comments.append((number, text.lstrip().lstrip("#%/").strip()))
        else:
            plain.append((number, text))
    wanted = settings.separator
    separator, lines, width = _find_separator(path, plain, wanted or (directive and directive[1]))
    first = _first_data_row(path, lines, width)
    data = [line for line in lines[first:] if abs(len(line.cells) - width) <= 1]
    decimal = _find_decimal(source, data, separator, settings)
    header_line, names, units = _find_names(path, lines[:first], comments, separator, width, lines[first])
    numbered = header_line is None
    if settings.columns:
        names, units = _names_of_settings(path, settings.columns, lines[first], header_line, names)
        header_line, numbered = None, False
    if names and not names[-1] and len(names) > 1:
        names, units = names[:-1], units[:-1]
    heads = tuple(
        tuple(line.cells[column] if column < len(line.cells) else "" for line in data[:SHOWN_ROWS])
        for column in range(len(names))
    )
    texts = tuple(text for number, text in comments if number < lines[first].number)
    return Layout(
        separator, decimal, header_line, lines[first].number, len(names), names, units,
        tuple(map(column_kind, heads)), texts,
        numbered=numbered,
        first_cells=tuple(lines[first].cells),
        heads=heads,
    )  # fmt: skip


def _find_separator(
    path: Path, plain: list[tuple[int, str]], wanted: str | None
) -> tuple[str, list[Line], int]:
    candidates = _SEPARATORS if wanted is None else (SPELLINGS.get(wanted, wanted),)
    best: tuple[float, str, list[Line], int] | None = None
    for separator in candidates:
        for number, text in plain:  # before they are split
            count = len(text.split()) if separator == SPACES else text.count(separator) + 1
            if count > COLUMNS:
                message = f"found {count} columns, expected at most {COLUMNS}"
                remedy = "export the channels of the log alone; perhaps rows and columns are swapped"
                raise FileFormatError(message, remedy, path=path, line=number)
        lines = [Line(number, split_row(text, separator)) for number, text in plain]
        whole = lines[:-1] if len(lines) > 4 else lines
        tail = whole[-min(100, max(2, len(whole) // 2)) :]
        widths = Counter(len(line.cells) for line in tail)
        everywhere = Counter(len(line.cells) for line in lines)
        width = max(widths, key=lambda key: (widths[key], everywhere[key], key), default=0)
        if width < 2:
            continue
        cells = [cell for line in tail for cell in line.cells if cell]
        score = widths[width] / len(tail) * sum(map(is_datum, cells)) / max(len(cells), 1)
        if best is None or score > best[0] + 1e-9:
            best = (score, separator, lines, width)
    if best is None or best[0] < 0.2:
        message = (
            "found no rows of numbers, at most a header"
            if wanted is None
            else f"found no columns separated by {wanted!r}"
        )
        remedy = "set separator, skip_rows or encoding for this log in run.toml, or choose the right file"
        raise FileFormatError(message, remedy, path=path)
    return best[1:]


def _first_data_row(path: Path, lines: list[Line], width: int) -> int:
    """Return the index of the first row that looks like the rows further down."""
    alike = [line for line in lines if len(line.cells) == width]
    sample = alike[-100:]
    numeric = [
        column
        for column in range(width)
        if sum(_is_filled_datum(line.cells[column]) for line in sample) * 2 >= len(sample)
    ]
    for index, line in enumerate(lines):
        if abs(len(line.cells) - width) <= 1 and any(map(_is_filled_datum, line.cells)):
            cells = [line.cells[column] for column in numeric if column < len(line.cells)]
            if all(is_datum(cell) or cell.lower() in MISSING_TOKENS for cell in cells):
                return index
    message = "the log has a header but no data rows"
    raise FileFormatError(
        message, "the logger was stopped before its first sample; choose another file", path=path
    )


def _is_filled_datum(cell: str) -> bool:
    return bool(cell) and is_datum(cell)


def _find_decimal(source: TextSource, data: list[Line], separator: str, settings: Log) -> str:
    if settings.decimal is not None:
        return settings.decimal
    commas = points = decided = False
    grouped: tuple[int, str] | None = None
    for line in data:
        for cell in line.cells:
            if _BOTH_SIGNS.fullmatch(cell):
                message = f"found {cell!r}: a number with thousands separators"
                raise FileFormatError(
                    message, "export the log without them", path=source.path, line=line.number
                )
            if "," in cell and (is_number(cell, ",") or _GROUPED.fullmatch(cell)):
                commas = True
                grouped = grouped or (line.number, cell)
                decided |= _GROUPED.fullmatch(cell) is None
            points |= "." in cell and is_number(cell, ".")
    if not commas or grouped is None:
        return "."
    if decided and not points:
        return ","
    if not points and _has_decimal_comma(source.bodies(), separator):
        return ","
    number, cell = grouped
    message = f"found {cell!r}: its comma may be a decimal sign or a thousands separator"
    if points:
        message = f"found {cell!r} beside numbers with a decimal point"
    remedy = 'set decimal = "," for this log in run.toml if it is, or export without thousands separators'
    raise FileFormatError(message, remedy, path=source.path, line=number)


def _has_decimal_comma(bodies: Iterator[bytes], separator: str) -> bool:
    """Look through the log for a comma that can only be a decimal sign, as far as is needed."""
    edge = rb"[\s\"]" if separator == SPACES else b'[\r\n "' + re.escape(separator.encode()) + b"]"
    number = rb"[-+]?(?:0,\d+|\d+,(?:\d{1,2}|\d{4,}))"
    sure = re.compile(rb"(?:\A|" + edge + b")" + number + b"(?:" + edge + rb"|\Z)")
    return any(sure.search(body) for body in bodies)


def _find_names(
    path: Path, above: list[Line], comments: list[tuple[int, str]], separator: str, width: int, first: Line
) -> tuple[int | None, tuple[str, ...], tuple[str, ...]]:
    """Return the header line, the names and the units."""
    header: list[Line] = []
    for line in reversed(above):
        if abs(len(line.cells) - width) > 1 or (header and line.number < header[0].number - 1):
            break
        header.insert(0, line)
    if not header:
        if above:
            line = above[-1]
            message = f"the header has {len(line.cells)} names, the rows have {len(first.cells)} columns"
            remedy = "set separator, decimal or skip_rows for this log in run.toml"
            raise FileFormatError(message, remedy, path=path, line=line.number)
        return _names_without_header(comments, separator, width, first)
    units: list[str] = [""] * width
    if len(header) > 1 and is_units_row(header[-1].cells) and not is_units_row(header[-2].cells):
        units = [bare_unit(cell) for cell in header.pop().cells]
    row = header[-1]
    if len(header) > 1 and width > 2:
        message = f"found {len(header)} rows of names above the data"
        remedy = "set skip_rows for this log in run.toml, so that one row of names and one of units remain"
        raise FileFormatError(message, remedy, path=path, line=row.number)
    if _is_filled_datum(row.cells[0]) or any(is_number(cell, ".") and "." in cell for cell in row.cells):
        message = f"found {'; '.join(row.cells[:4])!r} above the data, which is neither names nor numbers"
        remedy = "set skip_rows for this log in run.toml to leave out rows, or export the log again"
        raise FileFormatError(message, remedy, path=path, line=row.number)
    if len(row.cells) < width - 1 or (len(row.cells) == width - 1 and first.cells[-1]):
        message = f"the header has {len(row.cells)} names, the rows have {width} columns"
        raise FileFormatError(
            message, "export the log again with a name per column", path=path, line=row.number
        )
    pairs = [split_unit(cell) for cell in row.cells]
    units = [*units, *[""] * len(pairs)][: len(pairs)]
    written = tuple(below or own for (_, own), below in zip(pairs, units, strict=True))
    return row.number, tuple(name for name, _ in pairs), written


def _names_without_header(
    comments: list[tuple[int, str]], separator: str, width: int, first: Line
) -> tuple[int | None, tuple[str, ...], tuple[str, ...]]:
    """Take the names from the last comment above the data if it fits, else number the columns."""
    for number, text in reversed(comments):
        cells = split_row(text, separator)
        if number < first.number and len(cells) == width:
            pairs = [split_unit(cell) for cell in cells]
            return number, tuple(name for name, _ in pairs), tuple(unit for _, unit in pairs)
    return None, tuple(f"column {column + 1}" for column in range(width)), ("",) * width


def _names_of_settings(
    path: Path, columns: tuple[str, ...], first: Line, header_line: int | None, header: tuple[str, ...]
) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return the names that run.toml gives, with the units in their brackets.

    Raises
    ------
    FileFormatError
        The file has names of its own, or another number of columns.
    """
    if header_line is not None:
        message = f"run.toml gives columns, but the log names its own: {', '.join(map(repr, header[:8]))}"
        remedy = f"remove columns for this log in run.toml, or set skip_rows = {header_line} to use them"
        raise FileFormatError(message, remedy, path=path, line=header_line)
    width = len(first.cells) - (not first.cells[-1])
    if len(columns) not in {width, len(first.cells)}:
        message = f"run.toml names {len(columns)} columns, the rows have {width}"
        raise FileFormatError(message, "give every column a name", path=path, line=first.number)
    return columns, tuple(split_unit(name)[1] for name in columns)
