"""Loops over samples that no array operation does: a recursive filter, and pieces of polynomials anywhere."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from tethertest.kernels.jit import compiled

FloatArray: TypeAlias = npt.NDArray[np.float64]


@compiled
def filter_section(
    numerator: FloatArray, denominator: FloatArray, state: FloatArray, values: FloatArray
) -> None:
    """Run a second-order section over the samples, in place.

    Parameters
    ----------
    numerator, denominator : (3,) float64
        The denominator's first coefficient is 1.
    state : (2,) float64
        Of the transposed direct form II; changed.
    values : (n,) float64
        Replaced by the output.
    """
    first, second = state
    for index in range(values.size):
        sample = values[index]
        result = numerator[0] * sample + first
        first = numerator[1] * sample - denominator[1] * result + second
        second = numerator[2] * sample - denominator[2] * result
        values[index] = result
    state[0], state[1] = first, second


@compiled
def evaluate_pieces(
    knots: FloatArray, coefficients: FloatArray, times: FloatArray, derivative: int, found: FloatArray
) -> None:
    """Fill the value, or a derivative, of a piecewise polynomial; the end pieces go on beyond.

    Parameters
    ----------
    knots : (n,) float64
        Strictly increasing.
    coefficients : (p, n - 1, k) float64
        Of the powers p - 1 to 0 of the time since a piece's first knot.
    times : (m,) float64
        In any order; neighbours that lie close together are found fastest.
    derivative : int
        0, 1 or 2.
    found : (m, k) float64
        Filled.
    """
    last, highest = knots.size - 2, coefficients.shape[0] - 1
    piece = 0
    for row in range(times.size):
        time = times[row]
        if time < knots[piece] or time >= knots[piece + 1]:
            if piece < last and knots[piece + 1] <= time < knots[piece + 2]:
                piece += 1
            else:
                piece = min(max(np.searchsorted(knots, time, "right") - 1, 0), last)
        since = time - knots[piece]
        for column in range(found.shape[1]):
            total, power = 0.0, 1.0
            for exponent in range(derivative, highest + 1):
                factor = 1.0
                for step in range(derivative):
                    factor *= exponent - step
                total += coefficients[highest - exponent, piece, column] * power * factor
                power *= since
            found[row, column] = total
