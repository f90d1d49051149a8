"""Scale ratios from demands: what follows and what stays free.

Every demand is a product of variables whose ratio, prototype over model, is to have a given value. In the
logarithms x of the variables' ratios a demand is one linear row, so consistency and freedom are exact.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from tethertest.errors import DataError
from tethertest.records.arrays import FloatArray
from tethertest.similitude.conflicts import conflicts
from tethertest.similitude.demands import Demand, rows_of
from tethertest.similitude.rational import null_space, solve


@dataclass(frozen=True, slots=True)
class Scales:
    """What demands make of the ratios of the variables."""

    ratios: dict[str, float]  #: variable -> prototype over model, those that are determined
    undetermined: tuple[str, ...]  #: variables whose ratio is still free
    freedom: int  #: how many ratios may still be chosen
    residuals: dict[str, float]  #: wish -> its ratio found over its ratio wished for
    conflicts: tuple[tuple[str, ...], ...]  #: minimal sets of demands that cannot hold together


def scale_ratios(
    variables: Sequence[str],
    demands: Iterable[Demand],
    wishes: Iterable[Demand] = (),
    background: Iterable[Demand] = (),
) -> Scales:
    """Return the scale ratios that follow from demands.

    Parameters
    ----------
    variables : sequence of str
        All variables, in any order.
    demands : iterable of Demand
        What must hold exactly; conflicts are told in these names.
    wishes : iterable of Demand
        What is to hold as nearly as the demands allow, by least squares of the logarithms.
    background : iterable of Demand
        What must hold too but is not up for discussion, such as the groups to keep: conflicts do not list it.

    Returns
    -------
    Scales
        With conflicts there are no ratios.

    Raises
    ------
    DataError
        A demand names an unknown variable or a ratio that is not positive.
    """
    names = tuple(sorted(variables))
    hard = sorted(demands, key=lambda demand: demand.name)
    firm = [*hard, *sorted(background, key=lambda demand: demand.name)]
    soft = sorted(wishes, key=lambda demand: demand.name)
    for demand in (*firm, *soft):
        _check(demand, names)
    found = conflicts(hard, firm[len(hard) :])
    if found:
        return Scales({}, names, 0, {}, found)
    directions = null_space(rows_of([*firm, *soft], names), len(names))
    free = {name for column, name in enumerate(names) if any(vector[column] for vector in directions)}
    logs = _least_squares(names, firm, soft)
    ratios = {}
    for name, value in zip(names, logs, strict=True):
        if name not in free:
            exact = _product_of_ratios(name, firm, names)
            ratios[name] = math.exp(float(value)) if exact is None else exact
    misfits = np.array(rows_of(soft, names), dtype=np.float64).reshape(-1, len(names)) @ logs
    residuals = {
        wish.name: math.exp(float(misfit) - wish.log_ratio)
        for wish, misfit in zip(soft, misfits, strict=True)
    }
    return Scales(ratios, tuple(sorted(free)), len(directions), residuals, ())


def _product_of_ratios(name: str, firm: Sequence[Demand], names: tuple[str, ...]) -> float | None:
    """Return the ratio of a variable as a product of the demanded ones, None where they do not fix it."""
    if not firm:
        return None
    transposed = list(zip(*rows_of(firm, names), strict=True))
    powers = solve(transposed, [Fraction(other == name) for other in names])
    if powers is None:
        return None
    product = 1.0
    for demand, power in zip(firm, powers, strict=True):
        product *= demand.ratio ** float(power)
    return product


def _least_squares(names: tuple[str, ...], firm: Sequence[Demand], soft: Sequence[Demand]) -> FloatArray:
    """Return the logarithms of the ratios: firm rows exactly, soft ones nearest, shortest otherwise."""
    logs = np.zeros(len(names))
    directions = np.eye(len(names))
    if firm:
        exact = rows_of(firm, names)
        right = np.array([demand.log_ratio for demand in firm])
        logs = np.linalg.lstsq(np.array(exact, dtype=np.float64), right)[0]
        basis = np.array(null_space(exact, len(names)), dtype=np.float64)
        directions = basis.reshape(-1, len(names)).T
    if soft and directions.size:
        rows = np.array(rows_of(soft, names), dtype=np.float64)
        missing = np.array([demand.log_ratio for demand in soft]) - rows @ logs
        logs = logs + directions @ np.linalg.lstsq(rows @ directions, missing)[0]
    return logs


def _check(demand: Demand, names: tuple[str, ...]) -> None:
    unknown = sorted(set(demand.exponents) - set(names))
    if unknown:
        message = f"{demand.name!r} is about {', '.join(unknown)}, which is not among {', '.join(names)}"
        raise DataError(message, "add the variable or correct the demand")
    if not (math.isfinite(demand.ratio) and demand.ratio > 0.0):
        message = f"{demand.name!r} asks for the ratio {demand.ratio!r}, expected a positive number"
        raise DataError(message, "give prototype over model, such as 50")
