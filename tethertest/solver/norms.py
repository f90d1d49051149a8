"""How far two answers lie apart, in the measure that tolerances are asked in."""

from __future__ import annotations

import numpy as np

from tethertest.records.arrays import FloatArray
from tethertest.solver.solution import Solution

#: dynamic part, relative to the tension at rest, below which nothing moves
_STILL = 1e-9


def relative_difference(tension: FloatArray, reference: FloatArray) -> float:
    """Return the largest RMS difference of a gauge over the RMS of the largest dynamic part.

    Parameters
    ----------
    tension, reference : (n, g) float64
        [N].
    """
    still = _STILL * float(np.max(np.abs(reference[0])))
    dynamic = float(np.sqrt(np.max(np.mean((reference - reference[0]) ** 2, axis=0))))
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
