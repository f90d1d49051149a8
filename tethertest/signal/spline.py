"""A cubic through samples: the numbers of scipy's `CubicSpline`, without half a second of imports."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tethertest.signal.series import Floats


@dataclass(frozen=True, slots=True, eq=False)
class Piecewise:
    """A polynomial between each two knots; the first and the last go on beyond."""

    knots: Floats  #: (n,) [s]
    coefficients: Floats  #: (p, n - 1, k), the highest power first, of the time since a piece's first knot
    columns: tuple[int, ...]  #: shape of what belongs to one time: () or (k,)

    def __call__(self, time: Floats, derivative: int = 0) -> Floats:
        """Return the values at any times (m,), or their first or second derivative there: (m,) or (m, k)."""
        from tethertest.kernels.samples import evaluate_pieces

        times = np.ascontiguousarray(time, dtype=np.float64)
        found = np.empty((times.size, self.coefficients.shape[2]))
        evaluate_pieces(self.knots, self.coefficients, times.ravel(), derivative, found)
        return found.reshape(times.shape + self.columns)

    def slope(self) -> Piecewise:
        """Return the derivative, for many times: it has a power less."""
        highest = self.coefficients.shape[0] - 1
        powers = np.arange(highest, 0, -1, dtype=np.float64)[:, None, None]
        return Piecewise(self.knots, self.coefficients[:-1] * powers, self.columns)


def spline(time: Floats, values: Floats) -> Piecewise:
    """Return the cubic spline through samples; not a knot are the second and the last but one.

    Parameters
    ----------
    time : (n,) ndarray
        Strictly increasing, at least two.
    values : (n,) or (n, k) ndarray
        Finite.
    """
    knots, heights = np.ascontiguousarray(time, dtype=np.float64), np.asarray(values, dtype=np.float64)
    columns = heights.shape[1:]
    gap = np.diff(knots).reshape((-1,) + (1,) * len(columns))
    chord = np.diff(heights, axis=0) / gap
    slope = _slopes(knots, gap, chord)
    bend = (slope[:-1] + slope[1:] - 2.0 * chord) / gap
    cubics = np.stack((bend / gap, (chord - slope[:-1]) / gap - bend, slope[:-1], heights[:-1]))
    return Piecewise(knots, cubics.reshape(4, knots.size - 1, -1), columns)


def _slopes(knots: Floats, gap: Floats, chord: Floats) -> Floats:
    """Return the spline's slope at each knot: curvature is continuous there."""
    from scipy.linalg import solve, solve_banded

    count, step = knots.size, np.diff(knots)
    if count == 2:
        return np.concatenate((chord, chord))
    if count == 3:  # a parabola
        matrix = np.array([
            [1.0, 1.0, 0.0],
            [step[1], 2.0 * (step[0] + step[1]), step[0]],
            [0.0, 1.0, 1.0],
        ])  # fmt: skip
        middle = 3.0 * (gap[0] * chord[1] + gap[1] * chord[0])
        return np.asarray(solve(matrix, np.stack((2.0 * chord[0], middle, 2.0 * chord[1]))))
    bands = np.zeros((3, count))
    bands[1, 1:-1] = 2.0 * (step[:-1] + step[1:])
    bands[0, 2:] = step[:-1]
    bands[2, :-2] = step[1:]
    right = np.empty((count, *chord.shape[1:]))
    right[1:-1] = 3.0 * (gap[1:] * chord[:-1] + gap[:-1] * chord[1:])
    bands[1, 0], bands[0, 1] = step[1], knots[2] - knots[0]
    reach = knots[2] - knots[0]
    right[0] = ((gap[0] + 2.0 * reach) * gap[1] * chord[0] + gap[0] ** 2 * chord[1]) / reach
    bands[1, -1], bands[2, -2] = step[-2], knots[-1] - knots[-3]
    reach = knots[-1] - knots[-3]
    right[-1] = (gap[-1] ** 2 * chord[-2] + (2.0 * reach + gap[-1]) * gap[-2] * chord[-1]) / reach
    return np.asarray(
        solve_banded((1, 1), bands, right, overwrite_ab=True, overwrite_b=True, check_finite=False)
    )
