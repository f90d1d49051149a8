"""What tells one file from another: its hash, and that it stayed as it was while it was read."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Final

from tethertest.errors import FileFormatError

#: bytes of a file that are hashed at once
_HASHED_AT_ONCE: Final = 2**22


def file_sha256(path: Path) -> str:
    """Return the SHA-256 of the file as it lies on disk.

    Raises
    ------
    OSError
        The file cannot be read.
    """
    digest = hashlib.sha256()
    piece = bytearray(_HASHED_AT_ONCE)
    with path.open("rb", buffering=0) as stream:
        while count := stream.readinto(piece):
            digest.update(memoryview(piece)[:count])
    return digest.hexdigest()


@dataclass(frozen=True)
class FileFingerprint:
    """A log's file as it was before the first byte of it was read.

    The file is hashed when the hash is first asked for, so that whoever only reads does not wait for it; that
    what is hashed is what was read, is known by the file's size and time of change.
    """

    path: Path
    size: int  #: [bytes]
    changed: int  #: time of the last change [ns]

    @cached_property
    def sha256(self) -> str:
        """Hash of the file on disk, in hexadecimal digits.

        Raises
        ------
        FileFormatError
            The file has changed since, or cannot be read any more.
        """
        try:
            digest = file_sha256(self.path)
        except OSError as error:
            message = f"the log can no longer be read ({error.strerror})"
            raise FileFormatError(message, "put it back and read it again", path=self.path) from error
        self.verify()
        return digest

    def verify(self) -> None:
        """Refuse a file that is no longer what it was.

        Raises
        ------
        FileFormatError
            Its size or the time of its last change differs, or it is gone.
        """
        now = fingerprint(self.path)
        if now != self:
            grown = f"; it had {self.size} bytes and has {now.size}" if now and now.size != self.size else ""
            message = "the log changed while it was read" if now else "the log was removed while it was read"
            remedy = "wait until the logger or the copying has closed the file, then read it again"
            raise FileFormatError(message + grown, remedy, path=self.path)


@contextmanager
def unchanged(path: Path) -> Iterator[FileFingerprint | None]:
    """Read a file within: if it changes meanwhile, that is said instead of what it made a reader say.

    Raises
    ------
    FileFormatError
        The file has changed or was removed between the beginning and the end.
    """
    before = fingerprint(path)
    try:
        yield before
    except FileFormatError:
        if before is not None:
            before.verify()
        raise
    if before is not None:
        before.verify()


def fingerprint(path: Path) -> FileFingerprint | None:
    """Return the file as it is now; None where there is none, which readers refuse in their own words."""
    try:
        status = path.stat()
    except OSError:
        return None
    return FileFingerprint(path, status.st_size, status.st_mtime_ns)
