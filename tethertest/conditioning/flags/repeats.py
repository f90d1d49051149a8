"""Runs of identical values in a record of any length, gathered block by block."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from tethertest.records.arrays import BoolArray, FloatArray

IntArray = npt.NDArray[np.int64]
#: time [s] and values, both (n,), of the samples from first to last + 1
Reader = Callable[[int, int], tuple[FloatArray, FloatArray]]


@dataclass(frozen=True, slots=True, eq=False)
class Repeats:
    """Runs of identical finite values that last long or have many samples, and what the others amount to."""

    pairs: IntArray  #: (n, 2) first and last sample
    level: FloatArray  #: (n,) the value
    duration: FloatArray  #: (n,) [s]
    long: BoolArray  #: (n,) lasts at least the time asked for
    repeats: float  #: samples of runs that do not last so long and repeat the one before
    samples: float  #: samples of runs that do not last so long
    low: float  #: smallest finite value
    high: float

    @property
    def length(self) -> FloatArray:
        """Samples of each run, (n,)."""
        return (self.pairs[:, 1] - self.pairs[:, 0] + 1).astype(np.float64)

    def share(self, apart: BoolArray) -> float:
        """Return which share of the samples repeats the one before, long runs and some others set apart.

        Parameters
        ----------
        apart : (n,) bool
            Runs that do not count.
        """
        left_out = self.length[apart & ~self.long]
        samples = self.samples - float(np.sum(left_out))
        return (self.repeats - float(np.sum(left_out - 1.0))) / max(samples, 1.0)


def repeats_of(read: Reader, size: int, block: int, *, lasting: float, samples: int) -> Repeats:
    """Gather the runs of identical finite values; a run may reach across blocks.

    Parameters
    ----------
    read : callable
        The record.
    size, block : int
        Its samples, and samples at once.
    lasting : float
        Runs that last so long are kept [s].
    samples : int
        And runs of so many samples.
    """
    parts: list[tuple[IntArray, FloatArray, FloatArray]] = []
    repeats = counted = 0.0
    low, high = np.inf, -np.inf
    carried: tuple[int, float, float] | None = None  # first sample, its time and value, of the open run
    ended_at = 0.0
    for start in range(0, size, block):
        time, values = read(start, min(start + block, size))
        stop = start + values.size
        finite = values[np.isfinite(values)]
        if finite.size:
            low, high = min(low, float(finite.min())), max(high, float(finite.max()))
        new = np.flatnonzero(np.concatenate(([True], np.diff(values) != 0.0)))
        first, begun, level = start + new, time[new], values[new]
        last, ended = np.append(start + new[1:] - 1, stop - 1), np.append(time[new[1:] - 1], time[-1])
        if carried is not None and values[0] == carried[2]:
            first[0], begun[0] = carried[0], carried[1]
        elif carried is not None:
            first, begun = np.append(carried[0], first), np.append(carried[1], begun)
            level = np.append(carried[2], level)
            last, ended = np.append(start - 1, last), np.append(ended_at, ended)
        carried, ended_at = (int(first[-1]), float(begun[-1]), float(level[-1])), float(ended[-1])
        known = np.isfinite(level)
        if stop < size:
            known[-1] = False  # it may go on
        duration, length = (ended - begun)[known], (last - first + 1)[known]
        short = duration < lasting
        repeats += float(np.sum(length[short] - 1))
        counted += float(np.sum(length[short]))
        kept = (length >= samples) | ~short
        pairs = np.column_stack((first[known], last[known]))[kept].astype(np.int64)
        parts.append((pairs, level[known][kept], duration[kept]))
    pairs = np.concatenate([part[0] for part in parts])
    level, duration = (np.concatenate([part[number] for part in parts]) for number in (1, 2))
    return Repeats(pairs, level, duration, duration >= lasting, repeats, counted, low, high)
