"""Zeros, noise and hum of a long log: from its rest windows, at the full rate where they are short enough."""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from tethertest.conditioning.condition import DEFAULT_NOISE, mapped
from tethertest.conditioning.flags.hum import with_hum_flagged
from tethertest.conditioning.flags.limits import sensor_of
from tethertest.conditioning.rest import RunWindows
from tethertest.conditioning.rig_priors import RigPriors
from tethertest.conditioning.sensors import finished
from tethertest.jobs.long_runs.columns import Sizes
from tethertest.jobs.long_runs.flagging import Flagged
from tethertest.records.channel import Channel, ClockFit, Finding, Flag, Window
from tethertest.records.rig import Rig, sensor_noise
from tethertest.signal.passes import blocks_of


@dataclass(frozen=True, slots=True, eq=False)
class Zeroed:
    """How one sensor's samples become its final ones: a straight line is taken out."""

    log: Flagged
    number: int  #: of the sensor in its log
    fit: ClockFit
    about: Channel  #: with every step on record, without samples
    flags: Flag  #: that every sample carries
    origin: float  #: [s]
    offset: float  #: at the origin
    slope: float  #: per second

    def channel(self, start: int, stop: int) -> Channel:
        """Return some samples on the run's clock, tared."""
        logged = mapped(self.log.channel(self.number, start, stop), self.fit)
        line = self.offset + self.slope * (logged.time - self.origin)
        flags = (logged.flags | np.uint16(self.flags)).astype(np.uint16)
        return replace(self.about, time=logged.time, values=logged.values - line, flags=flags)


def zeroed_sensors(
    logs: Sequence[tuple[Flagged, ClockFit]],
    others: Sequence[Channel],
    rig: Rig,
    priors: RigPriors,
    windows: RunWindows,
    sizes: Sizes,
) -> tuple[list[Zeroed], list[Finding]]:
    """Return how every sensor of the long logs is tared, and what was found on the way.

    Parameters
    ----------
    logs : sequence of (Flagged, ClockFit)
        The long logs and their clocks.
    others : sequence of Channel
        Displacements of other logs, which tell whether the base stands in the same place after the run.
    rig, priors, windows
        As `finished` takes them.
    sizes : Sizes
        Rows at once.
    """
    spans = [item for item in (windows.rest_before, windows.rest_after) if item is not None]
    sources = [(log, number, fit) for log, fit in logs for number in range(len(log.flags))]
    excerpts = [_excerpt(log, number, fit, spans, sizes) for log, number, fit in sources]
    done, found = finished([*excerpts, *others], rig, priors, windows)
    names = {channel.name for channel in excerpts}
    findings = [item for item in found if item.subject in names]
    result: list[Zeroed] = []
    for (log, number, fit), before, after in zip(sources, excerpts, done, strict=False):
        kept = np.flatnonzero(np.isfinite(before.values) & np.isfinite(after.values))[[0, -1]]
        time, line = before.time[kept], before.values[kept] - after.values[kept]
        slope = float(line[1] - line[0]) / float(time[1] - time[0]) if time[1] > time[0] else 0.0
        constant = Flag(int(np.bitwise_and.reduce(after.flags & ~before.flags)))
        if after.kind == "tension":
            hum, hums = _hum(log, number, fit, spans, after, priors, rig, sizes)
            constant |= hum
            findings += hums
        nothing = np.zeros(0)
        about = replace(after, time=nothing, values=nothing, flags=nothing.astype(np.uint16), noise=0.0)
        result.append(Zeroed(log, number, fit, about, constant, float(time[0]), float(line[0]), slope))
    return result, [_whole(item, result) for item in findings]


def _whole(finding: Finding, sensors: Sequence[Zeroed]) -> Finding:
    """Return a finding about all samples of a channel with all of its samples."""
    if finding.kind not in {"drift", "hum"}:
        return finding
    sensor = next(item for item in sensors if item.about.name == finding.subject)
    rows = sensor.log.record.rows
    ends = [float(sensor.channel(row, row + 1).time[0]) for row in (0, rows - 1)]
    return replace(finding, spans=((ends[0], ends[1]),), samples=rows)


def _excerpt(log: Flagged, number: int, fit: ClockFit, spans: Sequence[Window], sizes: Sizes) -> Channel:
    """Return a sensor's samples at rest, thinned where there are many; the record where none is usable."""
    ranges = _ranges(log, fit, spans)
    rows = sum(stop - start for start, stop in ranges)
    found = _thinned(log, number, ranges, rows // sizes.whole + 1, sizes)
    if found is None or not found.usable.any():
        whole = [(0, log.record.rows)]
        found = _thinned(log, number, whole, log.record.rows // sizes.whole + 1, sizes)
    if found is None:
        raise AssertionError(log.names[number])  # a log has rows
    return mapped(found, fit)


def _ranges(log: Flagged, fit: ClockFit, spans: Sequence[Window]) -> list[tuple[int, int]]:
    """Return first and last + 1 row of each window; windows that overlap become one."""
    rows = range(log.record.rows)

    def time(row: int) -> float:
        stamp = log.record.time(row, row + 1)
        return float(stamp[0] if fit.clock == fit.reference else fit.to_reference(stamp)[0])

    found: list[tuple[int, int]] = []
    for span in sorted(spans, key=lambda item: item.start):
        start, stop = bisect_left(rows, span.start, key=time), bisect_right(rows, span.stop, key=time)
        if found and start < found[-1][1]:
            start, stop = found[-1][0], max(stop, found[-1][1])
            found.pop()
        if stop > start:
            found.append((start, stop))
    return found


def _thinned(
    log: Flagged, number: int, ranges: Sequence[tuple[int, int]], factor: int, sizes: Sizes
) -> Channel | None:
    """Return means over the usable ones of every `factor` samples of some rows; all samples for factor 1."""
    parts: list[Channel] = []
    block = max(sizes.block // factor, 1) * factor
    for first, last in ranges:
        for start, stop in blocks_of(last - first, block):
            part = log.channel(number, first + start, first + stop)
            parts.append(part if factor == 1 else _means(part, factor))
    if not parts:
        return None
    series = (np.concatenate([getattr(part, key) for part in parts]) for key in ("time", "values", "flags"))
    time, values, flags = series
    return replace(parts[0], time=time, values=values, flags=flags)


def _means(channel: Channel, factor: int) -> Channel:
    rows = channel.time.size // factor * factor
    usable = channel.usable[:rows].reshape(-1, factor)
    count = usable.sum(axis=1)
    total = np.where(usable, channel.values[:rows].reshape(-1, factor), 0.0).sum(axis=1)
    values = np.where(count > 0, total / np.maximum(count, 1), np.nan)
    flags = np.where(count > 0, 0, Flag.MISSING).astype(np.uint16)
    return replace(
        channel, time=channel.time[:rows].reshape(-1, factor).mean(axis=1), values=values, flags=flags
    )


def _hum(
    log: Flagged,
    number: int,
    fit: ClockFit,
    spans: Sequence[Window],
    tared: Channel,
    priors: RigPriors,
    rig: Rig,
    sizes: Sizes,
) -> tuple[Flag, list[Finding]]:
    """Judge hum at the full rate, in as much of the rest windows as is read at once."""
    ranges = [(start, min(stop, start + sizes.whole // 2)) for start, stop in _ranges(log, fit, spans)]
    excerpt = _thinned(log, number, ranges, 1, sizes)
    if excerpt is None:
        return Flag.NONE, []
    excerpt = replace(mapped(excerpt, fit), kind=tared.kind, unit=tared.unit)
    noise = sensor_noise(sensor_of(rig, excerpt)) or DEFAULT_NOISE
    judged, found = with_hum_flagged(excerpt, priors.mains, noise, spans)
    return (Flag.HUM if found else Flag.NONE), list(found) if judged.time.size else []
