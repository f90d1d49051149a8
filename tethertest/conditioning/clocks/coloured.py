"""Sums over coloured noise: their covariance from the spectrum of what a fit leaves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tethertest.records.arrays import FloatArray
from tethertest.signal.filters import moving_mean

#: the spectrum is smoothed over this band [Hz]: the fit itself takes out what lies right at the drive's
#: orders
SMOOTHING = 0.5
#: and over this many bins at least
FEWEST_BINS = 12
#: zeros behind the record, so that its ends do not meet [samples, as a fraction of it]
MARGIN = 0.05


@dataclass(frozen=True, slots=True, eq=False)
class Noise:
    """Spectrum of a stationary residual that is known at part of the samples."""

    spectrum: (
        FloatArray  #: (size/2 + 1,) variance of a sample times the number of samples per cycle, smoothed
    )
    size: int  #: samples of the transform
    count: int  #: samples at which the residual is known

    @property
    def variance(self) -> float:
        """Variance of one sample."""
        return float(np.mean(_two_sided(self.spectrum, self.size)) * self.spectrum.size / self.size)

    @property
    def squared_correlation(self) -> float:
        """Sum over all lags of the squared autocovariance."""
        return float(np.sum(_two_sided(self.spectrum**2, self.size))) / self.size

    @property
    def independent(self) -> float:
        """Number of independent samples that the residual amounts to."""
        return self.count * self.variance**2 / max(self.squared_correlation, np.finfo(float).tiny)

    def covariance(self, columns: FloatArray) -> FloatArray:
        """Return the covariance of ``columns.T @ noise``.

        Parameters
        ----------
        columns : ndarray
            (n, p), zero at the samples that do not enter.
        """
        transformed = np.fft.rfft(columns, self.size, axis=0)
        weighted = _two_sided(self.spectrum, self.size)[:, None] * transformed
        return np.asarray((np.conj(transformed).T @ weighted).real / self.size, dtype=np.float64)


def noise_of(residual: FloatArray, count: int, parameters: int, step: float, shortest: float) -> Noise:
    """Return the noise that a residual shows.

    Parameters
    ----------
    residual : ndarray
        (n,) zero at the samples that are not known.
    count : int
        Samples at which it is known.
    parameters : int
        Fitted ones: they took their share of the variance.
    step : float
        Between samples [s].
    shortest : float
        Length of the shortest stretch of known samples [s]: nothing finer than its reciprocal is resolved.
    """
    from scipy.fft import next_fast_len

    size = int(next_fast_len(int(residual.size * (1.0 + MARGIN)) + 1, real=True))
    power = np.abs(np.fft.rfft(residual, size)) ** 2 / max(count, 1)
    width = max(SMOOTHING, 2.0 / shortest) * size * step
    smoothed = moving_mean(power, max(width, FEWEST_BINS))
    raw = Noise(np.asarray(smoothed, dtype=np.float64), size, count)
    free = max(raw.independent - parameters, 1.0)
    return Noise(raw.spectrum * raw.independent / free, size, count)


def _two_sided(spectrum: FloatArray, size: int) -> FloatArray:
    """Return a one-sided spectrum with every bin that stands for two counted twice."""
    twice = np.full(spectrum.size, 2.0)
    twice[0] = 1.0
    if size % 2 == 0:
        twice[-1] = 1.0
    return twice * spectrum
