"""Which demands on scale ratios cannot hold together."""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction
from itertools import combinations

import numpy as np

from tethertest.similitude.demands import Demand, rows_of
from tethertest.similitude.rational import Matrix, Row, null_space, rank

#: two logarithms of a ratio that differ by less are the same demand
SAME_RATIO = 1e-9


def conflicts(demands: Sequence[Demand], background: Sequence[Demand] = ()) -> tuple[tuple[str, ...], ...]:
    """Return the minimal sets of demands that cannot hold together on top of the background.

    Parameters
    ----------
    demands : sequence of Demand
        Those that may be given up.
    background : sequence of Demand
        Those that may not.

    Returns
    -------
    tuple of tuple of str
        Names, smallest sets first; one empty set where the background contradicts itself.

    Notes
    -----
    The demands are restricted to what the background leaves free, a space of a few dimensions; a minimal set
    has at most one demand more than that, so few sets need a look.
    """
    ordered = sorted(demands, key=lambda demand: demand.name)
    names = sorted({name for demand in (*ordered, *background) for name in demand.exponents})
    if not _is_consistent(rows_of(background, names), [demand.log_ratio for demand in background]):
        return ((),)
    rows, logs = _on_background(ordered, background, names)
    found: list[tuple[int, ...]] = []
    for size in range(1, min(rank(rows) + 1, len(ordered)) + 1):
        for chosen in combinations(range(len(ordered)), size):
            if any(set(smaller) <= set(chosen) for smaller in found):
                continue
            if not _is_consistent([rows[index] for index in chosen], [logs[index] for index in chosen]):
                found.append(chosen)
    return tuple(tuple(ordered[index].name for index in chosen) for chosen in found)


def _on_background(
    demands: Sequence[Demand], background: Sequence[Demand], names: Sequence[str]
) -> tuple[Matrix, list[float]]:
    """Return rows and right sides of demands in coordinates of what a consistent background leaves free."""
    fixed = rows_of(background, names)
    directions = null_space(fixed, len(names))
    point = np.zeros(len(names))
    if background:
        matrix = np.array(fixed, dtype=np.float64)
        point = np.linalg.lstsq(matrix, np.array([demand.log_ratio for demand in background]))[0]
    rows = rows_of(demands, names)
    inner = tuple(
        tuple(
            sum((a * b for a, b in zip(row, direction, strict=True)), Fraction(0)) for direction in directions
        )
        for row in rows
    )
    logs = [
        demand.log_ratio - math.fsum(float(power) * value for power, value in zip(row, point, strict=True))
        for demand, row in zip(demands, rows, strict=True)
    ]
    return inner, logs


def _is_consistent(rows: Sequence[Row], logs: Sequence[float]) -> bool:
    """Tell whether ratios can meet all rows: where rows cancel, their right sides must cancel too."""
    if not rows:
        return True
    for weights in null_space(list(zip(*rows, strict=True)), len(rows)):
        terms = [float(weight) * log for weight, log in zip(weights, logs, strict=True)]
        if abs(math.fsum(terms)) > SAME_RATIO * max(1.0, *(abs(term) for term in terms)):
            return False
    return True
