"""Noise and resolution of a record on disk; see `tethertest.signal.noise`."""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise

import numpy as np

from tethertest.pipeline.long_runs.columns import blocks
from tethertest.records.arrays import FloatArray
from tethertest.signal.noise import DIFFERENCE, MAD_TO_SIGMA, PIECES, QUIET, quantum, white_noise

#: distinct values after which a record counts as not rounded
_MOST_DISTINCT = 1 << 18


def white_noise_of(read: Callable[[int, int], FloatArray], size: int, whole: int) -> float:
    """Return the standard deviation of one sample's white noise, piece by piece.

    Parameters
    ----------
    read : callable
        Values (n,) without NaN of the samples from first to last + 1.
    size : int
        Samples of the record.
    whole : int
        Up to so many samples the record is taken whole.
    """
    if size <= whole:
        return white_noise(read(0, size))
    reach = DIFFERENCE.size - 1
    edges = np.linspace(0, size - reach, PIECES + 1).astype(int).tolist()
    sigmas = []
    for start, stop in pairwise(edges):
        differences = np.abs(np.convolve(read(start, stop + reach), DIFFERENCE, mode="valid"))
        sigmas.append(MAD_TO_SIGMA * float(np.median(differences)))
    white = float(np.quantile(sigmas, QUIET)) / float(np.linalg.norm(DIFFERENCE))
    return max(white, quantum_of(read, size, whole) / math.sqrt(12.0))


def quantum_of(read: Callable[[int, int], FloatArray], size: int, block: int) -> float:
    """Return the step that the values are rounded to, or 0 where none is seen.

    Parameters
    ----------
    read : callable
        Values (n,) without NaN of the samples from first to last + 1.
    size, block : int
        Samples of the record, and samples at once.
    """
    distinct = np.zeros(0)
    for start, stop in blocks(size, block):
        distinct = np.union1d(distinct, read(start, stop))
        if distinct.size > _MOST_DISTINCT:
            return 0.0
    # the first value again: `quantum` looks for steps only where values repeat
    return quantum(np.append(distinct, distinct[:1])) if distinct.size < size else 0.0
