"""MATLAB files: variables and structs of numeric arrays."""

from __future__ import annotations

import struct
from contextlib import suppress
from pathlib import Path
from typing import Final

from tethertest.errors import FileFormatError
from tethertest.readers.formats.hdf5 import opened
from tethertest.readers.guards.sandboxed_read import read_in_sandbox
from tethertest.readers.tables.containers import mat5, mat73
from tethertest.readers.tables.containers.choice import table_of
from tethertest.readers.tables.containers.log import log_of
from tethertest.readers.tables.containers.matlab_tree import Array, Item, Struct, tree_of
from tethertest.readers.tables.text.document import Head, read_bytes
from tethertest.records.channel import RawLog
from tethertest.records.run import DEFAULT, Log

NAME = "matlab"
#: keys of a log in run.toml that it takes
USES = frozenset(["date_order", "time_zone", "units", "table", "columns", "time", "rate"])
_HEADER_BYTES: Final = 128
#: version and mark of the byte order at the end of the header
_LEVEL_5: Final = {b"\x00\x01IM", b"\x01\x00MI"}
_LEVEL_73: Final = {b"\x00\x02IM", b"\x02\x00MI"}
#: how the header begins where it is not whole or of another version
_TITLE: Final = b"MATLAB 5.0 MAT-file", b"MATLAB 7.3 MAT-file"
_OCTAVE: Final = "# Created by Octave"
_SAVE: Final = "save it with: save('log.mat', ..., '-v7')"


def sniff(head: Head) -> str | None:
    """Claim files with MATLAB's header of any version, and Octave's text."""
    if head.data[124:128] in _LEVEL_5:
        return "the header is that of a MATLAB file (version 5 to 7)"
    if head.data[124:128] in _LEVEL_73:
        return "the header is that of a MATLAB file of version 7.3"
    if head.data.startswith(_TITLE):
        return "the first bytes are those of a MATLAB file"
    if head.lines and head.lines[0].startswith(_OCTAVE):
        return "the first line is that of an Octave file"
    return "the first bytes are those of a MATLAB file of version 4" if _is_level_4(head.data) else None


def read(path: Path, settings: Log = DEFAULT) -> RawLog:
    """Read a MATLAB log.

    Parameters
    ----------
    path : Path
        The log, plain or in gzip or zip.
    settings : Log
        Its `table` is a struct or a matrix, its `time` a vector, by name or path (``"daq.t"``).

    Returns
    -------
    RawLog
        Vectors by their names; columns of a matrix by the texts beside it (``names``, ``channels``, ...), or
        numbered; units from the field ``units`` beside them.

    Raises
    ------
    FileFormatError
        The file is damaged or cut, is of version 4 or Octave's text, or holds no table or several.
    """
    version = read_bytes(path, _HEADER_BYTES)[124:]
    if version in _LEVEL_73:
        read_in_sandbox(path, __name__, "h5py")
        with opened(path) as file:
            table, rest = table_of(tree_of(path, mat73.variables(path, file)), settings)
        return log_of(NAME, table, rest)
    data = read_bytes(path)
    if version not in _LEVEL_5 and data.startswith(_TITLE):
        message = "the MATLAB file is damaged or cut: its header is not whole"
        raise FileFormatError(message, "copy it again, or save it again from MATLAB", path=path)
    if version not in _LEVEL_5:
        what = "Octave's text format" if data.startswith(_OCTAVE.encode()) else "MATLAB's format of version 4"
        message = f"found {what}, which is not read"
        raise FileFormatError(message, _SAVE, path=path)
    table, rest = table_of(tree_of(path, mat5.variables(path, data)), settings)
    return log_of(NAME, table, rest)


def read_everything(path: Path) -> None:
    """Read each variable of a file of version 7.3."""
    with opened(path) as file:
        for _, item in mat73.variables(path, file):
            _load(item)


def _load(item: Item) -> None:
    if isinstance(item, Array):
        with suppress(FileFormatError, MemoryError):
            item.load()
    elif isinstance(item, Struct):
        for values in item.fields.values():
            for value in values:
                _load(value)


def _is_level_4(data: bytes) -> bool:
    """Return whether the first matrix has a header of version 4: type, sides, a name that ends with NUL."""
    for order, machine in (("<", 0), (">", 1)):
        if len(data) < 22:
            return False
        kind, rows, columns, is_complex, length = struct.unpack_from(f"{order}5i", data)
        tens = (kind // 1000, kind // 100 % 10, kind // 10 % 10, kind % 10)  # machine, 0, precision, type
        is_kind = kind >= 0 and tens[:2] == (machine, 0) and tens[2] <= 5 and tens[3] <= 2
        name = data[20 : 20 + max(min(length, 64), 0)]
        is_name = name.endswith(b"\0") and name[:-1].decode("latin-1").isidentifier()
        if is_kind and rows >= 0 and columns >= 0 and is_complex in {0, 1} and is_name:
            return True
    return False
