"""Means over short blocks of usable samples: fewer rows for a linear model without changing the model.

A linear model ``y = X b + noise`` stays exact when rows of `y` and of `X` are averaged over the same samples,
holes included. Only noise above the blocks' own Nyquist frequency folds into the band, which costs a line at
frequency f a part ``1 - sinc(f h)^2`` of its information (5 % where the block length h is an eighth of the
period).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from tethertest.signal.passes import BLOCK
from tethertest.signal.rotation import Times, times
from tethertest.signal.series import sampling_interval

FloatArray = npt.NDArray[np.float64]
IndexArray = npt.NDArray[np.intp]

#: samples this close to equal spacing, relative, are averaged in closed form
SPACING_TOLERANCE = 1e-6


@dataclass(frozen=True, slots=True, eq=False)
class Blocks:
    """A series averaged over blocks of equal length; a block without samples has weight zero."""

    time: FloatArray  #: (b,) [s], mean time of the samples used, the middle of the block where there are none
    values: FloatArray  #: (b,) mean of the samples used, zero where there are none
    weights: FloatArray  #: (b,) samples used over samples expected, 0 to about 1
    interval: float  #: between samples [s]
    width: int  #: samples in a full block
    grid: Times  #: (b,) the same times, for phasors
    samples: Times  #: (n,) times of the samples in blocks with holes or jitter
    starts: IndexArray  #: first sample in `samples` of each such block
    irregular: IndexArray  #: number of each such block

    @property
    def step(self) -> float:
        """Length of a block [s]."""
        return self.width * self.interval

    @property
    def rate(self) -> float:
        """Blocks per second [Hz]."""
        return 1.0 / self.step

    @property
    def length(self) -> float:
        """Length of the record [s]."""
        return self.step * self.time.size

    def phasor(self, frequency: float, origin: float) -> npt.NDArray[np.complex128]:
        """Return block means (b,) of ``exp(2 pi i f (t - origin))``, exact for the samples used."""
        half_angle = np.pi * frequency * self.interval
        # mean of equally spaced phasors: Dirichlet's kernel
        gain = np.sin(self.width * half_angle) / (self.width * np.sin(half_angle)) if half_angle else 1.0
        means = self.grid.rotating(frequency, origin)
        means *= np.where(self.weights > 0.0, gain, 0.0)
        if self.irregular.size:
            rotating = self.samples.rotating(frequency, origin)
            counts = np.diff(np.append(self.starts, rotating.size))
            means[self.irregular] = np.add.reduceat(rotating, self.starts) / counts
        return means


def block_means(
    time: FloatArray, values: FloatArray, usable: npt.NDArray[np.bool_], slowest_rate: float
) -> Blocks:
    """Average a series over blocks of whole sampling intervals.

    Parameters
    ----------
    time, values : (n,) float64
        Strictly increasing times [s]; jitter and holes are allowed.
    usable : (n,) bool
        Samples that may be used.
    slowest_rate : float
        Blocks per second wanted at least [Hz]; a series slower than that is kept sample by sample.

    Returns
    -------
    Blocks
        On a uniform grid from the first to the last usable sample.

    Raises
    ------
    ValueError
        Fewer than two usable samples.
    """
    count = int(np.count_nonzero(usable))
    if count < 2:
        message = f"{count} usable samples, expected at least two"
        raise ValueError(message)
    first, last = int(np.argmax(usable)), usable.size - 1 - int(np.argmax(usable[::-1]))
    interval = sampling_interval(time)
    width = max(1, int(1.0 / (interval * slowest_rate) + 1e-9))
    step = width * interval
    start = time[first] - 0.5 * interval
    total = int(np.floor((time[last] - start) / step)) + 1
    mean_time = start + (np.arange(total) + 0.5) * step
    means, weights = np.zeros(total), np.zeros(total)
    kept_times: list[FloatArray] = []
    kept_numbers: list[IndexArray] = []
    closed = np.ones(total, dtype=bool)
    for used_time, used_values, number in _together(time, values, usable, start, step):
        starts = np.flatnonzero(np.diff(number, prepend=-1))
        filled = number[starts]
        counts = np.diff(np.append(starts, used_time.size))
        mean_time[filled] = np.add.reduceat(used_time, starts) / counts
        means[filled] = np.add.reduceat(used_values, starts) / counts
        weights[filled] = counts / width
        closed[filled] = _equally_spaced(used_time, number, interval, starts) & (counts == width) | (
            counts == 1
        ) & (width == 1)
        kept = ~closed[number]
        kept_times.append(used_time[kept])
        kept_numbers.append(number[kept])
    irregular = np.flatnonzero(~closed)
    irregular_starts = np.searchsorted(np.concatenate(kept_numbers), irregular)
    return Blocks(
        mean_time,
        means,
        weights,
        interval,
        width,
        times(mean_time, step),
        times(np.concatenate(kept_times), interval),
        irregular_starts,
        irregular,
    )


def _together(
    time: FloatArray, values: FloatArray, usable: npt.NDArray[np.bool_], start: float, step: float
) -> Iterator[tuple[FloatArray, FloatArray, IndexArray]]:
    """Yield times, values and block numbers of the usable samples, many whole blocks at a time."""
    row, size = 0, BLOCK
    while row < time.size:
        inside = usable[row : row + size]
        used_time, used_values = time[row : row + size][inside], values[row : row + size][inside]
        number = np.floor((used_time - start) / step).astype(np.intp)
        whole = number.size
        if row + size < time.size and number.size:
            whole = int(np.searchsorted(number, number[-1]))  # what follows may belong to the last one
            if not whole:
                size *= 2
                continue
            row += int(np.searchsorted(time[row : row + size], used_time[whole]))
        else:
            row += size
        if whole:
            yield used_time[:whole], used_values[:whole], number[:whole]


def _equally_spaced(
    time: FloatArray, number: IndexArray, interval: float, starts: IndexArray
) -> npt.NDArray[np.bool_]:
    """Return for each block with samples whether they stand one interval apart."""
    apart = np.abs(np.diff(time, prepend=time[0]) - interval) > SPACING_TOLERANCE * interval
    apart[starts] = False  # the step into a block does not belong to it
    jittered = np.zeros(int(number[-1] - number[0]) + 1, dtype=bool)
    jittered[number[apart] - number[0]] = True
    return np.asarray(~jittered[number[starts] - number[0]], dtype=bool)
