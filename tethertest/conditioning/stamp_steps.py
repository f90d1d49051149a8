"""The steps between a log's stamps, as they are: repeats, gaps, jitter, and stamps cut to whole steps."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tethertest.records.arrays import BoolArray, FloatArray

#: steps below this fraction of the median step are a stamp that repeats
DUPLICATE_FRACTION = 1e-3
#: a step longer than this many median steps is a gap
GAP_STEPS = 1.5
#: repeated stamps in more than this fraction of the rows come from a coarse stamp, not from a row written
#: twice
COARSE_FRACTION = 0.02
#: stamps of even rows are one or two quanta apart, or two or three: farther apart they differ by less than a
#: gap does
_MOST_QUANTA = 2
#: a step is a number of quanta within this share of one: stamps of 12.5 ms are written as 0.012 and 0.025
_WRITTEN = 0.2
#: this share of the steps may be neither: gaps, and what else happens to stamps
_STRAY = 0.01
#: each of the two is seen this often at least, and the stamps stay this many quanta from even time: half of
#: one is their own, and that twelve rows lost by chance lie so evenly is one in 1e4
_FEWEST, _FROM_EVEN = 12, 0.65
#: stamps that are cut repeat themselves after few rows where their quantum and the rows' step have a common
#: one: 10 ms and 60 Hz after three
_PATTERN = 12


@dataclass(frozen=True, slots=True)
class Quantised:
    """Stamps that are cut to whole quanta nearly as long as the rows' own step.

    Rows every 17.3 ms with stamps of 12.5 ms are 12.5 ms or 25 ms apart: that is no jitter, and no row is
    missing.
    """

    quantum: float  #: [s]
    step: float  #: the rows' own [s]
    longest: float  #: between two stamps of neighbouring rows at most [s]
    pattern: int  #: rows after which the steps repeat themselves exactly, 0 where they do not


@dataclass(frozen=True, slots=True, eq=False)
class Steps:
    """What the steps between stamps are like, before anything is mended."""

    median: float  #: of the steps forward [s]; 0 where there is none
    duplicate: BoolArray  #: (n,) True where a stamp repeats the one before it, or goes back
    backward: BoolArray  #: (n,) True where time goes back
    gap: BoolArray  #: (n,) True behind a step that is longer than between neighbouring rows
    jitter: float  #: standard deviation of the steps that are no gaps and no repeats [s]
    quantised: Quantised | None

    @property
    def step(self) -> float:
        """Between neighbouring rows [s]; 0 where no stamp goes forward."""
        return self.median if self.quantised is None else self.quantised.step

    @property
    def coarse(self) -> bool:
        """Whether so many stamps repeat that the clock is coarser than the rows."""
        return int(np.count_nonzero(self.duplicate)) > COARSE_FRACTION * self.duplicate.size


def steps_of(time: FloatArray) -> Steps:
    """Sort the steps between stamps.

    Parameters
    ----------
    time : ndarray
        (n,) [s], finite, as logged.
    """
    step = np.diff(time)
    median = float(np.median(step[step > 0])) if np.any(step > 0) else 0.0
    ordinary = step[(step > (2.0 - GAP_STEPS) * median) & (step < GAP_STEPS * median)]
    quantised = quantised_steps(time)
    longest = GAP_STEPS * median if quantised is None else max(GAP_STEPS * median, quantised.longest)
    return Steps(
        median,
        np.concatenate(([False], step <= DUPLICATE_FRACTION * median)),
        np.concatenate(([False], step < 0)),
        np.concatenate(([False], step > longest)),
        float(np.std(ordinary)) if ordinary.size else 0.0,
        quantised,
    )


def quantised_steps(time: FloatArray) -> Quantised | None:
    """Return the quantum to which stamps of even rows are cut, None where they are not.

    Parameters
    ----------
    time : ndarray
        (n,) [s], finite, as logged.

    Notes
    -----
    Rows lost by chance from an exact clock leave single and double steps too, but their stamps wander from
    even time as the root of the losses; stamps that are cut stay within half a quantum of it however long the
    record is. Rows lost in a pattern that repeats itself look the same as both.
    """
    step = np.diff(time)
    forward = step[step > 0]
    if forward.size < 2 * _FEWEST:
        return None
    median = float(np.median(forward))
    for fewer in range(1, _MOST_QUANTA + 1):
        for quanta in (fewer, fewer + 1):
            found = _evenly_cut(time, step, median / quanta, fewer)
            if found is not None:
                return found
    return None


def _evenly_cut(time: FloatArray, step: FloatArray, quantum: float, fewer: int) -> Quantised | None:
    """Return the stamps' quantum if their steps are `fewer` quanta or one more, as even rows make them."""
    longest = (fewer + 1.5) * quantum
    short, long = (np.abs(step / quantum - quanta) < _WRITTEN for quanta in (fewer, fewer + 1))
    stray = np.count_nonzero(~short & ~long)
    if min(np.count_nonzero(short), np.count_nonzero(long)) < _FEWEST or stray > _STRAY * step.size:
        return None
    period, even = even_rows(time, longest)
    if float(np.max(np.abs(even - time))) > _FROM_EVEN * quantum:
        return None
    quanta = fewer * np.count_nonzero(short) + (fewer + 1) * np.count_nonzero(long)
    exact = float(np.sum(step[short | long])) / int(quanta)
    return Quantised(exact, period, longest, _pattern(short, long))


def _pattern(short: BoolArray, long: BoolArray) -> int:
    """Return after how many steps they repeat themselves all along, 0 if they do not within `_PATTERN`."""
    stray = ~(short | long)
    for rows in range(1, _PATTERN + 1):
        same = long[rows:] == long[:-rows]
        # behind a gap the pattern may begin anywhere
        across = np.convolve(stray, np.ones(rows + 1))[rows:-rows] > 0
        if np.all(same | across):
            return rows
    return 0


def even_rows(time: FloatArray, longest: float) -> tuple[float, FloatArray]:
    """Return the rows' own step and even times through the stamps.

    Parameters
    ----------
    time : ndarray
        (n,) [s], as logged.
    longest : float
        Rows may be missing across a longer step [s]: what follows it lies on a line of its own, of the same
        slope.
    """
    stretch = np.concatenate(([0], np.cumsum(np.diff(time) > longest)))
    row = np.arange(time.size, dtype=float)
    count = np.bincount(stretch)
    row_mean = (np.bincount(stretch, row) / count)[stretch]
    time_mean = (np.bincount(stretch, time) / count)[stretch]
    slope = float(np.sum((row - row_mean) * (time - time_mean)) / np.sum((row - row_mean) ** 2))
    return slope, np.asarray(time_mean + slope * (row - row_mean), dtype=np.float64)
