"""Exact linear algebra against identities that floats would miss."""

from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tethertest.similitude.rational import null_space, primitive, rank, reduced, solve

ENTRIES = st.fractions(min_value=-4, max_value=4, max_denominator=3)
MATRICES = st.integers(1, 4).flatmap(
    lambda columns: st.lists(st.lists(ENTRIES, min_size=columns, max_size=columns), min_size=1, max_size=4)
)


def times(rows, vector):
    return [sum((a * b for a, b in zip(row, vector, strict=True)), Fraction(0)) for row in rows]


@settings(deadline=None)
@given(MATRICES)
def test_null_space_is_exact_and_complete(rows):
    columns = len(rows[0])
    basis = null_space(rows, columns)
    assert len(basis) == columns - rank(rows)
    assert all(not any(times(rows, vector)) for vector in basis)
    assert not basis or rank(basis) == len(basis)
    assert all(entry.denominator == 1 for vector in basis for entry in vector)


@settings(deadline=None)
@given(MATRICES)
def test_rank_is_that_of_the_transpose(rows):
    assert rank(rows) == rank(list(zip(*rows, strict=True)))


@settings(deadline=None)
@given(MATRICES, st.data())
def test_solve_meets_every_right_side_in_the_image(rows, data):
    vector = [data.draw(ENTRIES) for _ in rows[0]]
    right = times(rows, vector)
    assert times(rows, solve(rows, right)) == right


def test_solve_tells_a_contradiction():
    assert solve([[Fraction(1)], [Fraction(2)]], [Fraction(1), Fraction(3)]) is None


def test_a_nearly_singular_matrix_has_full_rank():
    third = Fraction(1, 3)
    assert rank([[third, Fraction(1)], [Fraction(1), 3 + Fraction(1, 10**30)]]) == 2


def test_reduced_rows_start_with_one():
    echelon, pivots = reduced([[Fraction(0), Fraction(2)], [Fraction(3), Fraction(6)]])
    assert echelon == ((1, 0), (0, 1))
    assert pivots == (0, 1)


@pytest.mark.parametrize(
    ("vector", "expected"), [(("1/2", "-1/3"), (3, -2)), (("4", "6"), (2, 3)), (("0", "0"), (0, 0))]
)
def test_primitive_vector(vector, expected):
    assert primitive([Fraction(entry) for entry in vector]) == expected
