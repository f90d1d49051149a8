"""Load cycles by rainflow counting, and extremes."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import chain
from typing import Final

import numpy as np

from tethertest.errors import DataError
from tethertest.records.arrays import FloatArray
from tethertest.records.channel import Channel, Window
from tethertest.records.events import Cycle, CycleCount, Extremes
from tethertest.signal.passes import blocks_of

#: ranges below this many standard deviations of one sample are noise: a few thousand normal values span it
NOISE_RANGE: Final = 8.0
#: slope of the S-N curve where the caller knows none: six-strand steel wire rope has 4 in DNV-OS-E301
EXPONENT: Final = 4.0


def extremes(channel: Channel, window: Window | None = None) -> Extremes:
    """Return the largest and the smallest usable value.

    Raises
    ------
    DataError
        No sample is usable.
    """
    time, values = _used(channel, window)
    highest, lowest = int(np.argmax(values)), int(np.argmin(values))
    return Extremes(float(values[highest]), float(time[highest]), float(values[lowest]), float(time[lowest]))


def count_cycles(
    channel: Channel,
    window: Window | None = None,
    *,
    smallest: float | None = None,
    exponent: float = EXPONENT,
) -> CycleCount:
    """Count load cycles by the rainflow rule of ASTM E1049-85 (2017), 5.4.4.

    Parameters
    ----------
    channel : Channel
        Usable samples only enter.
    window : Window, optional
        All of the record where absent.
    smallest : float, optional
        Smaller ranges are left out before counting; where absent, what the channel's noise makes.
    exponent : float
        Slope of the S-N curve for the equivalent range ``(sum n_i r_i^m / sum n_i)^(1/m)``.

    Raises
    ------
    DataError
        No sample is usable, or the exponent is not positive.
    """
    from rainflow import extract_cycles

    if not exponent > 0.0:
        message = f"slope of the S-N curve: found {exponent:g}, expected a number above zero"
        raise DataError(message, "give the slope of the rope's S-N curve, such as 4")
    _, values = _used(channel, window)
    gate = NOISE_RANGE * channel.noise if smallest is None else smallest
    turning = turning_points(values, gate)
    found = [Cycle(float(size), float(mean), float(n)) for size, mean, n, _, _ in extract_cycles(turning)]
    cycles = tuple(sorted(found, key=lambda cycle: -cycle.range))
    number = sum(cycle.count for cycle in cycles)
    largest = cycles[0].range if cycles else 0.0
    equivalent = 0.0
    if largest > 0.0:  # ratios to the largest: a high power of a newton overflows nothing
        mean = sum(cycle.count * (cycle.range / largest) ** exponent for cycle in cycles) / number
        equivalent = largest * float(mean ** (1.0 / exponent))
    return CycleCount(cycles, float(gate), exponent, equivalent)


def turning_points(values: FloatArray, gate: float) -> FloatArray:
    """Return the ends of a series and its reversals, without excursions smaller than `gate`."""
    if values.size < 3:
        return values
    parts = chain((values[:1],), _reversals(values), (values[-1:],))
    points = (point for part in parts for point in part.tolist())
    if gate <= 0.0:
        return np.array(list(points))
    kept = [next(points)]
    direction = 0.0
    for value in points:
        step = value - kept[-1]
        if direction * step > 0.0:  # further the same way: the turn moves on
            kept[-1] = value
        elif abs(step) >= gate:
            kept.append(value)
            direction = np.sign(step)
    return np.array(kept)


def _reversals(values: FloatArray) -> Iterator[FloatArray]:
    """Yield the values at which a series turns, block by block."""
    before = 0.0  # sign of the latest slope that is none of a level stretch
    for start, stop in blocks_of(values.size - 1):
        slopes = np.sign(np.diff(values[start : stop + 1]))
        moving = np.flatnonzero(slopes)
        if moving.size:
            signs = slopes[moving]
            previous = np.concatenate(([before or signs[0]], signs[:-1]))
            yield values[start + moving[signs != previous]]
            before = float(signs[-1])


def _used(channel: Channel, window: Window | None) -> tuple[FloatArray, FloatArray]:
    part = channel if window is None else channel.between(window.start, window.stop)
    usable = part.usable
    if not usable.any():
        message = f"channel {channel.name!r} has no usable sample"
        raise DataError(message, "choose another window or take the channel out")
    return (part.time, part.values) if usable.all() else (part.time[usable], part.values[usable])
