"""What a variable of a MATLAB file can be, whichever version of the format holds it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import prod
from typing import TypeAlias

from tethertest.readers.containers.table import Numbers


@dataclass(frozen=True, slots=True, eq=False)
class Array:
    """Real numbers."""

    shape: tuple[int, ...]  #: in MATLAB's order, two lengths or more
    load: Callable[[], Numbers]  #: returns the values, of that shape

    @property
    def size(self) -> int:
        """Number of values."""
        return prod(self.shape)


@dataclass(frozen=True, slots=True, eq=False)
class Struct:
    """A struct, or an array of structs."""

    count: int
    fields: dict[str, list[Item]]  #: `count` values of each field, in MATLAB's order of the array


@dataclass(frozen=True, slots=True)
class Other:
    """Something that cannot be a channel."""

    what: str  #: as in "is a sparse matrix"


#: numbers; a text; texts of a cell array or the rows of a char matrix; a struct; or something else
Item: TypeAlias = "Array | str | tuple[str, ...] | Struct | Other"


def cell_of(found: list[Item]) -> Item:
    """Return a cell array: its texts if it holds nothing else, empty cells among them."""
    texts = tuple("" if isinstance(item, Array) and not item.size else item for item in found)
    plain = tuple(text for text in texts if isinstance(text, str))
    return plain if len(plain) == len(texts) and any(plain) else Other("is a cell array")
