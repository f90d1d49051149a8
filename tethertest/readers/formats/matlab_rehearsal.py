"""The other process of `rehearse` for MATLAB files of version 7.3."""

from __future__ import annotations

import contextlib
from pathlib import Path

from tethertest.errors import FileFormatError
from tethertest.readers.containers.mat73 import variables
from tethertest.readers.containers.matlab_items import Array, Item, Struct
from tethertest.readers.containers.rehearsing import serve
from tethertest.readers.formats.hdf5 import opened


def read_all(path: Path) -> None:
    """Read each variable."""
    with opened(path) as file:
        for _, item in variables(path, file):
            _load(item)


def _load(item: Item) -> None:
    if isinstance(item, Array):
        with contextlib.suppress(FileFormatError, MemoryError):
            item.load()
    elif isinstance(item, Struct):
        for values in item.fields.values():
            for value in values:
                _load(value)


if __name__ == "__main__":
    serve(read_all, "h5py")
