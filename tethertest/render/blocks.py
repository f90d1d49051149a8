"""What a section of the page is made of; the template knows how each looks."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar


@dataclass(frozen=True, slots=True)
class Cell:
    """One cell of a table."""

    text: str
    title: str = ""  #: shown when the pointer rests on it
    tone: str = ""  #: style class: pass, fail, undecided, quiet, strong
    badge: bool = False


@dataclass(frozen=True, slots=True)
class Column:
    """One column of a table."""

    heading: str
    numeric: bool = False


@dataclass(frozen=True, slots=True)
class Table:
    """A table with a caption; the first cell of a row is its heading."""

    block: ClassVar[str] = "table"
    caption: str
    columns: tuple[Column, ...]
    rows: tuple[tuple[Cell, ...], ...]
    style: str = ""


@dataclass(frozen=True, slots=True)
class Picture:
    """A figure, drawn."""

    block: ClassVar[str] = "picture"
    png: bytes
    width: int  #: [pixels]
    height: int  #: [pixels]
    caption: str
    alternative: str  #: what it shows, for those who cannot see it

    @property
    def source(self) -> str:
        """The image as a data address."""
        return "data:image/png;base64," + base64.b64encode(self.png).decode("ascii")


@dataclass(frozen=True, slots=True)
class Sentence:
    """A sentence, often one that says why something is not there."""

    block: ClassVar[str] = "sentence"
    text: str
    tone: str = ""


@dataclass(frozen=True, slots=True)
class Items:
    """A list with a heading."""

    block: ClassVar[str] = "items"
    heading: str
    texts: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Facts:
    """Names and values."""

    block: ClassVar[str] = "facts"
    heading: str
    pairs: tuple[tuple[str, str], ...]
    style: str = ""


Block = Table | Picture | Sentence | Items | Facts


@dataclass(frozen=True, slots=True)
class Section:
    """A part of the page that the navigation leads to."""

    key: str
    heading: str
    blocks: tuple[Block, ...]


def columns(*headings: str) -> tuple[Column, ...]:
    """Return columns; a heading that starts with ``#`` is one of numbers."""
    return tuple(Column(text.removeprefix("#"), text.startswith("#")) for text in headings)


def row(*cells: str | Cell) -> tuple[Cell, ...]:
    """Return a row; plain texts become cells."""
    return tuple(cell if isinstance(cell, Cell) else Cell(cell) for cell in cells)


def table_or_sentence(table: Table, absent: str) -> Block:
    """Return the table, or a sentence if it would be empty."""
    return table if table.rows else Sentence(absent)


def texts(items: Sequence[str], heading: str) -> tuple[Items, ...]:
    """Return a list in a tuple, or nothing if there is nothing to list."""
    return (Items(heading, tuple(items)),) if items else ()
