"""Bytes of a log and its text: through gzip and zip, in any encoding, with line numbers that stay true."""

from __future__ import annotations

import gzip
import zipfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO, Final, cast

from tethertest.errors import FileFormatError
from tethertest.readers.guards.zips import (
    ZIP_MAGIC,
    LimitedStream,
    is_workbook,
    member_stream,
    members,
    opened_zip,
)
from tethertest.readers.tables.text.encoding import decodes, detect_encoding

#: enough to pass a header of more than a hundred long lines
HEAD_BYTES: Final = 65536


@dataclass(frozen=True, slots=True)
class Head:
    """The beginning of a file, as every reader is shown it."""

    path: Path
    data: bytes  #: first bytes, decompressed
    lines: tuple[str, ...]  #: decoded lines without line ends, empty for a binary file
    encoding: str | None  #: None for a binary file
    complete: bool  #: the whole file is here


@dataclass(frozen=True, slots=True)
class Document:
    """A whole text log in one form: UTF-8, line ends of one byte, no byte-order mark."""

    path: Path
    body: bytes
    encoding: str  #: as the file had it

    def lines(self, count: int) -> list[str]:
        """Return the first `count` lines."""
        return [line.decode() for line in self.body.split(b"\n", count)[:count]]

    def bodies(self) -> Iterator[bytes]:
        """Yield the text, whole."""
        yield self.body

    def from_line(self, number: int) -> bytes:
        """Return the text from a line on, counted from 1."""
        start = 0
        for _ in range(number - 1):
            start = self.body.find(b"\n", start) + 1
            if start == 0:
                return b""
        return self.body[start:]


def read_head(path: Path, encoding: str | None = None) -> Head:
    """Read the beginning of a file.

    Raises
    ------
    FileFormatError
        The file is missing, empty, a folder, damaged or not in the encoding asked for.
    """
    data = read_bytes(path, HEAD_BYTES)
    complete = len(data) < HEAD_BYTES
    found = encoding or detect_encoding(data, complete=complete)
    lines: tuple[str, ...] = ()
    if found is not None:
        text = decode(path, data, found, errors="replace")
        lines = tuple(_one_line_end(text).split("\n"))
        if not complete and len(lines) > 1:
            lines = lines[:-1]
    return Head(path, data, lines, found, complete)


def read_document(path: Path, encoding: str | None = None) -> Document:
    """Read a whole text log.

    Raises
    ------
    FileFormatError
        The file is missing, empty, damaged, no text, not in the encoding asked for, or holds NUL bytes.
    """
    data = read_bytes(path)
    found = encoding or detect_encoding(data)
    if found is None:
        position = data.find(b"\0")
        if position >= 0:
            raise nul_bytes(path, data.count(b"\n", 0, position) + 1)
        message = "found control bytes in a text log: the file is binary"
        raise FileFormatError(message, "export it from the logger as text", path=path)
    if (found == "ascii" and data.isascii()) or (found in {"utf-8", "utf-8-sig"} and decodes(data, "utf-8")):
        body = data.removeprefix(b"\xef\xbb\xbf").replace(b"\r\n", b"\n")
    else:
        body = decode(path, data, found).replace("\r\n", "\n").encode()
    if b"\n" not in body:
        body = body.replace(b"\r", b"\n")
    nul = body.find(b"\0")
    if nul >= 0:
        raise nul_bytes(path, body.count(b"\n", 0, nul) + 1)
    return Document(path, body, found)


def nul_bytes(path: Path, line: int) -> FileFormatError:
    """Return the error of a text log with NUL bytes, which a power cut leaves behind."""
    message = "found NUL bytes in a text log: the logger stopped while it wrote"
    return FileFormatError(message, "export the log again from the logger", path=path, line=line)


@contextmanager
def opened(path: Path) -> Iterator[tuple[BinaryIO, BinaryIO]]:
    """Open a log to be read from its start, decompressed; yield that stream and the file's own.

    Raises
    ------
    FileFormatError
        The file is missing, a folder, a device, unreadable, or its compression is damaged, now or later.
    """
    if path.is_dir():
        message = "found a folder, expected a log file"
        raise FileFormatError(message, "name one of the files in it", path=path)
    try:
        if path.exists() and not path.is_file():  # it can be read once, or never ends
            message = "found a pipe or a device, expected a file"
            raise FileFormatError(message, "save the log as a file and name that", path=path)
        with path.open("rb") as file, _decompressed(path, file) as stream:
            yield stream, file
    except FileNotFoundError as error:
        message = "the log does not exist"
        raise FileFormatError(message, "correct the file name or copy the log here", path=path) from error
    except (EOFError, zlib.error, gzip.BadGzipFile, zipfile.BadZipFile) as error:
        message = f"the compressed file is damaged or cut ({error})"
        raise FileFormatError(message, "copy it again from the logger", path=path) from error
    except OSError as error:
        message = f"the log cannot be read ({error.strerror})"
        raise FileFormatError(message, "check its permissions and the disk", path=path) from error


def read_bytes(path: Path, limit: int = -1) -> bytes:
    """Return the first `limit` decompressed bytes of a file, or all of them.

    Raises
    ------
    FileFormatError
        The file is missing, empty, a folder, unreadable, or its compression is damaged.
    """
    with opened(path) as (stream, _):
        data = stream.read(limit)
    if not data.strip():
        message = "the log is empty"
        raise FileFormatError(message, "copy it again from the logger", path=path)
    return data


def _decompressed(path: Path, stream: BinaryIO) -> BinaryIO:
    """Return the log inside a gzip file or a zip archive of one; any other file as it is."""
    magic = stream.read(4)
    stream.seek(0)
    if magic.startswith(b"\x1f\x8b"):
        return cast("BinaryIO", LimitedStream(gzip.GzipFile(fileobj=stream), path, stream))
    if magic != ZIP_MAGIC:
        return stream
    archive = opened_zip(stream, path)
    found = members(archive)
    if len(found) != 1 or is_workbook(archive):  # other readers choose among the members
        stream.seek(0)
        return stream
    return cast("BinaryIO", member_stream(archive, found[0], path))


def decode(path: Path, data: bytes, encoding: str, errors: str = "strict") -> str:
    """Return the text without its byte-order mark.

    Raises
    ------
    FileFormatError
        The encoding is unknown or none of a log, or bytes do not belong to it.
    """
    try:
        return data.decode(encoding, errors).removeprefix("\ufeff")
    except LookupError as error:
        message = f"encoding {encoding!r} is not known"
        raise FileFormatError(message, "use utf-8, utf-16, cp1252 or gb18030", path=path) from error
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        message = f"byte 0x{data[error.start]:02x} does not belong to the encoding {encoding}"
        remedy = "set encoding in run.toml to the one the logger used"
        raise FileFormatError(message, remedy, path=path, line=line) from error
    except UnicodeError as error:  # codecs that are not for text, such as idna
        message = f"encoding {encoding!r} is none of a log ({error})"
        raise FileFormatError(message, "use utf-8, utf-16, cp1252 or gb18030", path=path) from error


def _one_line_end(text: str) -> str:
    text = text.replace("\r\n", "\n")
    return text if "\n" in text else text.replace("\r", "\n")
