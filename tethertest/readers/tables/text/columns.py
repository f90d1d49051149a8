"""The rows of an instrument's log, whole, into columns of numbers and text."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass

from tethertest.errors import FileFormatError
from tethertest.readers.tables.text.blocks import Parsed, RowPlan, parse_block
from tethertest.readers.tables.text.table import Rows
from tethertest.readers.tables.text.textlog import TextBlock
from tethertest.records.arrays import FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Columns:
    """Parsed columns and what a person should know about them."""

    numbers: dict[int, FloatArray]  #: (n,) NaN where the cell is blank
    texts: dict[int, list[str]]  #: n cells, "" where blank
    remarks: tuple[str, ...]


def read_columns(
    rows: Rows,
    width: int,
    names: Collection[str],
    *,
    texts: Collection[int] = (),
    unused: Collection[int] = (),
) -> Columns:
    """Parse the rows.

    Parameters
    ----------
    rows : Rows
        Rows whose widths were checked; short rows are filled with blanks.
    width : int
        Number of columns.
    names : collection of str
        Names of the columns, for messages.
    texts, unused : collection of int
        Columns that are returned as text, or not at all; all others must be numbers.

    Raises
    ------
    FileFormatError
        A cell is neither blank, nor a number, nor one of `MISSING_TOKENS`.
    """
    stray = rows.body.find(b"\r")
    if stray >= 0:  # a spreadsheet would begin a row there
        message = "found a carriage return inside a row"
        line = int(rows.lines[rows.body.count(b"\n", 0, stray)])
        raise FileFormatError(message, "copy the log again, as binary", path=rows.path, line=line)
    most = int(rows.counts.max())
    wanted = [column for column in range(min(width, most)) if column not in unused]
    numbers = tuple(column for column in wanted if column not in texts)
    plan = RowPlan(
        path=rows.path,
        separator=rows.separator,
        decimal=rows.decimal,
        names=(*names, *[""] * most)[:most],
        numbers=numbers,
        texts=tuple(column for column in wanted if column in texts),
        least=0,
        has_quotes=rows.quotes,
        has_comments=False,
    )
    block = TextBlock(rows.body, len(rows.body), "utf-8", last=False, newline_at_end=True, before=b"")
    parsed = parse_block(block, plan)
    if parsed.problem is not None:
        found = parsed.problem
        line = int(rows.lines[(found.line or 1) - 1])
        raise FileFormatError(found.problem, found.remedy, path=rows.path, line=line)
    columns = {column: parsed.numbers[place] for place, column in enumerate(numbers)}
    return Columns(columns, parsed.texts, tuple(_remarks(rows, plan, parsed)))


def _remarks(rows: Rows, plan: RowPlan, parsed: Parsed) -> Iterator[str]:
    """Yield a remark on each word for missing, by column, and on infinite values."""
    for (column, word), where in sorted(parsed.words.items(), key=lambda item: (item[0][0], min(item[1]))):
        cells = f"column {plan.names[column]!r}: {len(where)} cells {word!r}"
        yield f"{cells} read as missing, first in line {rows.lines[min(where)]}"
    for column, where in sorted(parsed.infinite.items()):
        yield f"column {plan.names[column]!r}: {len(where)} infinite values read as missing"
