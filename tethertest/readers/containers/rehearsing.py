"""The other process of `rehearse`, of any format: it reads each file it is told of, and keeps nothing."""

from __future__ import annotations

import contextlib
import importlib
import json
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Final

from tethertest.errors import FileFormatError
from tethertest.readers.containers.limits import CELLS

#: memory for a small file: the largest table that is read, and the libraries [bytes]
_MEMORY: Final = 8 * CELLS + 400 * 2**20
#: bytes of memory for each byte of a file: the file, its numbers, and a copy of them in another order
_MEMORY_RATIO: Final = 12


def serve(read_all: Callable[[Path], None], library: str) -> None:
    """Load the library, say so by an empty line, and answer each line of the input.

    Parameters
    ----------
    read_all : callable
        Reads all of a file that any settings could ask for. Values that cannot be read are none of its
        errors: who asks for them meets them again.
    library : str
        The package that it needs.
    """
    with contextlib.suppress(ImportError):  # the first process tells of it
        importlib.import_module(library)
    print(flush=True)  # noqa: T201
    for line in sys.stdin:
        path = Path(json.loads(line))
        bound_memory(path)
        print(json.dumps(_trouble(read_all, path)), flush=True)  # noqa: T201


def _trouble(read_all: Callable[[Path], None], path: Path) -> list[str]:
    """Return what is wrong with the records of a file and what to do, or nothing."""
    try:
        read_all(path)
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
