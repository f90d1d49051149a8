"""Logs in consecutive pieces, for those that do not fit into memory."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Final

from tethertest.readers.fingerprint import unchanged
from tethertest.readers.formats import delimited, tdms
from tethertest.readers.registry import identified, refuse_keys
from tethertest.readers.tables.text.textlog import Progress
from tethertest.records.channel import RawLog
from tethertest.records.run import DEFAULT, Log

#: a piece of so many rows and a dozen channels takes some ten megabytes
ROWS: Final = 100_000


def stream_log(
    path: Path | str, settings: Log = DEFAULT, *, rows: int = ROWS, progress: Progress | None = None
) -> Iterator[RawLog]:
    """Yield a log in consecutive pieces that together are what `read_log` returns.

    Every piece has the same channels, names, units, start, format and hash; its time goes on from the piece
    before, in seconds since the log's start. A remark on the whole log stands in the first piece; a remark on
    single cells counts those of its own piece. A log that turns out wrong is refused when the mistake is
    reached: what came before it was read right.

    What a log leaves open is settled before the first piece: where neither the first block nor run.toml
    shows the order of day and month, the stamps alone are looked through as far as is needed; where a comma
    may be a decimal sign or a thousands separator, so is the text. A log whose decimal sign shows only below
    its first 600 lines is refused with the setting that it needs.

    Parameters
    ----------
    path : Path or str
        The log, plain or in gzip or zip.
    settings : Log
        As for `read_log`.
    rows : int
        Rows of a piece; the last may have fewer. Logs that are neither plain tables nor TDMS come in one
        piece. In TDMS no channel has more samples in a piece, and slower ones have fewer.
    progress : callable, optional
        Called as ``progress(done, total)`` with the bytes of the file that were read and all of them.

    Raises
    ------
    ValueError
        `rows` is below 1.
    FileFormatError
        As `read_log`.
    """
    if rows < 1:
        message = f"rows must be at least 1, found {rows}"
        raise ValueError(message)
    return _pieces(Path(path), settings, rows, progress)


def _pieces(path: Path, settings: Log, rows: int, progress: Progress | None) -> Iterator[RawLog]:
    with unchanged(path) as before:
        reader, reason = identified(path, settings)
        refuse_keys(path, reader, settings)
        if reader is delimited:
            pieces = delimited.stream(path, settings, rows, progress)
        elif reader is tdms:
            pieces = tdms.stream(path, settings, rows, progress)
        else:
            pieces = iter([reader.read(path, settings)])
        for piece in pieces:
            yield replace(piece, reason=reason, fingerprint=before)
    if progress is not None:
        size = path.stat().st_size
        progress(size, size)
