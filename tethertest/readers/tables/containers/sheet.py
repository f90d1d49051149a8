"""One worksheet as a grid of cells, whatever Excel makes of their formats."""

from __future__ import annotations

import datetime as dt
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, TypeAlias

from tethertest.errors import FileFormatError
from tethertest.readers.guards.limits import SHEET_CELLS
from tethertest.readers.tables.containers.workbook import Merged, checked_sheet, column_name, merged_cells
from tethertest.readers.tables.time_units import CLOCK_UNIT

#: what is no part of the number in a format: quoted, escaped, padding, and brackets other than [h], [m], [s]
_LITERAL: Final = re.compile(r'"[^"]*"|\\.|_.|\*.|\[(?!h+\]|m+\]|s+\])[^\]]*\]')


#: hours, minutes or seconds that go on beyond the day, the hour or the minute
_DURATION: Final = re.compile(r"\[(?:h+|m+|s+)\]")
#: commas behind the last digit of a format show thousands, millions, ...
_THOUSANDS: Final = re.compile(r"[0#?](,+)(?!.*[0#?])")


@dataclass(frozen=True, slots=True)
class Dated:
    """A number that is shown as a date or a time of day."""

    value: float
    unit: str  #: one of the calendars, or a part of a day


class Scaled(float):
    """A number that is shown as another: per cent of it, or thousands."""

    shown_as: float  #: what is shown is this many times the number

    def __new__(cls, value: float, shown_as: float) -> Scaled:
        """Return the number with what it is shown as."""
        made = super().__new__(cls, value)
        made.shown_as = shown_as
        return made


@dataclass(frozen=True, slots=True)
class Wrong:
    """What Excel shows where a formula has no value, such as ``#DIV/0!``."""

    text: str


Cell: TypeAlias = "float | int | bool | str | Dated | Wrong | None"


@dataclass(frozen=True, slots=True, eq=False)
class Sheet:
    """The cells of one worksheet, from A1 on."""

    path: Path
    name: str
    rows: list[list[Cell]]
    merged: list[Merged]

    def error(self, problem: str, remedy: str, row: int, column: int | None = None) -> FileFormatError:
        """Return an error of a row and a column, counted from 0."""
        place = f"row {row + 1}" if column is None else f"cell {column_name(column + 1)}{row + 1}"
        return FileFormatError(f"sheet {self.name!r} {place}: {problem}", remedy, path=self.path)


def sheet_of(path: Path, book: Any, worksheet: Any, parts: dict[str, bytes]) -> Sheet:
    """Read the cells of a worksheet.

    Raises
    ------
    FileFormatError
        It holds more cells than a log, cells out of order, or formulas without a value.
    """
    from openpyxl.utils.datetime import CALENDAR_MAC_1904

    name = worksheet.title
    text = checked_sheet(path, name, parts, worksheet._worksheet_path.removeprefix("/"))
    calendar = "excel-1904" if book.epoch == CALENDAR_MAC_1904 else "excel"
    units: dict[str, str] = {}
    rows: list[list[Cell]] = []
    count = 0
    worksheet.reset_dimensions()  # what the sheet says of its own size is not believed
    for cells in worksheet.iter_rows():
        count += len(cells) + 1
        if count > SHEET_CELLS:
            message = f"sheet {name!r} holds more than {SHEET_CELLS} cells"
            raise FileFormatError(message, "export the log as text", path=path)
        rows.append([_cell(cell, units, calendar) for cell in cells])
    return Sheet(path, name, rows, merged_cells(text))


def _cell(cell: Any, units: dict[str, str], calendar: str) -> Cell:
    value = cell.value
    if value is None:
        return None
    if cell.data_type == "e":
        return Wrong(str(value))
    if isinstance(value, dt.datetime):  # written as an ISO stamp
        return value.isoformat(sep=" ")
    if isinstance(value, bool | str):
        return value.strip() or None if isinstance(value, str) else value
    if not isinstance(value, int | float):
        return str(value)
    form = cell.number_format
    if form not in units:
        units[form] = date_unit(form, calendar)
    if units[form]:
        return Dated(float(value), units[form])
    shown_as = shown_times(form)
    return value if shown_as == 1.0 else Scaled(value, shown_as)


def shown_times(form: str) -> float:
    """Return what a number is multiplied by as it is shown: 100 in per cent, 0.001 in thousands."""
    plain = _LITERAL.sub("", form.split(";", maxsplit=1)[0])
    thousands = _THOUSANDS.search(plain)
    return 100.0 ** plain.count("%") / 1000.0 ** (len(thousands[1]) if thousands else 0)


def date_unit(form: str, calendar: str) -> str:
    """Return what a number of this format counts: days of a calendar, days, or "" for a plain number."""
    letters = set(_LITERAL.sub("", form.lower().split(";")[0]).replace("general", ""))
    if letters & set("yd"):
        return calendar
    if letters & set("hs"):
        return "day" if _DURATION.search(form.lower()) else CLOCK_UNIT
    return calendar if "m" in letters and not letters & set("0#?") else ""
