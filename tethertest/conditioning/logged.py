"""One log -> channels on the log's own clock, in SI or in the ratio, count or wavelength that was logged."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from tethertest.conditioning.gratings import assigned
from tethertest.conditioning.jumps import without_jumps
from tethertest.conditioning.mapping import Pairing, is_grating, paired
from tethertest.conditioning.stamps import Stamps, audited
from tethertest.conditioning.starts import start_after
from tethertest.records.channel import Channel, Finding, Flag, RawLog, Source
from tethertest.records.run import Log, Run


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
        Names, units or stamps are wrong; see `paired`, `start_after` and `audited`.
    """
    pairings, findings = paired(raw, entry, run.rig)
    start, start_findings = start_after(raw, entry, run.file.date)
    found = [*findings, *start_findings, *(Finding(entry.clock, "log", text, "note") for text in raw.remarks)]
    channels: list[Channel] = []
    for group in _with_same_times(pairings):
        stamps = audited(group[0].raw.time + start, raw, entry.clock)
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


def _with_same_times(pairings: Sequence[Pairing]) -> Iterator[list[Pairing]]:
    """Yield the columns that share their stamps."""
    left = list(pairings)
    while left:
        time = left[0].raw.time
        same = [item.raw.time is time or np.array_equal(item.raw.time, time) for item in left]
        yield [item for item, shared in zip(left, same, strict=True) if shared]
        left = [item for item, shared in zip(left, same, strict=True) if not shared]


def _column(pairing: Pairing, stamps: Stamps, raw: RawLog, entry: Log) -> Channel:
    scale = pairing.scale
    logged, told = pairing.raw.values, pairing.raw.flags
    if pairing.raw.as_written is not None and (pairing.sensor is None or is_grating(pairing.sensor)):
        # the rig knows its gratings better than the reader, who had to learn them from the log
        logged, told = pairing.raw.as_written, None
    values = scale.factor * logged[stamps.rows] + scale.offset
    missing = np.where(np.isfinite(values), np.uint16(0), np.uint16(Flag.MISSING))
    if told is not None:
        missing |= told[stamps.rows]
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
        (stamps.flags | missing).astype(np.uint16),
        None if sensor is None else sensor.at,
        source=source,
    )
