"""Strain and temperature of slipped gratings: values that leap from their own course and come back."""

from __future__ import annotations

from typing import Final

import numpy as np

from tethertest.records.arrays import BoolArray, FloatArray

#: a value leaps when it strays from its sound neighbours by this many times what nearly all others do
_LEAP: Final = 3.0
#: nearly all: the rest may be true snaps
_NEARLY_ALL: Final = 99.9
#: without an error status only a leap this many times larger than most is worth a remark
_SUSPECT: Final = 30.0
#: most
_MOST: Final = 95.0
#: fewer rows without an error status than this say nothing; then the bulk of all rows does
_FEWEST: Final = 10
#: the bulk lies within so many median deviations
_BULK: Final = 10.0


def moved_values(values: FloatArray, alarmed: BoolArray) -> tuple[BoolArray, BoolArray]:
    """Find values that do not belong to their column.

    Parameters
    ----------
    values : ndarray
        (n, columns) no wavelengths.
    alarmed : ndarray
        (n,) True where the error status is not all zero; only there values are condemned, and only those that
        leap, with all behind them up to the end of their fibre.

    Returns
    -------
    tuple of ndarray
        (n, columns) True where a value belongs elsewhere; (n,) True for rows without an error status that
        look like slipped ones.
    """
    gone = np.zeros(values.shape, dtype=bool)
    calm = ~alarmed
    if np.count_nonzero(calm) < _FEWEST:
        middle = np.nanmedian(values, axis=0) if len(values) else values
        spread = np.nanmedian(np.abs(values - middle), axis=0)
        calm = np.all(~(np.abs(values - middle) > _BULK * spread), axis=1)
        if np.count_nonzero(calm) < _FEWEST:
            return gone, np.zeros(len(values), dtype=bool)
    suspect = np.zeros(values.shape, dtype=bool)
    for column in range(values.shape[1]):
        gone[:, column] = _leaps(values[:, column], calm)
        suspect[:, column] = _outliers(values[:, column], calm)
    together = suspect[:, 1:] & suspect[:, :-1]
    return _to_the_ends(gone), np.asarray(np.any(together, axis=1))


def _leaps(values: FloatArray, calm: BoolArray) -> BoolArray:
    """Return which values of the other rows stray from the course of the calm rows around them."""
    seen = np.isfinite(values)
    good = np.flatnonzero(calm & seen)
    result = np.zeros(values.size, dtype=bool)
    if good.size < _FEWEST:
        return result
    course, row = values[good], np.arange(values.size)
    usual = _usual_steps(course)
    place = np.searchsorted(good, row)
    before = np.maximum(place - 1, 0)
    after = np.minimum(place, good.size - 1)
    expected = 0.5 * (course[before] + course[after])
    apart = np.minimum(np.abs(row - good[before]), np.abs(good[after] - row))
    allowed = _LEAP * usual[np.minimum(np.ceil(np.log2(np.maximum(apart, 1))).astype(int), usual.size - 1)]
    allowed = allowed + np.abs(course[after] - course[before])
    leaps: BoolArray = ~calm & seen & (np.abs(values - expected) > allowed)
    return leaps


def _outliers(values: FloatArray, calm: BoolArray) -> BoolArray:
    """Return which values of the calm rows leave their neighbours' mean far more than most do."""
    result = np.zeros(values.size, dtype=bool)
    rows = np.flatnonzero(calm & np.isfinite(values))
    if rows.size < _FEWEST:
        return result
    course = values[rows]
    away = np.abs(course[1:-1] - 0.5 * (course[:-2] + course[2:]))
    back = np.abs(course[2:] - course[:-2])
    most = float(np.percentile(away, _MOST))
    result[rows[1:-1]] = (away > _SUSPECT * most) & (away > _LEAP * back) & (most > 0.0)
    return result


def _usual_steps(course: FloatArray) -> FloatArray:
    """Return what nearly all values change by over 1, 2, 4, ... rows, never less than the smallest step."""
    steps = np.abs(np.diff(course))
    floor = float(np.min(steps[steps > 0.0], initial=np.inf))
    floor = floor if np.isfinite(floor) else 1e-9 * float(np.max(np.abs(course)))
    result = [max(float(np.percentile(steps, _NEARLY_ALL)), floor)]
    lag = 2
    while lag < course.size // 2:
        result.append(
            max(float(np.percentile(np.abs(course[lag:] - course[:-lag]), _NEARLY_ALL)), result[-1])
        )
        lag *= 2
    return np.array(result)


def _to_the_ends(gone: BoolArray) -> BoolArray:
    """Condemn all columns from the first that leapt to the end of the fibre, as far as it is known."""
    result = gone.copy()
    width = gone.shape[1]
    behind = np.zeros(gone.shape, dtype=bool)
    behind[:, :-1] = gone[:, 1:]
    last = np.count_nonzero(gone & ~behind, axis=0)
    ends = [column for column in range(width) if last[column] * 2 > np.count_nonzero(gone[:, column]) > 0]
    first = 0
    for end in ends:
        result[:, first : end + 1] |= np.maximum.accumulate(gone[:, first : end + 1], axis=1)
        first = end + 1
    return result
