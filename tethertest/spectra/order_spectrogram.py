"""Amplitude against time and order of the drive, over a whole record."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from tethertest.errors import DataError
from tethertest.records.arrays import FloatArray, frozen
from tethertest.records.channel import Channel
from tethertest.signal.filters import filled, moving_mean

#: periods of the drive in one column: orders a half apart are told apart
PERIODS: Final = 6.0
#: columns begin this many times per column's length, at the least and at the most
FEWEST_STARTS, MOST_STARTS = 4, 16
#: a picture has no more columns of pixels; neighbours are then joined, the greatest amplitude kept
MOST_COLUMNS: Final = 1200
#: columns transformed at a time, which bounds the memory
_AT_ONCE: Final = 256
LOWEST_ORDER: Final = 0.25
HIGHEST_ORDER: Final = 6.0
#: orders per order
_STEPS: Final = 32
#: samples per period of the highest order, so that averaging takes 0.2 % of it at most
_SAMPLES: Final = 32.0
#: numbers that hide rounding in a count
_HAIR: Final = 1e-6


@dataclass(frozen=True, slots=True, eq=False)
class OrderSpectrogram:
    """Amplitude against time and order of the drive."""

    channel: str
    unit: str
    time: FloatArray  #: (n,) [s], middle of each column
    order: FloatArray  #: (m,)
    amplitude: FloatArray  #: (m, n) peak of a cosine, in `unit`


def order_spectrogram(channel: Channel, frequency: float) -> OrderSpectrogram:
    """Return the amplitude of a whole record against time and order, by Hann windows of `PERIODS` periods.

    Parameters
    ----------
    channel : Channel
        Straight lines bridge samples that may not be used. What is slower than a column is taken out.
    frequency : float
        Of the drive [Hz].

    Raises
    ------
    DataError
        The record is shorter than one column, has fewer than two samples per period, or no usable sample.
    """
    width = max(1, int(channel.rate / (_SAMPLES * HIGHEST_ORDER * frequency)))
    rate = channel.rate / width
    count = int((channel.time[-1] - channel.time[0]) * channel.rate + 1.0 + _HAIR) // width
    length = math.ceil(PERIODS / frequency * rate - _HAIR) if rate else 0
    if count < length or rate <= 2.0 * frequency:
        message = f"channel {channel.name!r} is shorter than {PERIODS:g} periods of {frequency:.4g} Hz"
        if rate <= 2.0 * frequency:
            message = f"channel {channel.name!r} has at most two samples per period of {frequency:.4g} Hz"
        raise DataError(message, "use a longer or faster record for a spectrogram")
    grid = channel.time[0] + np.arange(count * width) / channel.rate
    values = np.interp(grid, channel.time, filled(channel)).reshape(count, width).mean(axis=1)
    values = values - moving_mean(values, length)
    order = np.arange(LOWEST_ORDER, HIGHEST_ORDER + _HAIR, 1.0 / _STEPS)
    order = order[order * frequency < 0.5 * rate]
    taper = np.sin(np.pi * (np.arange(length) + 0.5) / length) ** 2
    kernels = np.exp(np.outer(order, -2j * np.pi * frequency * np.arange(length) / rate)) * taper
    step = max(length // MOST_STARTS, min(length // FEWEST_STARTS, count // MOST_COLUMNS), 1)
    starts = np.arange(0, count - length + 1, step)
    columns = np.lib.stride_tricks.sliding_window_view(values, length)
    parts = [
        np.abs(kernels @ columns[starts[first : first + _AT_ONCE]].T)
        for first in range(0, starts.size, _AT_ONCE)
    ]
    amplitude = np.concatenate(parts, axis=1) * (2.0 / taper.sum())
    joined = np.arange(0, starts.size, -(-starts.size // MOST_COLUMNS))
    last = np.append(joined[1:], starts.size) - 1
    middle = 0.5 * (starts[joined] + starts[last] + length - 1) + 0.5 * (1.0 - 1.0 / width)
    return OrderSpectrogram(
        channel.name,
        channel.unit,
        frozen(channel.time[0] + middle / rate),
        frozen(order),
        frozen(np.maximum.reduceat(amplitude, joined, axis=1)),
    )
