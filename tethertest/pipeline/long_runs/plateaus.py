"""Runs of identical values over a whole record, block by block; see `tethertest.conditioning.plateaus`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from tethertest.conditioning.plateaus import (
    APPROACH,
    IMPROBABLE,
    LEAP_STEPS,
    PLATEAU_WIDTH,
    SHORTEST_PLATEAU,
    SHORTEST_STUCK,
)
from tethertest.pipeline.long_runs.columns import blocks
from tethertest.records.channel import Channel, Flag

#: any samples of one channel: first and last + 1, counted over the rows that are kept
Reader = Callable[[int, int], Channel]


@dataclass(frozen=True, slots=True, eq=False)
class Plateaus:
    """Which samples of a channel stand still and should not."""

    saturated: npt.NDArray[np.int64]  #: (n, 2) first and last sample
    limits: npt.NDArray[np.float64]  #: values of the saturated runs: shorter touches are saturated too
    stuck: npt.NDArray[np.int64]  #: (n, 2)

    def marked(self, channel: Channel, start: int) -> Channel:
        """Return a part of the channel, from sample `start` on, with its flags."""
        size = channel.values.size
        saturated = _inside(self.saturated, start, size) | np.isin(channel.values, self.limits)
        flagged = channel.with_flags(saturated, Flag.SATURATED)
        return flagged.with_flags(_inside(self.stuck, start, size), Flag.STUCK)


@dataclass(slots=True, eq=False)
class _Runs:
    """Runs that are long enough to matter, and what the others amount to."""

    first: list[int]
    last: list[int]
    level: list[float]
    duration: list[float]
    repeats: float = 0.0  #: of short runs: samples that repeat the one before
    samples: float = 0.0  #: of short runs
    low: float = np.inf
    high: float = -np.inf


def plateaus_of(read: Reader, size: int, block: int, noise: Callable[[], float]) -> Plateaus:
    """Return where a channel is saturated or stuck.

    Parameters
    ----------
    read : callable
        The channel, as logged.
    size, block : int
        Its samples, and samples at once.
    noise : callable
        Its step or noise, whichever is larger; asked for a displacement only.
    """
    runs = _runs(read, size, block)
    pairs = np.column_stack((np.array(runs.first, dtype=np.int64), np.array(runs.last, dtype=np.int64)))
    level, duration = np.array(runs.level), np.array(runs.duration)
    nothing = np.zeros((0, 2), dtype=np.int64)
    long = duration >= SHORTEST_STUCK
    if read(0, 1).kind == "displacement":
        step = noise() if long.any() else 0.0
        leaps = [_leaps(read, size, first, last, step) for first, last in pairs[long].tolist()]
        return Plateaus(nothing, np.zeros(0), pairs[long][np.array(leaps, dtype=bool)])
    length = (pairs[:, 1] - pairs[:, 0] + 1).astype(float)
    repeated = runs.repeats / max(runs.samples, 1.0)
    improbable = size * max(repeated, 1.0 / size) ** (length - 1.0) < IMPROBABLE
    width = PLATEAU_WIDTH * (runs.high - runs.low)
    extreme = (level >= runs.high - width) | (level <= runs.low + width)
    saturated = improbable & extreme & (length >= SHORTEST_PLATEAU)
    stuck = improbable & long & ~saturated
    limits = np.unique(level[saturated])
    return Plateaus(pairs[saturated], limits, pairs[stuck & ~np.isin(level, limits)])


def _runs(read: Reader, size: int, block: int) -> _Runs:
    """Return the runs of identical finite values; a run may reach across blocks."""
    runs = _Runs([], [], [], [])
    carried: tuple[int, float, float] | None = None  # first sample, its time and value, of the open run
    for start, stop in blocks(size, block):
        channel = read(start, stop)
        values, time = channel.values, channel.time
        finite = values[np.isfinite(values)]
        if finite.size:
            runs.low, runs.high = min(runs.low, float(finite.min())), max(runs.high, float(finite.max()))
        new = np.flatnonzero(np.concatenate(([True], np.diff(values) != 0.0)))
        first, begun, level = start + new, time[new], values[new]
        if carried is not None and values[0] == carried[2]:
            first[0], begun[0] = carried[0], carried[1]
        elif carried is not None:
            previous = read(start - 1, start)
            _note(runs, np.array([carried[0]]), np.array([start - 1]), np.array([carried[2]]),
                  np.array([previous.time[0] - carried[1]]))  # fmt: skip
        last, ended = np.append(start + new[1:] - 1, stop - 1), np.append(time[new[1:] - 1], time[-1])
        carried = (int(first[-1]), float(begun[-1]), float(level[-1]))
        part = slice(0, -1) if stop < size else slice(None)
        _note(runs, first[part], last[part], level[part], (ended - begun)[part])
    return runs


def _note(runs: _Runs, first: np.ndarray, last: np.ndarray, level: np.ndarray, duration: np.ndarray) -> None:
    known = np.isfinite(level)
    first, last, level, duration = first[known], last[known], level[known], duration[known]
    length = last - first + 1
    short = duration < SHORTEST_STUCK
    runs.repeats += float(np.sum(length[short] - 1))
    runs.samples += float(np.sum(length[short]))
    matters = (length >= SHORTEST_PLATEAU) | ~short
    runs.first += first[matters].tolist()
    runs.last += last[matters].tolist()
    runs.level += level[matters].tolist()
    runs.duration += duration[matters].tolist()


def _leaps(read: Reader, size: int, first: int, last: int, step: float) -> bool:
    """Return whether a run ends with a leap, or follows motion too fast to have stopped by itself."""
    end = read(last, min(last + 2, size))
    leap = abs(end.values[-1] - end.values[0]) > LEAP_STEPS * step
    rate = read(max(first - 64, 0), first + 64).rate
    reach = max(round(APPROACH * rate), 1)
    start = read(max(first - reach, 0), first + 1)
    return bool(leap or abs(start.values[-1] - start.values[0]) > LEAP_STEPS * step)


def _inside(pairs: npt.NDArray[np.int64], start: int, size: int) -> npt.NDArray[np.bool_]:
    mask = np.zeros(size, dtype=bool)
    near = pairs[(pairs[:, 1] >= start) & (pairs[:, 0] < start + size)] - start
    for first, last in near.tolist():
        mask[max(first, 0) : last + 1] = True
    return mask
