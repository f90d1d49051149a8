"""The variables of a MATLAB file of any version, and the tree they make: structs are its branches."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from math import prod
from pathlib import Path
from typing import TypeAlias

import numpy as np

from tethertest.errors import FileFormatError
from tethertest.readers.tables.containers.table import Column, Numbers
from tethertest.readers.tables.containers.tree import (
    NAME_LISTS,
    UNIT_KEYS,
    Branch,
    Leaf,
    Records,
    Tree,
    facts_of,
)
from tethertest.readers.tables.text.stamps import stamp_kind
from tethertest.readers.tables.time_units import is_time_name


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


def tree_of(path: Path, variables: Iterator[tuple[str, Item]]) -> Tree:
    """Return the tree of a file's variables.

    Parameters
    ----------
    path : Path
        The file, for messages.
    variables : iterator of tuple
        Name and content. Without a name it is MATLAB's own store of objects and is passed over.

    Raises
    ------
    FileFormatError
        Two variables have one name.
    """
    root: dict[str, Item] = {}
    for name, item in variables:
        if name in root:
            message = f"the MATLAB file holds the variable {name!r} twice"
            raise FileFormatError(message, "save it again from MATLAB", path=path)
        if name:
            root[name] = item
    left_out: dict[str, str] = {}
    branches: list[Branch] = []
    waiting: list[tuple[str, Mapping[str, Item]]] = [("", root)]
    while waiting:
        here, fields = waiting.pop(0)
        branches.append(_branch(here, fields, left_out))
        for name, item in fields.items():
            if isinstance(item, Struct) and _columns(item) is None:
                place = _joined(here, name)
                for number in range(item.count):
                    inner = {key: values[number] for key, values in item.fields.items()}
                    waiting.append((place if item.count == 1 else f"{place}({number + 1})", inner))
    return Tree(path, "the MATLAB file", ".", tuple(branches), left_out)


def _joined(here: str, name: str) -> str:
    return f"{here}.{name}" if here else name


def _branch(here: str, fields: Mapping[str, Item], left_out: dict[str, str]) -> Branch:
    leaves: list[Leaf] = []
    records: list[Records] = []
    scalars: dict[str, object] = {}
    units = _units(fields)
    for name, item in fields.items():
        place = _joined(here, name)
        if isinstance(item, str):
            scalars[name] = item
        elif isinstance(item, tuple):
            first = next((text for text in item if text), "")
            if len(item) > 1 and stamp_kind(first) is not None:
                leaves.append(Leaf(name, (len(item),), partial(list, item)))
            elif name not in {*NAME_LISTS, *UNIT_KEYS}:
                left_out[place] = "holds text"
        elif isinstance(item, Other):
            left_out[place] = item.what
        elif isinstance(item, Struct):
            columns = _columns(item)
            if columns is not None:
                records.append(Records(name, item.count, tuple(columns), partial(_loaded, columns)))
        elif item.size == 1:
            scalars[name] = float(item.load().reshape(-1)[0])
        else:
            _add_array(name, place, item, fields, units, leaves, left_out)
    return Branch(here, _with_one_unit(leaves, fields), tuple(records), facts_of(scalars))


def _add_array(
    name: str,
    place: str,
    item: Array,
    fields: Mapping[str, Item],
    units: Mapping[str, str],
    leaves: list[Leaf],
    left_out: dict[str, str],
) -> None:
    sides = tuple(side for side in item.shape if side != 1)
    if not item.size:
        left_out[place] = "is empty"
    elif len(sides) > 2:
        left_out[place] = f"has {len(sides)} dimensions"
    else:
        names: tuple[str, ...] = ()
        own_units: tuple[str, ...] = ()
        if len(sides) == 2:
            names = _texts(fields, NAME_LISTS, sides)
            own_units = _texts(fields, UNIT_KEYS, sides) or tuple(units.get(key, "") for key in names)
        load = partial(_reshaped, item, sides)
        leaves.append(Leaf(name, sides, load, unit=units.get(name, ""), units=own_units, names=names))


def _reshaped(item: Array, sides: tuple[int, ...]) -> Numbers:
    return item.load().reshape(sides)  # only sides of one are lost


def _texts(fields: Mapping[str, Item], keys: tuple[str, ...], sides: tuple[int, ...]) -> tuple[str, ...]:
    """Return the texts beside a matrix that name or give units to its columns, or to its rows."""
    for key in keys:
        found = fields.get(key)
        if isinstance(found, tuple) and len(found) in sides:
            return found
    return ()


def _units(fields: Mapping[str, Item]) -> dict[str, str]:
    """Return the units that a struct beside the arrays gives by their names."""
    for key in UNIT_KEYS:
        found = fields.get(key)
        if isinstance(found, Struct) and found.count == 1:
            return {name: unit for name, (unit,) in found.fields.items() if isinstance(unit, str)}
    return {}


def _with_one_unit(leaves: list[Leaf], fields: Mapping[str, Item]) -> tuple[Leaf, ...]:
    """Return the arrays; a single unit beside them belongs to the only one that is no time."""
    unit = next((found for key in UNIT_KEYS if isinstance(found := fields.get(key), str) and found), "")
    data = [leaf for leaf in leaves if not is_time_name(leaf.name, leaf.unit)]
    if not unit or len(data) != 1 or data[0].unit or data[0].units:
        return tuple(leaves)
    (only,) = data
    named = Leaf(only.name, only.shape, only.load, unit=unit, names=only.names)
    return tuple(named if leaf is only else leaf for leaf in leaves)


def _columns(item: Struct) -> dict[str, list[Item]] | None:
    """Return the fields of an array of structs that hold one value or text each, if all of them do."""
    if item.count < 2:
        return None
    for values in item.fields.values():
        is_number = all(isinstance(value, Array) and value.size == 1 for value in values)
        if not is_number and not all(isinstance(value, str) for value in values):
            return None
    return item.fields


def _loaded(columns: Mapping[str, list[Item]]) -> tuple[Column, ...]:
    found = []
    for name, values in columns.items():
        cells: Numbers | list[str] = [value for value in values if isinstance(value, str)]
        if not cells:
            arrays = [value.load().reshape(-1) for value in values if isinstance(value, Array)]
            cells = np.concatenate(arrays)
        found.append(Column(name, "", cells))
    return tuple(found)
