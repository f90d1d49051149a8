"""The header of a catman ASCII export: keys, then rows with one cell per channel."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from tethertest.errors import FileFormatError
from tethertest.readers.tables.text.document import Document
from tethertest.readers.tables.text.table import is_number
from tethertest.readers.tables.time_units import SECONDS

MARK: Final = "HBM_CATMAN_DATAFILE"
_CHANNEL_NUMBER = re.compile(r"\s*CH\s*=\s*\d+\s*$")
_START = re.compile(r"T0\s*=\s*(.*)")
_INTERVAL = re.compile(r"dt\s*=\s*([-+\d.,eE]+)\s*(\S+)\s*")
_ISO_DATE = re.compile(r"(\d{4})-(\d\d)-(\d\d)-\d\d:\d\d")
#: rows of keys, before the rows of channels
_KEY_LINES: Final = 8
_HEADER_LINES: Final = 400
#: of the longest number that a header states
_DIGITS: Final = 18
_AGAIN: Final = "copy the whole file from the logger again, or export it again from catman"
#: what separates columns where SEPARATOR says nothing
_SEPARATORS: Final = ("\t", ";", ",")


@dataclass(frozen=True, slots=True)
class Header:
    """What the header states, one entry per column."""

    names: tuple[str, ...]
    units: tuple[str, ...]
    starts: tuple[str, ...]  #: text behind "T0 =", "" where absent
    intervals: tuple[float | None, ...]  #: behind "dt =" [s]
    date: (
        tuple[int, int, int] | None
    )  #: year, month, day of the recording, from the row that writes it plainly
    separator: str
    stated_rows: int | None
    names_line: int
    start_line: int
    interval_line: int
    first_line: int  #: of the data


def read_header(document: Document) -> Header:
    """Read the header.

    Raises
    ------
    FileFormatError
        It has no row of names or no data behind it, or its rows and keys contradict each other.
    """
    path = document.path
    lines = document.lines(_HEADER_LINES)
    keys = {
        key.strip(): (value.strip(), number)
        for number, (key, sign, value) in enumerate(
            (line.partition(":") for line in lines[:_KEY_LINES]), start=1
        )
        if sign
    }
    named = next((i for i, line in enumerate(lines[3:], start=3) if re.search(r"CH\s*=\s*\d", line)), None)
    if named is None:
        raise _incomplete(document, lines, "names (CH=n)")
    separator = _separator(document, keys, lines[named], named + 1)
    cells = [[cell.strip() for cell in line.split(separator)] for line in lines]
    first = _first_data_line(cells, named + 2)
    if first is None or named + 1 >= len(lines):
        raise _incomplete(document, lines, "data")
    count = _number(document, keys, "CHANNELS")
    written = cells[named]
    if count is not None and count != len(written):
        message = f"CHANNELS states {count} channels, the row of names has {len(written)}"
        raise FileFormatError(message, _AGAIN, path=path, line=named + 1)
    names = tuple(_CHANNEL_NUMBER.sub("", name) for name in written)
    units = cells[named + 1]
    if len(units) != len(names):
        message = f"the row of units has {len(units)} cells, the row of names has {len(names)}"
        raise FileFormatError(message, _AGAIN, path=path, line=named + 2)
    start_line, starts = _row_of(cells[:first], _START, len(names), document)
    interval_line, texts = _row_of(cells[:first], _INTERVAL, len(names), document)
    dates = {match[0] for row in cells[named:first] for cell in row if (match := _ISO_DATE.fullmatch(cell))}
    days = {tuple(map(int, match.groups())) for text in dates if (match := _ISO_DATE.fullmatch(text))}
    return Header(
        names=names,
        units=tuple(units),
        starts=tuple(match[1].strip() if match else "" for match in starts),
        intervals=tuple(_interval(document, match, interval_line) for match in texts),
        date=next(iter(days)) if len(days) == 1 else None,  # type: ignore[arg-type]
        separator=separator,
        stated_rows=_number(document, keys, "MAXLINES"),
        names_line=named + 1,
        start_line=start_line,
        interval_line=interval_line,
        first_line=first + 1,
    )


def _incomplete(document: Document, lines: Sequence[str], missing: str) -> FileFormatError:
    message = f"the header of the catman file is incomplete: found no row of {missing}"
    return FileFormatError(message, _AGAIN, path=document.path, line=len(lines))


def _number(document: Document, keys: dict[str, tuple[str, int]], key: str) -> int | None:
    if key not in keys:
        return None
    text, line = keys[key]
    if not text.isdecimal() or len(text) > _DIGITS:
        message = f"{key} is {text[:40]!r}, expected a whole number"
        raise FileFormatError(message, _AGAIN, path=document.path, line=line)
    return int(text)


def _separator(document: Document, keys: dict[str, tuple[str, int]], names: str, line: int) -> str:
    """Return the separator that the header states, after checking it against the row of names."""
    code = _number(document, keys, "SEPARATOR")
    used = [separator for separator in _SEPARATORS if re.search(rf"CH\s*=\s*\d+\s*{separator}", names)]
    if code is None:
        return used[0] if used else "\t"
    stated = chr(code) if 0 < code < 128 else ""
    if used and stated not in used:
        message = f"SEPARATOR states character {code}, but {used[0]!r} separates the names"
        remedy = f"correct it to {ord(used[0])} in a copy of the log, or export the log again"
        raise FileFormatError(message, remedy, path=document.path, line=line)
    return stated or "\t"


def _first_data_line(cells: list[list[str]], begin: int) -> int | None:
    """Return the index of the first row of numbers behind the header rows."""
    for index in range(begin, len(cells)):
        filled = [cell for cell in cells[index] if cell]
        if filled and all(is_number(cell, ".") or is_number(cell, ",") for cell in filled):
            return index
    return None


def _row_of(
    cells: list[list[str]], pattern: re.Pattern[str], count: int, document: Document
) -> tuple[int, list[re.Match[str] | None]]:
    """Return the line and the cells of the row whose cells match, or no matches where there is none."""
    for line, row in enumerate(cells, start=1):
        if row and pattern.fullmatch(row[0]):
            if len(row) != count:
                message = (
                    f"the row of {row[0].partition('=')[0].strip()} has {len(row)} cells, expected {count}"
                )
                raise FileFormatError(message, _AGAIN, path=document.path, line=line)
            return line, [pattern.fullmatch(cell) for cell in row]
    return 0, [None] * count


def _interval(document: Document, match: re.Match[str] | None, line: int) -> float | None:
    if match is None:
        return None
    text, unit = match[1], match[2].lower()
    number = text if is_number(text, ".") else text.replace(",", ".")
    if unit not in SECONDS or not is_number(number, ".") or not float(number) > 0.0:
        message = f"found {match[0]!r}, expected a time between samples such as 'dt =20 ms'"
        raise FileFormatError(message, _AGAIN, path=document.path, line=line)
    return float(number) * SECONDS[unit]
