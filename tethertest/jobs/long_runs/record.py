"""A log on disk as channels: any rows of it, on its own clock, in the unit that was logged."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from tethertest.conditioning.timestamps.jumps import NEAR, SHORTEST_JUMP, SIDE, without_jumps
from tethertest.conditioning.timestamps.mapping import Pairing
from tethertest.conditioning.timestamps.stamps import audit_of
from tethertest.jobs.long_runs.columns import Column, Scratch, Sizes
from tethertest.jobs.long_runs.gather import Gathered
from tethertest.records.arrays import FloatArray
from tethertest.records.channel import Channel, Finding, Flag, Source
from tethertest.signal.passes import blocks_of


@dataclass(slots=True, eq=False)
class Record:
    """A log whose stamps are audited; clock jumps are taken out of every piece that is read."""

    log: Gathered
    step: float  #: usual step of the stamps [s]
    columns: tuple[Column, ...]  #: of the rows that are kept: stamps, their flags, values of each sensor
    sizes: Sizes
    findings: tuple[Finding, ...] = ()
    steps: tuple[str, ...] = ()  #: what was done to the stamps
    jumps: list[tuple[int, float]] = field(default_factory=list)  #: (row, leap [s]) in rows of the log

    @property
    def rows(self) -> int:
        """Rows that are kept."""
        return self.columns[0].size

    def time(self, start: int, stop: int) -> FloatArray:
        """Return the stamps of some rows [s], on the log's clock."""
        start, stop = max(start, 0), min(stop, self.rows)
        time = self.columns[0].read(start, stop).copy()
        for row, leap in self.jumps:
            if row < stop:
                time[max(row - start, 0) :] -= leap
        return time

    def channels(self, start: int, stop: int) -> tuple[Channel, ...]:
        """Return the sensors' channels over some rows, with the flags that follow from stamps and holes."""
        start, stop = max(start, 0), min(stop, self.rows)
        flags = self.columns[1].read(start, stop).copy()
        for row, _ in self.jumps:
            if start <= row < stop:
                flags[row - start] &= ~np.uint16(Flag.GAP)
                flags[row - start] |= np.uint16(Flag.CLOCK_JUMP)
        time = self.time(start, stop)
        return tuple(
            self._channel(pairing, column.read(start, stop), time, flags)
            for pairing, column in zip(self.log.pairings, self.columns[2:], strict=True)
        )

    def _channel(self, pairing: Pairing, logged: FloatArray, time: FloatArray, flags: np.ndarray) -> Channel:
        scale, raw = pairing.scale, self.log.raw
        values = scale.factor * logged + scale.offset
        missing = np.where(np.isfinite(values), np.uint16(0), np.uint16(Flag.MISSING))
        step = f"{pairing.written} -> {scale.unit}: factor {scale.factor:.9g}"
        source = Source(
            raw.path.name, raw.sha256, raw.format, pairing.written, self.log.entry.clock, (step, *self.steps)
        )
        sensor = pairing.sensor
        return Channel(
            pairing.raw.name if sensor is None else sensor.name,
            scale.kind,
            scale.unit,
            time,
            values,
            (flags | missing).astype(np.uint16),
            None if sensor is None else sensor.at,
            source=source,
        )


def record_of(log: Gathered, scratch: Scratch, sizes: Sizes) -> Record:
    """Return a log with its stamps audited and its clock jumps found.

    Parameters
    ----------
    log : Gathered
        The log.
    scratch : Scratch
        For further columns.
    sizes : Sizes
        Rows at once.

    Raises
    ------
    DataError
        As `audit_of`.
    """
    clock = log.entry.clock
    audit = audit_of(log.stamps, log.rows, log.raw, clock, sizes.block, most=sizes.whole)
    time, flags, kept = scratch.column("<f8"), scratch.column("<u2"), scratch.column("?")
    for part in audit.blocks():
        time.append(part.time)
        flags.append(part.flags)
        kept.append(np.ones(part.time.size, dtype=bool) if part.rows is None else part.rows)
    values = log.values
    if time.size < log.rows:
        values = tuple(_kept(column, kept, scratch, sizes) for column in values)
    findings = (*log.findings, *audit.findings)
    record = Record(log, audit.step, (time, flags, *values), sizes, findings, audit.steps)
    gaps = _gaps(record)
    lost: list[tuple[float, float]] = []
    jumped: list[Finding] = []
    missing = 0
    for row in gaps:
        leap, finding, span = _leap(record, row)
        if finding is not None:
            record.jumps.append((row, leap))
            jumped.append(finding)
        else:
            lost.append(span)
            missing += round(leap / record.step)
    found: Sequence[Finding] = jumped
    if lost:
        longest = max(stop - start for start, stop in lost)
        text = f"{missing} rows are missing in {len(lost)} gaps, the longest {longest:.4g} s"
        found = [*jumped, Finding(clock, "gap", text, spans=tuple(lost), samples=missing)]
    record.findings = (*record.findings, *found)
    if jumped:
        record.steps = (*record.steps, "; ".join(finding.text for finding in jumped))
    return record


def _kept(column: Column, kept: Column, scratch: Scratch, sizes: Sizes) -> Column:
    """Return a column without the rows that are dropped."""
    shorter = scratch.column(column.dtype)
    for start, stop in blocks_of(column.size, sizes.block):
        shorter.append(column.read(start, stop)[kept.read(start, stop)])
    return shorter


def _gaps(record: Record) -> list[int]:
    """Return the rows with a gap before them."""
    found: list[int] = []
    for start, stop in blocks_of(record.rows, record.sizes.block):
        flags = record.columns[1].read(start, stop)
        found += (start + np.flatnonzero(flags & np.uint16(Flag.GAP))).tolist()
    return found


def _leap(record: Record, row: int) -> tuple[float, Finding | None, tuple[float, float]]:
    """Return how far the stamps leap before a row, the finding where it is a jump, and the gap's ends."""
    step = record.step
    reach = round((NEAR + 2.0 * SIDE) / step) + 2
    near = record.channels(row - 2, row + 1)[0].time
    before, after = float(near[-2]), float(near[-1])
    leap = after - before - step
    if leap < SHORTEST_JUMP:
        return leap, None, (before, after)
    channels = record.channels(row - reach, row + reach)
    only = [replace(channel, flags=_only_gap(channel, after)) for channel in channels]
    _, found = without_jumps(only, record.log.entry.clock)
    jump = next((finding for finding in found if finding.kind == "clock_jump"), None)
    return leap, jump, (before, after)


def _only_gap(channel: Channel, at: float) -> np.ndarray:
    """Return a channel's flags with no gap but the one before a time."""
    flags = channel.flags & ~np.uint16(Flag.GAP)
    return np.where(channel.time == at, flags | np.uint16(Flag.GAP), flags).astype(np.uint16)
