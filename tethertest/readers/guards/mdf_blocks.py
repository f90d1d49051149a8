"""Blocks of an ASAM MDF file, checked before a library follows them: places, lengths, lists and counts.

Layout after ASAM MDF 4.1 (blocks of 64-bit links) and 3.3 (blocks of 32-bit links). A list that leads back
to itself never ends, and a count of records that the data do not bear out asks for any memory.
"""

from __future__ import annotations

import struct
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from tethertest.errors import FileFormatError
from tethertest.readers.guards.limits import (
    CELLS,
    COMPRESSION_RATIO,
    DECOMPRESSED_BYTES,
    OBJECTS,
    RATIO_FROM,
)

_HEAD = struct.Struct("<4s4xQQ")
_GROUP = struct.Struct("<QQHH4xII")
_CHANNEL = struct.Struct("<BxBBII")
_PACKED = struct.Struct("<2sBxIQQ")
_FIRST: Final = 64
#: bytes of a group of channels in version 3.1, the smallest block that is read here but for a group of data
_SMALLEST: Final = 26
#: links by which a block of a kind is reached as a member of a list or a tree; all others may repeat
_LISTED: Final = {
    b"##HD": range(5), b"##DG": range(2), b"##CG": range(2), b"##CN": range(2), b"##CA": range(1),
    b"##FH": range(1), b"##AT": range(1), b"##EV": range(1), b"##CH": range(2), b"##DL": range(1),
    b"##LD": range(1), b"##HL": range(1),
}  # fmt: skip
#: links that a block has at least; asammdf looks for what follows them at a fixed place
_LINKS: Final = {b"##HD": 6, b"##DG": 4, b"##CG": 6, b"##CN": 8, b"##CC": 4, b"##SI": 3, b"##DL": 1}
#: what the first link of a kind leads to; asammdf reads on there without a look at the kind
_NEXT: Final = {b"##HD": b"##DG", b"##DG": b"##DG", b"##CG": b"##CG", b"##CN": b"##CN"}
_PLAIN_DATA: Final = {b"##DT", b"##DV", b"##DI", b"##SD", b"##RD", b"##RV", b"##RI"}
#: a group whose records have a length each
_IS_VARIABLE: Final = 1
#: types of channels that are computed from the number of the record, and take no bits of it
VIRTUAL: Final = {3, 6}
#: data types of floating-point numbers, in either order of their bytes
_FLOATS: Final = {4, 5}
#: the same in version 3
_FLOATS_3: Final = {2, 3, 11, 12, 15, 16}
#: bytes of a channel in version 3, without and with the bytes that its place lies farther on
_CHANNEL_3: Final = 218
_CHANNEL_3_FAR: Final = 228
#: declarations that make an XML text grow without end
_DECLARATIONS: Final = (b"<!DOCTYPE", b"<!ENTITY")


@dataclass(frozen=True, slots=True)
class _Block:
    kind: bytes
    links: tuple[int, ...]
    start: int  #: of its data
    end: int


def check_level_4(path: Path, data: bytes) -> None:
    """Check the blocks of an MDF file of version 4.

    Raises
    ------
    FileFormatError
        A block lies outside the file, a list leads back to itself, the records are not as many as the data,
        or they are more than a log may hold.
    """
    blocks = _blocks(path, data)
    unpacked = sum(
        _data_size(path, data, blocks, block) for block in blocks.values() if block.kind == b"##DZ"
    )
    if unpacked > min(DECOMPRESSED_BYTES, max(RATIO_FROM, COMPRESSION_RATIO * len(data))):
        message = "the MDF file unpacks to more than a log of its size holds"
        raise FileFormatError(message, "export the channels of the log alone", path=path)
    groups = [block for block in blocks.values() if block.kind == b"##DG"]
    cells = sum(_check_group(path, data, blocks, group) for group in groups)
    _check_cells(path, cells)


def _blocks(path: Path, data: bytes) -> dict[int, _Block]:
    """Return every block that the first one leads to, by its place."""
    found: dict[int, _Block] = {}
    reached: Counter[int] = Counter()
    waiting = [_FIRST]
    while waiting:
        place = waiting.pop()
        if place in found or place == 0:
            continue
        block = _block(path, data, place)
        found[place] = block
        if len(found) > OBJECTS:
            message = f"the MDF file holds more than {OBJECTS} blocks"
            raise FileFormatError(message, "export the channels of the log alone", path=path)
        for number in _LISTED.get(block.kind, ()):
            reached[block.links[number] if number < len(block.links) else 0] += 1
        waiting += block.links
    for place, block in found.items():
        after = found.get(block.links[0]) if block.kind in _NEXT else None
        if after is not None and after.kind != _NEXT[block.kind]:
            raise _damaged(path, f"the block after that at byte {place} is of the kind {after.kind!r}")
    reached.pop(0, None)
    if any(count > 1 for count in reached.values()):
        raise _damaged(path, "a list of its blocks leads back to itself")
    return found


def _block(path: Path, data: bytes, place: int) -> _Block:
    if place < 0 or place + _HEAD.size > len(data):
        raise _damaged(path, f"a block lies at byte {place} of {len(data)}")
    kind, length, count = _HEAD.unpack_from(data, place)
    start = place + _HEAD.size + 8 * count
    if not kind.startswith(b"##") or start > place + length or place + length > len(data):
        raise _damaged(path, f"the block at byte {place} of {len(data)} declares {length} bytes")
    if place == _FIRST and kind != b"##HD":
        raise _damaged(path, "it does not begin with a header block")
    links = struct.unpack_from(f"<{count}Q", data, place + _HEAD.size)
    if count < _LINKS.get(kind, 0):
        raise _damaged(path, f"the block {kind.decode()} at byte {place} has {count} links")
    if kind == b"##MD" and any(mark in data[start : place + length].upper() for mark in _DECLARATIONS):
        raise _damaged(path, "a comment declares XML entities, which no log needs")
    return _Block(kind, links, start, place + length)


def _check_group(path: Path, data: bytes, blocks: dict[int, _Block], group: _Block) -> int:
    """Compare the records that the groups of channels declare with the data; return the count of cells."""
    if group.end == group.start:
        raise _damaged(path, "a group of data has no identifier")
    identifier = data[group.start]
    declared, cells, is_exact = 0, 0, True
    for channels in _chain(blocks, group.links[1]):
        if channels.kind != b"##CG" or channels.end - channels.start < _GROUP.size:
            raise _damaged(path, "a group of channels is none")
        _, cycles, flags, _, size, invalid = _GROUP.unpack_from(data, channels.start)
        if flags & _IS_VARIABLE:
            declared += cycles * (identifier + 4)
            is_exact = False
        else:
            declared += cycles * (identifier + size + invalid)
            listed = list(_chain(blocks, channels.links[1]))
            cells += cycles * len(listed)
            for channel in listed:
                _check_channel(path, data, channel, size)
    here = _data_size(path, data, blocks, blocks.get(group.links[2]))
    if declared > here or (is_exact and declared != here):
        problem = f"a group declares records of {declared} bytes and holds {here}: it is cut or not finalised"
        raise _damaged(path, problem)
    return cells


def _check_channel(path: Path, data: bytes, channel: _Block, size: int) -> None:
    """Refuse a channel that lies outside of its record."""
    if channel.kind != b"##CN" or channel.end - channel.start < _CHANNEL.size:
        raise _damaged(path, "a channel is none")
    kind, form, bit, byte, bits = _CHANNEL.unpack_from(data, channel.start)
    if form in _FLOATS and bits not in {16, 32, 64}:
        raise _damaged(path, f"a channel holds floating-point numbers of {bits} bits")
    if kind not in VIRTUAL and byte + -(-(bit + bits) // 8) > size:
        raise _damaged(path, f"a channel lies at byte {byte} of a record of {size}")


def _chain(blocks: dict[int, _Block], place: int) -> Iterator[_Block]:
    """Yield the blocks of a list that is known to end."""
    while place in blocks:
        yield blocks[place]
        place = blocks[place].links[0] if blocks[place].links else 0


def _data_size(path: Path, data: bytes, blocks: dict[int, _Block], block: _Block | None) -> int:
    """Return the unpacked bytes of a block of data, or of a list of them."""
    if block is None:
        return 0
    if block.kind in _PLAIN_DATA:
        return block.end - block.start
    if block.kind == b"##DZ":
        if block.end - block.start < _PACKED.size:
            raise _damaged(path, "a packed block has no header")
        _, method, width, size, packed = _PACKED.unpack_from(data, block.start)
        if method % 2 and not width:  # asammdf's compiled part would divide by it
            raise _damaged(path, "a packed block is turned by columns of no width")
        if packed > block.end - block.start - _PACKED.size:
            raise _damaged(path, f"a packed block declares {packed} bytes and is cut")
        return int(size)
    if block.kind == b"##HL":
        return _data_size(path, data, blocks, blocks.get(block.links[0]) if block.links else None)
    if block.kind not in {b"##DL", b"##LD"}:
        raise _damaged(path, f"data lie in a block of the kind {block.kind!r}")
    total = 0
    for part in _chain(blocks, _place_of(blocks, block)):
        for link in part.links[1:]:
            inner = blocks.get(link)
            if inner is not None and inner.kind not in {*_PLAIN_DATA, b"##DZ"}:
                raise _damaged(path, f"a list of data holds a block of the kind {inner.kind!r}")
            total += _data_size(path, data, blocks, inner)
    return total


def _place_of(blocks: dict[int, _Block], wanted: _Block) -> int:
    return next(place for place, block in blocks.items() if block is wanted)


def check_level_3(path: Path, data: bytes) -> None:
    """Check the lists and the counts of records of an MDF file of version 3.

    Raises
    ------
    FileFormatError
        As `check_level_4`.
    """
    order = "<" if data[24:26] == b"\0\0" else ">"
    lists = _Lists(path, data, order)
    cells = 0
    if data[_FIRST : _FIRST + 2] != b"HD" or len(data) < _FIRST + 8:
        raise _damaged(path, "it does not begin with a header block")
    for place in lists.chain(lists.link(_FIRST, 0), b"DG"):
        (identifier,) = struct.unpack_from(f"{order}H", data, place + 22)
        start, size = lists.link(place, 3), 0
        for group in lists.chain(lists.link(place, 1), b"CG"):
            _, count, width, cycles = struct.unpack_from(f"{order}3HI", data, group + 16)
            found = 0
            for channel in lists.chain(lists.link(group, 1), b"CN"):
                lists.check_channel(channel, width)
                found += 1
            if found != count:
                raise _damaged(path, f"a group declares {count} channels and lists {found}")
            size += cycles * (width + identifier)
            cells += cycles * count
        if size and (start < _FIRST or start + size > len(data)):
            raise _damaged(path, f"a group declares records of {size} bytes, which the file does not hold")
    _check_cells(path, cells)


class _Lists:
    """Lists of blocks of version 3: a kind of two letters, a length, and 32-bit links, the next one first."""

    def __init__(self, path: Path, data: bytes, order: str) -> None:
        self.path = path
        self.data = data
        self.order = order
        self.seen: set[int] = set()

    def link(self, place: int, number: int) -> int:
        """Return a link of a block."""
        (found,) = struct.unpack_from(f"{self.order}I", self.data, place + 4 + 4 * number)
        return int(found)

    def chain(self, place: int, kind: bytes) -> Iterator[int]:
        """Yield the places of the blocks of a list."""
        while place:
            if place in self.seen or len(self.seen) > OBJECTS:
                raise _damaged(self.path, "a list of its blocks leads back to itself")
            self.seen.add(place)
            if place + _SMALLEST > len(self.data) or self.data[place : place + 2] != kind:
                raise _damaged(self.path, f"no block {kind.decode()} lies at byte {place}")
            (length,) = struct.unpack_from(f"{self.order}H", self.data, place + 2)
            if length < _SMALLEST - 2 or place + length > len(self.data):
                raise _damaged(self.path, f"the block at byte {place} declares {length} bytes")
            yield place
            place = self.link(place, 0)

    def check_channel(self, place: int, width: int) -> None:
        """Refuse a channel that lies outside of its record."""
        (length,) = struct.unpack_from(f"{self.order}H", self.data, place + 2)
        if length < _CHANNEL_3:
            raise _damaged(self.path, f"the channel at byte {place} declares {length} bytes")
        bit, bits, form = struct.unpack_from(f"{self.order}3H", self.data, place + 186)
        byte = 0
        if length >= _CHANNEL_3_FAR:
            (byte,) = struct.unpack_from(f"{self.order}H", self.data, place + 226)
        if form in _FLOATS_3 and bits not in {32, 64}:
            raise _damaged(self.path, f"a channel holds floating-point numbers of {bits} bits")
        if byte + -(-(bit + bits) // 8) > width:
            raise _damaged(
                self.path, f"a channel ends at bit {8 * byte + bit + bits} of a record of {8 * width}"
            )


def _check_cells(path: Path, cells: int) -> None:
    if cells > CELLS:
        message = f"the MDF file declares {cells} values, expected at most {CELLS}"
        raise FileFormatError(message, "export the channels of the log alone", path=path)


def _damaged(path: Path, problem: str) -> FileFormatError:
    message = f"the MDF file is damaged or cut: {problem}"
    return FileFormatError(
        message, "copy the whole file again, or finalise it with the logger's tool", path=path
    )
