"""What the channels of a log are, for people and programs."""

from __future__ import annotations

import math

import numpy as np

from tethertest.errors import QuantityError
from tethertest.records.arrays import FloatArray
from tethertest.records.channel import Flag, RawChannel, RawLog
from tethertest.records.inspected import ChannelSeen
from tethertest.signal.passes import blocks_of
from tethertest.signal.series import some_steps
from tethertest.units import Kind, UnitScale, channel_scale


def described_channels(log: RawLog) -> tuple[list[ChannelSeen], list[str]]:
    """Describe the channels of a log as read, before any conditioning.

    Parameters
    ----------
    log : RawLog
        As `read_log` returns it.

    Returns
    -------
    channels : list of ChannelSeen
        SI values, None where there are none.
    remarks : list of str
        On units that are not known.
    """
    remarks: list[str] = []
    return [_channel(channel, remarks) for channel in log.channels], remarks


def _channel(channel: RawChannel, remarks: list[str]) -> ChannelSeen:
    scale = _scale(channel, remarks)
    finite, low, mean, high = _span(channel.values, scale)
    known = np.isfinite(channel.time)
    time = channel.time if known.all() else channel.time[known]  # a row may have no stamp
    steps = some_steps(time) if time.size > 1 else np.zeros(0)
    forward = steps[steps > 0]
    rate = 1.0 / float(np.median(forward)) if forward.size else math.nan
    return ChannelSeen(
        name=channel.name,
        kind=scale.kind,
        unit_as_written=channel.unit,
        unit=scale.unit,
        n=channel.values.size,
        rate=_known(rate),
        duration=float(time.max() - time.min()) if time.size else 0.0,
        minimum=_known(low),
        mean=_known(mean),
        maximum=_known(high),
        flags={"missing": channel.values.size - finite, **_told(channel)},
    )


def _span(values: FloatArray, scale: UnitScale) -> tuple[int, float, float, float]:
    """Return how many values are finite, and the smallest, the mean and the largest of them in SI."""
    count, low, total, high = 0, math.inf, 0.0, -math.inf
    with np.errstate(over="ignore", invalid="ignore"):  # what is then infinite is told as unknown
        for start, stop in blocks_of(values.size):
            part = values[start:stop]
            part = part[np.isfinite(part)] * scale.factor + scale.offset
            if part.size:
                count, total = count + part.size, total + float(np.sum(part))
                low, high = min(low, float(part.min())), max(high, float(part.max()))
    return (count, low, total / count, high) if count else (0, math.nan, math.nan, math.nan)


def _known(number: float) -> float | None:
    return number if math.isfinite(number) else None


def _told(channel: RawChannel) -> dict[str, int]:
    """Return how many samples carry each flag that the reader itself could tell."""
    if channel.flags is None:
        return {}
    counts = {flag: int(np.count_nonzero(channel.flags & np.uint16(flag))) for flag in Flag if flag}
    return {(flag.name or "").lower(): count for flag, count in counts.items() if count}


def _scale(channel: RawChannel, remarks: list[str]) -> UnitScale:
    try:
        return channel_scale(channel.unit)
    except QuantityError as error:
        remarks.append(f"channel {channel.name!r}: {error.problem}")
        return UnitScale(Kind.OTHER, channel.unit, 1.0)
