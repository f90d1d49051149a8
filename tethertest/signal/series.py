"""What the signal functions need of a channel; `records.Channel` has it."""

from __future__ import annotations

from typing import Final, Protocol, TypeAlias

import numpy as np
import numpy.typing as npt

from tethertest.signal.passes import BLOCK, blocks_of

Floats: TypeAlias = npt.NDArray[np.float64]
Booleans: TypeAlias = npt.NDArray[np.bool_]


#: steps that differ from the median by more than this share of it are gaps or jitter, not rounding
_GAP: Final = 0.25
#: steps of which the longest is at most this many times the shortest have no gap in this sense
_EVEN: Final = 1.2


class Series(Protocol):
    """Values at strictly increasing times, with a mask of the samples that may be used."""

    @property
    def time(self) -> Floats:
        """(n,) [s]."""

    @property
    def values(self) -> Floats:
        """(n,), NaN where missing."""

    @property
    def usable(self) -> Booleans:
        """(n,) True where a sample may enter an analysis."""

    @property
    def rate(self) -> float:
        """Usual sampling rate [Hz]."""


def sampling_interval(time: Floats) -> float:
    """Return the usual distance of samples [s]: gaps left out, and free of the rounding of the stamps.

    Stamps to a millisecond of 30 Hz are 33, 33 and 34 ms apart; the median of them is 1 % short.

    Parameters
    ----------
    time : (n,) float64
        Increasing [s], two or more.
    """
    some = some_steps(time)
    if some.size == time.size - 1 and np.max(some) <= _EVEN * np.min(some):
        return float(np.mean(some))  # nearly always: all are usual, whatever their median
    median = float(np.median(some))
    total, count = 0.0, 0
    for start, stop in blocks_of(time.size - 1):
        steps = np.diff(time[start : stop + 1])
        usual = steps[np.abs(steps - median) <= _GAP * median]
        total, count = total + float(np.sum(usual)), count + usual.size
    return total / count if count else median


def some_steps(time: Floats) -> Floats:
    """Return all steps between stamps [s], or as many of a long record as make a block.

    Parameters
    ----------
    time : (n,) float64
        [s], two or more.
    """
    if time.size - 1 <= BLOCK:
        return np.diff(time)
    rows = np.linspace(0, time.size - 2, BLOCK).astype(np.intp)
    return np.asarray(time[rows + 1] - time[rows])
