"""The other process of `rehearse` for HDF5 files."""

from __future__ import annotations

import contextlib
from pathlib import Path

from tethertest.errors import FileFormatError
from tethertest.readers.containers.hdf5_tree import Walk
from tethertest.readers.containers.rehearsing import serve
from tethertest.readers.formats.hdf5 import opened


def read_all(path: Path) -> None:
    """Read each group, attribute and data set."""
    with opened(path) as file:
        for branch in Walk(path).branches(file):
            loads = [table.load for table in branch.leaves] + [table.load for table in branch.records]
            for load in loads:
                with contextlib.suppress(FileFormatError, MemoryError):
                    load()


if __name__ == "__main__":
    serve(read_all, "h5py")
