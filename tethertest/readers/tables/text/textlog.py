"""A text log of any size, handed out in blocks of whole rows: decompressed, as UTF-8, nothing kept."""

from __future__ import annotations

import codecs
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO, Final, TypeAlias

from tethertest.errors import FileFormatError
from tethertest.readers.guards.limits import LAYOUT_BYTES, LINE_BYTES
from tethertest.readers.tables.text.document import HEAD_BYTES, decode, nul_bytes, opened, read_bytes
from tethertest.readers.tables.text.encoding import detect_encoding, encoding_of_blocks

#: called with the bytes of the file that were read, and all of them
Progress: TypeAlias = Callable[[int, int], None]

#: a block is large beside the cost of handling it and small beside the columns of a large log
BLOCK_BYTES: Final = 2**21
#: enough of the rows before an unfinished last row to tell whether its last number is cut
_BEFORE: Final = 2**18
#: the last row is looked for in so many bytes first
_TAIL: Final = 2**14
_MARK: Final = codecs.BOM_UTF8


@dataclass(frozen=True, slots=True, eq=False)
class TextBlock:
    """Whole rows of a text log, one after the other."""

    text: bytes | bytearray  #: UTF-8; its first `size` bytes are the rows, each ended by a line feed
    size: int
    encoding: str  #: of the file, as far as it was read
    last: bool  #: the file ends here, but for blank rows
    newline_at_end: bool  #: False where the last row of the file has no line end
    before: bytes  #: end of the rows before, where the last row has no line end


@dataclass(frozen=True, slots=True)
class TextLog:
    """A text log on disk."""

    path: Path
    encoding: str  #: asked for, or what the beginning shows
    asked: bool  #: the encoding was asked for
    bare_returns: bool  #: lines end with a carriage return alone

    def lines(self, count: int) -> list[str]:
        """Return the first `count` lines, fewer where they are long."""
        text = bytearray()
        for block in self.blocks():
            text += block.text[: block.size]
            if text.count(b"\n") >= count or len(text) > LAYOUT_BYTES:
                break
        lines = text.replace(b"\r\n", b"\n").removesuffix(b"\n").split(b"\n", count)
        return [line.decode() for line in lines[:count]]

    def bodies(self) -> Iterator[bytes]:
        """Yield the text from its start in pieces of whole rows."""
        for block in self.blocks():
            yield bytes(block.text[: block.size])

    def blocks(
        self, first_line: int = 1, blank: bytes = b" \r\n", progress: Progress | None = None
    ) -> Iterator[TextBlock]:
        """Yield the rows from a line on.

        Parameters
        ----------
        first_line : int
            Counted from 1.
        blank : bytes
            Characters of rows that are left out at the end of the file.
        progress : callable, optional
            Told the bytes of the file read so far, and all of them.

        Raises
        ------
        FileFormatError
            The file is damaged, holds NUL bytes, or bytes that do not belong to its encoding.
        """
        skip = first_line - 1
        total = self.path.stat().st_size
        with opened(self.path) as (stream, file):
            source = _Utf8(self, stream)
            carry = before = b""
            while True:
                if len(carry) > LINE_BYTES:  # each further block would be searched and copied with it
                    message = (
                        f"found a line or blank lines of more than {LINE_BYTES >> 20} MB, which no log has"
                    )
                    raise FileFormatError(
                        message, "cut that part out, or export the log again", path=self.path
                    )
                text = source.read(carry)
                if progress is not None:
                    progress(file.tell(), total)
                final = len(text) == len(carry)
                if final:
                    break
                begin = 0
                while skip and begin >= 0:
                    end = text.find(b"\n", begin)
                    skip, begin = (skip - 1, end + 1) if end >= 0 else (skip, -1)
                if begin < 0:
                    carry = bytes(text[text.rfind(b"\n") + 1 :])
                    continue
                if begin:
                    text = text[begin:]
                cut = _whole_rows(text, blank)
                carry = bytes(text[cut:])
                if cut:
                    yield TextBlock(text, cut, source.encoding, False, True, b"")
                    before = (before + bytes(text[max(0, cut - _BEFORE) : cut]))[-_BEFORE:]
            if skip:
                carry = b""
            end = len(carry.rstrip(blank))
            stop = carry.find(b"\n", end)
            text = carry[: stop + 1] if stop >= 0 else carry + b"\n"
            yield TextBlock(text, len(text) if end else 0, source.encoding, True, stop >= 0, before)


def open_text(path: Path, encoding: str | None = None) -> TextLog:
    """Look at the beginning of a text log.

    Raises
    ------
    FileFormatError
        The file is missing, empty, binary, or not in the encoding asked for.
    """
    data = read_bytes(path, HEAD_BYTES)
    complete = len(data) < HEAD_BYTES
    found = encoding or detect_encoding(data, complete=complete)
    if found is None:
        position = data.find(b"\0")
        if position >= 0:
            raise nul_bytes(path, data.count(b"\n", 0, position) + 1)
        message = "found control bytes in a text log: the file is binary"
        raise FileFormatError(message, "export it from the logger as text", path=path)
    text = decode(path, data, found, errors="replace")
    return TextLog(path, found, encoding is not None, "\n" not in text and "\r" in text)


def _whole_rows(text: bytes | bytearray, blank: bytes) -> int:
    """Return where the last row that is not blank begins: it and what follows may be the end of the file."""
    end = len(text)
    size = _TAIL
    while True:
        tail = bytes(text[max(0, end - size) : end])
        filled = len(tail.rstrip(blank))
        begin = tail.rfind(b"\n", 0, filled) + 1
        if (filled and begin) or len(tail) == end:
            return end - len(tail) + begin if filled else 0
        size *= 8


class _Utf8:
    """Read a log as UTF-8 with the state that lies between two reads."""

    def __init__(self, log: TextLog, stream: BinaryIO) -> None:
        self.encoding = log.encoding
        self._log = log
        self._stream: Any = stream
        self._decoder: codecs.IncrementalDecoder | None = None
        self._offset = 0  # bytes handed out before
        if log.asked or log.encoding not in {"ascii", "utf-8", "utf-8-sig"}:
            self._decoder = codecs.getincrementaldecoder(log.encoding)()

    def read(self, carry: bytes) -> bytes | bytearray:
        """Return `carry` and the text behind it; nothing follows at the end of the file."""
        text, size = self._next(carry)
        while size and len(text) == len(carry):  # a mark, or half a character
            text, size = self._next(carry)
        return text

    def _next(self, carry: bytes) -> tuple[bytes | bytearray, int]:
        """Read one block; return `carry` and its text, and the bytes that it had."""
        filled = bytearray(len(carry) + BLOCK_BYTES)
        size = self._fill(filled, len(carry))
        filled[: len(carry)] = carry
        del filled[len(carry) + size :]
        text: bytes | bytearray = filled
        if self._decoder is None and not text.isascii():
            self._settle(filled, len(carry))
        if self._decoder is not None:
            text = carry + self._decoded(bytes(text[len(carry) :]))
        if self._offset == 0 and text.startswith(_MARK):
            text = text[len(_MARK) :]
        nul = text.find(b"\0", len(carry))
        if nul >= 0:
            raise nul_bytes(self._log.path, self._line(self._offset) + text.count(b"\n", len(carry), nul))
        self._offset += size
        return text.replace(b"\r", b"\n") if self._log.bare_returns else text, size

    def _fill(self, text: bytearray, begin: int) -> int:
        with memoryview(text) as view:
            done = begin
            while done < len(view):
                if hasattr(self._stream, "readinto"):
                    count = self._stream.readinto(view[done:])
                else:
                    part = self._stream.read(len(view) - done)
                    count = len(part)
                    view[done : done + count] = part
                if not count:
                    break
                done += count
        return done - begin

    def _settle(self, text: bytearray, carried: int) -> None:
        """Choose the encoding at the first byte that is not ASCII."""
        if text[carried:].isascii():  # the row carried over was looked at before
            return
        if self.encoding == "ascii":
            with opened(self._log.path) as (stream, _):
                self.encoding = encoding_of_blocks(iter(lambda: stream.read(BLOCK_BYTES), b""))
        self._decoder = codecs.getincrementaldecoder(self.encoding)()

    def _decoded(self, data: bytes) -> bytes:
        assert self._decoder is not None
        pending = len(self._decoder.getstate()[0])
        try:
            return self._decoder.decode(data, final=not data).encode()
        except UnicodeDecodeError as error:
            place = self._offset - pending + error.start
            byte = error.object[error.start]
            message = f"byte 0x{byte:02x} does not belong to the encoding {self.encoding}"
            remedy = "set encoding in run.toml to the one the logger used"
            line = self._line(place)
            raise FileFormatError(message, remedy, path=self._log.path, line=line) from error
        except UnicodeError as error:  # codecs that are not for text, such as idna
            message = f"encoding {self.encoding!r} is none of a log ({error})"
            remedy = "use utf-8, utf-16, cp1252 or gb18030"
            raise FileFormatError(message, remedy, path=self._log.path) from error

    def _line(self, offset: int) -> int:
        """Return the line of a byte of the decompressed file, from 1."""
        line = 1
        with opened(self._log.path) as (stream, _):
            while offset > 0 and (part := stream.read(min(offset, BLOCK_BYTES))):
                line += part.count(b"\n")
                offset -= len(part)
        return line
