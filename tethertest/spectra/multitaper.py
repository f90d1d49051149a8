"""Thomson's harmonic F test of one order: a second opinion that needs flat noise next to it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Final

import numpy as np

from tethertest.records.arrays import FloatArray
from tethertest.spectra.loose import LooseOrder

#: time-bandwidth product and tapers: the noise is taken to be flat within 4/T of the order
BANDWIDTH: Final = 4.0
TAPERS: Final = 7


@dataclass(frozen=True, slots=True)
class MultitaperTest:
    """The F value of a line at a frequency, with its chance under noise."""

    f_value: float
    p_value: float


def multitaper_test(loose: LooseOrder) -> MultitaperTest:
    """Return Thomson's F of an order, on what the other orders leave.

    Parameters
    ----------
    loose : LooseOrder
        The order; its segments are the samples.

    Returns
    -------
    MultitaperTest
        ``F = (K - 1) |mu|^2 sum H_k^2 / sum |J_k - mu H_k|^2``, which is F(2, 2K - 2) under noise.

    References
    ----------
    D. J. Thomson, Proc. IEEE 70 (1982) 1055-1096.
    """
    tapers = _tapers(loose.left.size)
    transforms = tapers @ loose.left
    sums = tapers.sum(axis=1)
    power = float(sums @ sums)
    mean = complex(sums @ transforms) / power
    left = float(np.sum(np.abs(transforms - mean * sums) ** 2))
    f_value = (TAPERS - 1) * abs(mean) ** 2 * power / max(left, 1e-300)
    # the tail of F(2, 2K - 2)
    return MultitaperTest(f_value, float((1.0 + f_value / (TAPERS - 1)) ** (-(TAPERS - 1))))


@lru_cache(maxsize=8)
def _tapers(count: int) -> FloatArray:
    from scipy.signal.windows import dpss

    return np.asarray(dpss(count, BANDWIDTH, TAPERS), dtype=np.float64)
