"""NI TDMS files, through npTDMS."""

from __future__ import annotations

import datetime as dt
import logging
import shutil
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any, Final

import numpy as np

from tethertest.errors import FileFormatError
from tethertest.readers.channels import raw_channel, with_units
from tethertest.readers.formats.tdms_channels import Plan, planned
from tethertest.readers.formats.tdms_time import Key, Piece
from tethertest.readers.tables.text.document import Head, opened
from tethertest.readers.tables.text.stamps import time_zone_of
from tethertest.readers.tables.text.textlog import Progress
from tethertest.records.arrays import FloatArray, frozen
from tethertest.records.channel import RawChannel, RawLog
from tethertest.records.run import DEFAULT, Log

NAME = "tdms"
#: keys of a log in run.toml that it takes
USES = frozenset(["time_zone", "units"])
#: bytes of a compressed file that are unpacked in memory; a larger one goes to the disk
_SPOOLED: Final = 2**26


def sniff(head: Head) -> str | None:
    """Claim files that begin with ``TDSm``."""
    return "the first bytes are 'TDSm'" if head.data.startswith(b"TDSm") else None


def read(path: Path, settings: Log = DEFAULT) -> RawLog:
    """Read an NI TDMS file.

    Parameters
    ----------
    path : Path
        The log, plain or in gzip or zip.
    settings : Log
        Settings of the run file: units, and time_zone, in which the start is then shown.

    Returns
    -------
    RawLog
        Times follow each channel's ``wf_start_time`` (UTC) and ``wf_increment``, or the group's time channel;
        rates may differ. Raw counts stay counts.

    Raises
    ------
    FileFormatError
        The file is cut or damaged, holds no data, or a channel has no time.
    """
    with _opened(path) as file:
        plan = planned(path, file)
        arrays = {key: np.empty(length) for key, length in plan.lengths.items()}
        filled = dict.fromkeys(arrays, 0)
        for key, values in _chunks(path, file, plan):
            arrays[key][filled[key] : filled[key] + len(values)] = values
            filled[key] += len(values)
        times: dict[tuple[tuple[Piece, ...], int], FloatArray] = {}
        channels = []
        for source in plan.sources:
            values = frozen(arrays[source.key])
            if source.clock is not None:
                time = frozen(arrays[source.clock])
            else:  # channels of one clock share the array
                clock = (source.pieces, len(values))
                if clock not in times:
                    times[clock] = frozen(source.time(0, len(values)))
                time = times[clock]
            channels.append(raw_channel(source.name, source.unit, time, values))
        return _log(path, plan, channels, settings)


def stream(path: Path, settings: Log, rows: int, progress: Progress | None = None) -> Iterator[RawLog]:
    """Yield the log in pieces in which no channel has more samples than `rows`.

    Channels of other rates end sooner in a piece or go on in the next: what is together in the file stays
    together. A piece is made as soon as one channel has enough samples, so the chunks of the file, not its
    length, bound the memory.

    Raises
    ------
    FileFormatError
        As `read`, once the mistake is reached.
    """
    with _opened(path) as file:
        plan = planned(path, file)
        held: dict[Key, list[FloatArray]] = {key: [] for key in plan.lengths}
        begun = dict.fromkeys(plan.lengths, 0)
        size, total, done = path.stat().st_size, sum(plan.lengths.values()), 0
        pending = True
        for key, values in _chunks(path, file, plan):
            held[key].append(values)
            done += len(values)
            if progress is not None:
                progress(size * done // total, size)
            while max(counts := plan.ready(held), default=0) >= rows:
                yield _log(path, plan, _taken(plan, held, begun, counts, rows), settings)
                plan = replace(plan, remarks=())
                pending = False
        while pending or max(plan.ready(held), default=0) > 0:
            counts = plan.ready(held)
            yield _log(path, plan, _taken(plan, held, begun, counts, rows), settings)
            plan = replace(plan, remarks=())
            pending = False


def _taken(
    plan: Plan, held: dict[Key, list[FloatArray]], begun: dict[Key, int], counts: list[int], rows: int
) -> list[RawChannel]:
    """Take the next samples of every channel out of what is held."""
    taken: dict[Key, FloatArray] = {}
    channels = []
    for source, count in zip(plan.sources, counts, strict=True):
        for key in (source.key, source.clock):
            if key is not None and key not in taken:
                parts = held[key] or [np.empty(0)]
                whole = parts[0] if len(parts) == 1 else np.concatenate(parts)
                taken[key] = whole[: min(count, rows)].copy()
                held[key] = [whole[min(count, rows) :]]
        values = taken[source.key]
        first = begun[source.key]
        begun[source.key] = first + len(values)
        time = source.time(first, first + len(values)) if source.clock is None else taken[source.clock]
        channels.append(raw_channel(source.name, source.unit, time, values))
    return channels


def _chunks(path: Path, file: Any, plan: Plan) -> Iterator[tuple[Key, FloatArray]]:
    """Yield the samples as they come in the file, stamps as seconds since the first."""
    chunks = iter(file.data_chunks())
    while True:
        parts: list[tuple[Key, FloatArray]] = []
        try:
            chunk = next(chunks, None)
            if chunk is None:
                return
            for group in chunk.groups():
                for channel in group.channels():
                    key = (group.name, channel.name)
                    if key in plan.lengths and len(channel):
                        values = channel[:]
                        if key in plan.clocks:
                            values = plan.clocks[key].seconds(values)
                        parts.append((key, np.asarray(values, dtype=np.float64)))
        except Exception as error:  # npTDMS lets errors of struct and of its own parser through
            raise _damaged(path, error) from error
        yield from parts


def _log(path: Path, plan: Plan, channels: Iterable[RawChannel], settings: Log) -> RawLog:
    zone = time_zone_of(settings.time_zone, path)
    return RawLog(
        path=path,
        format=NAME,
        start=None if plan.start is None else _as_datetime(plan.start, zone),
        channels=with_units(path, channels, settings),
        rate=plan.rate,
        remarks=plan.remarks,
    )


@contextmanager
def _opened(path: Path) -> Iterator[Any]:
    """Open the file with its lists read and its samples left where they are."""
    from nptdms.log import log_manager

    from tethertest.readers.formats.tdms_history import FileWithHistory

    # what npTDMS would print about a cut file is in our own message
    log_manager.set_level(logging.CRITICAL)
    with opened(path) as (stream, on_disk), tempfile.SpooledTemporaryFile(_SPOOLED) as unpacked:
        seekable: Any = stream
        if stream is not on_disk:
            shutil.copyfileobj(stream, unpacked)
            unpacked.seek(0)
            seekable = unpacked
        try:
            file = FileWithHistory(seekable, read_metadata_only=True, keep_open=True)
        except Exception as error:  # npTDMS lets errors of struct and of its own parser through
            raise _damaged(path, error) from error
        status = file.file_status
        if status is not None and status.incomplete_final_segment:
            message = "the TDMS file is cut: its last segment is incomplete"
            raise FileFormatError(message, "copy the whole file from the logger again", path=path)
        # a last chunk may be short; where it is the only one, npTDMS gives a channel what belongs to others
        cut = (segment for segment in file._reader._segments if segment.final_chunk_lengths_override)
        if any(segment.num_chunks == 1 for segment in cut):
            message = "the TDMS file is damaged: a segment declares more samples than it holds"
            raise FileFormatError(message, "copy the whole file from the logger again", path=path)
        yield file


def _damaged(path: Path, error: Exception) -> FileFormatError:
    message = f"the TDMS file is damaged or cut ({error})"
    return FileFormatError(message, "copy the whole file from the logger again", path=path)


def _as_datetime(instant: np.datetime64, zone: dt.tzinfo | None) -> dt.datetime:
    microseconds = int(instant.astype("datetime64[us]").astype(np.int64))
    start = dt.datetime(1970, 1, 1, tzinfo=dt.UTC) + dt.timedelta(microseconds=microseconds)
    return start if zone is None else start.astimezone(zone)
