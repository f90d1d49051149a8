"""How much `inspect` and `ingest` hold in memory, and which logs are therefore taken in parts."""

from __future__ import annotations

from pathlib import Path
from typing import Final

#: memory that `inspect` and `ingest` may take above the program itself [bytes]
MEMORY: Final = 1_000_000_000
#: a text log of short numbers is twice its size as arrays, and working on them takes 2.5 times those [bytes]
LARGEST_WHOLE: Final = MEMORY // 5
#: logs of numbers shrink to about a part of this in gzip and zip, known by their first bytes
UNPACKED, _PACKED = 5, (b"\x1f\x8b", b"PK")


def is_long(path: Path, largest: int = LARGEST_WHOLE) -> bool:
    """Return whether a log is to be taken in parts.

    Parameters
    ----------
    path : Path
        The log.
    largest : int
        Bytes, unpacked, up to which it is taken whole.
    """
    with path.open("rb") as file:
        packed = file.read(2) in _PACKED
    return path.stat().st_size * (UNPACKED if packed else 1) > largest
