"""Steps: the level of a load cell leaps from one sample to the next and stays, and no other cell says so."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from tethertest.records.arrays import BoolArray, FloatArray
from tethertest.records.channel import Channel, Flag
from tethertest.signal.filters import filled_reader
from tethertest.signal.noise import white_noise_of
from tethertest.signal.passes import blocks_of

#: height of the edge, in standard deviations of one sample
HEIGHT_SIGMAS = 12.0
#: the edge is steeper by this factor than every step around it: a snap rises over many samples
ISOLATION = 3.0
#: samples on either side that are looked at for that, and that make up the level beside the edge
AROUND, BESIDE = 10, 3
#: rows beside a block that decide about its own
CONTEXT = 2 * AROUND
#: levels beside the edge differ by this share of it: at a spike they do not
STAYS_NEAR = 0.7
#: the difference to the other load cell changes by this share of the edge beside it (within the first time),
#: and by as much as the edge within this share farther out: snaps come and go, a zero stays [s]
STAYS, NEAR_TIME = 0.5, 0.3
SAME_HEIGHT, FAR_TIME = 0.3, 3.0


def with_steps_flagged(channels: Sequence[Channel]) -> tuple[Channel, ...]:
    """Return the channels with `Flag.STEP` on the first sample after a leap of a load cell's zero.

    Parameters
    ----------
    channels : sequence of Channel
        All channels of a run on one clock; tensions [N] are looked at, each against the others.

    Returns
    -------
    tuple of Channel
        The same channels, in the same order.
    """
    cells = [channel for channel in channels if channel.kind == "tension" and channel.usable.any()]
    return tuple(
        channel.with_flags(_steps(channel, [other for other in cells if other is not channel]), Flag.STEP)
        if any(channel is cell for cell in cells)
        else channel
        for channel in channels
    )


def _steps(channel: Channel, others: Sequence[Channel]) -> BoolArray:
    size = channel.time.size
    found = np.zeros(size, dtype=bool)
    read, usable = filled_reader(channel), channel.usable
    sigma = white_noise_of(read, size)
    if sigma == 0.0 or size < 4 * AROUND:
        return found
    for start, stop in blocks_of(size):
        first, last = max(start - CONTEXT, 0), min(stop + CONTEXT, size)
        values = read(first, last)
        edge = np.diff(values)
        for row in _alone(values, edge, sigma, usable[first:last]).tolist():
            if start <= first + row < stop and _stays(channel, read, others, first + row, float(edge[row])):
                found[first + row + 1] = True
    return found


def _alone(values: FloatArray, edge: FloatArray, sigma: float, usable: BoolArray) -> np.ndarray:
    """Return the rows of edges that stand alone between two levels."""
    height = np.abs(edge)
    rows = np.arange(AROUND, edge.size - AROUND - 1)
    rows = rows[height[rows] > HEIGHT_SIGMAS * np.sqrt(2.0) * sigma]
    around = np.lib.stride_tricks.sliding_window_view(height, AROUND)
    beside = np.maximum(around[rows - AROUND].max(axis=1), around[rows + 1].max(axis=1))
    rows = rows[height[rows] > ISOLATION * beside]
    near = rows[:, None] + np.arange(1 - BESIDE, 1 + BESIDE)
    levels = values[near].reshape(rows.size, 2, BESIDE).mean(axis=2)
    stays = (levels[:, 1] - levels[:, 0]) / edge[rows] > STAYS_NEAR
    whole = usable[rows[:, None] + np.arange(-BESIDE, BESIDE + 2)].all(axis=1)
    alone: np.ndarray = rows[stays & whole]
    return alone


def _stays(
    channel: Channel,
    read: Callable[[int, int], FloatArray],
    others: Sequence[Channel],
    row: int,
    height: float,
) -> bool:
    """Return whether the new level stays, against the other load cells where there are any."""
    near, far = (max(round(length * channel.rate), AROUND) for length in (NEAR_TIME, FAR_TIME))
    first, last = max(row + 1 - far, 0), min(row + 1 + far, channel.time.size)
    time, own = channel.time[first:last], read(first, last)
    here = row + 1 - first
    if here < AROUND or own.size - here < AROUND:
        return False
    beside = slice(max(here - near, 0), here + near)
    if not others:
        return bool(_jump(own[beside], min(here, near)) / height > STAYS)
    for other in others:
        apart = own - _values_at(other, time)
        if _level_change(apart[beside], min(here, near)) / height < STAYS:
            return False
        if abs(_level_change(apart, here) / height - 1.0) > SAME_HEIGHT:
            return False
    return True


def _values_at(other: Channel, time: FloatArray) -> FloatArray:
    """Return another channel's values at some times, straight across what is not usable."""
    first, last = np.searchsorted(other.time, time[[0, -1]])
    first, last = max(int(first) - 1, 0), min(int(last) + 1, other.time.size)
    return np.interp(time, other.time[first:last], filled_reader(other)(first, last))


def _level_change(values: FloatArray, here: int) -> float:
    return float(np.median(values[here:]) - np.median(values[:here]))


def _jump(values: FloatArray, here: int) -> float:
    """Return what lies between straight lines through the values before and after, at the edge."""
    row = np.arange(values.size, dtype=np.float64)
    before = np.polynomial.polynomial.polyfit(row[:here] - here, values[:here], 1)
    after = np.polynomial.polynomial.polyfit(row[here:] - here, values[here:], 1)
    return float(after[0] - before[0])
