"""A checksum at the end of a store: HDF5 itself may fall over a damaged file, or read a changed attribute.

The line comes after the end of the HDF5 data, where HDF5 does not look. A program that changes the file takes
it away or makes it wrong.
"""

from __future__ import annotations

import hashlib
import os
import re
from pathlib import Path
from typing import BinaryIO

from tethertest.errors import FileFormatError
from tethertest.store.whole import WholeFile

#: first bytes of an HDF5 file
MAGIC = b"\x89HDF\r\n\x1a\n"
#: the last line of a store
_LINE = re.compile(rb"\ntethertest-run sha256 ([0-9a-f]{64})\n")
_LENGTH = len("\ntethertest-run sha256 \n") + 64
#: bytes hashed at once
_BLOCK = 1 << 20


def seal(file: WholeFile) -> None:
    """Write the checksum of a complete file after its end.

    Parameters
    ----------
    file : WholeFile
        HDF5 is done with it.
    """
    file.seek(0)
    digest = hashlib.sha256()
    while block := file.read(_BLOCK):
        digest.update(block)
    file.write(f"\ntethertest-run sha256 {digest.hexdigest()}\n".encode("ascii"))


def is_sealed(path: Path) -> bool:
    """Return whether a file begins as HDF5 and ends as a store, whatever its checksum."""
    try:
        with path.open("rb") as file:
            return file.read(len(MAGIC)) == MAGIC and _stated(file) is not None
    except OSError:
        return False


def _stated(file: BinaryIO) -> str | None:
    """Return the checksum that a file ends with, None where it has none."""
    size = file.seek(0, os.SEEK_END)
    file.seek(max(size - _LENGTH, 0))
    found = _LINE.fullmatch(file.read())
    return None if found is None else found.group(1).decode("ascii")


def check_seal(path: Path) -> None:
    """Refuse a store that is not as it was written.

    Parameters
    ----------
    path : Path
        The store; all of it is read once.

    Raises
    ------
    FileFormatError
        The file cannot be opened, is no HDF5 file, has no checksum, or another one.
    """
    remedy = "name a run store, as ingest writes it"
    try:
        with path.open("rb") as file:
            if file.read(len(MAGIC)) != MAGIC:
                message = "found no HDF5 file, expected a run store"
                raise FileFormatError(message, remedy, path=path)
            stated = _stated(file)
            if stated is None:
                message = "the HDF5 file is no run store, or it was cut or changed since it was written"
                raise FileFormatError(message, f"{remedy}, or ingest the run again", path=path)
            left = file.seek(0, os.SEEK_END) - _LENGTH
            file.seek(0)
            digest = hashlib.sha256()
            while left and (block := file.read(min(_BLOCK, left))):
                digest.update(block)
                left -= len(block)
    except OSError as error:
        message = f"the store cannot be read ({(error.strerror or str(error)).lower()})"
        raise FileFormatError(message, remedy, path=path) from error
    if digest.hexdigest() != stated:
        message = "the store is damaged or was changed: its content does not have the checksum at its end"
        raise FileFormatError(message, "ingest the run again from its raw logs", path=path)
