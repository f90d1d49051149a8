"""The rows of a text log as the readers of instruments find them, and what may stand in their cells."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

import numpy as np
import numpy.typing as npt

from tethertest.errors import FileFormatError

SPACES: Final = "spaces"  #: separator of columns that are aligned by blanks
#: cells that loggers write where they have no value; each use ends up in the log's remarks
MISSING_TOKENS: Final = frozenset([
    "nan", "n/a", "na", "#n/a", "null", "none", "lost", "-", "--", "---", "----", "overflow",
    "overrange", "ovf", "ovl", "invalid", "error", "inf", "+inf", "-inf",
])  # fmt: skip
NUMBER_PATTERNS: Final = {
    ".": re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"),
    ",": re.compile(r"[-+]?(?:\d+,?\d*|,\d+)(?:[eE][-+]?\d+)?"),
}
_NEWLINE, _QUOTE = ord("\n"), ord('"')


@dataclass(frozen=True, slots=True, eq=False)
class Rows:
    """The data rows of a text log, not yet parsed."""

    path: Path
    body: bytes  #: UTF-8, one row a line, no blank lines
    lines: npt.NDArray[np.int64]  #: (n,) line of each row in the file, from 1
    counts: npt.NDArray[np.int64]  #: (n,) fields of each row
    separator: str
    decimal: str
    newline_at_end: bool  #: the last row ends with a line end
    quotes: bool = False  #: cells may be quoted

    def keep(self, mask: npt.NDArray[np.bool_]) -> Rows:
        """Return the rows where the mask is true."""
        parts = self.body.split(b"\n")
        body = b"\n".join(part for part, kept in zip(parts, mask, strict=False) if kept) + b"\n"
        complete = self.newline_at_end or not bool(mask[-1])
        return replace(
            self, body=body, lines=self.lines[mask], counts=self.counts[mask], newline_at_end=complete
        )


def find_rows(
    path: Path, text: bytes, first_line: int, separator: str, decimal: str, *, quotes: bool = False
) -> Rows:
    """Count the fields of every row; blank lines and blank rows at the end are left out.

    Parameters
    ----------
    path : Path
        The log, for messages.
    body : bytes
        The whole text, UTF-8, each ended by a line feed.
    first_line : int
        Line of the first data row, from 1.
    separator : str
        One ASCII character, or `SPACES`.
    decimal : str
        ``"."`` or ``","``.
    quotes : bool
        Whether cells may be quoted; instruments do not quote, and a quote in a comment is only a character.

    Raises
    ------
    FileFormatError
        There are no data rows, or a quote is not closed in its row.
    """
    blank = b" \t\n" if separator == SPACES else b" \n" + separator.encode()
    trimmed = len(text.rstrip(blank))
    if trimmed == 0:
        message = "the log has a header but no data rows"
        raise FileFormatError(
            message, "the logger was stopped before its first sample; choose another file", path=path
        )
    end = text.find(b"\n", trimmed)
    newline_at_end = end >= 0
    text = text[: end if newline_at_end else len(text)] + b"\n"
    characters = np.frombuffer(text, np.uint8)
    ends = np.flatnonzero(characters == _NEWLINE)
    if separator == SPACES:
        blanks = (characters == 32) | (characters == 9) | (characters == _NEWLINE)
        marks = np.flatnonzero(~blanks & np.concatenate(([True], blanks[:-1])))
        counts = np.diff(np.searchsorted(marks, ends), prepend=0)
    else:
        is_separator = characters == ord(separator)
        if quotes and b'"' in text:
            inside = np.cumsum(characters == _QUOTE) % 2 == 1
            if np.any(inside[ends]):
                raise unclosed_quote(path, first_line + int(np.argmax(inside[ends])))
            is_separator &= ~inside
        counts = np.diff(np.searchsorted(np.flatnonzero(is_separator), ends), prepend=0) + 1
    lengths = np.diff(ends, prepend=-1) - 1
    filled = lengths > 0
    lines = first_line + np.flatnonzero(filled)
    if not np.all(filled):
        text = b"\n".join(part for part in text.split(b"\n") if part) + b"\n"
    return Rows(
        path, text, lines, counts[filled].astype(np.int64), separator, decimal, newline_at_end, quotes
    )


def check_widths(rows: Rows, minimum: int, maximum: int) -> None:
    """Refuse rows with too few or too many fields, and a last row cut inside its last number.

    Raises
    ------
    FileFormatError
        Names the first wrong line; a short last row is reported as a cut file.
    """
    wrong = (rows.counts < minimum) | (rows.counts > maximum)
    if np.any(wrong):
        row = int(np.argmax(wrong))
        last = row == len(rows.counts) - 1
        line, count = int(rows.lines[row]), int(rows.counts[row])
        raise wrong_width(rows.path, line, count, minimum, maximum, last=last)
    if not rows.newline_at_end and last_number_is_cut(rows.body[:-1]):
        raise cut_row(rows.path, int(rows.lines[-1]))


def unclosed_quote(path: Path, line: int) -> FileFormatError:
    """Return the error of a quote that is still open at the end of its row."""
    message = "a quoted cell is not closed in its row"
    return FileFormatError(message, "export the log again", path=path, line=line)


def wrong_width(
    path: Path, line: int, count: int, minimum: int, maximum: int, *, last: bool
) -> FileFormatError:
    """Return the error of a row with too few or too many fields."""
    expected = f"{minimum}" if minimum == maximum else f"{minimum} to {maximum}"
    if last and count < minimum:
        message = f"the last row is cut: found {count} of {expected} columns"
        remedy = "copy the whole file from the logger again, or delete this row in a copy of the log"
    else:
        message = f"found {count} columns, expected {expected}"
        remedy = "export the log again; check separator and decimal in run.toml"
    return FileFormatError(message, remedy, path=path, line=line)


def cut_row(path: Path, line: int) -> FileFormatError:
    """Return the error of a last row whose last number is cut."""
    message = "the last row is cut: it has no line end and its last number has fewer digits than all others"
    remedy = "copy the whole file from the logger again, or delete this row in a copy of the log"
    return FileFormatError(message, remedy, path=path, line=line)


def is_number(text: str, decimal: str) -> bool:
    """Return whether a cell is a number with that decimal sign."""
    return NUMBER_PATTERNS[decimal].fullmatch(text.strip()) is not None


def no_number(text: str, path: Path, decimal: str, name: str, line: int) -> FileFormatError:
    """Return the error of a cell that is neither a number nor a word for a missing one."""
    other = "," if decimal == "." else "."
    remedy = "export the log again; a logger's text belongs in a comment column"
    if NUMBER_PATTERNS[other].fullmatch(text):
        remedy = f'set decimal = "{other}" for this log in run.toml if that is its decimal sign'
    elif re.fullmatch(r"[-+]?\d{1,3}(?:[., ']\d{3})+(?:[.,]\d+)?", text):
        remedy = "export the log without thousands separators"
    message = f"found {text!r} in column {name!r}, expected a number with decimal sign {decimal!r}"
    return FileFormatError(message, remedy, path=path, line=line)


def last_number_is_cut(text: bytes) -> bool:
    """Return whether the last number of a text without line end has fewer decimals than those above it."""
    last_lines = text.rsplit(b"\n", 201)[-201:]
    pattern = re.compile(rb"[.,](\d+)(?:[eE][-+]?\d+)?\"?\s*$")
    found = [pattern.search(line) for line in last_lines]
    digits = [len(match[1]) if match else 0 for match in found]
    return len(digits) > 5 and min(digits[:-1]) == max(digits[:-1]) > digits[-1]
