"""The model that a scene gets, and what its answer says of itself."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tethertest.errors import DataError
from tethertest.records.cable import Air, Cable
from tethertest.records.response import Status
from tethertest.records.scene import Bottom, Geometry, Output, Scene, Top, WindSeries
from tethertest.solver import relative_difference, solve

SWELL = Scene(
    name="a ship in long swell",
    cable=Cable(144.0, "unstretched", 0.048, axial_stiffness=410e3, diameter=0.006, axial_damping_time=1e-4),
    geometry=Geometry("ends", top=(110.0, 90.0)),
    bottom=Bottom("harmonic", "vertical", amplitude=0.5, frequency=0.01, start="ramp", ramp=60.0),
    top=Top("fixed"),
    output=Output(400.0, 5.0, (0.0, 0.5, 1.0)),
    air=Air(1.225, 1.2, 0.01),
)
TAUT = Scene(
    name="taut and upright",
    cable=Cable(150.0, "unstretched", 0.0333, axial_stiffness=120.17, diameter=0.003),
    geometry=Geometry("vertical", tension=80.0),
    bottom=Bottom("harmonic", amplitude=2.0, frequency=0.1, start="ramp", ramp=10.0),
    top=Top("fixed"),
    output=Output(30.0, 20.0, (0.0, 0.5, 1.0)),
)
SNAP = Scene(
    name="slack and upright",
    cable=Cable(150.0, "unstretched", 0.0484, axial_stiffness=10020.0, diameter=0.006),
    geometry=Geometry("vertical", tension=50.0),
    bottom=Bottom("harmonic", amplitude=2.0, frequency=0.2, start="ramp", ramp=5.0),
    top=Top("fixed"),
    output=Output(15.0, 200.0, (0.0, 1.0)),
)


def test_a_stiff_cable_in_long_swell_is_a_catenary_within_its_stated_error_of_the_march() -> None:
    quasi_static = solve(SWELL)
    assert quasi_static.fidelity == "catenary"
    assert quasi_static.status is Status.OK
    march = solve(SWELL, fidelity="nonlinear")
    assert march.fidelity == "nonlinear"
    stated = quasi_static.error.numerical + (quasi_static.error.model or 0.0)
    true = relative_difference(quasi_static.tension, march.tension)
    assert 1e-5 < true < stated < 0.01


def test_a_taut_upright_cable_is_linear_and_its_march_agrees() -> None:
    linear = solve(TAUT)
    assert linear.fidelity == "linear"
    march = solve(TAUT, fidelity="nonlinear", tolerance=1e-4)
    assert relative_difference(linear.tension, march.tension) < march.error.numerical + linear.error.numerical


def test_drag_along_the_cable_moves_a_strict_tolerance_up_to_the_march() -> None:
    blown = replace(TAUT, air=Air(1.225, 1.2, 0.02))
    loose, strict = solve(blown, tolerance=0.05), solve(blown, tolerance=1e-4)
    assert (loose.fidelity, strict.fidelity) == ("linear", "nonlinear")
    true = relative_difference(loose.tension, strict.tension)
    assert loose.error.model is not None
    assert 1e-4 < true < loose.error.model


def test_a_cable_that_goes_slack_moves_up_and_states_what_is_unknown() -> None:
    snap = solve(SNAP, finest=160)
    assert snap.fidelity == "nonlinear"
    assert "viscosity" in snap.scheme
    assert snap.slack[0.0]
    assert snap.error.spread is not None
    assert snap.error.model is not None
    low, high = snap.error.peak_range or (0.0, 0.0)
    assert low < 1.0 <= high
    assert any("slack without drag" in warning for warning in snap.warnings)
    assert any("bows sideways" in warning for warning in snap.warnings)


def test_known_damping_leaves_no_damping_band() -> None:
    known = replace(SNAP, cable=replace(SNAP.cable, axial_damping_time=1e-3))
    unknown, stated = solve(SNAP, finest=40).error, solve(known, finest=40).error
    assert (unknown.spread or 0.0) > 0.01
    assert stated.spread == 0.0


def test_the_members_are_left_out_where_nobody_asks() -> None:
    assert solve(SNAP, finest=40, spread=False).error.spread is None


def test_the_linear_model_says_that_a_cable_went_slack() -> None:
    assert solve(SNAP, fidelity="linear").status is Status.SLACK_IN_LINEAR


def test_gusts_need_the_march() -> None:
    time = np.linspace(0.0, 30.0, 61)
    gust = np.column_stack([2.0 * np.sin(time), np.zeros_like(time), np.zeros_like(time)])
    blown = replace(TAUT, air=Air(1.225, 1.2, 0.01))
    assert solve(blown, wind=WindSeries(time, gust)).fidelity == "nonlinear"
    with pytest.raises(DataError, match="no wind"):
        solve(blown, wind=WindSeries(time, gust), fidelity="linear")


def test_side_wind_and_sideways_motion_open_the_third_dimension() -> None:
    side = replace(SWELL, air=Air(1.225, 1.2, 0.01, (0.0, 6.0, 0.0)))
    side = replace(side, output=replace(side.output, duration=20.0, fields=("position",)))
    answer = solve(side, fidelity="nonlinear", cells=20)
    assert np.max(np.abs(answer.fields["position"][:, 1, 1])) > 0.1
    flat = replace(side, air=Air(1.225, 1.2, 0.01, (6.0, 0.0, 0.0)))
    assert np.all(solve(flat, fidelity="nonlinear", cells=20).fields["position"][:, 1, 1] == 0.0)


def test_native_times_are_the_levels_of_the_scheme_within_the_record() -> None:
    sudden = replace(TAUT, bottom=replace(TAUT.bottom, start="jump", ramp=None))
    answer = solve(sudden, native_times=True)
    np.testing.assert_allclose(np.diff(answer.time), answer.time_step, rtol=1e-9)
    assert answer.time[-1] <= 30.0 < answer.time[-1] + answer.time_step * (1.0 + 1e-9)


@pytest.mark.parametrize("tolerance", [0.0, -0.1, 1.5])
def test_a_tolerance_that_is_none_is_an_error(tolerance: float) -> None:
    with pytest.raises(DataError, match="tolerance") as caught:
        solve(TAUT, tolerance=tolerance)
    assert caught.value.remedy


def test_a_step_budget_that_does_not_suffice_is_said() -> None:
    ended = solve(SNAP, finest=10, spread=False)
    assert ended.status is not Status.OK
    assert ended.error.numerical > 0.01


def test_a_sudden_start_is_measured_from_rest_and_not_from_its_first_row() -> None:
    sudden = replace(TAUT, bottom=replace(TAUT.bottom, start="jump", ramp=None))
    answer = solve(sudden)
    rest = np.array([80.0, 80.0, 80.0]) + np.array([0.0, 0.5, 1.0]) * 0.0333 * 150.0 * 9.80665
    assert answer.tension[0, 0] < 79.0
    expected = np.max(np.abs(answer.tension - rest)) / rest[-1]
    assert answer.numbers["dynamic_over_static"] == pytest.approx(expected, rel=1e-6)
