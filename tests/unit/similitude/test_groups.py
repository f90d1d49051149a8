"""Pi groups: the article's five, exact exponents, independence of order and hash seed, diagnostics."""

import os
import random
import subprocess
import sys
from fractions import Fraction

import pytest

from tethertest.errors import DataError
from tethertest.records.similarity import Variable
from tethertest.similitude import (
    PAPER_GROUPS,
    PAPER_REPEATING,
    PAPER_VARIABLES,
    diagnose,
    dimensions_of,
    formula,
    pi_groups,
    value_of,
)
from tethertest.similitude.rational import rank
from tethertest.similitude.sets import PAPER_DEFINITIONS, TETHER_GROUPS, TETHER_UNITS

TETHER_VARIABLES = tuple(Variable(name, unit) for name, unit in TETHER_UNITS.items())

#: the groups printed after the article's Table 2, as they are without a dimension
PAPER_EXPONENTS = {
    "F/(E l^2)": {"F": 1, "E": -1, "l": -2},
    "Ae/l": {"Ae": 1, "l": -1},
    "rho a l/E": {"rho": 1, "a": 1, "l": 1, "E": -1},
    "w^2 l/a": {"w": 2, "l": 1, "a": -1},
    "A/l^2": {"A": 1, "l": -2},
}


def by_name(groups):
    return {group.name: group.exponents for group in groups}


def test_the_articles_set_with_its_repeating_variables_gives_its_five_groups():
    groups = by_name(pi_groups(PAPER_VARIABLES, PAPER_REPEATING, PAPER_GROUPS))
    assert groups == PAPER_EXPONENTS


def test_the_articles_groups_are_found_among_all_choices():
    assert by_name(pi_groups(PAPER_VARIABLES, named=PAPER_GROUPS)) == PAPER_EXPONENTS


def test_the_articles_groups_need_no_names_to_come_out():
    found = pi_groups(PAPER_VARIABLES, PAPER_REPEATING)
    assert {frozenset(group.exponents.items()) for group in found} == {
        frozenset(exponents.items()) for exponents in PAPER_EXPONENTS.values()
    }


def test_the_articles_dimension_matrix_has_rank_three():
    diagnosis = diagnose(PAPER_VARIABLES, PAPER_DEFINITIONS)
    assert (diagnosis.rank, diagnosis.groups, diagnosis.dimensions) == (3, 5, ("L", "M", "T"))
    assert diagnosis.stranded == ()
    assert diagnosis.redundant == ("a",)


@pytest.mark.parametrize("variables", [PAPER_VARIABLES, TETHER_VARIABLES], ids=["paper", "tether"])
def test_groups_are_dimensionless_independent_and_as_many_as_the_theorem_says(variables):
    groups = pi_groups(variables)
    names = sorted(variable.name for variable in variables)
    assert len(groups) == len(variables) - diagnose(variables).rank
    assert rank([[group.exponents.get(name, Fraction(0)) for name in names] for group in groups]) == len(
        groups
    )
    for group in groups:
        assert dimensions_of(group.exponents, variables) == {}
        assert all(power.denominator == 1 for power in group.exponents.values())


@pytest.mark.parametrize("group", TETHER_GROUPS, ids=lambda group: group.name)
def test_named_groups_of_the_tether_are_dimensionless(group):
    assert dimensions_of(group.exponents, TETHER_VARIABLES) == {}
    assert group.meaning


def test_wave_groups_have_square_roots():
    waves = next(group for group in TETHER_GROUPS if group.name == "w L/cl")
    assert waves.exponents["mass_per_length"] == Fraction(1, 2)
    assert waves.exponents["axial_stiffness"] == -Fraction(1, 2)


def test_a_product_with_a_dimension_is_told():
    assert dimensions_of({"F": Fraction(1)}, PAPER_VARIABLES) == {"M": 1, "L": 1, "T": -2}


def test_groups_do_not_depend_on_the_order_of_the_variables():
    expected = pi_groups(PAPER_VARIABLES)
    shuffled = list(PAPER_VARIABLES)
    for seed in range(5):
        random.Random(seed).shuffle(shuffled)
        assert pi_groups(shuffled) == expected
        assert pi_groups(shuffled, PAPER_REPEATING[::-1]) == pi_groups(PAPER_VARIABLES, PAPER_REPEATING)


def test_groups_do_not_depend_on_the_hash_seed():
    program = (
        "from tethertest.similitude import PAPER_VARIABLES, pi_groups\n"
        "print([(group.name, list(group.exponents.items())) for group in pi_groups(PAPER_VARIABLES)])"
    )
    printed = {
        subprocess.run(
            [sys.executable, "-c", program],
            env={**os.environ, "PYTHONHASHSEED": seed},
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for seed in ("0", "1", "4242")
    }
    assert len(printed) == 1


def test_a_lone_mass_is_stranded():
    diagnosis = diagnose(
        [Variable("m", "kg"), Variable("l", "m"), Variable("w", "1/s"), Variable("v", "m/s")]
    )
    assert diagnosis.stranded == ("m",)
    assert diagnosis.groups == 1


def test_rank_below_the_number_of_dimensions():
    """Force and stiffness have M and T only as M/T^2."""
    diagnosis = diagnose([Variable("F", "N"), Variable("k", "N/m"), Variable("l", "m")])
    assert (diagnosis.rank, len(diagnosis.dimensions)) == (2, 3)
    (group,) = pi_groups([Variable("F", "N"), Variable("k", "N/m"), Variable("l", "m")])
    assert set(group.exponents.values()) == {1, -1}


@pytest.mark.parametrize("repeating", [("E", "l"), ("Ae", "l", "A"), ("E", "l", "w", "a")])
def test_bad_repeating_variables_are_refused(repeating):
    with pytest.raises(DataError, match="cannot be the repeating variables of a set of rank 3"):
        pi_groups(PAPER_VARIABLES, repeating)


def test_unknown_repeating_variables_are_named():
    with pytest.raises(DataError, match="kappa are not in the set"):
        pi_groups(PAPER_VARIABLES, ("E", "l", "kappa"))


def test_two_variables_of_one_name_are_refused():
    with pytest.raises(DataError, match="same name"):
        pi_groups([Variable("l", "m"), Variable("l", "mm")])


def test_formula_and_value():
    exponents = {"F": Fraction(1), "E": Fraction(-1), "l": Fraction(-2), "w": Fraction(1, 2)}
    assert formula(exponents) == "F w^(1/2)/(E l^2)"
    assert value_of(exponents, {"F": 12.0, "E": 3.0, "l": 2.0, "w": 9.0}) == pytest.approx(3.0)
