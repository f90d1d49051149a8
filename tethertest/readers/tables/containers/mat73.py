"""Variables of a MATLAB file of version 7.3: HDF5 with the axes reversed and MATLAB's own attributes.

Cells, and the fields of arrays of structs, are references to what MATLAB keeps in the group ``#refs#``. The
attributes are ``MATLAB_class``, ``MATLAB_empty`` (the values are then the sides), ``MATLAB_sparse`` and
``MATLAB_object_decode``.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import prod
from pathlib import Path
from typing import Any, Final

import numpy as np

from tethertest.errors import FileFormatError
from tethertest.readers.guards.hdf5_sets import trouble_of
from tethertest.readers.guards.limits import DEPTH, OBJECTS, TEXT_BYTES
from tethertest.readers.tables.containers.hdf5_tree import text_attribute, values_of
from tethertest.readers.tables.containers.matlab_tree import Array, Item, Other, Struct, cell_of
from tethertest.readers.tables.containers.table import Numbers

_NUMERIC: Final = "biuf"
#: fields of the records that MATLAB writes for complex numbers
_COMPLEX: Final = ("real", "imag")


def variables(path: Path, file: Any) -> Iterator[tuple[str, Item]]:
    """Yield name and content of every variable of an opened file.

    Raises
    ------
    FileFormatError
        The file is nested too deep, or holds more objects than a log.
    """
    walk = _Walk(path, file)
    for name in file:
        if not name.startswith("#"):  # MATLAB's own groups of cells and objects
            yield name, walk.linked(file, name, 0)


class _Walk:
    def __init__(self, path: Path, file: Any) -> None:
        self.path = path
        self.file = file
        self.objects = 0
        self._known: dict[int, Item] = {}  # by their place in the file

    def linked(self, group: Any, name: str, depth: int) -> Item:
        """Return what a hard link leads to."""
        import h5py

        if not isinstance(group.get(name, getlink=True), h5py.HardLink):
            return Other("is a link, which is not followed")
        return self._item(group[name], depth)

    def _item(self, found: Any, depth: int) -> Item:
        self.objects += 1
        if depth > DEPTH or self.objects > OBJECTS:
            message = f"the MATLAB file has more than {DEPTH} levels or {OBJECTS} arrays"
            raise FileFormatError(message, "save the channels alone", path=self.path)
        kind = text_attribute(found.attrs, "MATLAB_class")
        if kind == "function_handle":
            return Other("is a function handle")
        if "MATLAB_sparse" in found.attrs:
            return Other("is a sparse matrix")
        if "MATLAB_object_decode" in found.attrs:
            return Other(f"is a MATLAB {kind[:40] or 'object'}")
        if hasattr(found, "keys"):
            return self._struct(found, depth) if kind in {"", "struct"} else Other(f"is a MATLAB {kind[:40]}")
        if not hasattr(found, "shape"):
            return Other("is no array")
        return self._data_set(found, kind, depth)

    def _data_set(self, found: Any, kind: str, depth: int) -> Item:
        import h5py

        if "MATLAB_empty" in found.attrs:
            return "" if kind == "char" else Array((0, 0), lambda: np.zeros((0, 0)))
        shape = tuple(int(side) for side in reversed(found.shape or ()))
        if h5py.check_ref_dtype(found.dtype) is h5py.Reference:
            return cell_of(self._referred(found, depth)) if kind == "cell" else Other("refers to others")
        if found.dtype.names == _COMPLEX or found.dtype.kind == "c":
            return Other("holds complex numbers")
        if found.dtype.kind not in _NUMERIC or found.shape is None:
            return Other("holds no numbers")
        trouble = trouble_of(found, shape)
        if trouble:
            return Other(trouble)
        if kind == "char":
            return self._text(found, shape)
        return Array(shape, lambda: _loaded(self.path, found))

    def _text(self, found: Any, shape: tuple[int, ...]) -> Item:
        if found.dtype != np.uint16 or len(shape) != 2 or prod(shape) > TEXT_BYTES:
            return Other("is a text of an unknown kind, or a long one")
        rows = values_of(self.path, found).T.astype("<u2")
        texts = tuple(row.tobytes().decode("utf-16-le", errors="replace").strip("\0 ") for row in rows)
        return texts[0] if len(texts) == 1 else texts

    def _referred(self, found: Any, depth: int) -> list[Item]:
        """Return what the references of a data set lead to, in MATLAB's order."""
        if prod(found.shape) > OBJECTS:
            message = f"{found.name!r} declares {prod(found.shape)} cells, expected at most {OBJECTS}"
            raise FileFormatError(message, "save the channels alone", path=self.path)
        references = values_of(self.path, found).reshape(-1)
        return [self._target(reference, depth + 1) for reference in references]

    def _target(self, reference: Any, depth: int) -> Item:
        """Return what a reference leads to, read once however many lead there: cells may list each other."""
        import h5py

        found = self.file[reference]
        address = int(h5py.h5o.get_info(found.id).addr)
        self.objects += 1
        if address not in self._known:
            self._known[address] = self._item(found, depth)
        return self._known[address]

    def _struct(self, group: Any, depth: int) -> Item:
        fields: dict[str, list[Item]] = {}
        for name in group:
            found = group[name] if self._is_hard(group, name) else None
            if found is not None and self._is_field_of_array(found):
                fields[name] = self._referred(found, depth)
            else:
                fields[name] = [self.linked(group, name, depth + 1)]
        counts = {len(values) for values in fields.values()}
        if not fields:
            return Other("is a struct without fields")
        return Struct(counts.pop(), fields) if len(counts) == 1 else Other("is a struct of uneven fields")

    def _is_hard(self, group: Any, name: str) -> bool:
        import h5py

        return isinstance(group.get(name, getlink=True), h5py.HardLink)

    def _is_field_of_array(self, found: Any) -> bool:
        """Return whether a field has a value for each struct of an array: a cell array is marked as such."""
        import h5py

        is_reference = hasattr(found, "shape") and h5py.check_ref_dtype(found.dtype) is h5py.Reference
        return is_reference and "MATLAB_class" not in found.attrs


def _loaded(path: Path, found: Any) -> Numbers:
    values = values_of(path, found).T
    return values.astype(np.int8) if values.dtype.kind == "b" else values
