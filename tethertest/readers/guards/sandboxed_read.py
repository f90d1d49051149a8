"""Read a file in another process first, where a library that a damaged file hangs or crashes does no harm.

HDF5's library follows addresses in the file without end, or out of its memory, where damaged records of the
file lead it there. No exception tells of that, so the first reading is one that may fail. The other process
has a bound on its memory and its time, reads all that could be asked for, and keeps nothing.
"""

from __future__ import annotations

import atexit
import contextlib
import importlib
import json
import subprocess
import sys
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Final

from tethertest.errors import FileFormatError
from tethertest.readers.guards.limits import CELLS

#: what a small file may take [s]
_PATIENCE: Final = 30.0
#: what a busy machine may take to load the libraries [s]
_START: Final = 120.0
#: slowest reading of a sound file: deflated, from a network drive [bytes/s]
_SLOWEST: Final = 2e6
#: memory for a small file: the largest table that is read, and the libraries [bytes]
_MEMORY: Final = 8 * CELLS + 400 * 2**20
#: bytes of memory for each byte of a file: the file, its numbers, and a copy of them in another order
_MEMORY_RATIO: Final = 12

_busy = threading.Lock()
_children: dict[str, subprocess.Popen[str]] = {}  # by the module that reads there


def read_in_sandbox(path: Path, module: str, library: str) -> None:
    """Let another process read a file to its end.

    Parameters
    ----------
    path : Path
        The file.
    module : str
        Module whose `read_everything` reads all of a file that any settings could ask for. Values that cannot
        be read are none of its errors: who asks for them meets them again.
    library : str
        The package that it needs, loaded before the time is taken.

    Raises
    ------
    FileFormatError
        The other process did not start, refused the file, died of it, or was not done in a time that a sound
        file of this size needs.
    """
    if not sys.executable:  # embedded in another program: there is no interpreter to start
        return
    limit = _PATIENCE + path.stat().st_size / _SLOWEST
    with _busy:
        child = _child(module, library)
        if child is None:
            message = "the process that tries the file first did not start"
            raise FileFormatError(message, "free memory or processes, and try again", path=path)
        line, was_in_time = _said(child, json.dumps(str(path.absolute())) + "\n", limit)
        if not line:
            _end(module)
    answer = json.loads(line) if line else None
    if answer is None:
        how = "the library that reads it died of it"
        if not was_in_time:
            how = f"reading it did not end in {limit:.0f} s"
        answer = [
            f"the file's own records are damaged: {how}",
            "copy the whole file again, or export it again",
        ]
    if answer:
        problem, remedy = answer
        raise FileFormatError(problem, remedy, path=path)


def _child(module: str, library: str) -> subprocess.Popen[str] | None:
    """Return the process that reads by a module, started where there is none yet."""
    child = _children.get(module)
    if child is not None and child.poll() is None:
        return child
    if child is not None:
        _end(module)
    child = _children[module] = subprocess.Popen(
        [sys.executable, "-c", f"from {__name__} import serve; serve({module!r}, {library!r})"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    if not _said(child, "", _START)[0]:
        _end(module)
        return None
    return child


def _said(child: subprocess.Popen[str], question: str, limit: float) -> tuple[str, bool]:
    """Return the next line, "" where the process has ended, and whether that was not for want of time."""
    assert child.stdin is not None
    assert child.stdout is not None
    overdue = threading.Timer(limit, child.kill)
    overdue.start()
    try:
        child.stdin.write(question)
        child.stdin.flush()
        line = child.stdout.readline()
    except OSError:
        line = ""
    finally:
        was_in_time = overdue.is_alive()
        overdue.cancel()
    return (line if line.endswith("\n") else ""), was_in_time


def _end(module: str) -> None:
    child = _children.pop(module)
    child.kill()
    for pipe in (child.stdin, child.stdout):
        if pipe is not None:
            with contextlib.suppress(OSError):  # what was not yet written to a process that is gone
                pipe.close()
    child.wait()


@atexit.register
def _end_all() -> None:
    for module in list(_children):
        _end(module)


def serve(module: str, library: str) -> None:
    """Be the other process: say by an empty line that all is loaded, and answer each line of the input.

    A line is a path as JSON; its answer is an empty list, or what is wrong with the file and what to do.
    """
    read_everything: Callable[[Path], None] = importlib.import_module(module).read_everything
    with contextlib.suppress(ImportError):  # the first process tells of it
        importlib.import_module(library)
    print(flush=True)  # noqa: T201
    for line in sys.stdin:
        path = Path(json.loads(line))
        bound_memory(path)
        print(json.dumps(_trouble(read_everything, path)), flush=True)  # noqa: T201


def _trouble(read_everything: Callable[[Path], None], path: Path) -> list[str]:
    """Return what is wrong with the records of a file and what to do, or nothing."""
    try:
        read_everything(path)
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
