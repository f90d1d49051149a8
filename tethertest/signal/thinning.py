"""A record more slowly: means over so many samples, where a rule needs no more."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np

from tethertest.signal.filters import filled, filled_reader
from tethertest.signal.passes import BLOCK, LONGEST, blocks_of
from tethertest.signal.series import Floats, Series

#: a long record keeps at least so many samples in a period of what is looked for
PER_PERIOD: Final = 50.0


def means_of(time: Floats, read: Callable[[int, int], Floats], size: int) -> tuple[Floats, Floats]:
    """Return means of stamps and values over every `size` samples.

    Parameters
    ----------
    time : ndarray
        (n,) [s].
    read : callable
        Values (m,) without NaN of the samples from first to last + 1.
    size : int
        Samples of a mean; what is left at the end has none, a record that is shorter has one.
    """
    size = min(size, time.size)
    times, values = [], []
    for start, stop in blocks_of(time.size // size * size, max(BLOCK // size, 1) * size):
        times.append(time[start:stop].reshape(-1, size).mean(axis=1))
        values.append(read(start, stop).reshape(-1, size).mean(axis=1))
    return np.concatenate(times), np.concatenate(values)


def evenly(series: Series, span: tuple[float, float], frequency: float) -> tuple[Floats, Floats, float]:
    """Return times [s], values and rate [Hz] of a span at even steps, thinned where the record is long.

    Parameters
    ----------
    series : Series
        A channel.
    span : tuple of float
        First time, and the last that is left out [s].
    frequency : float
        What is looked for [Hz].
    """
    rate, size = series.rate, series.time.size
    factor = 1
    if size > LONGEST:
        factor = max(min(-(-size // LONGEST), int(rate / (PER_PERIOD * frequency))), 1)
    if factor == 1:
        known, values = series.time, filled(series)
    else:
        known, values = means_of(series.time, filled_reader(series), factor)
    rate /= factor
    time = np.arange(span[0], span[1], 1.0 / rate)
    return time, np.interp(time, known, values), rate
