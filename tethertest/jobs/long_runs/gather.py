"""First pass: one log into columns on disk, as it is read."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace

import numpy as np

from tethertest.conditioning.timestamps.mapping import Pairing, paired
from tethertest.conditioning.timestamps.starts import start_after
from tethertest.errors import DataError
from tethertest.jobs.long_runs.columns import Column, Scratch
from tethertest.records.arrays import FloatArray
from tethertest.records.channel import Finding, RawLog, Severity
from tethertest.records.run import Log, Run

#: kinds of sensors whose samples are conditioned one by one or from a few neighbours
KINDS = ("tension", "displacement")


@dataclass(frozen=True, slots=True, eq=False)
class Gathered:
    """A log on disk."""

    raw: RawLog  #: without samples
    entry: Log
    pairings: tuple[Pairing, ...]  #: its sensors' columns, without samples
    start: float  #: [s] after the run's date
    time: Column  #: [s] after the log's start, as logged
    values: tuple[Column, ...]  #: as logged, one per pairing
    findings: tuple[Finding, ...]

    @property
    def rows(self) -> int:
        """Rows of the log."""
        return self.time.size

    def stamps(self, start: int, stop: int) -> FloatArray:
        """Return the stamps of some rows as logged [s], after the run's date."""
        return np.asarray(self.time.read(start, stop) + self.start)


def gathered(
    pieces: Iterable[RawLog], entry: Log, run: Run, scratch: Scratch, progress: Callable[[int], None]
) -> Gathered:
    """Read a log once, to its end.

    Parameters
    ----------
    pieces : iterable of RawLog
        The log in consecutive pieces with the same channels.
    entry : Log
        Its entry in the run file.
    run : Run
        The run and its rig.
    scratch : Scratch
        For its columns.
    progress : callable
        Is told the number of rows so far.

    Raises
    ------
    DataError
        The log has no rows, its channels do not share their time, or it holds sensors that need the whole
        record in memory.
    """
    time = scratch.column("<f8")
    values: list[Column] = []
    first = last = None
    found: tuple[Finding, ...] = ()
    for piece in pieces:
        if first is None:
            first, found = _sensors(piece, entry, run)
            values = [scratch.column("<f8") for _ in first]
        by_name = {channel.name: channel for channel in piece.channels}
        stamps = by_name[first[0].raw.name].time
        for pairing, column in zip(first, values, strict=True):
            channel = by_name[pairing.raw.name]
            if channel.time is not stamps and not np.array_equal(channel.time, stamps, equal_nan=True):
                raise _refused(
                    piece, f"{pairing.raw.name!r} has other time stamps than {first[0].raw.name!r}"
                )
            column.append(channel.values)
        time.append(stamps)
        progress(time.size)
        last = piece
    if first is None or last is None or time.size < 2:
        message = f"the log has {time.size} rows, expected a record"
        raise DataError(message, "export the log again", path=entry.file)
    raw = replace(last, channels=())
    start, _ = start_after(raw, entry, run.file.date)
    remarks = (Finding(entry.clock, "log", text, Severity.NOTE) for text in raw.remarks)
    return Gathered(raw, entry, first, start, time, tuple(values), (*found, *remarks))


def _sensors(piece: RawLog, entry: Log, run: Run) -> tuple[tuple[Pairing, ...], tuple[Finding, ...]]:
    """Return the columns that belong to sensors, without samples, and notes on the others."""
    pairings, found = paired(piece, entry, run.rig)
    nothing = np.zeros(0)
    for pairing in pairings:
        if pairing.sensor is None or pairing.sensor.kind not in KINDS:
            name = pairing.raw.name if pairing.sensor is None else pairing.sensor.name
            raise _refused(piece, f"{name!r} is no load cell and no displacement")
    bare = (replace(pairing, raw=replace(pairing.raw, time=nothing, values=nothing)) for pairing in pairings)
    return tuple(bare), found


def _refused(piece: RawLog, why: str) -> DataError:
    message = f"the log is larger than is read at once, and {why}"
    remedy = "log or export it in parts of less than 200 MB, or as files of one instrument each"
    return DataError(message, remedy, path=piece.path)
