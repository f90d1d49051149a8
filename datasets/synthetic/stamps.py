"""Dates and times as loggers print them."""

from __future__ import annotations

from datetime import datetime, timedelta

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

TICK = 100_000
"""Stamps carry five decimals of a second."""


def moment(date: datetime, reading: float) -> datetime:
    """Return the instrument's local date and time for a clock reading."""
    return date + timedelta(microseconds=round(reading * TICK) * 10)


def clock_texts(date: datetime, readings: Floats) -> list[str]:
    """Return 'HH:MM:SS.fffff' of every reading; a run must not pass midnight."""
    midnight = date.replace(hour=0, minute=0, second=0, microsecond=0)
    since = round((date - midnight).total_seconds() * TICK)
    ticks = np.round(readings * TICK).astype(np.int64) + since
    seconds, fraction = np.divmod(ticks, TICK)
    minutes, second = np.divmod(seconds, 60)
    hour, minute = np.divmod(minutes, 60)
    return [
        f"{h:02d}:{m:02d}:{s:02d}.{f:05d}" for h, m, s, f in zip(hour, minute, second, fraction, strict=True)
    ]
