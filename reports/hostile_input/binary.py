"""TDMS, catman, MDF and other binary logs whose headers promise more than they hold."""

from __future__ import annotations

import io
import pickle
import struct
from collections.abc import Callable
from typing import Any, Final

import numpy as np

from reports.fuzzing.seeds import catman, mdf, tdms
from reports.hostile_input.case import SECRET, Case
from reports.hostile_input.hdf5 import Told
from reports.hostile_input.packed import writes

_SAMPLES: Final = 24  #: rows of the sound logs


def put(data: bytes, mark: bytes, offset: int, form: str, number: int, *, turn: int = 0) -> bytes:
    """Return a file with the number changed that stands so far behind a mark, found for the given time."""
    place = -1
    for _ in range(turn + 1):
        place = data.index(mark, place + 1)
    found = bytearray(data)
    struct.pack_into(form, found, place + offset, number)
    return bytes(found)


def tdms_samples(number: int) -> bytes:
    """Return a TDMS file whose first channel declares so many samples."""
    data = tdms().data
    index = data.index(struct.pack("<IIIQ", 20, 10, 1, _SAMPLES))
    return data[: index + 12] + struct.pack("<Q", number) + data[index + 20 :]


def tdms_objects() -> bytes:
    return put(tdms().data, b"TDSm", 28, "<I", 2**31)


def npy() -> bytes:
    buffer = io.BytesIO()
    np.save(buffer, np.array([Told()], dtype=object), allow_pickle=True)
    return buffer.getvalue()


def channels(count: bytes) -> bytes:
    data = catman(".").data
    start = data.index(b"CHANNELS:")
    return data[:start] + b"CHANNELS: " + count + data[data.index(b"\n", start) :]


def ring() -> bytes:
    """Return an MDF file whose group of data is its own next."""
    data = mdf("4.10").data
    return put(data, b"##DG", 24, "<Q", data.index(b"##DG"))


def _case(
    kind: str, name: str, attack: str, file: str, make: Callable[[], bytes], said: str, **keys: Any
) -> Case:
    return Case(kind, name, attack, file, writes(make), said, never=str(SECRET)[:6], **keys)


CASES: Final = (
    _case("TDMS", "2^62 samples", "memory", "log.tdms", lambda: tdms_samples(2**62), "TDMS file"),
    _case("TDMS", "10^9 samples", "memory", "log.tdms", lambda: tdms_samples(10**9), "TDMS file"),
    _case("TDMS", "2^31 objects", "memory", "log.tdms", tdms_objects, "TDMS file is damaged"),
    _case(
        "TDMS",
        "a segment of 2^63 bytes",
        "memory",
        "log.tdms",
        lambda: put(tdms().data, b"TDSm", 12, "<Q", 2**63 - 1),
        "TDMS file is",
    ),
    _case(
        "TDMS",
        "segments in each other",
        "never ends",
        "log.tdms",
        lambda: put(tdms().data, b"TDSm", 12, "<Q", 0),
        "TDMS file is",
    ),
    _case(
        "catman",
        "999,999,999 channels",
        "memory",
        "log.txt",
        lambda: channels(b"999999999"),
        "channels|columns|names",
    ),
    _case(
        "catman",
        "9...9 channels, 10^4 digits",
        "time",
        "log.txt",
        lambda: channels(b"9" * 10**4),
        "CHANNELS is '99",
    ),
    _case(
        "MDF",
        "10^12 records",
        "memory",
        "log.mf4",
        lambda: put(mdf("4.10").data, b"##CG", 80, "<Q", 10**12),
        "declares records of",
    ),
    _case(
        "MDF",
        "a block of 2^62 bytes",
        "memory",
        "log.mf4",
        lambda: put(mdf("4.10").data, b"##CN", 8, "<Q", 2**62),
        "declares 4611686018427387904 bytes",
    ),
    _case(
        "MDF",
        "2^40 links",
        "memory",
        "log.mf4",
        lambda: put(mdf("4.10").data, b"##CN", 16, "<Q", 2**40),
        "the block at byte",
    ),
    _case(
        "MDF",
        "a group that is its own next",
        "never ends",
        "log.mf4",
        ring,
        "leads back to itself",
    ),
    _case(
        "pickle",
        "a pickle as log",
        "unpickles",
        "log.dat",
        lambda: pickle.dumps([Told()] * 10),
        "expected a log",
    ),
    _case("pickle", "a .npy of objects", "unpickles", "log.npy", npy, "expected a log"),
    _case(
        "pickle",
        "a pickle called .mat",
        "unpickles",
        "log.mat",
        lambda: pickle.dumps([Told()]),
        "expected a log",
    ),
    _case(
        "binary",
        "200 MB of noise",
        "time",
        "log.bin",
        lambda: np.random.default_rng(1).bytes(200_000_000),
        "expected a log",
        slow=True,
    ),
    _case("binary", "empty", "faults", "log.csv", lambda: b"", "is empty"),
    _case(
        "binary",
        "40 MB of blanks",
        "time",
        "log.csv",
        lambda: b" \n" * 20_000_000,
        "is empty|no rows|blank",
        slow=True,
    ),
    _case(
        "binary", "40 MB of NUL", "time", "log.csv", lambda: bytes(40_000_000), "expected a log", slow=True
    ),
)
