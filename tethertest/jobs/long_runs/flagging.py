"""Second pass: every sample of a log calibrated and flagged, and a thinned copy for clocks and windows."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from tethertest.conditioning.flags.limits import sensor_of
from tethertest.conditioning.flags.spikes import CONTEXT, SpikeRule
from tethertest.conditioning.flags.stuck_saturated import Plateaus, plateaus_of
from tethertest.conditioning.load_cells.calibration import calibrated
from tethertest.jobs.long_runs.columns import Column, Scratch, Sizes
from tethertest.jobs.long_runs.record import Record
from tethertest.records.arrays import FloatArray
from tethertest.records.channel import Channel, Finding, Flag, RawChannel, RawLog
from tethertest.records.run import Run
from tethertest.signal.passes import blocks_of


@dataclass(frozen=True, slots=True, eq=False)
class Flagged:
    """A log on disk with the flags of every sample."""

    record: Record
    run: Run
    flags: tuple[Column, ...]  #: of each sensor
    findings: tuple[Finding, ...]  #: from calibration

    @property
    def names(self) -> tuple[str, ...]:
        """Its sensors."""
        return tuple(channel.name for channel in self.record.channels(0, 1))

    def channel(self, number: int, start: int, stop: int) -> Channel:
        """Return some samples of one sensor, calibrated and flagged, on the log's clock."""
        channel = _calibrated(self.record.channels(start, stop)[number], self.run)[0]
        return replace(channel, flags=self.flags[number].read(start, stop))


def flagged(
    record: Record, run: Run, scratch: Scratch, sizes: Sizes, progress: Callable[[int], None]
) -> Flagged:
    """Flag plateaus and spikes of a log.

    Parameters
    ----------
    record : Record
        The log.
    run : Run
        The run and its rig.
    scratch : Scratch
        For further columns.
    sizes : Sizes
        Rows at once.
    progress : callable
        Is told the number of rows so far.
    """
    count = len(record.log.pairings)
    plateaus = [_plateaus(record, number, sizes) for number in range(count)]
    rules = [_spike_rule(record, number, run) for number in range(count)]
    columns = tuple(scratch.column("<u2") for _ in range(count))
    findings: dict[tuple[str, str], Finding] = {}
    for start, stop in blocks_of(record.rows, sizes.block):
        first = max(start - CONTEXT, 0)
        parts = []
        for number, logged in enumerate(record.channels(first, stop + CONTEXT)):
            level = replace(logged, flags=logged.flags | plateaus[number].flags(logged.values, first))
            channel, found = _calibrated(level, run)
            parts.append(channel)
            findings |= {(item.subject, item.kind): item for item in found}
        for number, (column, part) in enumerate(zip(columns, parts, strict=True)):
            others = [
                (other, rule.sigma)
                for other, rule in zip(parts, rules, strict=True)
                if other is not part and other.kind == part.kind
            ]
            marked = part.with_flags(rules[number].spikes(part, others), Flag.SPIKE)
            column.append(marked.flags[start - first : stop - first])
        progress(stop)
    return Flagged(record, run, columns, tuple(findings.values()))


def thinned(log: Flagged, factor: int, sizes: Sizes) -> RawLog:
    """Return a log as its logger would have written it more slowly: means over the usable samples.

    Parameters
    ----------
    log : Flagged
        The log.
    factor : int
        Rows per row of the copy.
    sizes : Sizes
        Rows at once.
    """
    record = log.record
    times: list[FloatArray] = []
    values: list[list[FloatArray]] = [[] for _ in log.flags]
    block = max(sizes.block // factor, 1) * factor
    for start, stop in blocks_of(record.rows // factor * factor, block):
        times.append(record.time(start, stop).reshape(-1, factor).mean(axis=1))
        for number, channel in enumerate(record.channels(start, stop)):
            usable = replace(channel, flags=log.flags[number].read(start, stop)).usable
            logged = record.columns[2 + number].read(start, stop)
            values[number].append(_means(logged, usable, factor))
    time = np.concatenate(times) - record.log.start
    channels = tuple(
        RawChannel(pairing.raw.name, pairing.raw.unit, time, np.concatenate(parts))
        for pairing, parts in zip(record.log.pairings, values, strict=True)
    )
    return replace(record.log.raw, channels=channels, remarks=())


def _means(values: FloatArray, usable: np.ndarray, factor: int) -> FloatArray:
    """Return means over the usable values of every `factor` samples, NaN where there are none."""
    count = usable.reshape(-1, factor).sum(axis=1)
    total = np.where(usable, values, 0.0).reshape(-1, factor).sum(axis=1)
    return np.where(count > 0, total / np.maximum(count, 1), np.nan)


def _plateaus(record: Record, number: int, sizes: Sizes) -> Plateaus:
    def read(start: int, stop: int) -> tuple[FloatArray, FloatArray]:
        channel = record.channels(start, stop)[number]
        return channel.time, channel.values

    return plateaus_of(read, record.rows, sizes.block, record.channels(0, 1)[number].kind)


def _spike_rule(record: Record, number: int, run: Run) -> SpikeRule:
    def values(start: int, stop: int) -> FloatArray:
        return _without_holes(_calibrated(record.channels(start, stop)[number], run)[0])

    return SpikeRule.of(values, record.rows, 1.0 / record.step)


def _calibrated(channel: Channel, run: Run) -> tuple[Channel, tuple[Finding, ...]]:
    sensor = sensor_of(run.rig, channel)
    if sensor.kind != "tension":
        return channel, ()
    return calibrated(channel, sensor, run.rig, run.file.date.date())


def _without_holes(channel: Channel) -> FloatArray:
    """Return the values, straight across holes; zero where there are nothing but holes."""
    known = np.isfinite(channel.values)
    if known.all():
        return channel.values
    if not known.any():
        return np.zeros(channel.values.size)
    return np.interp(channel.time, channel.time[known], channel.values[known])
