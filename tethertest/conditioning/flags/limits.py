"""Limits of a sensor, what a person excludes, and findings made of sample flags."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from tethertest.errors import DataError
from tethertest.records.arrays import BoolArray
from tethertest.records.channel import Channel, Finding, Flag, Severity
from tethertest.records.rig import Rig, Sensor, sensor_range
from tethertest.records.run import Exclude, Run
from tethertest.signal.passes import blocks_of

#: flags of single samples that become findings, and what they say; clock, hum and drift findings are made
#: where seen
WORDS = {
    Flag.MISSING: "no value was logged",
    Flag.STUCK: "the value stands still while the sensor's noise or motion should move it",
    Flag.OUT_OF_RANGE: "beyond the sensor's range",
    Flag.SATURATED: "the amplifier is at its limit",
    Flag.SPIKE: "isolated samples far from their neighbours",
    Flag.STEP: "the level leaps and stays: its zero is not the same before and after",
    Flag.LOST: "the grating's peak was not seen",
    Flag.SLIPPED: "the grating was found in another column and put back",
}
#: flagged samples closer than this belong to one span [s]
SPAN_APART = 0.05
#: spans named in a text; all are in the finding
SPANS_NAMED = 3


def with_range_flagged(channel: Channel, sensor: Sensor) -> Channel:
    """Return the channel with `Flag.OUT_OF_RANGE` beyond the sensor's range.

    Parameters
    ----------
    channel : Channel
        In SI, tared.
    sensor : Sensor
        Its ``range`` is text with units.
    """
    if sensor.kind != channel.kind:
        return channel
    low, high = sensor_range(sensor)
    beyond = np.isfinite(channel.values) & ((channel.values < low) | (channel.values > high))
    return channel.with_flags(beyond, Flag.OUT_OF_RANGE)


def with_excludes(channels: Sequence[Channel], run: Run) -> tuple[tuple[Channel, ...], tuple[Finding, ...]]:
    """Return the channels with `Flag.EXCLUDED` on the spans of the run file.

    Raises
    ------
    DataError
        A span names a channel that the run does not have, holds no sample of it, or leaves none.
    """
    result = {channel.name: channel for channel in channels}
    findings: list[Finding] = []
    for item in run.file.exclude:
        channel = result.get(item.channel)
        if channel is None:
            message = f"[[exclude]] names channel {item.channel!r}, the run has {', '.join(result)}"
            raise DataError(message, "correct the channel in run.toml", path=run.folder / "run.toml")
        inside = excluded(channel, item)
        result[item.channel] = channel.with_flags(inside, Flag.EXCLUDED)
        if channel.usable.any() and not result[item.channel].usable.any():
            message = f"[[exclude]] leaves no sample of {item.channel!r}"
            remedy = "shorten the span, or leave the channel out of [[log]] channels"
            raise DataError(message, remedy, path=run.folder / "run.toml")
        ends = (float(channel.time[0]), float(channel.time[-1]))
        findings.append(exclude_finding(item, int(np.count_nonzero(inside)), ends, run))
    return tuple(result.values()), tuple(findings)


def excluded(channel: Channel, item: Exclude) -> BoolArray:
    """Return which samples of a channel a person excludes."""
    return np.asarray((channel.time >= item.span[0]) & (channel.time <= item.span[1]), dtype=bool)


def exclude_finding(item: Exclude, count: int, ends: tuple[float, float], run: Run) -> Finding:
    """Return the finding about a span that a person excludes.

    Parameters
    ----------
    item : Exclude
        The span.
    count : int
        Samples in it.
    ends : tuple of float
        First and last time of the channel [s].
    run : Run
        For the message.

    Raises
    ------
    DataError
        It holds no sample.
    """
    if not count:
        span = f"{item.span[0]:g} s to {item.span[1]:g} s"
        logged = f"{ends[0]:.4g} s to {ends[1]:.4g} s"
        message = f"[[exclude]] {item.channel!r} from {span}: it was logged from {logged}"
        raise DataError(message, "correct the span in run.toml", path=run.folder / "run.toml")
    text = f"{item.span[0]:g}-{item.span[1]:g} s excluded by hand: {item.reason}"
    return Finding(item.channel, "excluded", text, Severity.NOTE, (item.span,), count)


class FlagTally:
    """Which flags a channel carries and where, counted as its blocks come in their order."""

    def __init__(self, name: str) -> None:
        self._name = name
        self._spans: dict[Flag, list[tuple[float, float]]] = {flag: [] for flag in WORDS}
        self._counts = dict.fromkeys(WORDS, 0)

    def note(self, channel: Channel) -> None:
        """Note what a block holds."""
        for flag, spans in self._spans.items():
            times = channel.time[(channel.flags & np.uint16(flag)) != 0]
            if not times.size:
                continue
            self._counts[flag] += times.size
            for group in np.split(times, np.flatnonzero(np.diff(times) > SPAN_APART) + 1):
                start, stop = float(group[0]), float(group[-1])
                if spans and start - spans[-1][1] <= SPAN_APART:
                    spans[-1] = (spans[-1][0], stop)
                else:
                    spans.append((start, stop))

    @property
    def findings(self) -> tuple[Finding, ...]:
        """One finding for each kind of flag."""
        return tuple(self._finding(flag, spans) for flag, spans in self._spans.items() if spans)

    def _finding(self, flag: Flag, spans: list[tuple[float, float]]) -> Finding:
        count = self._counts[flag]
        named = ", ".join(f"{start:.3f}-{stop:.3f} s" for start, stop in spans[:SPANS_NAMED])
        more = f" and {len(spans) - SPANS_NAMED} more" if len(spans) > SPANS_NAMED else ""
        text = f"{WORDS[flag]}: {count} samples in {len(spans)} spans, {named}{more}"
        return Finding(self._name, (flag.name or "").lower(), text, spans=tuple(spans), samples=count)


def flag_findings(channel: Channel) -> tuple[Finding, ...]:
    """Return one finding per kind of sample flag that a channel carries.

    Parameters
    ----------
    channel : Channel
        On the run's clock.
    """
    tally = FlagTally(channel.name)
    for start, stop in blocks_of(channel.time.size):
        tally.note(channel.rows(start, stop))
    return tally.findings


def sensor_of(rig: Rig, channel: Channel) -> Sensor:
    """Return the sensor of a channel; every channel has one once names are mapped."""
    return next(sensor for sensor in rig.sensor if sensor.name == channel.name)
