"""The other process of `rehearse`: reads every HDF5 file that it is told of, and keeps nothing."""

from __future__ import annotations

import contextlib
import importlib
import json
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Final

from tethertest.errors import FileFormatError
from tethertest.readers.containers.hdf5_tree import Walk
from tethertest.readers.containers.limits import CELLS
from tethertest.readers.formats.hdf5 import opened

#: memory for a small file: the largest table that is read, and the libraries [bytes]
_MEMORY: Final = 8 * CELLS + 400 * 2**20
#: bytes of memory for each byte of a file: the file, its numbers, and a copy of them in another order
_MEMORY_RATIO: Final = 12


def trouble(path: Path) -> list[str]:
    """Read each group, attribute and data set that any settings could ask for.

    Returns
    -------
    list of str
        What is wrong with the records of the file and what to do, or nothing; values that cannot be read are
        met again by who asks for them.
    """
    try:
        with opened(path) as file:
            for branch in Walk(path).branches(file):
                for load in [table.load for table in branch.leaves] + [
                    table.load for table in branch.records
                ]:
                    with contextlib.suppress(FileFormatError, MemoryError):
                        load()
    except FileFormatError as error:
        return [error.problem, error.remedy]
    except MemoryError:
        return ["the file's own records ask for more memory than it has data", "copy the whole file again"]
    return []


def bound_memory(path: Path) -> None:
    """Let this process take as much as a sound file of this size needs, where the system can do that."""
    try:
        import resource
    except ImportError:  # Windows
        return
    _, most = resource.getrlimit(resource.RLIMIT_DATA)
    bound = _MEMORY + _MEMORY_RATIO * path.stat().st_size
    resource.setrlimit(resource.RLIMIT_DATA, (bound if most < 0 else min(bound, most), most))


def main(answer: Callable[[Path], list[str]] = trouble, library: str = "h5py") -> None:
    """Load the library, say so by an empty line, and answer each line of the input."""
    with contextlib.suppress(ImportError):  # the first process tells of it
        importlib.import_module(library)
    print(flush=True)  # noqa: T201
    for line in sys.stdin:
        path = Path(json.loads(line))
        bound_memory(path)
        print(json.dumps(answer(path)), flush=True)  # noqa: T201


if __name__ == "__main__":
    main()
