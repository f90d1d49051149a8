"""What a log is, as one object for people and programs."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from tethertest.errors import QuantityError
from tethertest.records.channel import Flag, RawChannel, RawLog
from tethertest.units import UnitScale, channel_scale


def describe(log: RawLog) -> dict[str, Any]:
    """Describe a log as read, before any conditioning.

    Parameters
    ----------
    log : RawLog
        As `read_log` returns it.

    Returns
    -------
    dict
        The object of ``inspect --json``: SI values, None where there are none.
    """
    remarks = list(log.remarks)
    channels = [_channel(channel, remarks) for channel in log.channels]
    return {
        "path": str(log.path),
        "format": log.format,
        "encoding": log.encoding,
        "start": None if log.start is None else log.start.isoformat(),
        "decimal": log.decimal,
        "separator": log.separator,
        "date_order": log.date_order,
        "header_line": log.header_line,
        "rate": log.rate,
        "sha256": log.sha256,
        "channels": channels,
        "remarks": remarks,
        "reason": log.reason,
    }


def _channel(channel: RawChannel, remarks: list[str]) -> dict[str, Any]:
    scale = _scale(channel, remarks)
    with np.errstate(over="ignore", invalid="ignore"):  # what is then infinite is told as unknown
        values = channel.values[np.isfinite(channel.values)] * scale.factor + scale.offset
        mean = float(values.mean()) if values.size else math.nan
    time = channel.time[np.isfinite(channel.time)]  # a row may have no stamp
    steps = np.diff(time)
    forward = steps[steps > 0]
    rate = 1.0 / float(np.median(forward)) if forward.size else math.nan
    return {
        "name": channel.name,
        "kind": scale.kind,
        "unit_as_written": channel.unit,
        "unit": scale.unit,
        "n": int(channel.values.size),
        "rate": _known(rate),
        "duration": float(time.max() - time.min()) if time.size else 0.0,
        "minimum": _known(float(values.min())) if values.size else None,
        "mean": _known(mean),
        "maximum": _known(float(values.max())) if values.size else None,
        "flags": {"missing": int(channel.values.size - values.size), **_told(channel)},
    }


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
        return UnitScale("other", channel.unit, 1.0)
