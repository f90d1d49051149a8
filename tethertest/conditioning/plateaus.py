"""Runs of identical values: a saturated amplifier or a stuck channel."""

from __future__ import annotations

import numpy as np

from tethertest.records.arrays import BoolArray, FloatArray
from tethertest.records.channel import Channel, Flag
from tethertest.signal.noise import quantum, white_noise

#: a stuck channel repeats its value at least this long [s]
SHORTEST_STUCK = 0.5
#: a saturated one repeats its extreme at least this many times in a row
SHORTEST_PLATEAU = 4
#: and no sample goes beyond the plateau by more than this fraction of the record's range
PLATEAU_WIDTH = 1e-6
#: runs that noise makes this improbable in the whole record are none of its doing
IMPROBABLE = 1e-6
#: an encoder that stands still repeats itself rightly: only a leap of so many steps at the end of the run,
#: or motion as fast before it, shows that it was stuck
LEAP_STEPS = 20.0
#: motion before the run is measured over this time [s]
APPROACH = 0.1


def with_plateaus_flagged(channel: Channel) -> Channel:
    """Return the channel with `Flag.SATURATED` at repeated extremes and `Flag.STUCK` in other long runs.

    Parameters
    ----------
    channel : Channel
        As logged, before any filter. A displacement (an encoder's counts) may stand still; any other
        channel has noise that moves it.
    """
    values = channel.values
    first, last = _runs(values)
    length = last - first + 1
    if not length.size or channel.time.size < 2:
        return channel
    duration = channel.time[last] - channel.time[first]
    long = duration >= SHORTEST_STUCK
    if channel.kind == "displacement":
        stuck = long & _leaps(channel, first, last)
        return channel.with_flags(_mask(values.size, first[stuck], last[stuck]), Flag.STUCK)
    short = ~long
    repeated = float(np.sum(length[short] - 1)) / max(float(np.sum(length[short])), 1.0)
    expected = values.size * max(repeated, 1.0 / values.size) ** (length - 1.0)
    improbable = expected < IMPROBABLE
    level = values[first]
    width = PLATEAU_WIDTH * float(np.nanmax(values) - np.nanmin(values))
    extreme = (level >= np.nanmax(values) - width) | (level <= np.nanmin(values) + width)
    saturated = improbable & extreme & (length >= SHORTEST_PLATEAU)
    stuck = improbable & long & ~saturated
    if saturated.any():
        # shorter touches of the same limit are saturated too
        limits = np.unique(level[saturated])
        saturated |= np.isin(level, limits)
    flagged = channel.with_flags(_mask(values.size, first[saturated], last[saturated]), Flag.SATURATED)
    return flagged.with_flags(_mask(values.size, first[stuck], last[stuck]), Flag.STUCK)


def _runs(values: FloatArray) -> tuple[np.ndarray, np.ndarray]:
    """Return first and last index of every run of identical finite values; single values are runs of one."""
    same = np.concatenate(([False], np.diff(values) == 0.0))
    first = np.flatnonzero(~same & np.isfinite(values))
    ends = np.append(np.flatnonzero(~same)[1:], values.size) - 1
    last = ends[np.isfinite(values[np.flatnonzero(~same)])]
    return first, last


def _leaps(channel: Channel, first: np.ndarray, last: np.ndarray) -> BoolArray:
    """Return which runs end with a leap, or follow motion too fast to have stopped by itself."""
    values = channel.values
    step = max(quantum(values[np.isfinite(values)]), white_noise(values))
    following = values[np.minimum(last + 1, values.size - 1)]
    leap = np.abs(following - values[last]) > LEAP_STEPS * step
    reach = max(round(min(APPROACH * channel.rate, values.size)), 1)
    before = values[np.maximum(first - reach, 0)]
    fast = np.abs(values[first] - before) > LEAP_STEPS * step
    return np.asarray(leap | fast, dtype=bool)


def _mask(size: int, first: np.ndarray, last: np.ndarray) -> BoolArray:
    marks = np.zeros(size + 1, dtype=np.int64)
    np.add.at(marks, first, 1)
    np.add.at(marks, last + 1, -1)
    return np.asarray(np.cumsum(marks)[:-1] > 0, dtype=bool)
