"""Compressed logs in bounded memory: gzip streams and zip archives that may lie about themselves."""

from __future__ import annotations

import struct
import zipfile
from pathlib import Path, PurePosixPath, PureWindowsPath
from typing import Any, BinaryIO, Final

from tethertest.errors import FileFormatError
from tethertest.readers.guards.limits import (
    COMPRESSION_RATIO,
    DECOMPRESSED_BYTES,
    DIRECTORY_BYTES,
    MEMBERS,
    RATIO_FROM,
)

ZIP_MAGIC: Final = b"PK\x03\x04"
#: bytes asked for at once: zipfile reads as many packed ones ahead
_BLOCK: Final = 2**16
#: what every packer writes; LZMA may ask for a dictionary of 4 GB
_METHODS: Final = {zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED}
_END = struct.Struct("<4s4H2LH")
_END_64 = struct.Struct("<4sQ2H2L4Q")
#: an end record and the longest comment behind it
_TAIL: Final = _END.size + 65_535
_ENCRYPTED: Final = 0x1


class LimitedStream:
    """A decompressing stream that stops at the limits on size and ratio."""

    def __init__(self, stream: Any, path: Path, packed: Any) -> None:
        self._stream = stream
        self._path = path
        self._packed = packed  # the file: how far it was read is held against what came out of it
        self._count = 0

    def read(self, limit: int = -1) -> bytes:
        """Return the next `limit` bytes, or all that are left.

        Raises
        ------
        FileFormatError
            More comes out than a log may hold.
        """
        parts: list[bytes] = []
        wanted = limit
        while wanted:
            part = self._stream.read(_BLOCK if wanted < 0 else min(wanted, _BLOCK))
            if not part:
                break
            self._count += len(part)
            if self._count > DECOMPRESSED_BYTES:
                raise _too_large(self._path, "MB", DECOMPRESSED_BYTES >> 20)
            if self._count > max(RATIO_FROM, COMPRESSION_RATIO * self._packed.tell()):
                raise _too_large(self._path, "times its size", COMPRESSION_RATIO)
            parts.append(part)
            wanted -= len(part) if wanted > 0 else 0
        return parts[0] if len(parts) == 1 else b"".join(parts)

    def __enter__(self) -> LimitedStream:
        return self

    def __exit__(self, *error: object) -> None:
        self._stream.close()


def _too_large(path: Path, unit: str, limit: int) -> FileFormatError:
    message = f"the compressed file unpacks to more than {limit} {unit}, which no log does"
    return FileFormatError(message, "unpack it and look, or split the log", path=path)


def opened_zip(stream: BinaryIO, path: Path) -> zipfile.ZipFile:
    """Open an archive whose list of members is of a sane size.

    Raises
    ------
    FileFormatError
        The archive is damaged or lists too many members.
    """
    stream.seek(0, 2)
    size = stream.tell()
    stream.seek(max(0, size - _TAIL))
    if _directory_bytes(stream.read()) > DIRECTORY_BYTES:
        raise _too_many(path)
    stream.seek(0)
    try:
        archive = zipfile.ZipFile(stream)
    except Exception as error:  # zipfile lets errors of struct and of decoding through
        message = f"the compressed file is damaged or cut ({error})"
        raise FileFormatError(message, "copy it again from the logger", path=path) from error
    if len(archive.infolist()) > MEMBERS:
        raise _too_many(path)
    return archive


def _directory_bytes(tail: bytes) -> int:
    """Return the size of the list of members as the archive states it."""
    start = tail.rfind(b"PK\x05\x06")
    if start < 0 or start + _END.size > len(tail):
        return 0
    size = int(_END.unpack_from(tail, start)[5])
    start_64 = tail.rfind(b"PK\x06\x06", 0, start)
    if start_64 >= 0 and start_64 + _END_64.size <= len(tail):
        size = max(size if size != 0xFFFFFFFF else 0, int(_END_64.unpack_from(tail, start_64)[8]))
    return size


def _too_many(path: Path) -> FileFormatError:
    message = f"the archive lists more than {MEMBERS} files"
    return FileFormatError(message, "pack the log alone", path=path)


def members(archive: zipfile.ZipFile) -> list[zipfile.ZipInfo]:
    """Return the files of an archive that may be logs: no folders, no hidden files, none that leads out."""
    return [info for info in archive.infolist() if _is_candidate(info.filename)]


def _is_candidate(name: str) -> bool:
    if not name or name.endswith("/"):  # a damaged list, or a folder
        return False
    posix, windows = PurePosixPath(name), PureWindowsPath(name)
    leads_out = posix.is_absolute() or bool(windows.drive or windows.root) or ".." in windows.parts
    # what macOS and file managers leave in archives
    clutter = "__MACOSX" in posix.parts or posix.name.startswith(".") or posix.name == "Thumbs.db"
    return not leads_out and not clutter


def is_workbook(archive: zipfile.ZipFile) -> bool:
    """Return whether the archive is an Excel workbook."""
    return any(info.filename.startswith("xl/") for info in archive.infolist())


def member_stream(archive: zipfile.ZipFile, info: zipfile.ZipInfo, path: Path) -> LimitedStream:
    """Open one member.

    Parameters
    ----------
    archive, info : ZipFile, ZipInfo
        The archive and its member.
    path : Path
        The archive, for messages. What the member's own entry says of its size is not believed.

    Raises
    ------
    FileFormatError
        The member is encrypted, or packed in a way that is not read.
    """
    if info.flag_bits & _ENCRYPTED:
        message = f"{info.filename!r} in the archive is encrypted"
        raise FileFormatError(message, "unpack it with its password, and name the file", path=path)
    if info.compress_type not in _METHODS:
        message = f"{info.filename!r} in the archive is packed by method {info.compress_type}"
        raise FileFormatError(message, "pack it again as an ordinary zip (deflate)", path=path)
    try:
        stream = archive.open(info)
    except Exception as error:  # a local header that is none, or of another name
        message = f"the compressed file is damaged or cut ({error})"
        raise FileFormatError(message, "copy it again from the logger", path=path) from error
    return LimitedStream(stream, path, archive.fp)
