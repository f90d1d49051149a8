"""Holm's correction for the number of orders tried."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction


def holm(p_values: Mapping[Fraction, float]) -> dict[Fraction, float]:
    """Return p-values adjusted for the number of orders tried, by Holm's step-down rule.

    References
    ----------
    S. Holm, Scand. J. Statist. 6 (1979) 65-70.
    """
    adjusted: dict[Fraction, float] = {}
    largest = 0.0
    for rank, order in enumerate(sorted(p_values, key=lambda order: p_values[order])):
        largest = max(largest, min(1.0, (len(p_values) - rank) * p_values[order]))
        adjusted[order] = largest
    return adjusted


def holm_chances(p_values: Mapping[Fraction, float], significance: float) -> dict[Fraction, float]:
    """Return the largest p-value at which each order would be significant, the others being as they are.

    Parameters
    ----------
    p_values : mapping
        Of all orders tried, not adjusted.
    significance : float
        Chance of any false line among them.
    """
    count = len(p_values)
    chances = {}
    for order in p_values:
        others = sorted(p for other, p in p_values.items() if other != order)
        before = (rank for rank, p in enumerate(others) if p > significance / (count - rank))
        chances[order] = significance / (count - next(before, count - 1))
    return chances
