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
