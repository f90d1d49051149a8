"""Logs in consecutive pieces."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from tethertest.readers.streaming import stream_log
from tethertest.records.channel import RawLog
from tethertest.records.run import Log


def pieces_of(path: Path, entry: Log) -> Iterator[RawLog]:
    """Yield a log in pieces with the same channels.

    Raises
    ------
    FileFormatError
        As `read_log`.
    """
    yield from stream_log(path, entry)
