"""Thomson's harmonic F test, which needs flat noise next to a line."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Final

import numpy as np

from tethertest.records.arrays import FloatArray
from tethertest.spectra.order_demodulation import ComplexArray, DemodulatedOrder

#: time-bandwidth product and number of the tapers: the noise is taken to be flat within 4/T of a line
BANDWIDTH: Final = 4.0
TAPERS: Final = 7


@dataclass(frozen=True, slots=True, eq=False)
class HarmonicTest:
    """The test at m frequencies."""

    mean: ComplexArray  #: (m,) half the amplitude of a cosine, with its phase
    f_value: FloatArray  #: (m,)
    p_value: FloatArray  #: (m,) chance of such an F under noise
    at_unit_f: FloatArray  #: (m,) amplitude of a cosine that has F = 1


@dataclass(frozen=True, slots=True)
class MultitaperTest:
    """The F value of a line at one frequency, with its chance under noise."""

    f_value: float
    p_value: float


def harmonic_test(transforms: ComplexArray, sums: FloatArray) -> HarmonicTest:
    """Return ``F = (K - 1) |mu|^2 sum H_k^2 / sum |J_k - mu H_k|^2``, which is F(2, 2K - 2) under noise.

    Parameters
    ----------
    transforms : (K, m) complex128
        J: Fourier sums of the tapered series, at m frequencies.
    sums : (K,) float64
        H: sums of the tapers.

    References
    ----------
    D. J. Thomson, Proc. IEEE 70 (1982) 1055-1096.
    """
    power = float(sums @ sums)
    mean = (sums @ transforms) / power
    left = np.sum(np.abs(transforms - sums[:, None] * mean) ** 2, axis=0)
    left = np.maximum(left, np.finfo(np.float64).tiny)
    f_value = (TAPERS - 1) * np.abs(mean) ** 2 * power / left
    p_value = (1.0 + f_value / (TAPERS - 1)) ** (1 - TAPERS)  # the tail of F(2, 2K - 2)
    return HarmonicTest(mean, f_value, p_value, 2.0 * np.sqrt(left / ((TAPERS - 1) * power)))


def f_value_at(chance: float) -> float:
    """Return the F value that noise exceeds with that chance."""
    return (TAPERS - 1) * (float(chance ** (-1.0 / (TAPERS - 1))) - 1.0)


def multitaper_test(loose: DemodulatedOrder) -> MultitaperTest:
    """Return Thomson's F of an order, on what the other orders leave: a second opinion.

    Parameters
    ----------
    loose : DemodulatedOrder
        The order; its segments are the samples.
    """
    shapes = tapers(loose.left.size)
    test = harmonic_test((shapes @ loose.left)[:, None], shapes.sum(axis=1))
    return MultitaperTest(float(test.f_value[0]), float(test.p_value[0]))


@lru_cache(maxsize=8)
def tapers(count: int) -> FloatArray:
    """Return the tapers of a series of `count` samples, (K, count): discrete prolate spheroidal sequences.

    The even ones have a mean above zero, the odd ones begin upwards.

    References
    ----------
    D. B. Percival and A. T. Walden, Spectral Analysis for Physical Applications (1993), chapter 8.
    """
    from scipy.linalg import eigh_tridiagonal

    index = np.arange(count, dtype=np.float64)
    diagonal = ((count - 1 - 2 * index) / 2.0) ** 2 * np.cos(2 * np.pi * (BANDWIDTH / count))
    beside = index[1:] * (count - index[1:]) / 2.0
    _, vectors = eigh_tridiagonal(diagonal, beside, select="i", select_range=(count - TAPERS, count - 1))
    found = np.asarray(vectors[:, ::-1].T, dtype=np.float64)
    clear = max(1e-7, 1.0 / count)  # power of a sample that is more than rounding
    for number, taper in enumerate(found):
        upwards = taper.sum() if number % 2 == 0 else taper[taper**2 > clear][0]
        if upwards < 0.0:
            found[number] = -taper
    return found
