"""What the signal functions need of a channel; `records.Channel` has it."""

from __future__ import annotations

from typing import Protocol, TypeAlias

import numpy as np
import numpy.typing as npt

Floats: TypeAlias = npt.NDArray[np.float64]
Booleans: TypeAlias = npt.NDArray[np.bool_]


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
        """Median sampling rate [Hz]."""
