"""Noise and resolution of a record, from the record itself."""

from __future__ import annotations

import math

import numpy as np

from tethertest.signal.series import Floats

#: binomial weights of a fourth difference; slow motion drops out of it
DIFFERENCE = np.array([1.0, -4.0, 6.0, -4.0, 1.0])
#: the record is cut into this many pieces and the quieter ones decide: snaps and taps are no noise
PIECES = 40
#: quantile of the pieces that is taken as noise
QUIET = 0.25
#: median absolute deviation to standard deviation of a normal variable
MAD_TO_SIGMA = 1.4826
#: values closer than this, relative to the largest, differ by floating-point arithmetic only
ROUND_OFF = 1e-9


def white_noise(values: Floats) -> float:
    """Return the standard deviation of one sample's white noise.

    Parameters
    ----------
    values : ndarray
        (n,) uniformly sampled; NaN is left out.

    Returns
    -------
    float
        In the unit of the values, not below the rounding of the values; 0 for fewer than 10 values.
    """
    finite = values[np.isfinite(values)]
    if finite.size < 2 * DIFFERENCE.size:
        return 0.0
    differences = np.abs(np.convolve(finite, DIFFERENCE, mode="valid"))
    pieces = np.array_split(differences, min(PIECES, max(differences.size // 20, 1)))
    sigmas = [MAD_TO_SIGMA * float(np.median(piece)) for piece in pieces]
    white = float(np.quantile(sigmas, QUIET)) / float(np.linalg.norm(DIFFERENCE))
    return max(white, quantum(finite) / math.sqrt(12.0))


def quantum(values: Floats) -> float:
    """Return the step that the values are rounded to, or 0 where none is seen.

    Parameters
    ----------
    values : ndarray
        (n,) without NaN.

    Returns
    -------
    float
        The smallest difference between distinct values, in their unit, if values repeat at all.
    """
    distinct = np.unique(values)
    if distinct.size < 2 or distinct.size == values.size:
        return 0.0
    steps = np.diff(distinct)
    real = steps[steps > ROUND_OFF * float(np.max(np.abs(distinct)))]
    return float(np.min(real)) if real.size else 0.0
