"""Peaks that stand where a grating should be and are none: they do not move with the others."""

from __future__ import annotations

import numpy as np

from tethertest.conditioning.gratings.pattern import LEAST_GAIN, TELLING, Pattern
from tethertest.records.arrays import BoolArray, FloatArray

#: a peak this near to one that no grating owns [m], within this time [s], is taken for the same
SAME_PEAK, SAME_TIME = 15e-12, 3.0
#: fewer peaks than this are no judgement
FEWEST = 50


def stray(peaks: FloatArray, column: np.ndarray, time: FloatArray) -> BoolArray:
    """Return which given peaks stand where a peak that no grating owns stands in rows near by.

    Parameters
    ----------
    peaks : ndarray
        (n, p) [m].
    column : ndarray
        (n, g) column of each grating's peak, negative where none.
    time : ndarray
        (n,) [s].
    """
    owned = np.zeros(peaks.shape, dtype=bool)
    row, grating = np.nonzero(column >= 0)
    owned[row, column[row, grating]] = True
    decided = np.asarray((column >= 0).any(axis=1))
    loose_row, loose_column = np.nonzero(np.isfinite(peaks) & ~owned & decided[:, None])
    suspect = np.zeros(column.shape, dtype=bool)
    if not loose_row.size:
        return suspect
    loose = peaks[loose_row, loose_column]
    order = np.argsort(loose, kind="stable")
    loose, loose_time = loose[order], time[loose_row[order]]
    for number, member in zip(row, grating, strict=True):
        value = peaks[number, column[number, member]]
        first, last = np.searchsorted(loose, (value - SAME_PEAK, value + SAME_PEAK))
        near = np.abs(loose_time[first:last] - time[number]) <= SAME_TIME
        suspect[number, member] = bool(np.any(near))
    return suspect


def unmoved(peaks: FloatArray, column: np.ndarray, shift: FloatArray, pattern: Pattern) -> BoolArray:
    """Return which strained gratings' peaks do not follow the common motion, where that can be told.

    Parameters
    ----------
    peaks : ndarray
        (n, p) [m].
    column : ndarray
        (n, g) column of each grating's peak, negative where none.
    shift : ndarray
        (n,) common shift, NaN where it is not known.
    pattern : Pattern
        What was learnt.
    """
    result = np.zeros(column.shape[1], dtype=bool)
    for grating in np.flatnonzero(pattern.strained):
        seen = (column[:, grating] >= 0) & np.isfinite(shift)
        if np.count_nonzero(seen) < FEWEST:
            continue
        common = shift[seen]
        value = peaks[seen, column[seen, grating]] / pattern.expected[grating] - 1.0
        spread = float(np.std(common))
        others = np.delete(pattern.tolerance, grating)
        if spread <= TELLING * float(np.min(others, initial=np.inf)):
            continue
        gain = float(np.mean((common - common.mean()) * (value - value.mean()))) / spread**2
        result[grating] = gain < LEAST_GAIN
    return result
