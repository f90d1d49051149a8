"""Limits of a sensor, what a person excludes, and findings made of sample flags."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from tethertest.errors import DataError
from tethertest.records.arrays import BoolArray
from tethertest.records.channel import Channel, Finding, Flag, Severity
from tethertest.records.rig import Rig, Sensor, sensor_range
from tethertest.records.run import Run

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
        inside = (channel.time >= item.span[0]) & (channel.time <= item.span[1])
        result[item.channel] = channel.with_flags(inside, Flag.EXCLUDED)
        if channel.usable.any() and not result[item.channel].usable.any():
            message = f"[[exclude]] leaves no sample of {item.channel!r}"
            remedy = "shorten the span, or leave the channel out of [[log]] channels"
            raise DataError(message, remedy, path=run.folder / "run.toml")
        text = f"{item.span[0]:g}-{item.span[1]:g} s excluded by hand: {item.reason}"
        count = int(np.count_nonzero(inside))
        if not count:
            span = f"{item.span[0]:g} s to {item.span[1]:g} s"
            logged = f"{channel.time[0]:.4g} s to {channel.time[-1]:.4g} s"
            message = f"[[exclude]] {item.channel!r} from {span}: it was logged from {logged}"
            raise DataError(message, "correct the span in run.toml", path=run.folder / "run.toml")
        findings.append(Finding(item.channel, "excluded", text, Severity.NOTE, (item.span,), count))
    return tuple(result.values()), tuple(findings)


def flag_findings(channel: Channel) -> tuple[Finding, ...]:
    """Return one finding per kind of sample flag that a channel carries.

    Parameters
    ----------
    channel : Channel
        On the run's clock.
    """
    found: list[Finding] = []
    for flag in WORDS:
        marked = (channel.flags & np.uint16(flag)) != 0
        if not marked.any():
            continue
        count = int(np.count_nonzero(marked))
        found.append(flag_finding(channel.name, flag, spans_of(channel, marked), count))
    return tuple(found)


def flag_finding(name: str, flag: Flag, spans: tuple[tuple[float, float], ...], count: int) -> Finding:
    """Return the finding about one kind of flag, a key of `WORDS`, on some samples of a channel."""
    named = ", ".join(f"{start:.3f}-{stop:.3f} s" for start, stop in spans[:SPANS_NAMED])
    more = f" and {len(spans) - SPANS_NAMED} more" if len(spans) > SPANS_NAMED else ""
    text = f"{WORDS[flag]}: {count} samples in {len(spans)} spans, {named}{more}"
    return Finding(name, (flag.name or "").lower(), text, spans=spans, samples=count)


def spans_of(channel: Channel, marked: BoolArray) -> tuple[tuple[float, float], ...]:
    """Return the spans of marked samples [s], joined where they are closer than `SPAN_APART`."""
    times = channel.time[marked]
    groups = np.split(times, np.flatnonzero(np.diff(times) > SPAN_APART) + 1)
    return tuple((float(group[0]), float(group[-1])) for group in groups if group.size)


def sensor_of(rig: Rig, channel: Channel) -> Sensor:
    """Return the sensor of a channel; every channel has one once names are mapped."""
    return next(sensor for sensor in rig.sensor if sensor.name == channel.name)
