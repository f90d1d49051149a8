"""Damage to a log, the same for the same seed number."""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import wraps
from typing import Final, TypeAlias

import numpy as np

Bytes: TypeAlias = Callable[[bytes, np.random.Generator], bytes]
_NUMBER: Final = re.compile(rb"\d+")
_HEADER_LINES: Final = 40


def _span(data: bytes, draw: np.random.Generator, longest: int = 60) -> tuple[int, int]:
    begin = int(draw.integers(len(data)))
    return begin, min(len(data), begin + 1 + int(draw.integers(longest)))


def flip(data: bytes, draw: np.random.Generator) -> bytes:
    changed = bytearray(data)
    for _ in range(int(draw.integers(1, 4))):
        changed[int(draw.integers(len(data)))] ^= 1 << int(draw.integers(8))
    return bytes(changed)


def delete_span(data: bytes, draw: np.random.Generator) -> bytes:
    begin, end = _span(data, draw)
    return data[:begin] + data[end:]


def insert_span(data: bytes, draw: np.random.Generator) -> bytes:
    place = int(draw.integers(len(data)))
    return data[:place] + draw.bytes(int(draw.integers(1, 12))) + data[place:]


def duplicate_span(data: bytes, draw: np.random.Generator) -> bytes:
    begin, end = _span(data, draw)
    return data[:end] + data[begin:end] + data[end:]


def truncate(data: bytes, draw: np.random.Generator) -> bytes:
    return data[: int(draw.integers(1, len(data)))]


def nul_bytes(data: bytes, draw: np.random.Generator) -> bytes:
    begin, end = _span(data, draw)
    return data[:begin] + bytes(end - begin) + data[end:]


def huge_number(data: bytes, draw: np.random.Generator) -> bytes:
    """Put an absurd number in place of one in the first lines, where headers state their counts."""
    head = b"\n".join(data.split(b"\n")[:_HEADER_LINES])
    found = list(_NUMBER.finditer(head))
    if not found:
        return flip(data, draw)
    number = found[int(draw.integers(len(found)))]
    absurd = (b"999999999999", b"4294967296", b"-1", b"0", b"1e308", b"1e999", b"nan", b"9" * 400)
    return data[: number.start()] + absurd[int(draw.integers(len(absurd)))] + data[number.end() :]


def letter_for_digit(data: bytes, draw: np.random.Generator) -> bytes:
    found = [match.start() for match in re.finditer(rb"\d", data)]
    place = found[int(draw.integers(len(found)))]
    return data[:place] + b"OlExSB"[(k := int(draw.integers(6))) : k + 1] + data[place + 1 :]


def other_decimal_sign(data: bytes, draw: np.random.Generator) -> bytes:
    found = list(re.finditer(rb"(?<=\d)[.,](?=\d)", data))
    if not found:
        return flip(data, draw)
    place = found[int(draw.integers(len(found)))].start()
    return data[:place] + (b"," if data[place : place + 1] == b"." else b".") + data[place + 1 :]


def separator(data: bytes, draw: np.random.Generator) -> bytes:
    place = int(draw.integers(len(data)))
    return data[:place] + (b"\t", b",", b";", b" ", b'"', b"\n", b"\r")[int(draw.integers(7))] + data[place:]


def _by_line(change: Callable[[list[bytes], np.random.Generator], None]) -> Bytes:
    @wraps(change)
    def mutate(data: bytes, draw: np.random.Generator) -> bytes:
        lines = data.split(b"\n")
        change(lines, draw)
        return b"\n".join(lines)

    return mutate


def _line(lines: list[bytes], draw: np.random.Generator) -> int:
    """Return a line; every second one of the header, which is shorter than the rows."""
    last = min(_HEADER_LINES, len(lines)) if draw.integers(2) else len(lines)
    return int(draw.integers(last))


@_by_line
def delete_line(lines: list[bytes], draw: np.random.Generator) -> None:
    del lines[_line(lines, draw)]


@_by_line
def duplicate_line(lines: list[bytes], draw: np.random.Generator) -> None:
    lines.insert(int(draw.integers(len(lines))), lines[_line(lines, draw)])


@_by_line
def swap_lines(lines: list[bytes], draw: np.random.Generator) -> None:
    one, two = _line(lines, draw), _line(lines, draw)
    lines[one], lines[two] = lines[two], lines[one]


@_by_line
def repeat_header(lines: list[bytes], draw: np.random.Generator) -> None:
    place = int(draw.integers(len(lines)))
    lines[place:place] = lines[: int(draw.integers(1, min(_HEADER_LINES, len(lines)) + 1))]


def _by_field(change: Callable[[list[bytes], np.random.Generator], None]) -> Bytes:
    @_by_line
    @wraps(change)
    def mutate(lines: list[bytes], draw: np.random.Generator) -> None:
        number = _line(lines, draw)
        mark = next((mark for mark in (b"\t", b";", b",") if mark in lines[number]), b" ")
        fields = lines[number].split(mark)
        change(fields, draw)
        lines[number] = mark.join(fields)

    return mutate


@_by_field
def swap_fields(fields: list[bytes], draw: np.random.Generator) -> None:
    one, two = int(draw.integers(len(fields))), int(draw.integers(len(fields)))
    fields[one], fields[two] = fields[two], fields[one]


@_by_field
def delete_field(fields: list[bytes], draw: np.random.Generator) -> None:
    del fields[int(draw.integers(len(fields)))]


@_by_field
def blank_field(fields: list[bytes], draw: np.random.Generator) -> None:
    fields[int(draw.integers(len(fields)))] = b""


def reencode(data: bytes, draw: np.random.Generator) -> bytes:
    """Write the text in another encoding, one byte of it damaged every second time."""
    encoding = ("utf-16", "utf-16-be", "utf-32", "utf-8-sig", "cp1252", "gb18030")[int(draw.integers(6))]
    text = data.decode("utf-8").encode(encoding, errors="replace")
    return flip(text, draw) if draw.integers(2) else text


BINARY: Final[tuple[Bytes, ...]] = (flip, delete_span, insert_span, duplicate_span, truncate, nul_bytes)
TEXT: Final[tuple[Bytes, ...]] = (
    *BINARY, huge_number, letter_for_digit, other_decimal_sign, separator, delete_line, duplicate_line,
    swap_lines, repeat_header, swap_fields, delete_field, blank_field, reencode,
)  # fmt: skip
#: changes that mean nothing
BENIGN: Final[dict[str, Callable[[bytes], bytes]]] = {
    "CRLF": lambda data: data.replace(b"\n", b"\r\n"),
    "byte-order mark": lambda data: b"\xef\xbb\xbf" + data,
    "trailing blanks": lambda data: data.replace(b"\n", b"  \n"),
    "empty last line": lambda data: data + b"\n",
}


def mutant(data: bytes, number: int, *, text: bool) -> tuple[bytes, str]:
    """Return a damaged log and what was done to it; every fifth one is damaged twice."""
    draw = np.random.default_rng(number)
    kinds = TEXT if text else BINARY
    names: list[str] = []
    for _ in range(2 if number % 5 == 4 else 1):
        change = kinds[int(draw.integers(len(kinds)))]
        if change is reencode and names:
            continue
        names.append(getattr(change, "__name__", ""))
        data = change(data, draw) or b"\n"
    return data, " + ".join(names)
