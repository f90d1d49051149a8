"""Each number of a similarity from its place in the files, against hand calculations and exact thresholds."""

import math
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import pytest

from tethertest.errors import DataError
from tethertest.readers import load_prototype, load_rig
from tethertest.records.similarity import PiGroup, Variable
from tethertest.similitude import (
    Demand,
    Motion,
    conflicts,
    level,
    same,
    scale_ratios,
    similarity,
    tether_variables,
)
from tethertest.similitude.distortion import judged
from tethertest.similitude.groups import diagnose
from tethertest.similitude.rational import null_space, primitive, rank, reduced, solve

RIGS = Path(__file__).parents[3] / "rigs"


@pytest.fixture(scope="module")
def rig():
    return load_rig(RIGS / "rig3m.toml")


@pytest.fixture(scope="module")
def prototype():
    return load_prototype(RIGS / "prototype-150m.toml")


def test_every_variable_comes_from_its_place(rig, prototype):
    dragged = replace(rig, platform=replace(rig.platform, drag_area=(0.1, 0.2)))
    values = tether_variables(dragged, prototype, "hold", Motion(0.3, 0.1), Motion(0.2, None))
    model = {variable.name: variable.model for variable in values}
    full = {variable.name: variable.prototype for variable in values}
    assert model == pytest.approx(
        {
            "length": 3.0,
            "mass_per_length": 0.0484,
            "axial_stiffness": 10020.0,
            "diameter": 0.006,
            "axial_damping_time": 1e-4,
            "bending_stiffness": rig.cable.bending_stiffness,
            "static_tension": 5.0,
            "gravity": 9.80665,
            "platform_mass": 0.4,
            "hover_stiffness": 50.0,
            "hover_damping": 5.0,
            "drag_area": 0.2,
            "air_density": 1.2,
            "normal_drag": 1.2,
            "angular_frequency": 2.0 * math.pi * 0.3,
            "amplitude": 0.1,
        }
    )
    assert (full["hover_stiffness"], full["hover_damping"], full["static_tension"]) == (100.0, 60.0, 121.0)
    assert (full["drag_area"], full["amplitude"]) == (None, None)
    assert full["angular_frequency"] == pytest.approx(2.0 * math.pi * 0.2)
    still = tether_variables(
        replace(rig, air=None), prototype, "hold", Motion(None, None), Motion(None, None)
    )
    lost = {variable.name for variable in still if variable.model is None}
    assert {"air_density", "normal_drag", "angular_frequency", "amplitude", "drag_area"} <= lost


def test_axial_stiffness_is_given_or_follows_from_modulus_and_section(rig, prototype):
    def stiffness(**fields):
        cable = replace(rig.cable, axial_stiffness=None, **fields)
        values = tether_variables(
            replace(rig, cable=cable), prototype, "hold", Motion(0.3, 0.1), Motion(0.3, 5.0)
        )
        return next(variable.model for variable in values if variable.name == "axial_stiffness")

    assert stiffness(youngs_modulus=2e9, diameter=0.01) == pytest.approx(2e9 * math.pi * 0.005**2)
    assert stiffness(youngs_modulus=None, diameter=0.01) is None
    assert stiffness(youngs_modulus=2e9, diameter=None) is None


def test_ratios_of_a_pair_that_differs_in_everything(rig, prototype):
    cable = replace(prototype.cable, length=30.0, mass_per_length=0.0968, axial_stiffness=80160.0)
    other = replace(
        prototype, cable=cable, platform=replace(prototype.platform, static_tension=90.0, mass=1.2)
    )
    found = similarity(rig, other, 0.3, 0.1, "hold", prototype_frequency=0.15, prototype_amplitude=2.0)
    assert found.ratios == pytest.approx(
        {
            "length": 10.0,
            "mass_per_length": 2.0,
            "axial_stiffness": 8.0,
            "force": 18.0,
            "mass": 3.0,
            "hover_stiffness": 2.0,
            "hover_damping": 12.0,
            "amplitude": 20.0,
            "frequency": 0.5,
            "cable_mass": 20.0,
            "strain": 2.25,
            "axial_wave_speed": 2.0,
            "lateral_wave_speed": 3.0,
            "time": 2.0,
            "velocity": 10.0,
            "acceleration": 5.0,
        }
    )


def test_only_what_is_alike_to_five_percent_either_way_can_be_in_conflict(rig, prototype):
    def shared(factor):
        cable = replace(prototype.cable, mass_per_length=rig.cable.mass_per_length * factor)
        found = similarity(rig, replace(prototype, cable=cable), 0.3, 0.1, "hold")
        return any("same mass per length" in names for names in found.conflicts)

    assert shared(1.049)
    assert shared(1.0 / 1.049)
    assert not shared(1.06)
    assert not shared(1.0 / 1.06)


def test_the_amplitude_is_scaled_only_where_the_run_has_one_and_the_prototype_none(rig, prototype):
    def says(*args, **fields):
        found = similarity(rig, prototype, 0.3, *args, "hold", **fields)
        return any("so Ae/L matches" in remark for remark in found.remarks)

    assert says(0.1)
    assert not says(0.1, prototype_amplitude=5.0)
    assert not says(None)
    assert not says(None, prototype_amplitude=5.0)


def test_the_sea_holds_its_own_bounds(rig, prototype):
    def outside(frequency, amplitude):
        found = similarity(
            rig, prototype, 0.3, 0.1, "hold", prototype_frequency=frequency, prototype_amplitude=amplitude
        )
        return [remark for remark in found.remarks if "outside its sea" in remark]

    assert outside(0.1, 5.0) == outside(0.3, 0.001) == []
    assert outside(0.31, 5.0) == [
        "the prototype's heave frequency of 0.31 Hz is outside its sea of 0.1 to 0.3 Hz"
    ]
    assert outside(0.3, 5.1) == ["the prototype's heave amplitude of 5.1 m is outside its sea of 0 to 5 m"]
    assert len(outside(0.09, 6.0)) == 2


def test_groups_that_are_products_of_others_are_counted(rig, prototype):
    found = similarity(rig, prototype, 0.3, 0.1, "hold")
    (remark,) = [text for text in found.remarks if "independent" in text]
    # w L/cl, w L/ct and T/EA are two: (w L/cl)^2 = (w L/ct)^2 T/EA; and so on
    names = sorted({name for group in found.groups for name in group.exponents})
    rows = [[group.exponents.get(name, Fraction(0)) for name in names] for group in found.groups]
    assert remark.startswith(f"{rank(rows)} of the {len(found.groups)} groups are independent")
    assert rank(rows) < len(found.groups)
    still = similarity(rig, prototype, None, None, "free")
    assert not any("independent" in text for text in still.remarks)


def test_levels_change_above_their_thresholds():
    assert [level(ratio) for ratio in (1.05, 1.0500001, 2.0, 2.0000001)] == [
        "matched",
        "mild",
        "mild",
        "violated",
    ]
    assert [level(ratio) for ratio in (0.5, 0.4999999)] == ["mild", "violated"]
    assert level(-1.0) == "violated"


def test_a_group_is_judged_model_over_prototype():
    group = PiGroup("x", {"x": Fraction(1)})
    found = judged(group, 3.0, 2.0)
    assert (found.model, found.prototype, found.ratio, found.level) == (3.0, 2.0, 1.5, "mild")
    assert judged(group, 0.0, 2.0).level == "violated"
    assert judged(group, 3.0, 0.0).ratio is None


@pytest.mark.parametrize("ratio", [0.0, -0.5, math.inf, math.nan])
def test_a_ratio_is_a_positive_number(ratio):
    with pytest.raises(DataError, match="expected a positive number"):
        scale_ratios(["l"], [Demand("bad", {"l": Fraction(1)}, ratio)])
    with pytest.raises(DataError, match="expected a positive number"):
        scale_ratios(["l"], [], wishes=[Demand("bad", {"l": Fraction(1)}, ratio)])
    with pytest.raises(DataError, match="expected a positive number"):
        scale_ratios(["l"], [], background=[Demand("bad", {"l": Fraction(1)}, ratio)])


def test_a_ratio_between_nothing_and_one_is_positive():
    assert scale_ratios(["l"], [Demand("small", {"l": Fraction(1)}, 0.5)]).ratios == {"l": 0.5}


def test_freedom_counts_the_ratios_that_may_still_be_chosen():
    found = scale_ratios(["a", "b", "c"], [Demand("ab", {"a": Fraction(1), "b": Fraction(1)}, 6.0)])
    assert (found.freedom, found.undetermined, found.ratios) == (2, ("a", "b", "c"), {})
    more = scale_ratios(["a", "b", "c"], [Demand("ab", {"a": Fraction(1), "b": Fraction(1)}, 6.0), same("a")])
    assert (more.freedom, more.undetermined) == (1, ("c",))
    assert more.ratios == pytest.approx({"a": 1.0, "b": 6.0})


def test_wishes_fill_what_demands_leave_free():
    half = Demand("a^2 b", {"a": Fraction(2), "b": Fraction(1)}, 12.0)
    found = scale_ratios(["a", "b"], [half], wishes=[Demand("a 2", {"a": Fraction(1)}, 2.0)])
    assert found.ratios == pytest.approx({"a": 2.0, "b": 3.0})
    assert found.residuals == pytest.approx({"a 2": 1.0})


def test_a_larger_set_of_demands_is_no_conflict_where_a_smaller_one_in_it_is():
    demands = [
        Demand(name, {key: Fraction(power) for key, power in product.items()}, ratio)
        for name, product, ratio in (
            ("x 1", {"x": 1}, 1.0),
            ("x 2", {"x": 1}, 2.0),
            ("y 1", {"y": 1}, 1.0),
            ("xy 7", {"x": 1, "y": 1}, 7.0),
        )
    ]
    assert conflicts(demands) == (("x 1", "x 2"), ("x 1", "xy 7", "y 1"), ("x 2", "xy 7", "y 1"))


def test_a_ratio_that_differs_by_a_millionth_is_another():
    close = [Demand("x", {"x": Fraction(1)}, 2.0), Demand("again", {"x": Fraction(1)}, 2.0 * (1 + 1e-6))]
    assert conflicts(close) == (("again", "x"),)
    same_to_rounding = [close[0], Demand("again", {"x": Fraction(1)}, 2.0 * (1 + 1e-12))]
    assert conflicts(same_to_rounding) == ()


def test_elimination_by_hand():
    rows = [[Fraction(0), Fraction(2), Fraction(4)], [Fraction(1), Fraction(1), Fraction(1)]]
    assert reduced(rows) == (((1, 0, -1), (0, 1, 2)), (0, 1))
    assert null_space(rows, 3) == ((1, -2, 1),)
    assert null_space([], 2) == ((1, 0), (0, 1))
    assert solve(rows, [Fraction(2), Fraction(3)]) == (2, 1, 0)
    assert solve([[Fraction(1)], [Fraction(1)]], [Fraction(1), Fraction(2)]) is None
    assert primitive([Fraction(1, 2), Fraction(-2, 3)]) == (3, -4)
    assert primitive([Fraction(0), Fraction(0)]) == (0, 0)
    with pytest.raises(ValueError, match="argument 2"):
        solve(rows, [Fraction(2)])


def test_a_defined_variable_is_redundant_only_where_the_set_has_all_it_is_made_of():
    definition = {"a": {"Ae": Fraction(1), "w": Fraction(2)}}
    every = [Variable("a", "m/s^2"), Variable("Ae", "m"), Variable("w", "1/s")]
    assert diagnose(every, definition).redundant == ("a",)
    assert diagnose(every[:2], definition).redundant == ()
    assert diagnose(every[1:], definition).redundant == ()
