"""One log -> channels on the log's own clock, in SI or in the ratio, count or wavelength that was logged."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from tethertest.conditioning.gratings.assignment import assigned
from tethertest.conditioning.timestamps.jumps import without_jumps
from tethertest.conditioning.timestamps.mapping import Pairing, is_grating, paired
from tethertest.conditioning.timestamps.stamps import Stamps, audit_stamps
from tethertest.conditioning.timestamps.starts import start_after
from tethertest.records.arrays import FloatArray
from tethertest.records.channel import Channel, Finding, Flag, RawLog, Severity, Source
from tethertest.records.run import Log, Run
from tethertest.signal.passes import blocks_of

Timed = TypeVar("Timed")


@dataclass(frozen=True, slots=True, eq=False)
class LoggedChannels:
    """What one log holds of the rig's sensors."""

    clock: str
    channels: tuple[Channel, ...]  #: on the log's own clock, seconds since the run's date
    findings: tuple[Finding, ...]  #: spans on that clock


def as_logged(raw: RawLog, entry: Log, run: Run) -> LoggedChannels:
    """Return a log's channels with audited stamps, every grating's wavelengths under its own name.

    Parameters
    ----------
    raw : RawLog
        The log as read.
    entry : Log
        Its entry in the run file.
    run : Run
        The run, for its date and its rig.

    Raises
    ------
    DataError
        Names, units or stamps are wrong; see `paired`, `start_after` and `audit_stamps`.
    """
    pairings, findings = paired(raw, entry, run.rig)
    start, start_findings = start_after(raw, entry, run.file.date)
    found = [
        *findings,
        *start_findings,
        *(Finding(entry.clock, "log", text, Severity.NOTE) for text in raw.remarks),
    ]
    channels: list[Channel] = []
    for group in with_same_times(pairings, lambda pairing: pairing.raw.time):
        logged = group[0].raw.time
        stamps = audit_stamps(logged + start if start else logged, raw, entry.clock)
        found += stamps.findings
        columns = [_column(pairing, stamps, raw, entry) for pairing in group]
        optical = [pairing.sensor is None or is_grating(pairing.sensor) for pairing in group]
        named = [channel for channel, grating in zip(columns, optical, strict=True) if not grating]
        peaks = [channel for channel, grating in zip(columns, optical, strict=True) if grating]
        if peaks:
            gratings, doubts = assigned(peaks, run.rig)
            named += gratings
            found += doubts
        moved, jump_findings = without_jumps(named, entry.clock)
        channels += moved
        found += jump_findings
    return LoggedChannels(entry.clock, tuple(channels), tuple(found))


def with_same_times(items: Sequence[Timed], time_of: Callable[[Timed], FloatArray]) -> Iterator[list[Timed]]:
    """Yield the channels, or what stands for them, that share their stamps."""
    left = list(items)
    while left:
        time = time_of(left[0])
        same = [_same(time_of(item), time) for item in left]
        yield [item for item, shared in zip(left, same, strict=True) if shared]
        left = [item for item, shared in zip(left, same, strict=True) if not shared]


def _same(one: FloatArray, other: FloatArray) -> bool:
    if one is other or one.shape != other.shape:
        return one is other
    return all(
        np.array_equal(one[start:stop], other[start:stop], equal_nan=True)
        for start, stop in blocks_of(one.size)
    )


def _column(pairing: Pairing, stamps: Stamps, raw: RawLog, entry: Log) -> Channel:
    scale = pairing.scale
    logged, told = pairing.raw.values, pairing.raw.flags
    if pairing.raw.as_written is not None and (pairing.sensor is None or is_grating(pairing.sensor)):
        # the rig knows its gratings better than the reader, who had to learn them from the log
        logged, told = pairing.raw.as_written, None
    values = logged[stamps.rows]
    if (scale.factor, scale.offset) != (1.0, 0.0):
        values = scale.factor * values
        values += scale.offset
    flags = stamps.flags.copy()
    flags[~np.isfinite(values)] |= np.uint16(Flag.MISSING)
    if told is not None:
        flags |= told[stamps.rows]
    sensor = pairing.sensor
    source = Source(
        raw.path.name,
        raw.sha256,
        raw.format,
        pairing.written,
        entry.clock,
        (f"{pairing.written} -> {scale.unit}: factor {scale.factor:.9g}", *stamps.steps),
    )
    return Channel(
        pairing.raw.name if sensor is None else sensor.name,
        scale.kind,
        scale.unit,
        stamps.time,
        values,
        flags,
        None if sensor is None else sensor.at,
        source=source,
    )
