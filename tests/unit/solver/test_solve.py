"""Choice of the model, error estimate and status of a solve."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tethertest.errors import DataError
from tethertest.records.cable import Air, Cable
from tethertest.records.response import Status
from tethertest.records.scene import Bottom, Geometry, MeasuredMotion, Output, Scene, Top
from tethertest.solver import modes, rest_state, solve
from tethertest.solver.motion import crank_slider, displacement

SCENE = Scene(
    name="rig",
    cable=Cable(3.0, "unstretched", 0.0484, axial_stiffness=10020.0, diameter=0.006, axial_damping_time=5e-4),
    geometry=Geometry("vertical"),
    bottom=Bottom("crank-slider", radius=0.05, rod_ratio=0.25, frequency=0.3, start="ramp", ramp=5.0),
    top=Top("platform", mass=0.4, static_tension=5.0, hover_stiffness=50.0, hover_damping=5.0),
    output=Output(20.0, 200.0, (0.0, 0.5, 1.0)),
    air=Air(1.2, 1.2, 0.01),
)


def test_a_taut_scene_is_solved_by_the_linear_model() -> None:
    response = solve(SCENE)
    assert response.fidelity == "linear"
    assert response.status is Status.OK
    assert response.error.numerical < 0.01
    assert response.slack == {0.0: (), 0.5: (), 1.0: ()}


def test_a_scene_that_goes_slack_moves_up_and_shows_it_at_the_bottom() -> None:
    hard = replace(SCENE, bottom=replace(SCENE.bottom, radius=0.15))
    response = solve(hard, finest=40)
    assert response.fidelity == "nonlinear"
    assert response.slack[0.0]
    assert np.min(response.tension) == 0.0
    slack_time = {gauge: sum(b - a for a, b in spans) for gauge, spans in response.slack.items()}
    assert slack_time[0.0] > slack_time[1.0]


def test_the_linear_model_says_when_it_is_not_enough() -> None:
    hard = replace(SCENE, bottom=replace(SCENE.bottom, radius=0.15))
    assert solve(hard, fidelity="linear", finest=20).status is Status.SLACK_IN_LINEAR


def test_slack_without_air_is_warned_about() -> None:
    hard = replace(SCENE, air=None, bottom=replace(SCENE.bottom, radius=0.15))
    assert any("no air drag" in warning for warning in solve(hard, finest=20).warnings)


def test_unknown_damping_gives_a_spread() -> None:
    unknown = replace(SCENE.cable, axial_damping_time=None)
    hard = replace(SCENE, cable=unknown, bottom=replace(SCENE.bottom, radius=0.15))
    spread = solve(hard, finest=20).error.spread
    assert spread is not None
    assert 0.0 < spread < 1.0


def test_measured_motion_replays_the_same_as_the_formula() -> None:
    time = np.arange(0.0, 20.0, 0.005)
    motion = MeasuredMotion(time, displacement(SCENE.bottom, time))
    measured = replace(SCENE, bottom=Bottom("measured", direction="vertical"))
    ours = solve(measured, measured=motion, cells=20).tension
    formula = solve(SCENE, cells=20).tension
    np.testing.assert_allclose(ours[:-2], formula[:-2], atol=5e-3)


def test_field_extremes_hold_the_gauges() -> None:
    response = solve(SCENE)
    assert np.max(response.field.maximum[:, -1]) >= np.max(response.tension[:, -1]) - 1e-12
    assert np.min(response.field.minimum[:, 0]) <= np.min(response.tension[:, 0]) + 1e-12


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"geometry": Geometry("hovering"), "top": Top("fixed")}, "has a fixed top"),
        ({"geometry": Geometry("hovering"), "top": replace(SCENE.top, lift=9.0)}, "both lift and static"),
        ({"top": Top("platform", mass=0.4, static_tension=1.0)}, "leaves -0.42"),
        ({"top": Top("fixed")}, "no tension at rest"),
        ({"geometry": Geometry("vertical", tension=9.0)}, "says 9 N at the bottom"),
        ({"bottom": Bottom("harmonic", amplitude=0.1)}, "needs frequency"),
    ],
)
def test_a_scene_that_cannot_be_solved_is_an_error_with_its_remedy(
    change: dict[str, object], message: str
) -> None:
    with pytest.raises(DataError, match=message) as caught:
        solve(replace(SCENE, **change))
    assert caught.value.remedy


def test_equilibrium_length_keeps_the_mass() -> None:
    scene = replace(
        SCENE,
        cable=replace(SCENE.cable, length_state="equilibrium", axial_stiffness=100.0),
        top=Top("fixed"),
        geometry=Geometry("vertical", tension=50.0),
    )
    rest = rest_state(scene)
    mean = rest.bottom_tension + 0.5 * rest.weight
    assert rest.length * rest.mass_per_length == pytest.approx(3.0 * 0.0484)
    assert rest.length * (1.0 + mean / 100.0) == pytest.approx(3.0)


def test_natural_frequencies_of_the_rig() -> None:
    """Lateral 1.44 and 1.90 Hz held at 50 N/m, pendulum 0.281 Hz free; axial from x tan x = m / M."""
    held = {mode.name: mode.frequency for mode in modes(SCENE).frequencies}
    assert held["lateral 1"] == pytest.approx(1.44, abs=0.005)
    assert held["lateral 2"] == pytest.approx(1.90, abs=0.005)
    free = replace(SCENE, top=Top("platform", mass=0.4, static_tension=5.0))
    loose = {mode.name: mode.frequency for mode in modes(free).frequencies}
    assert loose["pendulum"] == pytest.approx(0.281, abs=0.002)
    x, ratio = 0.5, 3 * 0.0484 / 0.4
    for _ in range(60):
        x = np.arctan(ratio / x) if x > 0 else x
    wave_speed = np.sqrt(10020.0 / 0.0484)
    assert loose["axial 1"] == pytest.approx(x * wave_speed / 3.0 / (2 * np.pi), rel=1e-3)


def test_crank_slider_orders() -> None:
    """A2/A1 = q/4 + q^3/16 + 15 q^5/512 and no third order, for an in-line crank."""
    q = 0.25
    spectrum = np.abs(np.fft.rfft(crank_slider(1.0, q, 2 * np.pi * np.arange(512) / 512)))
    assert spectrum[2] / spectrum[1] == pytest.approx(0.063506, abs=1e-6)
    assert spectrum[3] / spectrum[1] < 1e-12
    assert crank_slider(1.0, q, np.array([0.0]))[0] == pytest.approx(0.0, abs=1e-15)
    assert crank_slider(1.0, q, np.array([0.1]))[0] > 0.0  # first motion is upwards
