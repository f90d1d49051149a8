"""The 3 m rig against its 150 m prototype."""

import math
from dataclasses import replace
from pathlib import Path

import pytest

from tethertest.errors import DataError
from tethertest.readers import load_prototype, load_rig
from tethertest.similitude import Motion, dimensions_of, level, similarity, tether_variables, value_of

RIGS = Path(__file__).parents[3] / "rigs"


@pytest.fixture(scope="module")
def rig():
    return load_rig(RIGS / "rig3m.toml")


@pytest.fixture(scope="module")
def prototype():
    return load_prototype(RIGS / "prototype-150m.toml")


@pytest.fixture(scope="module")
def found(rig, prototype):
    return similarity(rig, prototype, 0.3, 0.1, "hold")


@pytest.fixture(scope="module")
def groups(found):
    return {group.name: group for group in found.groups}


def test_groups_are_their_exponents_over_the_files_values(rig, prototype, found):
    variables = tether_variables(rig, prototype, "hold", Motion(0.3, 0.1), Motion(0.3, 5.0))
    model = {variable.name: variable.model for variable in variables}
    full = {variable.name: variable.prototype for variable in variables}
    for group in found.groups:
        assert dimensions_of(group.exponents, variables) == {}
        assert group.model == pytest.approx(value_of(group.exponents, model), rel=1e-12)
        assert group.prototype == pytest.approx(value_of(group.exponents, full), rel=1e-12)
        assert group.ratio == pytest.approx(group.model / group.prototype, rel=1e-12)


def test_group_values_by_hand(groups):
    speed = math.sqrt(10020.0 / 0.0484)
    assert groups["w L/cl"].model == pytest.approx(2 * math.pi * 0.3 * 3.0 / speed)
    assert groups["w L/ct"].prototype == pytest.approx(2 * math.pi * 0.3 * 150.0 / math.sqrt(121 / 0.0484))
    assert groups["M/(rl L)"].model == pytest.approx(0.4 / (0.0484 * 3))
    assert groups["EA Ae/(L T)"].model == pytest.approx(10020 * 0.1 / (3 * 5))
    assert groups["rl g L/T"].model == pytest.approx(0.0484 * 9.80665 * 3 / 5)


def test_distortion_of_table_4(groups):
    """The same cable, 50 times as long, at the same frequency: waves and inertia cannot be alike."""
    assert groups["Ae/L"].level == "matched"
    for name in ("w L/cl", "w L/ct", "w^2 L/g", "M/(rl L)", "Cd rho d Ae/rl"):
        assert groups[name].level == "violated"
    assert groups["w L/cl"].ratio == pytest.approx(1 / 50)
    assert groups["w^2 L/g"].ratio == pytest.approx(1 / 50)
    assert groups["M/(rl L)"].ratio == pytest.approx(4.0)


def test_ratios_are_prototype_over_model(found):
    expected = {
        "length": 50.0,
        "amplitude": 50.0,
        "time": 1.0,
        "velocity": 50.0,
        "acceleration": 50.0,
        "mass": 12.5,
        "cable_mass": 50.0,
        "force": 24.2,
        "strain": 24.2,
        "axial_wave_speed": 1.0,
        "lateral_wave_speed": math.sqrt(24.2),
    }
    assert {name: found.ratios[name] for name in expected} == pytest.approx(expected)


def test_conflicts_say_why(found):
    assert ("same frequency", "same gravity") in found.conflicts
    assert ("same axial stiffness", "same gravity", "same mass per length") in found.conflicts
    assert ("same axial stiffness", "same frequency", "same mass per length") in found.conflicts
    assert found.rank == 3


def test_remarks_name_the_frequencies_that_would_match(found):
    (text,) = [remark for remark in found.remarks if remark.startswith("matched by another")]
    assert "w^2 L/g at 0.04243 Hz" in text  # 0.3 Hz / sqrt(50)
    assert "w L/cl at 0.006 Hz" in text  # 0.3 Hz / 50


def test_driving_the_prototype_at_froudes_frequency_matches_froude(rig, prototype):
    found = similarity(rig, prototype, 0.3, 0.1, "hold", prototype_frequency=0.3 / math.sqrt(50))
    levels = {group.name: group.level for group in found.groups}
    assert levels["w^2 L/g"] == "matched"
    assert levels["w L/cl"] == "violated"
    assert any("frequency of 0.04243 Hz is outside its sea" in remark for remark in found.remarks)


def test_the_articles_amplitudes_distort_the_amplitude(rig, prototype):
    found = similarity(rig, prototype, 0.3, 0.2, "hold", prototype_amplitude=5.0)
    group = next(group for group in found.groups if group.name == "Ae/L")
    assert (group.ratio, group.level) == (pytest.approx(2.0), "mild")
    assert not any("so Ae/L matches" in remark for remark in found.remarks)


def test_a_rig_against_itself_matches_everywhere_without_conflict(rig, prototype):
    twin = replace(prototype, cable=rig.cable, platform=rig.platform, air=rig.air, gravity=rig.gravity)
    found = similarity(rig, twin, 0.3, 0.1, "hold")
    assert {group.level for group in found.groups} == {"matched"}
    assert list(found.ratios.values()) == pytest.approx([1.0] * len(found.ratios))
    assert found.conflicts == ()


def test_a_free_platform_has_no_hold_groups(rig, prototype):
    found = similarity(rig, prototype, 0.3, 0.1, "free")
    assert not {"k L/T", "c/(EA rl)^(1/2)"} & {group.name for group in found.groups}
    assert any(remark.startswith("left out") and "k L/T" in remark for remark in found.remarks)


def test_a_hold_that_only_the_rig_has_is_violated_without_a_ratio_or_left_out(rig, prototype):
    loose = replace(
        prototype, platform=replace(prototype.platform, modes={"hold": prototype.platform.modes["free"]})
    )
    group = next(group for group in similarity(rig, loose, 0.3, 0.1, "hold").groups if group.name == "k L/T")
    assert (group.ratio, group.level) == (None, "violated")
    without = replace(prototype, platform=replace(prototype.platform, modes={}))
    assert "k L/T" not in {group.name for group in similarity(rig, without, 0.3, 0.1, "hold").groups}


def test_a_run_without_drive_keeps_the_static_groups(rig, prototype):
    found = similarity(rig, prototype, None, None, "free")
    assert {group.name for group in found.groups} == {"T/EA", "rl g L/T", "M/(rl L)"}
    assert "time" not in found.ratios
    assert found.ratios["force"] == pytest.approx(24.2)


def test_an_unknown_mode_is_refused(rig, prototype):
    with pytest.raises(DataError, match="no platform mode 'hover'"):
        similarity(rig, prototype, 0.3, 0.1, "hover")


def test_different_length_states_are_remarked(rig, prototype):
    other = replace(prototype, cable=replace(prototype.cable, length_state="equilibrium"))
    assert any(
        "the prototype's equilibrium" in remark for remark in similarity(rig, other, 0.3, 0.1, "hold").remarks
    )


@pytest.mark.parametrize(
    ("ratio", "expected"),
    [
        (1.0, "matched"),
        (1.049, "matched"),
        (1 / 1.049, "matched"),
        (1.06, "mild"),
        (1 / 1.9, "mild"),
        (2.1, "violated"),
        (0.4, "violated"),
        (0.0, "violated"),
        (math.inf, "violated"),
        (math.nan, "violated"),
    ],
)
def test_levels(ratio, expected):
    assert level(ratio) == expected
