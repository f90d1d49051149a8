"""Vectors and matrices that lie together, as the columns of one table."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from tethertest.errors import FileFormatError
from tethertest.readers.guards.limits import CELLS, COLUMNS, COMPRESSION_RATIO, RATIO_FROM
from tethertest.readers.tables.containers.table import Column, Table, listed, toml_text
from tethertest.readers.tables.containers.tree import Leaf, Tree
from tethertest.readers.tables.time_units import Facts, is_time_name
from tethertest.records.run import Log


@dataclass(frozen=True, slots=True, eq=False)
class _Part:
    """One array of the table, with the way it is read."""

    leaf: Leaf
    width: int
    is_turned: bool = False  #: the second axis is the samples
    names: tuple[str, ...] = ()


def assembled(tree: Tree, name: str, leaves: Sequence[Leaf], facts: Facts, settings: Log) -> Table:
    """Load the arrays of one length as the columns of a table.

    Parameters
    ----------
    tree, name : Tree, str
        The file, and the table's name in it, for messages.
    leaves : sequence of Leaf
        The arrays that lie together; those of another length are left out with a remark where a time, or the
        channels of run.toml, settle which length is the table's.
    facts : Facts
        What the file says beside them.
    settings : Log
        `columns` names the columns of the one matrix.

    Raises
    ------
    FileFormatError
        The lengths leave open what the table is, or it is larger than a log may be.
    """
    length = _length(tree, name, leaves, settings)
    remarks: list[str] = []
    parts = [part for leaf in leaves if (part := _part(tree, leaf, length, settings, remarks)) is not None]
    remarks += [f"{part.leaf.name!r}: {part.leaf.remark}" for part in parts if part.leaf.remark]
    width = sum(part.width for part in parts)
    if width > COLUMNS or width * length > CELLS:
        message = (
            f"table {name!r} has {width} columns of {length}, expected at most {COLUMNS} and {CELLS} numbers"
        )
        raise FileFormatError(message, "split the log, or name a smaller table", path=tree.path)
    if width * length * 8 > max(RATIO_FROM, COMPRESSION_RATIO * tree.path.stat().st_size):
        message = f"table {name!r} unpacks to {width} columns of {length}, more than a log of its size holds"
        raise FileFormatError(message, "export the channels of the log alone", path=tree.path)
    parts, named = _with_names(tree, name, parts, settings)
    columns = tuple(column for part in parts for column in _columns(part))
    return Table(tree.path, columns, named, facts, remarks=tuple(remarks))


def _length(tree: Tree, name: str, leaves: Sequence[Leaf], settings: Log) -> int:
    vectors = [leaf for leaf in leaves if len(leaf.shape) == 1]
    wanted = settings.time
    mapped = settings.channels
    columns = settings.columns
    for settled in (
        [leaf for leaf in vectors if leaf.name == wanted],
        [leaf for leaf in vectors if is_time_name(leaf.name, leaf.unit)],
        [leaf for leaf in vectors if leaf.name in mapped],
    ):
        lengths = {leaf.shape[0] for leaf in settled}
        if len(lengths) == 1:
            return lengths.pop()
        if lengths:
            raise _differing(tree, name, settled, "time")
    matrices = [leaf for leaf in leaves if len(leaf.shape) == 2]
    lengths = {leaf.shape[0] for leaf in vectors}
    if not vectors:
        lengths = {_matrix_length(tree, leaf, len(columns)) for leaf in matrices}
    if len(lengths) != 1 or not all(lengths <= set(leaf.shape) for leaf in matrices):
        raise _differing(tree, name, leaves, "table")
    return lengths.pop()


def _differing(tree: Tree, name: str, leaves: Sequence[Leaf], key: str) -> FileFormatError:
    sizes = ", ".join(f"{leaf.name!r} {'x'.join(map(str, leaf.shape))}" for leaf in leaves[:8])
    message = f"the arrays of {name!r} differ in length: {sizes}"
    paths = [leaf.name if key == "time" else tree_path(tree, name, leaf) for leaf in leaves[:4]]
    lines = " or ".join(f"{key} = {toml_text(path)}" for path in paths)
    return FileFormatError(message, f"write for this log in run.toml: {lines}", path=tree.path)


def tree_path(tree: Tree, table: str, leaf: Leaf) -> str:
    """Return the path of an array of a table."""
    return leaf.name if table == "/" else f"{table}{tree.separator}{leaf.name}"


def _matrix_length(tree: Tree, leaf: Leaf, named: int) -> int:
    """Return the number of samples of a matrix that stands alone: its longer side."""
    rows, width = leaf.shape
    if leaf.rows_first:
        return rows
    if rows == width:
        raise _square(tree, leaf)
    if named in leaf.shape:
        return rows if named == width else width
    return max(leaf.shape)


def _square(tree: Tree, leaf: Leaf) -> FileFormatError:
    message = (
        f"{leaf.name!r} is square ({leaf.shape[0]}x{leaf.shape[1]}): rows and columns cannot be told apart"
    )
    return FileFormatError(message, "export the channels as vectors with names", path=tree.path)


def _part(tree: Tree, leaf: Leaf, length: int, settings: Log, remarks: list[str]) -> _Part | None:
    if len(leaf.shape) == 1:
        if leaf.shape[0] == length:
            return _Part(leaf, 1)
        remarks.append(f"{leaf.name!r} has {leaf.shape[0]} values, not {length}, and is left out")
        return None
    rows, width = leaf.shape
    if rows == width == length and not leaf.rows_first:
        raise _square(tree, leaf)
    if rows == length:
        return _Part(leaf, width)
    if width == length and not leaf.rows_first:
        remarks.append(f"{leaf.name!r} is {rows}x{width} and is read as {rows} columns of {width}")
        return _Part(leaf, rows, is_turned=True)
    remarks.append(f"{leaf.name!r} is {rows}x{width}, without a side of {length}, and is left out")
    return None


def _with_names(tree: Tree, name: str, parts: list[_Part], settings: Log) -> tuple[list[_Part], bool]:
    """Return the parts with the names of their columns, and whether these are more than numbers."""
    given = settings.columns
    nameless = [part for part in parts if len(part.leaf.shape) == 2 and len(part.leaf.names) != part.width]
    if given:
        if len(nameless) != 1:
            known = listed(part.leaf.name for part in parts)
            message = (
                f"run.toml gives columns, but {name!r} has {len(nameless)} matrices without names: {known}"
            )
            remedy = "remove columns for this log" if not nameless else "name one matrix as table"
            raise FileFormatError(message, remedy, path=tree.path)
        if len(given) != nameless[0].width:
            message = (
                f"run.toml names {len(given)} columns, {nameless[0].leaf.name!r} has {nameless[0].width}"
            )
            remedy = f"give columns {nameless[0].width} names, also for those not used"
            raise FileFormatError(message, remedy, path=tree.path)
    swapped = next(
        (part for part in nameless if part.leaf.rows_first and part.width > part.leaf.shape[0]), None
    )
    if swapped is not None and not given:
        message = f"{swapped.leaf.name!r} has {swapped.leaf.shape[0]} rows of {swapped.width} values"
        remedy = "export one row for each sample; if it is so, name its columns in run.toml"
        raise FileFormatError(message, remedy, path=tree.path)
    alone = len(parts) == 1
    found = []
    for part in parts:
        names = part.leaf.names
        if len(part.leaf.shape) == 1:
            names = (part.leaf.name,)
        elif part in nameless:
            prefix = "column" if alone else part.leaf.name
            names = given or tuple(f"{prefix} {number}" for number in range(1, part.width + 1))
        found.append(_Part(part.leaf, part.width, part.is_turned, names))
    return found, bool(given) or not (alone and nameless)


def _columns(part: _Part) -> Iterator[Column]:
    values = part.leaf.load()
    if isinstance(values, Column):
        yield replace(values, name=part.names[0], unit=part.leaf.unit)
        return
    if isinstance(values, list) or values.ndim == 1:
        yield Column(part.names[0], part.leaf.unit, values)
        return
    matrix = values.T if part.is_turned else values
    units = part.leaf.units if len(part.leaf.units) == part.width else (part.leaf.unit,) * part.width
    for number, (name, unit) in enumerate(zip(part.names, units, strict=True)):
        yield Column(name, unit, np.ascontiguousarray(matrix[:, number]))
