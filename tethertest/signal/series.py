"""What the signal functions need of a channel; `records.Channel` has it."""

from __future__ import annotations

from typing import Final, Protocol, TypeAlias

import numpy as np
import numpy.typing as npt

Floats: TypeAlias = npt.NDArray[np.float64]
Booleans: TypeAlias = npt.NDArray[np.bool_]


#: steps that differ from the median by more than this share of it are gaps or jitter, not rounding
_GAP: Final = 0.25


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
    steps = np.diff(time)
    median = float(np.median(steps))
    usual = steps[np.abs(steps - median) <= _GAP * median]
    return float(np.mean(usual)) if usual.size else median
