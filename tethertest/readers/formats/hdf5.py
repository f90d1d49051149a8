"""HDF5 logs: vectors of one length, matrices and records, in any group."""

from __future__ import annotations

import io
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, Final

from tethertest.errors import FileFormatError, TethertestError
from tethertest.readers.guards.sandboxed_read import read_in_sandbox
from tethertest.readers.tables.containers.choice import table_of
from tethertest.readers.tables.containers.hdf5_tree import Walk, text_attribute
from tethertest.readers.tables.containers.log import log_of
from tethertest.readers.tables.containers.tree import Tree
from tethertest.readers.tables.text.document import Head, read_bytes
from tethertest.records.channel import RawLog
from tethertest.records.run import DEFAULT, Log

NAME = "hdf5"
#: keys of a log in run.toml that it takes
USES = frozenset(["time_zone", "units", "table", "columns", "time", "rate"])
MAGIC: Final = b"\x89HDF\r\n\x1a\n"
#: `format` of the root of a run that was written by `tethertest ingest`
_STORE: Final = "tethertest-run"


def sniff(head: Head) -> str | None:
    """Claim files with HDF5's signature at their beginning."""
    return "the first bytes are HDF5's" if head.data.startswith(MAGIC) else None


def read(path: Path, settings: Log = DEFAULT) -> RawLog:
    """Read an HDF5 log.

    Parameters
    ----------
    path : Path
        The log, plain or in gzip or zip.
    settings : Log
        Its `table` is a group or data set, its `time` a data set, by name or path.

    Returns
    -------
    RawLog
        Vectors by their names, columns of a matrix by the attribute ``columns`` or numbered, fields of
        records by theirs; units from the attribute ``unit`` or ``units``.

    Raises
    ------
    FileFormatError
        The file is damaged, is a run store, holds no table or several, or what is asked for lies in another
        file, is larger than a log may be, or is compressed in a way that is not known.
    """
    read_in_sandbox(path, __name__, "h5py")
    with opened(path) as file:
        if text_attribute(file.attrs, "format") == _STORE:
            message = "found a run that tethertest has stored, expected a raw log"
            raise FileFormatError(message, "name the raw log that it was made from", path=path)
        walk = Walk(path)
        branches = tuple(walk.branches(file))
        tree = Tree(path, "the HDF5 file", "/", branches, walk.left_out)
        table, settings = table_of(tree, settings)
    return log_of(NAME, table, settings)


def read_everything(path: Path) -> None:
    """Read each group, attribute and data set."""
    with opened(path) as file:
        for branch in Walk(path).branches(file):
            loads = [table.load for table in branch.leaves] + [table.load for table in branch.records]
            for load in loads:
                with suppress(FileFormatError, MemoryError):
                    load()


@contextmanager
def opened(path: Path) -> Iterator[Any]:
    """Open an HDF5 file that may be compressed.

    Raises
    ------
    FileFormatError
        The file is cut or damaged.
    """
    import h5py

    data = read_bytes(path)
    try:
        with h5py.File(io.BytesIO(data), "r") as file:
            yield file
    except TethertestError:
        raise
    except (OSError, RuntimeError, KeyError, ValueError, TypeError, OverflowError) as error:  # all of h5py's
        message = f"the HDF5 file is damaged or cut ({error})"
        raise FileFormatError(message, "copy the whole file again", path=path) from error
