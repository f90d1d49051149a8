"""Scale ratios: the article's Table 3 put right, conflicts, freedom, laws by name."""

from fractions import Fraction

import pytest

from tethertest.errors import DataError
from tethertest.similitude import (
    LAWS,
    PAPER_GROUPS,
    PAPER_VARIABLES,
    Demand,
    conflicts,
    kept,
    same,
    scale_ratios,
    scaled,
)

NAMES = [variable.name for variable in PAPER_VARIABLES]
GROUPS = kept(PAPER_GROUPS)
LAW = {law.name: law for law in LAWS}


@pytest.mark.parametrize("length_ratio", [50.0, 0.02, 3.0])
def test_same_material_and_all_groups_kept(length_ratio):
    """With E and rho the same, acceleration and frequency go as 1/l, velocity stays: not what is printed."""
    scales = scale_ratios(NAMES, [same("E"), same("rho"), scaled("l", length_ratio)], background=GROUPS)
    assert scales.conflicts == ()
    assert scales.freedom == 0
    assert scales.ratios["a"] == pytest.approx(1 / length_ratio, rel=1e-14)
    assert scales.ratios["w"] == pytest.approx(1 / length_ratio, rel=1e-14)
    assert scales.ratios["w"] * scales.ratios["Ae"] == pytest.approx(1.0, rel=1e-14)
    assert scales.ratios["F"] == pytest.approx(length_ratio**2, rel=1e-14)
    assert scales.ratios["A"] == pytest.approx(length_ratio**2, rel=1e-14)


def test_what_table_3_demands_leaves_one_ratio_free():
    scales = scale_ratios(NAMES, [same("E"), scaled("l", 50)], background=GROUPS)
    assert scales.freedom == 1
    assert scales.undetermined == ("a", "rho", "w")
    assert scales.ratios["F"] == pytest.approx(2500)


def test_table_3_as_printed_contradicts_the_groups_and_the_same_density():
    printed = [same("E"), same("rho"), scaled("l", 50), scaled("a", 50)]
    assert conflicts(printed, GROUPS) == (("a 50", "l 50", "same E", "same rho"),)


def test_same_material_and_same_gravity_force_the_same_length():
    wanted = [same("E"), same("rho"), same("a")]
    assert scale_ratios(NAMES, wanted, background=GROUPS).ratios["l"] == 1.0
    assert conflicts(wanted, [*GROUPS, scaled("l", 50)]) == (("same E", "same a", "same rho"),)
    assert conflicts([*wanted, scaled("l", 50)], GROUPS) == (("l 50", "same E", "same a", "same rho"),)


@pytest.mark.parametrize("left_out", ["same E", "same rho", "same a"])
def test_the_conflicting_set_is_minimal(left_out):
    wanted = [demand for demand in (same("E"), same("rho"), same("a")) if demand.name != left_out]
    assert conflicts(wanted, [*GROUPS, scaled("l", 50)]) == ()


def test_with_conflicts_there_are_no_ratios():
    scales = scale_ratios(NAMES, [same("E"), same("rho"), same("a"), scaled("l", 50)], background=GROUPS)
    assert scales.ratios == {}
    assert scales.undetermined == tuple(sorted(NAMES))
    assert len(scales.conflicts) == 1


def test_groups_as_wishes_leave_the_residual_where_it_cannot_be_helped():
    demands = [same("E"), same("rho"), same("a"), scaled("l", 50)]
    scales = scale_ratios(NAMES, demands, wishes=GROUPS)
    assert scales.residuals.pop("keep rho a l/E") == pytest.approx(50.0)
    assert list(scales.residuals.values()) == pytest.approx([1.0] * 4)
    assert scales.ratios["w"] == pytest.approx(50**-0.5)


def test_least_squares_share_a_misfit():
    """One ratio that is to be 4 and to be 16 becomes 8, their geometric mean."""
    wishes = [Demand("four", {"x": Fraction(1)}, 4.0), Demand("sixteen", {"x": Fraction(1)}, 16.0)]
    scales = scale_ratios(["x"], [], wishes)
    assert scales.ratios["x"] == pytest.approx(8.0)
    assert scales.residuals == {"four": pytest.approx(2.0), "sixteen": pytest.approx(0.5)}


def test_order_of_demands_does_not_matter():
    demands = [same("E"), same("rho"), scaled("l", 50)]
    assert scale_ratios(NAMES, demands, background=GROUPS) == scale_ratios(
        NAMES[::-1], demands[::-1], background=GROUPS[::-1]
    )


def test_two_ratios_of_one_variable_conflict_but_the_same_twice_does_not():
    assert conflicts([scaled("l", 50), scaled("l", 49)]) == (("l 49", "l 50"),)
    assert conflicts([scaled("l", 50), Demand("again", {"l": Fraction(1)}, 50.0)]) == ()


@pytest.mark.parametrize("demand", [scaled("length", 50), scaled("l", -50), scaled("l", float("nan"))])
def test_bad_demands_are_refused(demand):
    with pytest.raises(DataError):
        scale_ratios(NAMES, [demand])


def test_a_demand_that_the_background_meets_is_no_conflict():
    assert conflicts([scaled("l", 50)], [scaled("l", 50)]) == ()
    assert conflicts([scaled("l", 50)], [scaled("l", 0.02)]) == (("l 50",),)


def test_many_demands_at_odds_are_all_found():
    """Of x = 1, x = 2 ... no two can hold together."""
    demands = [Demand(f"x {ratio}", {"x": Fraction(1)}, float(ratio)) for ratio in range(1, 21)]
    assert len(conflicts(demands)) == 20 * 19 / 2


def test_a_background_at_odds_with_itself_is_told_as_the_empty_set():
    assert conflicts([same("l")], [scaled("l", 2), scaled("l", 3)]) == ((),)


HALF = Fraction(1, 2)


@pytest.mark.parametrize(
    ("law", "unit", "exponents"),
    [
        ("froude", "1/s", {"length": -HALF}),
        ("froude", "m/s", {"length": HALF}),
        ("froude", "N", {"density": 1, "length": 3}),
        ("froude", "Pa", {"density": 1, "length": 1}),
        ("cauchy", "m/s", {"youngs_modulus": HALF, "density": -HALF}),
        ("cauchy", "1/s", {"youngs_modulus": HALF, "density": -HALF, "length": -1}),
        ("fixed_section_cable", "N", {"axial_stiffness": 1}),
        ("taut_string", "1/s", {"tension": HALF, "mass_per_length": -HALF, "length": -1}),
    ],
)
def test_laws_by_name(law, unit, exponents):
    assert LAW[law].exponents(unit) == exponents


def test_a_law_gives_ratios():
    assert LAW["froude"].ratio("N", {"length": 50.0, "density": 1.0}) == pytest.approx(125000.0)
    assert LAW["froude"].ratio("1/s", {"length": 50.0}) == pytest.approx(50**-0.5)
    assert LAW["froude"].ratio("1", {}) == 1.0
    assert LAW["cauchy"].free == ("length", "density", "youngs_modulus")


def test_a_law_asks_for_what_it_needs_and_refuses_what_it_does_not_scale():
    with pytest.raises(DataError, match="needs the ratio of density"):
        LAW["froude"].ratio("N", {"length": 50.0})
    with pytest.raises(DataError, match="does not scale 'K'"):
        LAW["froude"].exponents("K")
