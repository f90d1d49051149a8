"""The steps between a log's stamps, as they are: repeats, gaps, jitter, and stamps cut to whole steps."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from tethertest.records.arrays import BoolArray, FloatArray
from tethertest.signal.passes import BLOCK, blocks_of

#: stamps (n,) [s], finite, of the rows from first to last + 1
StampReader: TypeAlias = Callable[[int, int], FloatArray]

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
#: places of a long record at which its usual step is measured
SAMPLED = 64


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


@dataclass(frozen=True, slots=True)
class Stepping:
    """What the steps between stamps are like together, before anything is mended."""

    median: float  #: of the steps forward [s]; 0 where there is none
    duplicates: int  #: stamps that repeat the one before them, or go back
    backward: int  #: stamps that go back
    jitter: float  #: standard deviation of the steps that are no gaps and no repeats [s]
    quantised: Quantised | None
    rows: int

    @property
    def step(self) -> float:
        """Between neighbouring rows [s]; 0 where no stamp goes forward."""
        return self.median if self.quantised is None else self.quantised.step

    @property
    def coarse(self) -> bool:
        """Whether so many stamps repeat that the clock is coarser than the rows."""
        return self.duplicates > COARSE_FRACTION * self.rows

    @property
    def longest(self) -> float:
        """The longest step that is no gap [s]."""
        usual = GAP_STEPS * self.median
        return usual if self.quantised is None else max(usual, self.quantised.longest)


def stepping_of(read: StampReader, size: int, block: int = BLOCK) -> Stepping:
    """Look at all steps between the stamps of a record.

    Parameters
    ----------
    read : callable
        The stamps, as logged.
    size, block : int
        Rows, and rows at once.
    """
    median = _median_step(read, size)
    duplicates = backward = ordinary = 0
    total = square = 0.0
    low, high = (2.0 - GAP_STEPS) * median, GAP_STEPS * median
    for step in _steps(read, size, block):
        duplicates += int(np.count_nonzero(step <= DUPLICATE_FRACTION * median))
        backward += int(np.count_nonzero(step < 0))
        usual = step[(step > low) & (step < high)]
        ordinary, total = ordinary + usual.size, total + float(np.sum(usual))
    mean = total / ordinary if ordinary else 0.0
    for step in _steps(read, size, block):
        usual = step[(step > low) & (step < high)] - mean
        square += float(np.sum(usual * usual))
    jitter = float(np.sqrt(square / ordinary)) if ordinary else 0.0
    return Stepping(median, duplicates, backward, jitter, quantised_steps(read, size, block), size)


def _steps(read: StampReader, size: int, block: int) -> Iterator[FloatArray]:
    """Yield the steps, block by block."""
    for start, stop in blocks_of(max(size - 1, 0), block):
        yield np.diff(read(start, stop + 1))


def _median_step(read: StampReader, size: int) -> float:
    """Return the median of the steps forward, of a sample of them where the record is long; 0 for none."""
    if size <= BLOCK:
        step = np.diff(read(0, size))
    else:
        piece = BLOCK // SAMPLED
        starts = np.linspace(0, size - piece, SAMPLED).astype(int).tolist()
        step = np.concatenate([np.diff(read(start, start + piece)) for start in starts])
    forward = step[step > 0]
    return float(np.median(forward)) if forward.size else 0.0


@dataclass(frozen=True, slots=True, eq=False)
class Steps:
    """The steps between stamps, each told what it is."""

    together: Stepping
    duplicate: BoolArray  #: (n,) True where a stamp repeats the one before it, or goes back
    backward: BoolArray  #: (n,) True where time goes back
    gap: BoolArray  #: (n,) True behind a step that is longer than between neighbouring rows

    @property
    def median(self) -> float:
        """Of the steps forward [s]; 0 where there is none."""
        return self.together.median

    @property
    def jitter(self) -> float:
        """Standard deviation of the steps that are no gaps and no repeats [s]."""
        return self.together.jitter

    @property
    def quantised(self) -> Quantised | None:
        """The stamps' quantum, if they are cut to whole ones."""
        return self.together.quantised

    @property
    def step(self) -> float:
        """Between neighbouring rows [s]; 0 where no stamp goes forward."""
        return self.together.step


def steps_of(time: FloatArray) -> Steps:
    """Sort the steps between stamps.

    Parameters
    ----------
    time : ndarray
        (n,) [s], finite, as logged.
    """
    together = stepping_of(reader_of(time), time.size)
    marks = np.zeros((3, time.size), dtype=bool)
    for start, stop in blocks_of(max(time.size - 1, 0)):
        step = np.diff(time[start : stop + 1])
        marks[0, start + 1 : stop + 1] = step <= DUPLICATE_FRACTION * together.median
        marks[1, start + 1 : stop + 1] = step < 0
        marks[2, start + 1 : stop + 1] = step > together.longest
    return Steps(together, marks[0], marks[1], marks[2])


def reader_of(time: FloatArray) -> StampReader:
    """Return the stamps of an array as rows that are asked for."""
    return lambda start, stop: time[start:stop]


def quantised_steps(read: StampReader, size: int, block: int = BLOCK) -> Quantised | None:
    """Return the quantum to which stamps of even rows are cut, None where they are not.

    Parameters
    ----------
    read : callable
        The stamps, as logged.
    size, block : int
        Rows, and rows at once.

    Notes
    -----
    Rows lost by chance from an exact clock leave single and double steps too, but their stamps wander from
    even time as the root of the losses; stamps that are cut stay within half a quantum of it however long the
    record is. Rows lost in a pattern that repeats itself look the same as both.
    """
    if sum(int(np.count_nonzero(step > 0)) for step in _steps(read, size, block)) < 2 * _FEWEST:
        return None
    median = _median_step(read, size)
    for fewer in range(1, _MOST_QUANTA + 1):
        for quanta in (fewer, fewer + 1):
            found = _evenly_cut(read, size, block, median / quanta, fewer)
            if found is not None:
                return found
    return None


def _evenly_cut(read: StampReader, size: int, block: int, quantum: float, fewer: int) -> Quantised | None:
    """Return the stamps' quantum if their steps are `fewer` quanta or one more, as even rows make them."""
    longest = (fewer + 1.5) * quantum

    def cut(step: FloatArray) -> tuple[BoolArray, BoolArray]:
        short, long = (np.abs(step / quantum - quanta) < _WRITTEN for quanta in (fewer, fewer + 1))
        return np.asarray(short), np.asarray(long)

    shorts = longs = stray = 0
    total = 0.0
    for step in _steps(read, size, block):
        short, long = cut(step)
        shorts, longs = shorts + int(np.count_nonzero(short)), longs + int(np.count_nonzero(long))
        stray += int(np.count_nonzero(~short & ~long))
        total += float(np.sum(step[short | long]))
    if min(shorts, longs) < _FEWEST or stray > _STRAY * (size - 1):
        return None
    even = EvenRows.of(read, size, longest, block)
    if max(float(np.max(np.abs(rows - time))) for _, time, rows in even.blocks()) > _FROM_EVEN * quantum:
        return None
    parts = [cut(step) for step in _steps(read, size, block)]
    pattern = _pattern(
        np.concatenate([part[0] for part in parts]), np.concatenate([part[1] for part in parts])
    )
    return Quantised(total / (fewer * shorts + (fewer + 1) * longs), even.step, longest, pattern)


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


@dataclass(frozen=True, slots=True, eq=False)
class EvenRows:
    """Even times through the stamps: between long steps rows lie on lines of one slope."""

    read: StampReader
    size: int
    block: int
    longest: float  #: rows may be missing across a longer step [s]: what follows lies on a line of its own
    step: float  #: the rows' own [s]
    row_mean: FloatArray  #: (lines,)
    time_mean: FloatArray  #: (lines,) [s]

    @classmethod
    def of(cls, read: StampReader, size: int, longest: float, block: int = BLOCK) -> EvenRows:
        """Fit the lines.

        Parameters
        ----------
        read : callable
            The stamps, as logged.
        size, block : int
            Rows, and rows at once.
        longest : float
            The longest step within a line [s].
        """
        sums = np.zeros((3, 1))
        for line, row, time in _lines(read, size, longest, block):
            lines = int(line[-1]) + 1
            sums = np.pad(sums, ((0, 0), (0, max(lines - sums.shape[1], 0))))
            for number, weights in enumerate((None, row, time)):
                sums[number] += np.bincount(line, weights, sums.shape[1])
        row_mean, time_mean = sums[1] / sums[0], sums[2] / sums[0]
        product = square = 0.0
        for line, row, time in _lines(read, size, longest, block):
            off = row - row_mean[line]
            product += float(np.sum(off * (time - time_mean[line])))
            square += float(np.sum(off**2))
        return cls(read, size, block, longest, product / square, row_mean, time_mean)

    def blocks(self) -> Iterator[tuple[int, FloatArray, FloatArray]]:
        """Yield first row, stamps as logged and even times of every block."""
        start = 0
        for line, row, time in _lines(self.read, self.size, self.longest, self.block):
            yield start, time, np.asarray(self.time_mean[line] + self.step * (row - self.row_mean[line]))
            start += time.size


def _lines(
    read: StampReader, size: int, longest: float, block: int
) -> Iterator[tuple[np.ndarray, FloatArray, FloatArray]]:
    """Yield the number of the line that each row lies on, row and stamp, block by block."""
    number = 0
    for start, stop in blocks_of(size, block):
        time = read(max(start - 1, 0), stop)
        apart = np.diff(time) > longest
        line = number + np.cumsum(apart if start else np.concatenate(([False], apart)))
        number = int(line[-1])
        yield line, np.arange(start, stop, dtype=float), time[1:] if start else time
