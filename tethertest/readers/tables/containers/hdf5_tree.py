"""An HDF5 file as a tree: only hard links are followed, and only what lies in the file itself is read.

References
----------
Eaton et al., "NetCDF Climate and Forecast (CF) Metadata Conventions", section 8.1, packed data.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from math import prod
from pathlib import Path
from typing import Any, Final

import numpy as np

from tethertest.errors import FileFormatError
from tethertest.readers.guards.hdf5_sets import trouble_of
from tethertest.readers.guards.limits import DEPTH, OBJECTS, TEXT_BYTES
from tethertest.readers.tables.containers.table import Column, Numbers
from tethertest.readers.tables.containers.tree import NAME_LISTS, UNIT_KEYS, Branch, Leaf, Records, facts_of

_NUMERIC: Final = "biuf"
#: attributes of a data set whose numbers are packed, as the CF conventions of netCDF have it
_SCALE, _OFFSET = "scale_factor", "add_offset"
_MISSING: Final = ("_FillValue", "missing_value")


@dataclass(frozen=True, slots=True)
class Packing:
    """What makes the numbers of a data set its values."""

    scale: float = 1.0
    offset: float = 0.0
    missing: tuple[float, ...] = ()  #: numbers that stand for no value

    @property
    def remark(self) -> str:
        """What is done, in words; "" where nothing is."""
        said = []
        if (self.scale, self.offset) != (1.0, 0.0):
            said.append(
                f"values are {_SCALE} {self.scale:g} times what is stored, plus {_OFFSET} {self.offset:g}"
            )
        if self.missing:
            said.append(f"{' and '.join(f'{value:g}' for value in self.missing)} read as missing")
        return ", ".join(said)

    def unpacked(self, stored: Numbers) -> Numbers:
        """Return the values: as stored where nothing is packed, else as float64 with NaN for missing."""
        if self == PLAIN or stored.dtype.kind not in "iuf":
            return stored
        values = stored.astype(np.float64) * self.scale + self.offset
        for number in self.missing:
            values[stored == number] = np.nan
        return values


PLAIN: Final = Packing()


class Walk:
    """One walk through the groups of a file."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.left_out: dict[str, str] = {}
        self._seen: set[Any] = set()

    def branches(self, root: Any) -> Iterator[Branch]:
        """Yield every group below and including `root`.

        Raises
        ------
        FileFormatError
            The groups are nested too deep or hold too many objects.
        """
        waiting = [("", root, 0)]
        count = 0
        while waiting:
            here, group, depth = waiting.pop(0)
            if depth > DEPTH:
                message = f"group {here[:80]!r} is nested in more than {DEPTH} others"
                raise FileFormatError(message, "export the channels in one group", path=self.path)
            leaves: list[Leaf] = []
            records: list[Records] = []
            scalars: dict[str, object] = dict(self._scalar_attributes(group))
            count += len(group)  # told before the names are listed, which takes far longer
            if count > OBJECTS:
                message = f"the file holds more than {OBJECTS} objects"
                raise FileFormatError(message, "export the channels alone", path=self.path)
            for name in group:
                place = f"{here}/{name}" if here else name
                item = self._item(group, name, place)
                if item is None:
                    continue
                if not hasattr(item, "shape"):  # a group, or a named type
                    if hasattr(item, "keys"):
                        waiting.append((place, item, depth + 1))
                    continue
                self._add(name, place, item, leaves, records, scalars)
            yield Branch(here, tuple(leaves), tuple(records), facts_of(scalars))

    def _item(self, group: Any, name: str, place: str) -> Any | None:
        """Return what a hard link leads to, each object once."""
        import h5py

        link = group.get(name, getlink=True)
        if isinstance(link, h5py.ExternalLink):
            self.left_out[place] = "is a link into another file, which is not followed"
            return None
        if isinstance(link, h5py.SoftLink):
            self.left_out[place] = f"is a link to {link.path[:80]!r}, which is not followed: name that"
            return None
        item = group[name]
        info = h5py.h5o.get_info(item.id)
        if (info.fileno, info.addr) in self._seen:
            return None
        self._seen.add((info.fileno, info.addr))
        return item

    def _add(
        self,
        name: str,
        place: str,
        item: Any,
        leaves: list[Leaf],
        records: list[Records],
        scalars: dict[str, object],
    ) -> None:
        shape = tuple(int(side) for side in item.shape) if item.shape is not None else ()
        kind = item.dtype.kind
        is_table = kind == "V" and item.dtype.names is not None and len(shape) == 1
        if not is_table and kind not in _NUMERIC:
            if kind == "c":
                self.left_out[place] = "holds complex numbers"
            elif kind == "O" and prod(shape) == 1:
                value = _text_value(item)
                if value:
                    scalars[name] = value
            return
        trouble = trouble_of(item, shape)
        if trouble:
            self.left_out[place] = trouble
            return
        if is_table:
            if shape[0] > 1:
                names = tuple(_fields(item.dtype))
                records.append(Records(name, shape[0], names, partial(self._loaded_records, item)))
            return
        sides = tuple(side for side in shape if side != 1)
        if not sides:
            if prod(shape) == 1:
                scalars[name] = float(self._loaded(item, ()))
        elif len(sides) > 2:
            self.left_out[place] = f"has {len(sides)} dimensions"
        elif prod(sides) > 1:
            names = next((found for key in NAME_LISTS if (found := _texts(item.attrs, key))), ())
            units = next((found for key in UNIT_KEYS if (found := _texts(item.attrs, key))), ())
            unit = units[0] if len(units) == 1 else ""
            packing = packing_of(item)
            load = partial(self._loaded, item, sides, packing)
            leaves.append(Leaf(name, sides, load, unit=unit, units=units, names=names, remark=packing.remark))

    def _scalar_attributes(self, group: Any) -> Iterator[tuple[str, object]]:
        for count, name in enumerate(group.attrs):
            if count > 1000:
                return
            attribute = group.attrs.get_id(name)
            if prod(attribute.shape) != 1 or attribute.dtype.itemsize > TEXT_BYTES:
                continue
            if attribute.dtype.kind in _NUMERIC:
                yield name, float(np.asarray(group.attrs[name]).reshape(-1)[0])
            elif text := text_attribute(group.attrs, name):
                yield name, text

    def _loaded(self, item: Any, sides: tuple[int, ...], packing: Packing = PLAIN) -> Numbers:
        values = packing.unpacked(values_of(self.path, item).reshape(sides))
        return values.astype(np.int8) if values.dtype.kind == "b" else values

    def _loaded_records(self, item: Any) -> tuple[Column, ...]:
        values = values_of(self.path, item)
        units = next((found for key in UNIT_KEYS if (found := _texts(item.attrs, key))), ())
        names = list(_fields(item.dtype))
        columns = []
        for number, (name, (place, inner)) in enumerate(_fields(item.dtype).items()):
            cells = values[place] if inner is None else values[place][:, inner]
            unit = units[number] if len(units) == len(names) else ""
            columns.append(Column(name, unit, np.ascontiguousarray(cells)))
        return tuple(columns)


def values_of(path: Path, item: Any) -> Numbers:
    """Return the values of a data set without `trouble_of`.

    Raises
    ------
    FileFormatError
        They cannot be read.
    """
    try:
        return np.asarray(item[()])
    except (OSError, ValueError, RuntimeError, MemoryError) as error:
        message = f"data set {item.name!r} cannot be read ({error})"
        raise FileFormatError(message, "copy the whole file again", path=path) from error


def _fields(kind: Any) -> dict[str, tuple[str, int | None]]:
    """Return the numeric columns of a record: a field, or an element of a field that is a short vector."""
    found: dict[str, tuple[str, int | None]] = {}
    for name in kind.names:
        field = kind[name]
        if field.kind in _NUMERIC:
            found[name] = (name, None)
        elif field.subdtype is not None and field.base.kind in _NUMERIC and len(field.shape) == 1:
            found |= {f"{name} {number + 1}": (name, number) for number in range(field.shape[0])}
    return found


def _text_value(item: Any) -> str:
    """Return the text of a data set of one value."""
    if item.id.get_storage_size() > TEXT_BYTES or item.external is not None or item.is_virtual:
        return ""
    value = np.asarray(item[()]).reshape(-1)[0]
    return _decoded(value)


def text_attribute(attributes: Any, name: str) -> str:
    """Return an attribute of one text; "" where there is none, or it is none."""
    found = _texts(attributes, name)
    return found[0] if len(found) == 1 else ""


def _texts(attributes: Any, name: str) -> tuple[str, ...]:
    """Return an attribute of one or more texts; () where there is none, or it is none."""
    if name not in attributes:
        return ()
    kind = attributes.get_id(name)
    if prod(kind.shape) > TEXT_BYTES or kind.dtype.kind not in "SOU" or kind.dtype.itemsize > TEXT_BYTES:
        return ()
    values = np.asarray(attributes[name]).reshape(-1)
    texts = tuple(_decoded(value) for value in values)
    return texts if any(texts) else ()


def _decoded(value: object) -> str:
    if isinstance(value, bytes):
        value = value.decode("utf-8", errors="replace")
    return value.strip().strip("\0") if isinstance(value, str) else ""


def packing_of(item: Any) -> Packing:
    """Return how a data set of h5py is packed, by its attributes of one number."""
    scale, offset = (_numbers(item, key) for key in (_SCALE, _OFFSET))
    missing = {number for key in _MISSING for number in _numbers(item, key)}
    return Packing(scale[0] if scale else 1.0, offset[0] if offset else 0.0, tuple(sorted(missing)))


def _numbers(item: Any, key: str) -> tuple[float, ...]:
    if key not in item.attrs:
        return ()
    attribute = item.attrs.get_id(key)
    if prod(attribute.shape) != 1 or attribute.dtype.kind not in "iuf":
        return ()
    number = float(np.asarray(item.attrs[key]).reshape(-1)[0])
    return (number,) if np.isfinite(number) else ()
