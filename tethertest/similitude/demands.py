"""Demands on scale ratios: products of variables whose ratio is to have a given value."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from tethertest.similitude.groups import Exponents
from tethertest.similitude.rational import Matrix


@dataclass(frozen=True, slots=True)
class Demand:
    """A product of variables and the ratio, prototype over model, that it is to have."""

    name: str  #: e.g. "same E", "length 50", "keep Ae/l"
    exponents: Exponents
    ratio: float = 1.0

    @property
    def log_ratio(self) -> float:
        """Natural logarithm of the ratio: the right side of the demand's row."""
        return math.log(self.ratio)


def same(variable: str) -> Demand:
    """Return the demand that a variable is equal at both scales."""
    return Demand(f"same {variable.replace('_', ' ')}", {variable: Fraction(1)})


def scaled(variable: str, ratio: float) -> Demand:
    """Return the demand that a variable has a given ratio."""
    return Demand(f"{variable.replace('_', ' ')} {ratio:g}", {variable: Fraction(1)}, ratio)


def kept(groups: Mapping[str, Exponents]) -> tuple[Demand, ...]:
    """Return the demands that pi groups are equal at both scales."""
    return tuple(Demand(f"keep {name}", dict(exponents)) for name, exponents in sorted(groups.items()))


def rows_of(demands: Sequence[Demand], names: Sequence[str]) -> Matrix:
    """Return the exponents of demands, one row each, with a column for every variable."""
    return tuple(tuple(Fraction(demand.exponents.get(name, 0)) for name in names) for demand in demands)
