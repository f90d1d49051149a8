"""Least squares of offset, drift and sinusoids of given frequencies on series with holes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt

from tethertest.signal.blocked_matmul import blocked_cross, blocked_times
from tethertest.signal.blocks import Blocks

FloatArray = npt.NDArray[np.float64]
#: a variance inflated so many times by the other columns is nothing but round-off
_INFLATED: Final = 1e8


@dataclass(frozen=True, slots=True, eq=False)
class SinusoidFit:
    """Coefficients of ``polynomial(tau) + sum a_k cos(2 pi f_k t) + b_k sin(2 pi f_k t)``.

    t counts from `origin`; tau runs from -1 to 1 over the record, and the polynomial is a sum of Legendre's,
    so that the first coefficient is the offset and the second the linear drift.
    """

    frequencies: FloatArray  #: (k,) [Hz]
    origin: float  #: [s], where the phases refer to
    trend: int  #: coefficients of the polynomial, which come first
    coefficients: FloatArray  #: (trend + 2k,) offset, drift, ..., a_1, b_1, a_2, ...
    design: FloatArray  #: (b, trend + 2k) averaged like the values
    inverse: FloatArray  #: (trend + 2k, trend + 2k) of the weighted normal matrix
    residuals: FloatArray  #: (b,) zero in empty blocks
    weights: FloatArray  #: (b,)

    def pair(self, index: int) -> FloatArray:
        """Return (a, b) of one frequency."""
        first = self.trend + 2 * index
        return self.coefficients[first : first + 2]

    def pair_influence(self, indices: Sequence[int]) -> FloatArray:
        """Return the rows (2 len(indices), b) that give a, b of these frequencies from the values."""
        rows = [self.trend + 2 * index + part for index in indices for part in (0, 1)]
        product: FloatArray = (blocked_times(self.design, self.inverse[:, rows]) * self.weights[:, None]).T
        return product

    def without_trace(self, column: FloatArray) -> FloatArray:
        """Return a column (b,) or columns (b, m) with every fitted column projected out."""
        weighted = column * (self.weights if column.ndim == 1 else self.weights[:, None])
        left: FloatArray = column - blocked_times(
            self.design, self.inverse @ blocked_cross(self.design, weighted)
        )
        return left

    def extended(self, frequency: float, pair: FloatArray) -> SinusoidFit:
        """Return the fit with one more frequency, its columns (b, 2) given: exact, and nothing refitted."""
        weighted = pair * self.weights[:, None]
        shared = self.inverse @ blocked_cross(self.design, weighted)
        left = pair - blocked_times(self.design, shared)
        own = np.linalg.inv(blocked_cross(left, left * self.weights[:, None]))
        added = own @ blocked_cross(weighted, self.residuals)
        inverse = np.block([[self.inverse + shared @ own @ shared.T, -shared @ own], [-own @ shared.T, own]])
        return SinusoidFit(
            np.append(self.frequencies, frequency),
            self.origin,
            self.trend,
            np.concatenate((self.coefficients - shared @ added, added)),
            np.hstack((self.design, pair)),
            inverse,
            np.where(self.weights > 0.0, self.residuals - left @ added, 0.0),
            self.weights,
        )

    def amplitude(self, index: int) -> float:
        """Return the peak hypot(a, b) of one frequency."""
        return float(np.hypot(*self.pair(index)))

    def phase(self, index: int) -> float:
        """Return phi of ``A cos(2 pi f t + phi)`` [rad]."""
        cosine, sine = self.pair(index)
        return float(np.arctan2(-sine, cosine))

    def covariance(self, variance: float | None = None) -> FloatArray:
        """Return the covariance (p, p) of the coefficients under white noise.

        Parameters
        ----------
        variance : float, optional
            Of the noise of one full block; estimated from the residuals when absent.
        """
        if variance is None:
            freedom = int(np.count_nonzero(self.weights)) - self.coefficients.size
            variance = float(self.weights @ self.residuals**2) / max(1, freedom)
        return variance * self.inverse


def sinusoid_pair(blocks: Blocks, frequency: float, origin: float) -> FloatArray:
    """Return block means (b, 2) of cos and sin of ``2 pi f (t - origin)``, exact for the samples used."""
    rotating = blocks.phasor(frequency, origin)
    return np.column_stack([rotating.real, rotating.imag])


def trend_columns(blocks: Blocks, degree: int) -> FloatArray:
    """Return Legendre polynomials (b, degree + 1) over the record, zero in empty blocks."""
    middle = 0.5 * (blocks.time[0] + blocks.time[-1])
    half = max(0.5 * (blocks.time[-1] - blocks.time[0]), blocks.step)
    columns = np.polynomial.legendre.legvander((blocks.time - middle) / half, degree)
    return np.asarray(columns * (blocks.weights > 0.0)[:, None], dtype=np.float64)


def fit_sinusoids(
    blocks: Blocks, frequencies: Sequence[float] | FloatArray, origin: float, degree: int = 1
) -> SinusoidFit:
    """Fit offset, drift and one cosine and sine per frequency.

    By the normal equations: sinusoids 1/T or more apart are nearly orthogonal, so squaring the condition
    number (about 10) costs two of sixteen digits and saves most of the time of a QR.

    Parameters
    ----------
    blocks : Blocks
        The series.
    frequencies : sequence of float
        [Hz], all different, below half the sampling rate and at least about 1/T apart.
    origin : float
        Time to which phases refer [s].
    degree : int
        Of the drift: 1 is linear. Above that the lowest frequency should be 2/T or more.

    Returns
    -------
    SinusoidFit
        Weighted by the number of samples in each block.

    Raises
    ------
    ValueError
        More coefficients than blocks with samples, or frequencies that these samples do not tell apart.
    """
    trend = trend_columns(blocks, degree)
    design = np.empty((blocks.time.size, degree + 1 + 2 * len(frequencies)))
    design[:, : degree + 1] = trend
    for number, frequency in enumerate(frequencies):
        first = degree + 1 + 2 * number
        design[:, first : first + 2] = sinusoid_pair(blocks, float(frequency), origin)
    if np.count_nonzero(blocks.weights) <= design.shape[1]:
        message = f"{np.count_nonzero(blocks.weights)} blocks for {design.shape[1]} coefficients"
        raise ValueError(message)
    weighted = design * blocks.weights[:, None]
    normal = blocked_cross(design, weighted)
    inverse = np.asarray(np.linalg.inv(normal), dtype=np.float64)
    if not np.max(np.diag(normal) * np.diag(inverse)) < _INFLATED:
        message = "the samples do not tell the frequencies apart: holes at even steps fold them on each other"
        raise ValueError(message)
    coefficients = inverse @ blocked_cross(weighted, blocks.values)
    residuals = np.where(blocks.weights > 0.0, blocks.values - blocked_times(design, coefficients), 0.0)
    return SinusoidFit(
        np.asarray(frequencies, dtype=np.float64),
        origin,
        degree + 1,
        coefficients,
        design,
        inverse,
        residuals,
        blocks.weights,
    )
