"""What the channels of a log are, for people and programs."""

from __future__ import annotations

import math

import numpy as np

from tethertest.errors import QuantityError
from tethertest.records.channel import Flag, RawChannel, RawLog
from tethertest.records.inspected import ChannelSeen
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
    with np.errstate(over="ignore", invalid="ignore"):  # what is then infinite is told as unknown
        values = channel.values[np.isfinite(channel.values)] * scale.factor + scale.offset
        mean = float(values.mean()) if values.size else math.nan
    time = channel.time[np.isfinite(channel.time)]  # a row may have no stamp
    steps = np.diff(time)
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
        minimum=_known(float(values.min())) if values.size else None,
        mean=_known(mean),
        maximum=_known(float(values.max())) if values.size else None,
        flags={"missing": channel.values.size - values.size, **_told(channel)},
    )


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
