"""Pi groups: dimensionless products of variables, with exact exponents.

Nothing here depends on the order in which the variables come, nor on the interpreter's hash seed.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations
from typing import TypeAlias

from tethertest.errors import DataError
from tethertest.records.similarity import PiGroup, Variable
from tethertest.similitude.rational import Matrix, Row, null_space, primitive, rank, solve
from tethertest.units import dimension_of

Exponents: TypeAlias = dict[str, Fraction]  #: variable -> exponent, without zeros


@dataclass(frozen=True, slots=True)
class Diagnosis:
    """What a set of variables allows."""

    rank: int  #: of the dimension matrix
    dimensions: tuple[str, ...]  #: base dimensions that occur
    groups: int  #: how many independent groups there are
    stranded: tuple[str, ...]  #: variables that no group can hold
    redundant: tuple[str, ...]  #: variables that are products of others by definition


def dimension_matrix(variables: Iterable[Variable]) -> tuple[tuple[str, ...], tuple[str, ...], Matrix]:
    """Return the exponents of the base dimensions.

    Parameters
    ----------
    variables : iterable of Variable
        With distinct names.

    Returns
    -------
    dimensions : tuple of str
        Base dimensions that occur, sorted: the rows.
    names : tuple of str
        Variables, sorted: the columns.
    matrix : Matrix
        Exponents.

    Raises
    ------
    DataError
        Two variables have the same name.
    """
    ordered = sorted(variables, key=lambda variable: variable.name)
    names = tuple(variable.name for variable in ordered)
    if len(set(names)) < len(names):
        message = f"two variables have the same name among {', '.join(names)}"
        raise DataError(message, "name every variable once")
    columns = [dimension_of(variable.unit) for variable in ordered]
    dimensions = tuple(sorted({dimension for column in columns for dimension in column}))
    matrix = tuple(
        tuple(column.get(dimension, Fraction(0)) for column in columns) for dimension in dimensions
    )
    return dimensions, names, matrix


def dimensions_of(exponents: Mapping[str, Fraction], variables: Iterable[Variable]) -> Exponents:
    """Return the dimension of a product of variables, empty when it is dimensionless.

    Raises
    ------
    DataError
        The product has a variable that is not in the set.
    """
    dimensions, names, matrix = dimension_matrix(variables)
    vector = _vector(exponents, names)
    sums = [sum((a * b for a, b in zip(row, vector, strict=True)), Fraction(0)) for row in matrix]
    return {dimension: total for dimension, total in zip(dimensions, sums, strict=True) if total}


def diagnose(
    variables: Sequence[Variable], definitions: Mapping[str, Mapping[str, Fraction]] | None = None
) -> Diagnosis:
    """Return rank, number of groups, stranded and redundant variables of a set.

    Parameters
    ----------
    variables : sequence of Variable
        The set.
    definitions : mapping, optional
        Variables that are products of others by definition, e.g. ``{"a": {"Ae": 1, "w": 2}}``. Such a
        variable is redundant where the set has all the others: its group would be a constant.
    """
    dimensions, names, matrix = dimension_matrix(variables)
    basis = null_space(matrix, len(names))
    stranded = tuple(name for column, name in enumerate(names) if not any(vector[column] for vector in basis))
    redundant = tuple(
        name
        for name, product in sorted((definitions or {}).items())
        if name in names and all(part in names for part in product)
    )
    return Diagnosis(len(names) - len(basis), dimensions, len(basis), stranded, redundant)


def pi_groups(
    variables: Sequence[Variable],
    repeating: Sequence[str] | None = None,
    named: Mapping[str, Mapping[str, Fraction]] | None = None,
) -> tuple[PiGroup, ...]:
    """Return a complete set of independent pi groups, as primitive integer products.

    Parameters
    ----------
    variables : sequence of Variable
        The set, in any order.
    repeating : sequence of str, optional
        Variables that may occur in every group, as many as the rank. Without them all choices are tried and
        the best is taken: most groups of `named`, then the smallest sum of exponents, then the smallest
        largest exponent, then the first by name.
    named : mapping, optional
        Name -> exponents of groups to recognise, whatever their power and sign.

    Returns
    -------
    tuple of PiGroup
        One for each variable that does not repeat, sorted by that variable, whose exponent is positive.
        Recognised groups have the exponents of `named`; the others are named by their formula.

    Raises
    ------
    DataError
        `repeating` are not in the set, too few or many, or dimensionally dependent.
    """
    _, names, matrix = dimension_matrix(variables)
    order = rank(matrix)
    known = {
        primitive(_vector(product, names)): PiGroup(name, dict(product))
        for name, product in (named or {}).items()
    }
    if repeating is None:
        found = [
            groups
            for choice in combinations(names, order)
            if (groups := _groups_of(choice, names, matrix)) is not None
        ]
        groups = min(found, key=lambda groups: _cost(groups, known))
    else:
        unknown = [name for name in repeating if name not in names]
        if unknown:
            message = f"the repeating variables {', '.join(unknown)} are not in the set"
            raise DataError(message, f"use some of {', '.join(names)}")
        chosen = _groups_of(tuple(repeating), names, matrix) if len(repeating) == order else None
        if chosen is None:
            message = f"{', '.join(repeating)} cannot be the repeating variables of a set of rank {order}"
            raise DataError(message, f"give {order} variables of which none is a product of the others")
        groups = chosen
    return tuple(_group(vector, names, known) for vector in groups)


def formula(exponents: Mapping[str, Fraction]) -> str:
    """Return a product as text, e.g. ``"F/(E l^2)"``; what has a positive exponent comes first."""
    above = [_power(name, power) for name, power in sorted(exponents.items()) if power > 0]
    below = [_power(name, -power) for name, power in sorted(exponents.items()) if power < 0]
    text = " ".join(above) or "1"
    if not below:
        return text
    return f"{text}/{below[0]}" if len(below) == 1 else f"{text}/({' '.join(below)})"


def value_of(exponents: Mapping[str, Fraction], values: Mapping[str, float]) -> float:
    """Return the value of a product of variables."""
    product = 1.0
    for name, power in sorted(exponents.items()):
        product *= values[name] ** float(power)
    return product


def _vector(exponents: Mapping[str, Fraction], names: Sequence[str]) -> Row:
    unknown = sorted(set(exponents) - set(names))
    if unknown:
        message = f"{', '.join(unknown)} is not among the variables {', '.join(names)}"
        raise DataError(message, "add the variable or correct the product")
    return tuple(Fraction(exponents.get(name, 0)) for name in names)


def _groups_of(repeating: tuple[str, ...], names: tuple[str, ...], matrix: Matrix) -> tuple[Row, ...] | None:
    columns = [names.index(name) for name in repeating]
    square = [[row[column] for column in columns] for row in matrix]
    if rank(square) < len(columns):
        return None
    groups = []
    for other in (column for column in range(len(names)) if column not in columns):
        powers = solve(square, [row[other] for row in matrix]) if columns else ()
        if powers is None:
            return None
        vector = [Fraction(0)] * len(names)
        vector[other] = Fraction(1)
        for column, power in zip(columns, powers, strict=True):
            vector[column] = -power
        groups.append(primitive(vector))
    return tuple(groups)


def _cost(groups: tuple[Row, ...], known: Mapping[Row, PiGroup]) -> tuple[int, Fraction, Fraction, Matrix]:
    matched = sum(_recognised(vector, known) is not None for vector in groups)
    powers = [abs(power) for vector in groups for power in vector]
    return -matched, sum(powers, Fraction(0)), max(powers, default=Fraction(0)), groups


def _recognised(vector: Row, known: Mapping[Row, PiGroup]) -> Row | None:
    """Return the named vector that is the same group, whatever its sign."""
    negative = tuple(-power for power in vector)
    return next((candidate for candidate in (vector, negative) if candidate in known), None)


def _group(vector: Row, names: tuple[str, ...], known: Mapping[Row, PiGroup]) -> PiGroup:
    match = _recognised(vector, known)
    if match is not None:
        return known[match]
    exponents = {name: power for name, power in zip(names, vector, strict=True) if power}
    return PiGroup(formula(exponents), exponents)


def _power(name: str, power: Fraction) -> str:
    if power == 1:
        return name
    return f"{name}^{power}" if power.denominator == 1 else f"{name}^({power})"
