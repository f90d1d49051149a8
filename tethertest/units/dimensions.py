"""Exact dimensions, as the similitude algebra needs them."""

from __future__ import annotations

from fractions import Fraction

from tethertest.units.common import SI_UNITS
from tethertest.units.registry import parse_unit

_NAMES = {"[length]": "L", "[mass]": "M", "[time]": "T", "[temperature]": "K", "[current]": "A"}


def dimension_of(unit: str) -> dict[str, Fraction]:
    """Return the exponents of length L, mass M, time T, temperature K and current A of a unit.

    Parameters
    ----------
    unit : str
        Any unit text, e.g. ``"N"``.

    Returns
    -------
    dict
        Exponents as exact fractions, without zeros: ``{"M": 1, "L": 1, "T": -2}``.

    Raises
    ------
    QuantityError
        The unit is not known.
    """
    common = SI_UNITS.get(unit)
    if common is not None:
        return {name: Fraction(power) for name, power in common.dimension.items()}
    exponents = parse_unit(unit).dimensionality
    return {
        _NAMES.get(name, name): Fraction(power).limit_denominator(1000)
        for name, power in exponents.items()
        if power
    }
