"""MATLAB files of objects, of lengths that cannot be, and of cells that hold themselves."""

from __future__ import annotations

import pickle
import struct
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final

import h5py
import numpy as np

from reports.hostile_input.case import SECRET, Case
from reports.hostile_input.hdf5 import F, T, Told, external_link, hdf5, zeros

HEADER: Final = b"MATLAB 5.0 MAT-file".ljust(124) + b"\x00\x01IM"
_CELL, _STRUCT, _OBJECT, _CHAR, _DOUBLE, _FUNCTION, _OPAQUE = 1, 2, 3, 4, 6, 16, 17
_BYTES, _INT32, _UINT32, _FLOAT64, _UINT8 = 1, 5, 6, 9, 2


def element(kind: int, data: bytes) -> bytes:
    return struct.pack("<II", kind, len(data)) + data + bytes(-len(data) % 8)


def array(name: bytes, kind: int, content: bytes, sides: tuple[int, ...] = (50, 1)) -> bytes:
    head = element(_UINT32, struct.pack("<II", kind, 0)) + element(
        _INT32, struct.pack(f"<{len(sides)}i", *sides)
    )
    return element(14, head + element(_BYTES, name) + content)


def doubles(name: bytes, values: np.ndarray) -> bytes:
    return array(name, _DOUBLE, element(_FLOAT64, values.tobytes()))


def packed(data: bytes) -> bytes:
    small = zlib.compress(data, 9)
    return struct.pack("<II", 15, len(small)) + small


def level_5(*variables: bytes) -> Callable[[Path], object]:
    return lambda path: path.write_bytes(HEADER + b"".join(variables))


def of_class(kind: int, word: bytes) -> bytes:
    """Return an object of a MATLAB class, whose content is a pickle."""
    blob = array(b"", 9, element(_UINT8, pickle.dumps(Told())), (len(pickle.dumps(Told())), 1))
    if kind == _OPAQUE:
        texts = element(_BYTES, b"x") + element(_BYTES, b"MCOS") + element(_BYTES, word)
        return element(14, element(_UINT32, struct.pack("<II", _OPAQUE, 0)) + texts + blob)
    return array(b"x", kind, element(_BYTES, word) + blob, (1, 1))


def nested(kind: int, levels: int) -> bytes:
    inner = doubles(b"", F)
    for _ in range(levels):
        fields = element(_INT32, struct.pack("<i", 8)) + element(_BYTES, b"f".ljust(8, b"\0"))
        inner = array(b"x", kind, (fields if kind == _STRUCT else b"") + inner, (1, 1))
    return inner


def bomb(size: int, name: bytes) -> bytes:
    return packed(array(name, _DOUBLE, element(_FLOAT64, bytes(size)), (size // 8, 1)))


def level_73(fill: Callable[[h5py.File], object]) -> Callable[[Path], None]:
    inner = hdf5(fill, block=512)

    def make(path: Path) -> None:
        inner(path)
        with path.open("r+b") as file:
            file.write(b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM")

    return make


def cells_in_a_ring(file: h5py.File) -> None:
    file["F"] = F
    ring = file.create_dataset("#refs#/a", (3, 1), h5py.ref_dtype)
    ring.attrs["MATLAB_class"] = np.bytes_("cell")
    ring[:] = [[ring.ref]] * 3
    file["ring"] = ring


def cells_of_many(file: h5py.File) -> None:
    """Add cells of cells that each list the same ten: 10^32 ways."""
    file["F"] = F
    below = file["F"]
    for level in range(31):
        data = file.create_dataset(f"#refs#/{level}", (10, 1), h5py.ref_dtype)
        data.attrs["MATLAB_class"] = np.bytes_("cell")
        data[:] = [[below.ref]] * 10
        below = data
    file["many"] = below


def object_73(file: h5py.File) -> None:
    file["F"] = F
    for name, kind in (("handle", "function_handle"), ("table", "table")):
        file[name] = np.frombuffer(pickle.dumps(Told()), np.uint8)
        file[name].attrs["MATLAB_class"] = np.bytes_(kind)
        file[name].attrs["MATLAB_object_decode"] = np.int32(3)


def empty_73(file: h5py.File) -> None:
    file["F"] = F
    file["none"] = np.array([2**62, 2**62], np.uint64)
    file["none"].attrs["MATLAB_empty"] = np.uint8(1)


def _case(name: str, attack: str, make: Callable[[Path], object], said: str, **keys: Any) -> Case:
    return Case("MATLAB", name, attack, "log.mat", make, said, never=str(SECRET)[:6], **keys)


SOUND: Final = doubles(b"t", T) + doubles(b"F", F)
_HUGE: Final = (2**31 - 1, 2**31 - 1)
READ: Final = '"name": "F"'
CASES: Final = (
    _case("an object", "makes it", level_5(SOUND, of_class(_OBJECT, b"inline")), READ, refused=False),
    _case(
        "a function handle", "makes it", level_5(SOUND, of_class(_FUNCTION, b"@system")), READ, refused=False
    ),
    _case("a table object", "makes it", level_5(SOUND, of_class(_OPAQUE, b"table")), READ, refused=False),
    _case(
        "objects alone", "makes them", level_5(of_class(_OPAQUE, b"timetable")), "'x' is a MATLAB timetable"
    ),
    _case("cells in 1,000 cells", "the stack", level_5(nested(_CELL, 1000)), "more than 32 levels"),
    _case("structs in 1,000 structs", "the stack", level_5(nested(_STRUCT, 1000)), "more than 32 levels"),
    _case(
        "2^62 values declared",
        "memory",
        level_5(array(b"F", _DOUBLE, element(_FLOAT64, bytes(8)), _HUGE)),
        "declares 2147483647x2147483647",
    ),
    _case(
        "2^62 cells declared", "memory", level_5(array(b"F", _CELL, b"", _HUGE)), "an element begins 0 bytes"
    ),
    _case(
        "2^62 letters declared",
        "memory",
        level_5(SOUND, array(b"F2", _CHAR, element(_UINT8, b"a"), _HUGE)),
        READ,
        refused=False,
    ),
    _case(
        "an element of 4 GB",
        "memory",
        level_5(struct.pack("<II", 14, 2**32 - 1)),
        "declares 4294967295 bytes",
    ),
    _case(
        "10^9 zeros packed in 1 MB",
        "memory",
        lambda path: path.write_bytes(HEADER + _large_bomb()),
        "unpacks to more than a log of its size",
        slow=True,
    ),
    _case(
        "a bomb in many variables",
        "memory",
        level_5(*(bomb(8_000_000, b"F%d" % number) for number in range(40))),
        "unpacks to more than a log of its",
        slow=True,
    ),
    _case("packed twice", "memory", level_5(packed(packed(doubles(b"F", F)))), "a variable is of type 15"),
    _case("7.3: a link into another file", "reads another file", level_73(external_link), "is a link"),
    _case(
        "7.3: 9e7 zeros",
        "memory",
        level_73(zeros(90_000_000, 45_000_000, times=2)),
        "unpacks to more",
        slow=True,
    ),
    _case("7.3: cells in a ring", "never ends", level_73(cells_in_a_ring), "more than 32 levels"),
    _case("7.3: 10^31 cells", "never ends", level_73(cells_of_many), READ, refused=False),
    _case("7.3: objects", "makes them", level_73(object_73), READ, refused=False),
    _case("7.3: an empty array of 2^124", "memory", level_73(empty_73), READ, refused=False),
)


def _large_bomb() -> bytes:
    """Return 10^9 zeros as one packed variable, made in pieces."""
    machine = zlib.compressobj(9)
    inner = element(_UINT32, struct.pack("<II", _DOUBLE, 0)) + element(
        _INT32, struct.pack("<2i", 125_000_000, 1)
    )
    inner += element(_BYTES, b"F") + struct.pack("<II", _FLOAT64, 10**9)
    parts = [machine.compress(struct.pack("<II", 14, len(inner) + 10**9) + inner)]
    parts += [machine.compress(bytes(10**7)) for _ in range(100)] + [machine.flush()]
    data = b"".join(parts)
    return struct.pack("<II", 15, len(data)) + data
