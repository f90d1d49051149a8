"""JSON logs: lists of rows, lists of objects, objects of lists, at the top or under keys."""

from __future__ import annotations

import json
import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, Final, TypeAlias

import numpy as np

from tethertest.errors import FileFormatError
from tethertest.readers.guards.limits import CELLS, COLUMNS, DEPTH, JSON_BYTES, JSON_LISTS, OBJECTS
from tethertest.readers.tables.containers.choice import table_of
from tethertest.readers.tables.containers.log import log_of
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
from tethertest.readers.tables.text.cells import split_unit
from tethertest.readers.tables.text.document import Head, read_document
from tethertest.readers.tables.text.stamps import stamp_kind
from tethertest.readers.tables.text.table import MISSING_TOKENS
from tethertest.records.channel import RawLog
from tethertest.records.run import DEFAULT, Log

NAME = "json"
#: keys of a log in run.toml that it takes
USES = frozenset(
    ["encoding", "date_order", "skip_rows", "time_zone", "units", "table", "columns", "time", "rate"]
)
#: longer whole numbers may not be int64
_INT64_DIGITS: Final = 19
#: a list of lists or objects, or an object: what begins otherwise is text with brackets in it
_BEGINNING: Final = re.compile(r"\s*(?:\[\s*[\[{]|\{\s*[\"}])")
#: escapes of letters beyond the first 65,536, which come in pairs
_PAIR: Final = re.compile(rb"\\u[dD][89abAB][\da-fA-F]{2}\\u[dD][c-fC-F][\da-fA-F]{2}")
_HALF: Final = re.compile(rb"\\u[dD][89a-fA-F][\da-fA-F]{2}")
_Object: TypeAlias = dict[str, Any]


def sniff(head: Head) -> str | None:
    """Claim text that begins as a JSON list of rows or a JSON object."""
    text = "\n".join(head.lines[:100])
    return "the text begins as JSON" if _BEGINNING.match(text) else None


def read(path: Path, settings: Log = DEFAULT) -> RawLog:
    """Read a JSON log.

    Parameters
    ----------
    path : Path
        The log, plain or in gzip or zip; also one object on each line.
    settings : Log
        Its `table` is the path of keys (``"daq/data"``), its `columns` name the values of a row.

    Returns
    -------
    RawLog
        Lists of numbers as channels; a list of rows without names has columns 1 to n.

    Raises
    ------
    FileFormatError
        The JSON is cut, nested too deep, repeats a key or is too large, rows differ in width, a value is
        text among numbers, or the table or its time is not evident.
    """
    document = read_document(path, settings.encoding)
    if len(document.body) > JSON_BYTES:
        message = f"the JSON log has {len(document.body) >> 20} MB, expected at most {JSON_BYTES >> 20} MB"
        raise FileFormatError(message, "split the log, or export it as text or HDF5", path=path)
    lists = document.body.count(b"[") + document.body.count(b"{")
    if lists > JSON_LISTS:
        message = f"the JSON log has {lists} lists and objects, expected at most {JSON_LISTS}"
        raise FileFormatError(message, "split the log, or export it as text or HDF5", path=path)
    if _HALF.search(_PAIR.sub(b"", document.body)):
        message = "the JSON log has half of a pair of escapes (\\ud800), which is no letter"
        raise FileFormatError(message, "export the names again, in UTF-8", path=path)
    content = _parsed(path, document.body)
    skip = settings.skip_rows
    left_out: dict[str, str] = {}
    branches = tuple(_branches(path, content, skip, left_out))
    tree = Tree(path, "the JSON log", "/", branches, left_out)
    table, settings = table_of(tree, settings)
    return log_of(NAME, table, settings, encoding=document.encoding)


def _parsed(path: Path, body: bytes) -> Any:
    decoder = partial(
        json.loads, object_pairs_hook=partial(_object, path), parse_int=_whole, parse_constant=float
    )
    try:
        try:
            return decoder(body)
        except json.JSONDecodeError as error:
            if error.msg != "Extra data":
                raise
            # one object on each line
            lines = [line for line in body.split(b"\n") if line.strip()]
            return [decoder(line) for line in lines]
    except json.JSONDecodeError as error:
        message = f"the JSON is damaged or cut ({error.msg})"
        raise FileFormatError(message, "copy the whole log again", path=path, line=error.lineno) from error
    except RecursionError as error:
        message = f"the JSON is nested too deep, expected at most {DEPTH} levels"
        raise FileFormatError(message, "export the channels as plain lists", path=path) from error


def _object(path: Path, pairs: list[tuple[str, Any]]) -> _Object:
    if len(pairs) > OBJECTS:
        message = f"an object has {len(pairs)} keys, expected at most {OBJECTS}"
        raise FileFormatError(message, "export the channels alone, as lists", path=path)
    found = dict(pairs)
    if len(found) < len(pairs):
        seen: set[str] = set()
        name = next(name for name, _ in pairs if name in seen or seen.add(name))  # type: ignore[func-returns-value]
        message = f"the key {name!r} stands twice in one object"
        raise FileFormatError(message, "give every channel a name of its own", path=path)
    return found


def _whole(text: str) -> float | int:
    return int(text) if len(text) < _INT64_DIGITS else float(text)


def _branches(path: Path, content: Any, skip: int, left_out: dict[str, str]) -> Iterator[Branch]:
    """Yield every object that directly holds lists of values."""
    whole = content if isinstance(content, dict) else {"": content}
    waiting: list[tuple[str, Any, int, dict[str, str]]] = [("", whole, 0, {})]
    count = 0
    while waiting:
        here, value, depth, units = waiting.pop(0)
        count += 1
        if depth > DEPTH or count > OBJECTS:
            message = f"the JSON has more than {DEPTH} levels or {OBJECTS} objects outside its tables"
            raise FileFormatError(message, "export the channels as plain lists", path=path)
        units = {**units, **_units(value)}  # those of an object hold for what is in it
        yield _branch(path, here, value, skip, left_out, units)
        inner = [(name, item) for name, item in value.items() if isinstance(item, dict)]
        waiting += [(f"{here}/{name}" if here else name, item, depth + 1, units) for name, item in inner]


def _branch(
    path: Path, here: str, value: _Object, skip: int, left_out: dict[str, str], units: dict[str, str]
) -> Branch:
    leaves: list[Leaf] = []
    records: list[Records] = []
    for name, item in value.items():
        if not isinstance(item, list) or name in {*NAME_LISTS, *UNIT_KEYS}:
            continue
        rows = item[skip:] if item and isinstance(item[0], list | dict) else item
        kinds = {type(row) for row in rows}
        if kinds == {list} and not rows[0]:
            left_out[f"{here}/{name}" if here else name or "rows"] = "holds rows of no values"
        elif kinds == {list}:
            leaves.append(_matrix(path, name, rows, skip, value, units))
        elif kinds == {dict}:
            records.append(_records(path, name or "rows", rows, units))
        elif kinds & {list, dict}:
            left_out[f"{here}/{name}" if here else name] = "mixes rows with other values"
        elif _is_text(rows):
            left_out[f"{here}/{name}" if here else name] = "holds text"
        elif rows:
            own, unit = split_unit(name)
            load = partial(_vector, path, name, rows, 0)
            leaves.append(Leaf(own, (len(rows),), load, units.get(name, units.get(own, unit))))
    kept = tuple(leaf for leaf in leaves if leaf.shape[0] > 1)
    return Branch(here, kept, tuple(item for item in records if item.length > 1), facts_of(value))


def _units(value: _Object) -> dict[str, str]:
    """Return the units that an object gives by name."""
    found: _Object = next((value[key] for key in UNIT_KEYS if isinstance(value.get(key), dict)), {})
    return {name: unit for name, unit in found.items() if isinstance(unit, str)}


def _texts(value: _Object, keys: Sequence[str], width: int) -> tuple[str, ...]:
    """Return the list beside a matrix that names or gives units to its columns."""
    for key in keys:
        found = value.get(key)
        if isinstance(found, list) and len(found) == width and all(isinstance(item, str) for item in found):
            return tuple(found)
    return ()


def _matrix(
    path: Path, name: str, rows: list[list[Any]], skip: int, beside: _Object, units: Mapping[str, str]
) -> Leaf:
    width = len(rows[0])
    names = _texts(beside, NAME_LISTS, width)
    first = 0
    if not names and len(rows) > 1 and rows[0] and all(isinstance(cell, str) for cell in rows[0]):
        names, first = tuple(rows[0]), 1
    pairs = [split_unit(item) for item in names]
    written = _texts(beside, UNIT_KEYS, width) or tuple(
        units.get(full, units.get(own, unit)) for full, (own, unit) in zip(names, pairs, strict=True)
    )
    load = partial(_rows, path, rows[first:], width, skip + first)
    shape = (len(rows) - first, width)
    return Leaf(
        name or "rows", shape, load, units=written, names=tuple(own for own, _ in pairs), rows_first=True
    )


def _rows(path: Path, rows: list[list[Any]], width: int, skipped: int) -> Numbers:
    for number, row in enumerate(rows, start=skipped + 1):
        if len(row) != width:
            message = f"row {number}: found {len(row)} values, expected {width}"
            raise FileFormatError(message, "export the log again", path=path)
    columns = [
        _vector(path, f"column {number}", column, skipped)
        for number, column in enumerate(zip(*rows, strict=True), start=1)
    ]
    texts = [
        number
        for number, column in enumerate(columns, start=1)
        if isinstance(column.cells, list) or column.remark
    ]
    if texts:
        message = f"column {texts[0]} of the rows holds text, expected numbers"
        remedy = "export the log as a list of objects, or with null for missing values"
        raise FileFormatError(message, remedy, path=path)
    return np.column_stack([np.asarray(column.cells) for column in columns])


def _records(path: Path, name: str, rows: list[_Object], units: Mapping[str, str]) -> Records:
    keys = list(dict.fromkeys(key for row in rows for key in row))
    if len(keys) > COLUMNS or len(keys) * len(rows) > CELLS:
        message = f"found objects with {len(keys)} keys, expected at most {COLUMNS}"
        raise FileFormatError(message, "export the channels under the same keys in every row", path=path)
    flat = [key for key in keys if not any(isinstance(row.get(key), list | dict) for row in rows)]
    pairs = {key: split_unit(key) for key in flat}

    def load() -> tuple[Column, ...]:
        columns = [_vector(path, key, [row.get(key) for row in rows], 0) for key in pairs]
        return tuple(
            replace(column, name=own, unit=units.get(key, unit))
            for column, (key, (own, unit)) in zip(columns, pairs.items(), strict=True)
        )

    return Records(name, len(rows), tuple(own for own, _ in pairs.values()), load)


def _is_text(cells: Sequence[Any]) -> bool:
    """Return whether a list holds text that is neither stamps nor words for missing values."""
    filled = [cell for cell in cells if cell is not None]
    words = [cell for cell in filled if isinstance(cell, str) and cell.strip().lower() not in MISSING_TOKENS]
    return bool(words) and len(words) == len(filled) and stamp_kind(words[0]) is None


def _vector(path: Path, name: str, cells: Sequence[Any], skipped: int) -> Column:
    """Return a list of values as numbers, or as text where all of them are text."""
    kinds = {type(cell) for cell in cells}
    if kinds in ({float}, {int}, {float, int}):
        return Column(name, "", _integers(cells) if kinds == {int} else np.asarray(cells, dtype=np.float64))
    missing = Counter(
        cell.strip()
        for cell in cells
        if isinstance(cell, str) and cell.strip().lower() in {"", *MISSING_TOKENS}
    )
    words = [isinstance(cell, str) and cell.strip() not in missing for cell in cells]
    if any(words) and all(cell is None or isinstance(cell, str) for cell in cells):
        return Column(name, "", ["" if cell is None or cell.strip() in missing else cell for cell in cells])
    values = np.full(len(cells), np.nan)
    for row, cell in enumerate(cells):
        if words[row] or isinstance(cell, bool | list | dict):
            message = f"row {skipped + row + 1}: found {str(cell)[:40]!r} in {name!r}, expected a number"
            remedy = "export the log again with numbers alone in this column"
            raise FileFormatError(message, remedy, path=path)
        if isinstance(cell, int | float):
            values[row] = cell
    lost = [f"{count} values {word!r}" for word, count in missing.items()]
    return Column(name, "", values, f"column {name!r}: {', '.join(lost)} read as missing" if lost else "")


def _integers(cells: Sequence[int]) -> Numbers:
    try:
        return np.asarray(cells, dtype=np.int64)
    except OverflowError:
        return np.asarray(cells, dtype=np.float64)
