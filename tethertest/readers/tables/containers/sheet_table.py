"""The one table of a worksheet: where its names, its units and its first row are, and its columns."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from tethertest.readers.tables.containers.sheet import Cell, Dated, Scaled, Sheet, Wrong
from tethertest.readers.tables.containers.table import Column, Table, listed
from tethertest.readers.tables.containers.workbook import column_name
from tethertest.readers.tables.text.cells import bare_unit, is_units_row, split_unit
from tethertest.readers.tables.text.stamps import stamp_kind
from tethertest.readers.tables.text.table import MISSING_TOKENS, is_number
from tethertest.readers.tables.time_units import CALENDARS, CLOCK_UNIT, SECONDS, is_time_name

#: rows at the end by which a column is known to hold numbers or stamps
_SAMPLE = 100
_TEXT = "text"
_BOOLEAN = "true or false"
_APART = "move each time with its channels to a sheet of its own, and name one as table"
_CONVERT = "numbers stored as text are no numbers: convert them in Excel (Data, Text to Columns)"


def first_row(sheet: Sheet, skip: int = 0) -> int | None:
    """Return the first row of the table, counted from 0: it holds data where the last rows do.

    None for a sheet with fewer than two such rows.
    """
    filled = [
        row for row in range(skip, len(sheet.rows)) if any(cell is not None for cell in sheet.rows[row])
    ]
    sample = filled[-_SAMPLE:]
    width = max((len(sheet.rows[row]) for row in sample), default=0)
    numeric = [
        column
        for column in range(width)
        if sum(_is_datum(_at(sheet, row, column)) for row in sample) * 2 > len(sample)
    ]
    found = [row for row in filled if numeric and _is_data(sheet, row, numeric)]
    has_numbers = any(
        isinstance(_at(sheet, row, column), int | float | Dated) for row in found[-2:] for column in numeric
    )
    return found[0] if len(found) > 1 and has_numbers else None


def table_of_sheet(sheet: Sheet, first: int, skip: int = 0) -> Table:
    """Return the table that begins in a row.

    Raises
    ------
    FileFormatError
        A row is blank, cells are merged, a column has no name or holds text among its numbers, or what
        stands above the table can be its names in more than one way.
    """
    last = max(row for row, cells in enumerate(sheet.rows) if any(cell is not None for cell in cells))
    rows = range(first, last + 1)
    for row in rows:
        if all(cell is None for cell in sheet.rows[row]):
            problem = "a blank row within the table"
            raise sheet.error(problem, "delete it, or move what follows to a sheet of its own", row)
    width = max(len(sheet.rows[row]) for row in rows)
    columns = [column for column in range(width) if any(_at(sheet, row, column) is not None for row in rows)]
    _refuse_merged(sheet, rows, columns)
    names, remarks = _names(sheet, first, columns, skip)
    found: list[Column] = []
    for column in columns:
        name, unit = names[column] if names else (f"column {len(found) + 1}", "")
        found.append(_column(sheet, rows, column, name, unit))
    numbers = tuple(row + 1 for row in rows)
    place = f"sheet {sheet.name!r} row"
    _refuse_second_table(sheet, first, columns, found)
    return Table(
        sheet.path, tuple(found), named=bool(names), rows=numbers, place=place, remarks=tuple(remarks)
    )


def _refuse_second_table(sheet: Sheet, first: int, columns: list[int], found: list[Column]) -> None:
    """Refuse two tables beside each other, with a blank column between them and a time in each."""
    starts = [0, *(k for k in range(1, len(columns)) if columns[k] > columns[k - 1] + 1), len(columns)]
    blocks = [found[start:end] for start, end in pairwise(starts)]
    timed = [block for block in blocks if any(_is_time(column) for column in block)]
    if len(timed) > 1:
        names = listed(next(column.name for column in block if _is_time(column)) for block in timed)
        problem = f"found tables beside each other, each with a time: {names}"
        raise sheet.error(problem, _APART, first)


def _is_time(column: Column) -> bool:
    return (
        is_time_name(column.name, column.unit) or column.unit.lower() in SECONDS or column.unit in CALENDARS
    )


def _at(sheet: Sheet, row: int, column: int) -> Cell:
    cells = sheet.rows[row]
    return cells[column] if column < len(cells) else None


def _is_missing(cell: Cell) -> bool:
    return isinstance(cell, Wrong) or (isinstance(cell, str) and cell.lower() in MISSING_TOKENS)


def _is_datum(cell: Cell) -> bool:
    if isinstance(cell, str):
        return stamp_kind(cell) is not None
    return isinstance(cell, int | float | Dated) and not isinstance(cell, bool)


def _is_data(sheet: Sheet, row: int, numeric: Sequence[int]) -> bool:
    cells = [_at(sheet, row, column) for column in numeric]
    filled = [cell for cell in cells if cell is not None]
    return (
        len(filled) * 2 >= len(cells)
        and any(map(_is_datum, filled))
        and all(_is_datum(cell) or _is_missing(cell) for cell in filled)
    )


def _refuse_merged(sheet: Sheet, rows: range, columns: list[int]) -> None:
    for block in sheet.merged:
        crosses_rows = block.first_row - 1 <= rows[-1] and block.last_row - 1 >= rows[0]
        if crosses_rows and any(block.first_column - 1 <= column < block.last_column for column in columns):
            problem = f"the cells {block.name} are merged within the table"
            raise sheet.error(problem, "take the merging back, and write the value into each cell", rows[0])


def _names(
    sheet: Sheet, first: int, columns: list[int], skip: int
) -> tuple[dict[int, tuple[str, str]], list[str]]:
    """Return name and unit of each column from the rows above the table; none where nothing is above."""
    above = []
    for row in range(first - 1, skip - 1, -1):
        cells = [_at(sheet, row, column) for column in columns]
        texts = ["" if cell is None else str(cell) for cell in cells]
        if not all(cell is None or isinstance(cell, str) for cell in cells) or not any(texts):
            break
        above.append((row, texts))
    if not above:
        blank = all(cell is None for row in sheet.rows[skip:first] for cell in row)
        if not blank:
            problem = "the table has no row of names above it, though something stands there"
            remedy = "write one name above each column, or set skip_rows for this log in run.toml"
            raise sheet.error(problem, remedy, first)
        return {}, []
    units = [""] * len(columns)
    if len(above) > 1 and is_units_row(above[0][1]) and not is_units_row(above[1][1]):
        units = [bare_unit(text) for text in above.pop(0)[1]]
    row, texts = above[0]
    for column, text in zip(columns, texts, strict=True):
        if not text:
            problem = f"column {column_name(column + 1)} has values but no name"
            remedy = "write one name above each column, or set skip_rows for this log in run.toml"
            raise sheet.error(problem, remedy, row, column)
    if len(above) > 1 and 2 * sum(map(bool, above[1][1])) > len(columns) > 2:
        problem = "found more than one row of names above the table"
        remedy = "set skip_rows for this log in run.toml, so that one row of names and one of units remain"
        raise sheet.error(problem, remedy, row)
    pairs = [split_unit(text) for text in texts]
    named = {
        column: (name, unit or own) for column, (name, own), unit in zip(columns, pairs, units, strict=True)
    }
    beside = [
        cell for column, cell in enumerate(sheet.rows[row]) if column not in named and isinstance(cell, str)
    ]
    return named, [f"column {name!r} holds nothing and is left out" for name in beside[:8]]


def _column(sheet: Sheet, rows: range, column: int, name: str, unit: str) -> Column:
    cells = [_at(sheet, row, column) for row in rows]
    kinds = {_kind(cell) for cell in cells if cell is not None and not _is_missing(cell)}
    if kinds == {_TEXT}:
        _refuse_numbers_as_text(sheet, rows, column, name, cells)
        return Column(
            name, unit, [cell if isinstance(cell, str) and not _is_missing(cell) else "" for cell in cells]
        )
    if len(kinds) > 1:
        _refuse_mixed(sheet, rows, column, name, cells)
    values = np.full(len(cells), np.nan)
    lost: Counter[str] = Counter()
    for row, cell in enumerate(cells):
        if isinstance(cell, Dated):
            values[row] = cell.value
        elif isinstance(cell, int | float):
            values[row] = cell
        elif isinstance(cell, Wrong):
            lost[cell.text] += 1
        elif isinstance(cell, str):
            lost[cell] += 1
    parts = [f"{count} values {word!r}" for word, count in lost.items()]
    remark = f"column {name!r}: {', '.join(parts)} read as missing" if parts else ""
    if kinds == {_BOOLEAN}:
        remark = f"column {name!r} holds true and false, read as 1 and 0"
    scale = _shown_scale(sheet, rows, column, name, cells) if unit else 1.0
    if scale != 1.0:
        values *= scale
        shown = f"column {name!r} is read as it is shown, {scale:g} times what is stored"
        remark = f"{remark}; {shown}" if remark else shown
    shown_as = kinds - {_BOOLEAN, ""}
    counts = shown_as.pop() if shown_as else unit
    if counts == CLOCK_UNIT and np.nanmax(values) >= 1.0:
        counts = "day"  # a duration
    return Column(name, counts, values, remark)


def _shown_scale(sheet: Sheet, rows: range, column: int, name: str, cells: Sequence[Cell]) -> float:
    """Return what the numbers of a column with a unit are multiplied by as they are shown."""
    scales = [
        cell.shown_as if isinstance(cell, Scaled) else 1.0
        for cell in cells
        if isinstance(cell, int | float) and not isinstance(cell, bool)
    ]
    if len(set(scales)) > 1:
        problem = f"{name!r} is shown in per cent or thousands in some rows and not in others"
        raise sheet.error(problem, "give the whole column one number format", rows[0], column)
    return scales[0] if scales else 1.0


def _kind(cell: Cell) -> str:
    """Return what a cell holds: text, a logical value, or a number, by its unit if it is shown as a date."""
    if isinstance(cell, Dated):
        return cell.unit
    if isinstance(cell, bool):
        return _BOOLEAN
    return _TEXT if isinstance(cell, str) else ""


def _is_written_number(text: str) -> bool:
    return is_number(text, ".") or is_number(text, ",")


def _refuse_numbers_as_text(sheet: Sheet, rows: range, column: int, name: str, cells: Sequence[Cell]) -> None:
    filled = [cell for cell in cells if isinstance(cell, str) and not _is_missing(cell)]
    if all(map(_is_written_number, filled)):
        problem = f"{name!r} holds numbers stored as text"
        raise sheet.error(problem, _CONVERT, rows[0], column)


def _refuse_mixed(sheet: Sheet, rows: range, column: int, name: str, cells: Sequence[Cell]) -> None:
    """Raise the error of a column whose cells are of more than one kind, at the first of the rarer ones."""
    filled = [cell for cell in cells if cell is not None and not _is_missing(cell)]
    usual = Counter(map(_kind, filled)).most_common(1)[0][0]
    odd = next(
        row
        for row, cell in enumerate(cells)
        if cell is not None and not _is_missing(cell) and _kind(cell) != usual
    )
    cell = cells[odd]
    shown = "a date" if isinstance(cell, Dated) else repr(cell)[:42]
    expected = {"": "a number", _TEXT: "text", _BOOLEAN: _BOOLEAN}.get(usual, "a date or time")
    remedy = "correct the cell, or format the column as one kind"
    if isinstance(cell, str) and _is_written_number(cell):
        remedy = _CONVERT
    problem = f"found {shown} in {name!r}, expected {expected}"
    raise sheet.error(problem, remedy, rows[odd], column)
