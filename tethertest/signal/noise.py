"""Noise and resolution of a record, from the record itself."""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise

import numpy as np

from tethertest.signal.passes import blocks_of
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
#: a record of more distinct values counts as not rounded
MOST_DISTINCT = 1 << 18


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
    known = np.isfinite(values)
    finite = values if known.all() else values[known]
    return white_noise_of(lambda start, stop: finite[start:stop], finite.size)


def white_noise_of(read: Callable[[int, int], Floats], size: int) -> float:
    """Return the standard deviation of one sample's white noise, piece by piece.

    Parameters
    ----------
    read : callable
        Values (n,) without NaN of the samples from first to last + 1.
    size : int
        Samples of the record.
    """
    if size < 2 * DIFFERENCE.size:
        return 0.0
    reach = DIFFERENCE.size - 1
    pieces = min(PIECES, max((size - reach) // 20, 1))
    length, longer = divmod(size - reach, pieces)
    edges = [number * length + min(number, longer) for number in range(pieces + 1)]
    sigmas = [
        MAD_TO_SIGMA
        * float(np.median(np.abs(np.convolve(read(start, stop + reach), DIFFERENCE, mode="valid"))))
        for start, stop in pairwise(edges)
    ]
    white = float(np.quantile(sigmas, QUIET)) / float(np.linalg.norm(DIFFERENCE))
    return max(white, quantum_of(read, size) / math.sqrt(12.0))


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
    return quantum_of(lambda start, stop: values[start:stop], values.size)


def quantum_of(read: Callable[[int, int], Floats], size: int) -> float:
    """Return the step that a record's values are rounded to, or 0 where none is seen.

    Parameters
    ----------
    read : callable
        Values (n,) without NaN of the samples from first to last + 1.
    size : int
        Samples of the record.
    """
    distinct = np.zeros(0)
    for start, stop in blocks_of(size):
        distinct = np.union1d(distinct, read(start, stop))
        if distinct.size > MOST_DISTINCT:
            return 0.0
    if distinct.size < 2 or distinct.size == size:
        return 0.0
    steps = np.diff(distinct)
    real = steps[steps > ROUND_OFF * float(np.max(np.abs(distinct)))]
    return float(np.min(real)) if real.size else 0.0
