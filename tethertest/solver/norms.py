"""How far two answers lie apart, in the measure that tolerances are asked in."""

from __future__ import annotations

import numpy as np

from tethertest.records.arrays import FloatArray
from tethertest.solver.solution import Solution

#: dynamic part, relative to the tension at rest, below which nothing moves
_STILL = 2e-7


def relative_difference(
    tension: FloatArray, reference: FloatArray, rest: FloatArray | float | None = None
) -> float:
    """Return the largest RMS difference of a gauge over the RMS of the largest dynamic part.

    Parameters
    ----------
    tension, reference : (n, g) float64
        [N].
    rest : (g,) float64 or float, optional
        Tension at rest [N], from which the dynamic part counts; the reference's first row if absent, which a
        sudden start has left already.
    """
    start = reference[0] if rest is None else rest
    still = _STILL * float(np.max(np.abs(start)))
    dynamic = float(np.sqrt(np.max(np.mean((reference - start) ** 2, axis=0))))
    difference = float(np.sqrt(np.max(np.mean((tension - reference) ** 2, axis=0))))
    if dynamic <= still:
        return 0.0 if difference <= still else float("inf")
    return difference / dynamic


def goes_slack(solution: Solution) -> bool:
    """Return whether any part of the cable was without tension at any time."""
    return float(np.min(solution.field.minimum)) <= 0.0


def finished(solution: Solution) -> bool:
    """Return whether the solution stayed within the range of numbers to its end."""
    return solution.steps_done >= solution.steps
