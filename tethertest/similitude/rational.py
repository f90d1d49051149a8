"""Exact linear algebra on small matrices of fractions."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import gcd, lcm
from typing import TypeAlias

Row: TypeAlias = tuple[Fraction, ...]
Matrix: TypeAlias = tuple[Row, ...]


def reduced(rows: Sequence[Sequence[Fraction]]) -> tuple[Matrix, tuple[int, ...]]:
    """Return the reduced row echelon form, without zero rows, and its pivot columns."""
    work = [[Fraction(entry) for entry in row] for row in rows]
    pivots: list[int] = []
    for column in range(len(work[0]) if work else 0):
        top = len(pivots)
        pivot = next((row for row in range(top, len(work)) if work[row][column]), None)
        if pivot is None:
            continue
        work[top], work[pivot] = work[pivot], work[top]
        scale = work[top][column]
        work[top] = [entry / scale for entry in work[top]]
        for row in range(len(work)):
            factor = work[row][column]
            if row != top and factor:
                work[row] = [a - factor * b for a, b in zip(work[row], work[top], strict=True)]
        pivots.append(column)
    return tuple(tuple(row) for row in work[: len(pivots)]), tuple(pivots)


def rank(rows: Sequence[Sequence[Fraction]]) -> int:
    """Return the rank of a matrix."""
    return len(reduced(rows)[1])


def null_space(rows: Sequence[Sequence[Fraction]], columns: int) -> Matrix:
    """Return a basis of the vectors x with ``rows @ x = 0``, one for each free column, as primitive integers.

    Parameters
    ----------
    rows : sequence of rows
        The matrix; it may have no rows.
    columns : int
        Number of columns.
    """
    echelon, pivots = reduced(rows)
    basis = []
    for free in (column for column in range(columns) if column not in pivots):
        vector = [Fraction(0)] * columns
        vector[free] = Fraction(1)
        for row, pivot in zip(echelon, pivots, strict=True):
            vector[pivot] = -row[free]
        basis.append(primitive(vector))
    return tuple(basis)


def solve(rows: Sequence[Sequence[Fraction]], right: Sequence[Fraction]) -> Row | None:
    """Return one solution of ``rows @ x = right``, free unknowns zero; None where there is none."""
    columns = len(rows[0])
    augmented = [[*row, entry] for row, entry in zip(rows, right, strict=True)]
    echelon, pivots = reduced(augmented)
    if columns in pivots:
        return None
    solution = [Fraction(0)] * columns
    for row, pivot in zip(echelon, pivots, strict=True):
        solution[pivot] = row[columns]
    return tuple(solution)


def primitive(vector: Sequence[Fraction]) -> Row:
    """Return the multiple of a vector whose entries are integers without a common factor, sign kept."""
    denominator = lcm(*(entry.denominator for entry in vector))
    whole = [int(entry * denominator) for entry in vector]
    factor = gcd(*whole) or 1
    return tuple(Fraction(entry // factor) for entry in whole)
