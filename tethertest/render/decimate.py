"""Fewer points for the same picture: the extremes of every pixel column are kept."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from tethertest.records.arrays import FloatArray

IndexArray = npt.NDArray[np.intp]


def extreme_indices(position: FloatArray, values: FloatArray, columns: int) -> IndexArray:
    """Return which samples draw the same line as all of them.

    Parameters
    ----------
    position : (n,) float64
        Horizontal place of the samples, not decreasing; the logarithm of it for a logarithmic axis.
    values : (n,) float64
        Vertical place; NaN is a gap.
    columns : int
        Columns of pixels of the drawing.

    Returns
    -------
    (m,) intp
        Increasing indices: first, last, least and greatest sample of every column, and one sample of
        every column that holds nothing but a gap.
    """
    if position.size <= 4 * columns:
        return np.arange(position.size, dtype=np.intp)
    starts, column = _columns(position, columns)
    stops = np.append(starts[1:], position.size) - 1
    least = _first_equal(values, column, np.fmin.reduceat(values, starts))
    greatest = _first_equal(values, column, np.fmax.reduceat(values, starts))
    return np.unique(np.concatenate((starts, stops, least, greatest)))


def greatest_indices(position: FloatArray, values: FloatArray, columns: int) -> IndexArray:
    """Return the greatest sample of every column: a spectrum's lines and the upper edge of its floor.

    Parameters
    ----------
    position, values, columns
        As for `extreme_indices`.
    """
    if position.size <= columns:
        return np.arange(position.size, dtype=np.intp)
    starts, column = _columns(position, columns)
    return _first_equal(values, column, np.fmax.reduceat(values, starts))


def _columns(position: FloatArray, columns: int) -> tuple[IndexArray, IndexArray]:
    """Return the first sample of every column that has one, and the column of every sample."""
    n = position.size
    edges = np.linspace(position[0], position[-1], columns + 1)[1:-1]
    starts = np.unique(np.concatenate(([0], np.searchsorted(position, edges)))).astype(np.intp)
    starts = starts[starts < n]
    return starts, np.repeat(np.arange(starts.size), np.diff(np.append(starts, n)))


def _first_equal(values: FloatArray, column: IndexArray, extreme: FloatArray) -> IndexArray:
    hits = np.flatnonzero(values == extreme[column])
    _, first = np.unique(column[hits], return_index=True)
    return hits[first].astype(np.intp)


def envelope(
    position: FloatArray, values: FloatArray, columns: int
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return where each of so many columns begins, and the least and greatest value in it.

    Parameters
    ----------
    position : (n,) float64
        Horizontal place of the samples, not decreasing.
    values : (n,) float64
        Vertical place; NaN is passed over.
    columns : int
        Columns wanted at most.

    Returns
    -------
    tuple of (m,) float64
        Place, least and greatest.
    """
    starts = np.unique(np.linspace(0, values.size, min(columns, values.size), endpoint=False).astype(np.intp))
    return position[starts], np.fmin.reduceat(values, starts), np.fmax.reduceat(values, starts)


def reduced_rows(values: FloatArray, rows: int, reduction: np.ufunc) -> tuple[FloatArray, IndexArray]:
    """Return a map with at most `rows` rows, each the reduction of its neighbours, and where each begins.

    Parameters
    ----------
    values : (n, m) float64
        A map, time down the rows.
    rows : int
        Rows wanted at most.
    reduction : numpy.ufunc
        ``np.fmax`` or ``np.fmin``.

    Returns
    -------
    tuple
        (k, m) float64 and (k,) intp with k <= rows.
    """
    n = values.shape[0]
    if n <= rows:
        return values, np.arange(n, dtype=np.intp)
    starts = np.unique(np.linspace(0, n, rows, endpoint=False).astype(np.intp))
    return reduction.reduceat(values, starts, axis=0), starts
