"""One block of a text log into numbers, stamps and what is odd about them."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field
from decimal import Decimal
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Final, TypeAlias, TypeVar

import numpy as np
import numpy.typing as npt

from tethertest.errors import FileFormatError
from tethertest.readers.tables.text.table import (
    MISSING_TOKENS,
    NUMBER_PATTERNS,
    SPACES,
    cut_row,
    last_number_is_cut,
    no_number,
    unclosed_quote,
    wrong_width,
)
from tethertest.readers.tables.text.textlog import TextBlock
from tethertest.records.arrays import FloatArray

if TYPE_CHECKING:
    from tethertest.kernels import fields

Integers: TypeAlias = npt.NDArray[np.int64]
Characters: TypeAlias = npt.NDArray[np.uint8]

#: longest stamp, in bytes
STAMP_BYTES: Final = 48
#: odd cells that one pass lists; a block with more takes another
_ODD_CELLS: Final = 2**16
#: words of so many bytes are looked for in all odd cells at once, where there are many
_SHORT: Final = 8
_MANY: Final = 64
#: words for numbers beyond all bounds
_INFINITE: Final = frozenset(["inf", "+inf", "-inf", "infinity", "+infinity", "-infinity"])
_LARGEST_TICK: Final = 2**63 - 1
#: a row that begins with # is a comment
_COMMENT: Final = re.compile(rb"^#+[ \t]*([^\n]*)", re.MULTILINE)
#: comments of a block that are kept, and their characters
_COMMENTS, _COMMENT_SHOWN = 10_000, 60
_Key = TypeVar("_Key")


@dataclass(frozen=True, slots=True, eq=False)
class RowPlan:
    """How the rows of a text log are to be read."""

    path: Path
    separator: str
    decimal: str
    names: tuple[str, ...]  #: of the columns, for messages
    numbers: tuple[int, ...]  #: columns of numbers, in the order of their arrays
    stamps: tuple[int, ...] = ()  #: columns of stamps
    counter: int | None = None  #: column whose numbers are also wanted as exact ticks
    decimals: int = 0  #: a tick is 10**-decimals
    spare: bool = False  #: rows may end with one more separator, behind which nothing stands
    texts: tuple[int, ...] = ()  #: columns whose cells are returned as they are
    least: int | None = None  #: fewest fields of a row; None for all
    has_quotes: bool = True  #: cells may be quoted
    has_comments: bool = True  #: blank rows, and those that begin with #, are passed over


@dataclass(frozen=True, slots=True, eq=False)
class Parsed:
    """The rows of one block."""

    numbers: FloatArray  #: (columns, n) NaN where a cell is blank, a word for missing or infinite
    ticks: Integers  #: (n,) of the counter, or (0,)
    stamps: Characters  #: (columns, n, STAMP_BYTES) zero behind the end of a stamp
    lines: Integers  #: (n,) line of each row, from 0 at the start of the block
    line_count: int  #: lines of the block
    texts: dict[int, list[str]] = field(default_factory=dict)  #: column -> n cells, "" where blank
    words: dict[tuple[int, str], list[int]] = field(default_factory=dict)  #: column, word -> rows
    infinite: dict[int, list[int]] = field(default_factory=dict)  #: column -> rows
    comments: tuple[tuple[int, str], ...] = ()  #: line, from 0 at the start of the block, and text
    problem: FileFormatError | None = None  #: first mistake; its line counts from 1 in the block


def parse_block(block: TextBlock, plan: RowPlan) -> Parsed:
    """Parse the rows of a block; a mistake ends them and is returned, not raised.

    Parameters
    ----------
    block : TextBlock
        Whole rows.
    plan : RowPlan
        How to read them.

    Returns
    -------
    Parsed
        Rows before the first mistake.
    """
    from tethertest.kernels import fields

    text = np.frombuffer(block.text, np.uint8)[: block.size]
    text.flags.writeable = False  # one kind of array, so that the kernel is compiled once
    form = _form(plan)
    most = len(form.kinds)
    capacity = int(np.count_nonzero(text == ord("\n")))
    values = np.empty((len(plan.numbers), capacity))
    found = fields.RowArrays(
        values=values,
        words=values.view(np.uint64),
        ticks=np.zeros(capacity if plan.counter is not None else 0, np.int64),
        stamps=np.empty((len(plan.stamps), capacity, STAMP_BYTES), np.uint8),
        lines=np.empty(capacity, np.int64),
        odd=np.empty((max(_ODD_CELLS, 2 * most), 4), np.int64),
    )
    texts = {column: [""] * capacity for column in plan.texts}
    parsed = Parsed(found.values, found.ticks, found.stamps, found.lines, capacity, texts)
    reached = fields.Reached(0, 0, 0)
    problem: FileFormatError | None = None
    while reached.status == fields.FULL and problem is None:
        reached = fields.scan_rows(text, form, found, reached)
        problem = _settle_odd(block, plan, parsed, found.odd[: reached.odds])
    rows, line = reached.rows, reached.line
    if problem is None and reached.status == fields.QUOTE:
        problem = unclosed_quote(plan.path, line + 1)
    elif problem is None and reached.status == fields.WIDTH:
        last = block.last and block.text.find(b"\n", reached.position) == block.size - 1
        problem = wrong_width(plan.path, line + 1, reached.fields, form.least, most, last=last)
    elif problem is None and block.last and not block.newline_at_end:
        tail = bytes(block.before) + bytes(block.text[: block.size - 1])
        if last_number_is_cut(tail):
            problem = cut_row(plan.path, line)
    if problem is not None and problem.line is not None:
        rows = int(np.searchsorted(found.lines[:rows], problem.line - 1))
    return Parsed(
        numbers=found.values[:, :rows],
        ticks=found.ticks[:rows],
        stamps=found.stamps[:, :rows],
        lines=found.lines[:rows],
        line_count=capacity,
        texts={column: cells[:rows] for column, cells in parsed.texts.items()},
        words=_before(rows, parsed.words),
        infinite=_before(rows, parsed.infinite),
        comments=_comments(block) if plan.has_comments and rows < capacity else (),
        problem=problem,
    )


def _form(plan: RowPlan) -> fields.RowForm:
    """Return the plan as the scan takes it."""
    from tethertest.kernels import fields

    width = len(plan.names)
    kinds = np.full(width + plan.spare, fields.UNUSED, np.uint8)
    places = np.zeros(width + plan.spare, np.int64)
    for columns, kind in ((plan.numbers, fields.NUMBER), (plan.stamps, fields.STAMP)):
        kinds[list(columns)], places[list(columns)] = kind, np.arange(len(columns))
    kinds[list(plan.texts)] = fields.BLANK  # whatever stands there is odd
    kinds[width:] = fields.BLANK
    return fields.RowForm(
        separator=0 if plan.separator == SPACES else ord(plan.separator),
        decimal=ord(plan.decimal),
        least=width if plan.least is None else plan.least,
        kinds=kinds,
        places=places,
        counter=-1 if plan.counter is None else plan.counter,
        decimals=plan.decimals,
        has_quotes=plan.has_quotes,
        has_comments=plan.has_comments,
    )


def _comments(block: TextBlock) -> tuple[tuple[int, str], ...]:
    """Return the comments of a block with their lines."""
    text = bytes(block.text[: block.size])
    found = list(islice(_COMMENT.finditer(text), _COMMENTS))
    if not found:
        return ()
    line_ends = np.flatnonzero(np.frombuffer(text, np.uint8) == ord("\n"))
    lines = np.searchsorted(line_ends, [match.start() for match in found])
    shown = (match[1].decode(errors="replace").strip()[:_COMMENT_SHOWN] for match in found)
    return tuple((line, text) for line, text in zip(lines.tolist(), shown, strict=True) if text)


def _before(end: int, where: dict[_Key, list[int]]) -> dict[_Key, list[int]]:
    """Return the rows before one, without those keys that have none."""
    return {key: kept for key, rows in where.items() if (kept := [row for row in rows if row < end])}


def _settle_odd(block: TextBlock, plan: RowPlan, parsed: Parsed, odd: Integers) -> FileFormatError | None:
    """Read the cells that the scan has left: words for missing, numbers of many digits, quoted text."""
    pattern = NUMBER_PATTERNS[plan.decimal]
    place_of = {column: place for place, column in enumerate(plan.numbers)}
    done = _common_words(block, plan, parsed, odd) | _texts(block, plan, parsed, odd)
    for row, column, start, stop in odd[~done].tolist():
        cell = _cell(block, plan, start, stop)
        line = int(parsed.lines[row]) + 1
        if column >= len(plan.names):
            if cell:
                message = f"found {cell!r} behind the last named column"
                remedy = "set separator or decimal for this log in run.toml"
                return FileFormatError(message, remedy, path=plan.path, line=line)
        elif column in plan.stamps:
            message = f"found {cell!r}, expected a date and time"
            remedy = "export the stamps in full, such as 2026-09-05 14:20:00.000"
            return FileFormatError(message, remedy, path=plan.path, line=line)
        elif pattern.fullmatch(cell):
            number = cell.replace(",", ".")
            value = float(number)
            if math.isinf(value):
                parsed.infinite.setdefault(column, []).append(row)
                continue
            parsed.numbers[place_of[column], row] = value
            if column == plan.counter:
                tick = round(Decimal(number).scaleb(plan.decimals))
                if abs(tick) > _LARGEST_TICK:
                    message = f"the time {cell!r} is none that a date can have"
                    remedy = "export the log again; set units for the time in run.toml"
                    return FileFormatError(message, remedy, path=plan.path, line=line)
                parsed.ticks[row] = tick
        elif cell.lower() in _INFINITE:
            parsed.infinite.setdefault(column, []).append(row)
        elif cell.lower() in MISSING_TOKENS:
            parsed.words.setdefault((column, cell), []).append(row)
        elif cell:
            return no_number(cell, plan.path, plan.decimal, plan.names[column], line)
    return None


def _common_words(block: TextBlock, plan: RowPlan, parsed: Parsed, odd: Integers) -> npt.NDArray[np.bool_]:
    """Note the words for missing that stand in many cells, all at once; return which cells are done."""
    sizes = odd[:, 3] - odd[:, 2]
    candidates = np.flatnonzero((sizes <= _SHORT) & np.isin(odd[:, 1], plan.numbers))
    done = np.zeros(len(odd), np.bool_)
    if len(candidates) < _MANY:
        return done
    places = np.arange(_SHORT)
    within = places < sizes[candidates, None]
    text = np.frombuffer(block.text, np.uint8)
    letters = np.zeros((len(candidates), _SHORT), np.uint8)
    letters[within] = text[(odd[candidates, 2, None] + places)[within]]
    keys = letters.view(np.uint64)[:, 0]
    for key in np.unique(keys)[:_MANY]:
        alike = candidates[keys == key]
        word = key.tobytes().rstrip(b"\0").decode(errors="replace")
        if word.lower() in _INFINITE or word.lower() in MISSING_TOKENS:
            done[alike] = True
            for column in np.unique(odd[alike, 1]).tolist():
                rows = odd[alike[odd[alike, 1] == column], 0].tolist()
                if word.lower() in _INFINITE:
                    parsed.infinite.setdefault(column, []).extend(rows)
                else:
                    parsed.words.setdefault((column, word), []).extend(rows)
    return done


def _texts(block: TextBlock, plan: RowPlan, parsed: Parsed, odd: Integers) -> npt.NDArray[np.bool_]:
    """Keep the cells of columns of text; return which they are."""
    done = np.zeros(len(odd), np.bool_)
    for column in plan.texts:
        here = odd[:, 1] == column
        if not np.any(here):
            continue
        done |= here
        rows, _, starts, stops = odd[here].T.tolist()
        cells, first = parsed.texts[column], starts[0]
        piece = bytes(block.text[first : stops[-1]])
        if not piece.isascii() or (plan.has_quotes and b'"' in piece):
            for row, start, stop in zip(rows, starts, stops, strict=True):
                cells[row] = _cell(block, plan, start, stop)
            continue
        text = piece.decode("ascii")  # at once: there may be one in every row
        for row, start, stop in zip(rows, starts, stops, strict=True):
            cells[row] = text[start - first : stop - first]
    return done


def _cell(block: TextBlock, plan: RowPlan, start: int, stop: int) -> str:
    """Return the text of a cell, without its quotes."""
    cell = block.text[start:stop].decode(errors="replace")
    if plan.has_quotes and len(cell) > 1 and cell[0] == cell[-1] == '"':
        cell = cell[1:-1].replace('""', '"')
    return cell.strip()
