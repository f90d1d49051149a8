"""One table out of a container, before its time is known."""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, TypeAlias

import numpy.typing as npt

from tethertest.errors import FileFormatError
from tethertest.readers.channels import unique_names
from tethertest.readers.guards.limits import COLUMNS
from tethertest.readers.tables.time_units import NO_FACTS, Facts
from tethertest.records.run import Log

Numbers: TypeAlias = npt.NDArray[Any]

#: names that a message lists before it stops
_SHOWN = 12


@dataclass(frozen=True, slots=True, eq=False)
class Column:
    """One column: numbers of any real type, or text."""

    name: str
    unit: str
    cells: Numbers | list[str]
    remark: str = ""  #: what was read as missing


@dataclass(frozen=True, slots=True, eq=False)
class Table:
    """Columns of one length, and what the file says of them."""

    path: Path
    columns: tuple[Column, ...]
    named: bool  #: the names are the file's own
    facts: Facts = NO_FACTS
    rows: tuple[int, ...] | None = None  #: place of every row as the file counts them; None for 1, 2, ...
    place: str = "row"  #: what such a number counts, as in ``sheet 'log' row``
    remarks: tuple[str, ...] = field(default=())

    @property
    def length(self) -> int:
        """Number of rows."""
        return len(self.columns[0].cells) if self.columns else 0

    @property
    def names(self) -> list[str]:
        """Names of the columns."""
        return [column.name for column in self.columns]

    def column(self, name: str) -> Column | None:
        """Return the column of that name."""
        return next((column for column in self.columns if column.name == name), None)

    def error(self, problem: str, remedy: str, *keys: str, row: int | None = None) -> FileFormatError:
        """Return an error of this table, at a row counted from 0, with the keys of run.toml that mend it."""
        if row is not None:
            number = row + 1 if self.rows is None else self.rows[row]
            problem = f"{self.place} {number}: {problem}"
        return FileFormatError(problem, remedy, path=self.path, keys=keys)


def toml_text(text: str) -> str:
    """Return a text as run.toml writes it."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def listed(names: Iterable[str]) -> str:
    """Return names for a message, not more than a person reads."""
    known = list(names)
    more = f" and {len(known) - _SHOWN} more" if len(known) > _SHOWN else ""
    return ", ".join(repr(name) for name in known[:_SHOWN]) + more


def with_column_names(table: Table, settings: Log) -> Table:
    """Return the table with the names that run.toml gives, each of them once.

    Raises
    ------
    FileFormatError
        The names do not fit the width, or the file has its own; the table is wider than a log may be.
    """
    width = len(table.columns)
    if width > COLUMNS:
        message = f"found {width} columns, expected at most {COLUMNS}"
        raise table.error(message, "export the channels as columns; perhaps rows and columns are swapped")
    wanted = settings.columns
    if wanted:
        if table.named:
            message = f"run.toml gives columns, but the table has names: {listed(table.names)}"
            raise table.error(message, "remove columns for this log; channels maps these names to sensors")
        if len(wanted) != width:
            message = f"run.toml names {len(wanted)} columns, the table has {width}"
            raise table.error(message, f"give columns {width} names, also for those not used")
        pairs = zip(table.columns, wanted, strict=True)
        return replace(table, columns=tuple(replace(column, name=name) for column, name in pairs))
    names, renamed = unique_names(table.names)
    columns = tuple(replace(column, name=name) for column, name in zip(table.columns, names, strict=True))
    return replace(table, columns=columns, remarks=(*table.remarks, *renamed))
