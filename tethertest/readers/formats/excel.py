"""Excel workbooks, through openpyxl: one table on one sheet."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from tethertest.errors import FileFormatError
from tethertest.readers.tables.containers.log import log_of
from tethertest.readers.tables.containers.sheet import Sheet, sheet_of
from tethertest.readers.tables.containers.sheet_table import first_row, table_of_sheet
from tethertest.readers.tables.containers.table import listed, toml_text
from tethertest.readers.tables.containers.workbook import is_in, opened_workbook
from tethertest.readers.tables.text.document import Head
from tethertest.records.channel import RawLog
from tethertest.records.run import DEFAULT, Log

NAME = "excel"
#: keys of a log in run.toml that it takes
USES = frozenset(["date_order", "skip_rows", "time_zone", "units", "table", "columns", "time", "rate"])


def sniff(head: Head) -> str | None:
    """Claim zip archives that hold a workbook."""
    return "the archive holds 'xl/workbook.xml'" if is_in(head.path) else None


def read(path: Path, settings: Log = DEFAULT) -> RawLog:
    """Read one sheet of an Excel workbook (.xlsx, .xlsm).

    Parameters
    ----------
    path : Path
        The workbook.
    settings : Log
        Its `table` is the name of the sheet, needed where several hold numbers; its `skip_rows` passes over
        rows above the names.

    Returns
    -------
    RawLog
        Columns by their names; units from the brackets of a name or the row below the names. Dates are the
        days that Excel counts, since 1900 or 1904 as the workbook says, and unrounded.

    Raises
    ------
    FileFormatError
        openpyxl is not installed; the workbook is damaged or larger than a log may be; no sheet holds a table
        or several do; formulas were never calculated; cells are merged or of mixed kinds.
    """
    skip = settings.skip_rows
    wanted = settings.table
    with opened_workbook(path) as (book, parts):
        named = {worksheet.title: worksheet for worksheet in book.worksheets}
        shown = [title for title, worksheet in named.items() if worksheet.sheet_state == "visible"]
        if wanted is not None and wanted not in named:
            message = f"run.toml says table = {toml_text(wanted)}, the workbook has {listed(named)}"
            raise FileFormatError(message, _remedy(shown), path=path)
        titles = shown if wanted is None else [wanted]
        sheets = [sheet_of(path, book, named[title], parts) for title in titles]
    sheet, first = _only(path, sheets, skip, wanted)
    hidden = [title for title in named if title not in shown and title != sheet.name]
    table = table_of_sheet(sheet, first, skip)
    log = log_of(NAME, table, settings)
    remarks = [f"sheet {sheet.name!r} is read"] if len(named) > 1 else []
    if hidden:
        remarks.append(f"hidden sheets are not read: {listed(hidden)}")
    return replace(log, remarks=(*remarks, *log.remarks))


def _only(path: Path, sheets: list[Sheet], skip: int, wanted: str | None) -> tuple[Sheet, int]:
    tables = [(sheet, first) for sheet in sheets if (first := first_row(sheet, skip)) is not None]
    if len(tables) == 1:
        return tables[0]
    if tables:
        titles = [sheet.name for sheet, _ in tables]
        message = f"the workbook holds {len(titles)} sheets with tables: {listed(titles)}"
        raise FileFormatError(message, _remedy(titles), path=path)
    where = f"sheet {wanted!r}" if wanted is not None else "no visible sheet"
    verb = "holds no" if wanted is not None else "holds a"
    message = f"{where} {verb} table with two rows of numbers or more"
    raise FileFormatError(message, "choose the workbook or the sheet that holds the log", path=path)


def _remedy(titles: list[str]) -> str:
    lines = " or ".join(f"table = {toml_text(title)}" for title in titles[:4])
    return f"write for this log in run.toml: {lines}" if lines else "choose another workbook"
