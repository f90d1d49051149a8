"""Variables of a MATLAB file of version 5 to 7: a length that the file states is checked before it is used.

Layout after "MAT-File Format", The MathWorks (Level 5). Objects, functions and opaque data are named and
passed over; nothing of them is made. A reader that trusts the lengths in the file can be made to ask for any
memory.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from math import prod
from pathlib import Path
from typing import Final

import numpy as np

from tethertest.errors import FileFormatError
from tethertest.readers.guards.limits import (
    COMPRESSION_RATIO,
    DECOMPRESSED_BYTES,
    DEPTH,
    OBJECTS,
    RATIO_FROM,
)
from tethertest.readers.tables.containers.matlab_tree import Array, Item, Other, Struct, cell_of
from tethertest.readers.tables.containers.table import Numbers

_HEADER: Final = 128
_NUMBERS: Final = {
    1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8",
}  # fmt: skip
_TEXTS: Final = {1: "latin-1", 2: "latin-1", 4: "utf-16", 16: "utf-8", 17: "utf-16", 18: "utf-32"}
_MATRIX, _COMPRESSED = 14, 15
_CELL, _STRUCT, _CHAR, _OPAQUE = 1, 2, 4, 17
_NUMERIC: Final = range(6, 16)
_CLASSES: Final = {3: "is an object", 5: "is a sparse matrix", 16: "is a function handle"}
_COMPLEX: Final = 0x0800
#: bytes that are unpacked at once
_PIECE: Final = 2**16
#: numpy's own limit
_DIMENSIONS: Final = 32


@dataclass(frozen=True, slots=True)
class _Element:
    """One element: its type, and the bytes of its data."""

    kind: int
    data: memoryview
    end: int  #: where the next one begins


class _DamageError(Exception):
    """A length or a type that cannot be."""


def variables(path: Path, data: bytes) -> Iterator[tuple[str, Item]]:
    """Yield name and content of every variable.

    Raises
    ------
    FileFormatError
        The file is cut or damaged, nested too deep, or unpacks to more than a log may hold.
    """
    try:
        yield from _Parser(path, data).variables()
    except (_DamageError, struct.error, zlib.error, UnicodeDecodeError) as error:
        message = f"the MATLAB file is damaged or cut ({error})"
        raise FileFormatError(message, "save it again from MATLAB", path=path) from error


class _Parser:
    def __init__(self, path: Path, data: bytes) -> None:
        self.path = path
        self.data = memoryview(data)
        mark = bytes(self.data[126:_HEADER])
        if mark not in {b"IM", b"MI"}:
            text = "its header is not whole"
            raise _DamageError(text)
        self.order = "<" if mark == b"IM" else ">"
        self.packed = 0  # bytes so far of packed variables, and of what they held
        self.unpacked = 0
        self.objects = 0

    def variables(self) -> Iterator[tuple[str, Item]]:
        position = _HEADER
        while position < len(self.data):
            element = self._element(self.data, position, is_padded=False)
            position = element.end
            if element.kind == _COMPRESSED:
                inner = self._unpacked(element.data)
                element = self._element(inner, 0, is_padded=False)
                if element.end != len(inner):
                    text = f"a variable of {element.end} bytes unpacks to {len(inner)}"
                    raise _DamageError(text)
            if element.kind != _MATRIX:
                text = f"a variable is of type {element.kind}"
                raise _DamageError(text)
            yield self._matrix(element, 0)

    def _unpacked(self, body: memoryview) -> memoryview:
        """Return what a packed variable holds; its bytes are counted against those that it came from."""
        machine = zlib.decompressobj()
        unpacked = bytearray()
        for start in range(0, len(body), _PIECE):
            part: memoryview | bytes = body[start : start + _PIECE]
            self.packed += len(part)
            limit = min(DECOMPRESSED_BYTES, max(RATIO_FROM, COMPRESSION_RATIO * self.packed))
            while part:
                unpacked += machine.decompress(part, max(limit - self.unpacked - len(unpacked), 1))
                part = machine.unconsumed_tail
                if part and self.unpacked + len(unpacked) >= limit:
                    message = "the MATLAB file unpacks to more than a log of its size holds"
                    raise FileFormatError(message, "save the channels alone", path=self.path)
        if not machine.eof:
            text = "a compressed variable is cut"
            raise _DamageError(text)
        self.unpacked += len(unpacked)
        return memoryview(unpacked)

    def _element(self, data: memoryview, position: int, *, is_padded: bool = True) -> _Element:
        if position + 8 > len(data):
            text = f"an element begins {max(len(data) - position, 0)} bytes before the end"
            raise _DamageError(text)
        kind, size = struct.unpack_from(f"{self.order}II", data, position)
        if kind >> 16:  # a small element has its data in its tag
            size, kind = kind >> 16, kind & 0xFFFF
            if size > 4:
                text = f"a small element declares {size} bytes"
                raise _DamageError(text)
            return _Element(kind, data[position + 4 : position + 4 + size], position + 8)
        start = position + 8
        if size > len(data) - start:
            text = f"an element declares {size} bytes, and {len(data) - start} are left"
            raise _DamageError(text)
        end = start + (-(-size // 8) * 8 if is_padded else size)
        return _Element(kind, data[start : start + size], end)

    def _matrix(self, element: _Element, depth: int) -> tuple[str, Item]:
        self.objects += 1
        if depth > DEPTH or self.objects > OBJECTS:
            message = f"the MATLAB file has more than {DEPTH} levels or {OBJECTS} arrays"
            raise FileFormatError(message, "save the channels alone", path=self.path)
        if element.kind != _MATRIX:
            text = f"an array is of type {element.kind}"
            raise _DamageError(text)
        body = element.data
        if not len(body):  # an empty field of a struct
            return "", Array((0, 0), lambda: np.zeros((0, 0)))
        flags = self._element(body, 0)
        (word,) = struct.unpack_from(f"{self.order}I", flags.data)
        kind = word & 0xFF
        if kind == _OPAQUE:
            return self._opaque(body, flags.end)
        sides = self._element(body, flags.end)
        shape = tuple(int(side) for side in self._numbers(sides))
        if not 2 <= len(shape) <= _DIMENSIONS or min(shape) < 0:
            text = f"an array has the sides {shape[:4]}"
            raise _DamageError(text)
        named = self._element(body, sides.end)
        name = bytes(named.data).decode("latin-1")
        if kind in _CLASSES:
            return name, Other(_CLASSES[kind])
        if kind == _STRUCT:
            return name, self._struct(body, named.end, prod(shape), depth)
        if kind == _CELL:
            return name, self._cell(body, named.end, prod(shape), depth)
        content = self._element(body, named.end)
        if kind == _CHAR:
            return name, self._text(content, shape)
        if kind not in _NUMERIC:
            text = f"an array is of class {kind}"
            raise _DamageError(text)
        if word & _COMPLEX:
            return name, Other("holds complex numbers")
        values = self._numbers(content)
        if values.size != prod(shape):
            text = f"{name!r} declares {'x'.join(map(str, shape))} values and holds {values.size}"
            raise _DamageError(text)
        return name, Array(shape, lambda: values.reshape(shape, order="F"))

    def _opaque(self, body: memoryview, position: int) -> tuple[str, Item]:
        """Return name and class of an object of a class of its own, such as a table: it has no sides."""
        texts = []
        for _ in range(3):  # name, system of types, class
            element = self._element(body, position)
            position = element.end
            texts.append(bytes(element.data).decode("latin-1"))
        return texts[0], Other(f"is a MATLAB {texts[2][:40]}")

    def _numbers(self, element: _Element) -> Numbers:
        kind = _NUMBERS.get(element.kind)
        if kind is None:
            text = f"numbers are of type {element.kind}"
            raise _DamageError(text)
        dtype = np.dtype(self.order + kind)
        if len(element.data) % dtype.itemsize:
            text = f"{len(element.data)} bytes are no whole numbers of {dtype.itemsize}"
            raise _DamageError(text)
        return np.frombuffer(element.data, dtype)

    def _text(self, element: _Element, shape: tuple[int, ...]) -> Item:
        encoding = _TEXTS.get(element.kind)
        if encoding is None or len(element.data) > 4 * prod(shape):
            text = f"a text of {prod(shape)} letters has {len(element.data)} bytes of type {element.kind}"
            raise _DamageError(text)
        if encoding in {"utf-16", "utf-32"}:
            encoding += "-le" if self.order == "<" else "-be"
        letters = bytes(element.data).decode(encoding)
        if shape[0] <= 1 or prod(shape) != len(letters):
            return letters.strip("\0 ")
        return tuple(letters[row :: shape[0]].strip("\0 ") for row in range(shape[0]))

    def _cell(self, body: memoryview, position: int, count: int, depth: int) -> Item:
        found: list[Item] = []
        for _ in range(count):  # each takes bytes of the file: a count that is too large ends as damage
            element = self._element(body, position)
            position = element.end
            found.append(self._matrix(element, depth + 1)[1])
        return cell_of(found)

    def _struct(self, body: memoryview, position: int, count: int, depth: int) -> Item:
        width_of_names = self._element(body, position)
        (width,) = struct.unpack_from(f"{self.order}i", width_of_names.data)
        listed = self._element(body, width_of_names.end)
        if width <= 0 or len(listed.data) % width:
            text = f"names of fields have {width} letters"
            raise _DamageError(text)
        letters = bytes(listed.data).decode("latin-1")
        names = [letters[start : start + width].split("\0")[0] for start in range(0, len(letters), width)]
        position = listed.end
        fields: dict[str, list[Item]] = {name: [] for name in names}
        if len(fields) < len(names):
            text = "a struct repeats a field"
            raise _DamageError(text)
        if not names:
            return Other("is a struct without fields")
        for _ in range(count):
            for name in names:
                element = self._element(body, position)
                position = element.end
                fields[name].append(self._matrix(element, depth + 1)[1])
        return Struct(count, fields)
