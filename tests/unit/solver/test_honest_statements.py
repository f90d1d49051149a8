"""Scenes whose answers once said more, or less, than was true."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tethertest.errors import DataError
from tethertest.records.cable import Air, Cable
from tethertest.records.response import Status
from tethertest.records.scene import Bottom, Geometry, MeasuredMotion, Output, Scene, Top, WindSeries
from tethertest.solver import relative_difference, solve
from tethertest.solver.motion import displacement

HEAVE = Bottom("harmonic", "vertical", amplitude=0.02, frequency=0.5, start="ramp", ramp=2.0)
SCENE = Scene(
    name="20 m",
    cable=Cable(20.0, "unstretched", 0.05, axial_stiffness=10e3, diameter=6e-3),
    geometry=Geometry("vertical", tension=50.0),
    bottom=HEAVE,
    top=Top("fixed"),
    output=Output(6.0, 100.0, (0.0, 0.5, 1.0)),
)
INCLINED = replace(SCENE, geometry=Geometry("ends", top=(15.0, 13.0)))
AIR = Air(1.225, 1.2, 0.01)
TIME = np.arange(0.0, 6.005, 0.01)


@pytest.mark.parametrize(("rate", "frequency"), [(5.0, 0.5), (20.0, 0.5), (10.0, 2.0), (100.0, 2.0)])
def test_a_sudden_start_of_a_hovering_platform_is_within_its_statement(rate: float, frequency: float) -> None:
    """The same rig stated as vertical is solved by exact waves."""
    jump = Bottom("harmonic", "vertical", amplitude=0.005, frequency=frequency)
    top = Top("platform", mass=2.0, static_tension=60.0)
    hover = replace(SCENE, geometry=Geometry("hovering"), bottom=jump, top=top)
    hover = replace(hover, output=Output(4.0, rate, (0.0, 0.5, 1.0)))
    march = solve(hover, finest=320)
    waves = solve(replace(hover, geometry=Geometry("vertical")), tolerance=1e-6)
    assert waves.scheme.startswith("exact waves")
    assert relative_difference(march.tension, waves.tension) < march.error.numerical


@pytest.mark.parametrize("rows", [601, 600])
def test_a_measured_motion_does_not_stop_dead_at_its_last_row(rows: int) -> None:
    measured = MeasuredMotion(TIME[:rows], displacement(HEAVE, TIME[:rows]))
    for scene in (INCLINED, SCENE):
        replayed = solve(replace(scene, bottom=Bottom("measured", "vertical")), measured=measured)
        assert replayed.status is Status.OK
        assert relative_difference(replayed.tension, solve(scene).tension) < 5e-4


def test_one_mesh_alone_is_not_called_solved_within_its_error() -> None:
    for options in ({"cells": 2}, {"cells": 40, "native_times": True}, {"cells": 40, "fidelity": "linear"}):
        answer = solve(SCENE, **options)  # type: ignore[arg-type]
        assert answer.status is Status.UNJUDGED
        assert np.isnan(answer.error.numerical)


def test_native_times_of_one_mesh_are_native() -> None:
    answer = solve(SCENE, cells=40, native_times=True)
    assert answer.time[1] == pytest.approx(answer.time_step)


@pytest.mark.parametrize("scheme", ["as-printed", "two-grid"])
def test_a_linear_scheme_at_its_own_times_knows_its_model_error(scheme: Any) -> None:
    level = replace(
        SCENE, geometry=Geometry("shallow", tension=50.0), bottom=replace(HEAVE, direction="tangent")
    )
    answer = solve(level, scheme=scheme, native_times=True)
    assert answer.status is Status.MODEL_ERROR
    assert answer.error.model is not None
    assert answer.error.model > 0.1


def test_a_hanging_cable_is_not_refused_for_a_fold_that_two_cells_cannot_follow() -> None:
    answer = solve(replace(SCENE, geometry=Geometry("ends", top=(5.0, 12.0))))
    assert answer.status is Status.OK
    assert answer.tension[0, [0, 2]] == pytest.approx([1.9904, 7.8715], abs=2e-3)


def test_nothing_that_moves_is_solved_in_wind() -> None:
    still = replace(INCLINED, bottom=Bottom("fixed"), air=replace(AIR, wind=8.0, tangential_drag=0.0))
    answer = solve(still)
    assert answer.status is Status.OK
    assert np.max(np.abs(answer.tension - answer.tension[0])) < 1e-5


def test_the_quasi_static_rest_in_wind_is_part_of_its_model_error() -> None:
    still = replace(INCLINED, bottom=Bottom("fixed"), air=replace(AIR, wind=8.0))
    assert solve(still, fidelity="catenary").status is Status.MODEL_ERROR


def test_a_round_body_is_pushed_the_way_the_wind_blows() -> None:
    places = []
    for angle in (0.0, np.pi / 8, np.pi / 4):
        wind = (8.0 * np.cos(angle), 8.0 * np.sin(angle), 0.0)
        top = Top("platform", mass=2.0, static_tension=60.0, drag_area=(0.1, 0.1))
        output = Output(1.0, 10.0, (1.0,), ("position",))
        scene = replace(SCENE, geometry=Geometry("hovering"), top=top, bottom=Bottom("fixed"), output=output)
        place = solve(replace(scene, air=replace(AIR, wind=wind)), cells=20).fields["position"][-1, 0]
        places.append(np.hypot(place[0], place[1]))
        assert np.arctan2(place[1], place[0]) == pytest.approx(angle, abs=1e-6)
    assert places == pytest.approx([places[0]] * 3)


def test_high_frequencies_get_three_meshes() -> None:
    fast = Bottom("harmonic", "vertical", amplitude=1e-5, frequency=200.0, start="ramp", ramp=0.2)
    answer = solve(replace(INCLINED, bottom=fast, output=Output(0.4, 1000.0, (0.0, 1.0))))
    assert answer.status is not Status.STEP_LIMIT


GUST = WindSeries(np.array([0.0, 2.0, 2.5, 6.0]), np.zeros((4, 3)))


@pytest.mark.parametrize(
    ("change", "options", "words"),
    [
        ({"air": AIR}, {"wind": GUST, "fidelity": "catenary"}, "no gusts"),
        ({}, {"wind": GUST}, "no air"),
        ({"air": AIR}, {"wind": WindSeries(GUST.time[:3], GUST.velocity[:3])}, "at least 4"),
        ({"output": Output(20.0, 10.0, (1.0,)), "air": AIR}, {"wind": GUST}, "covers 0 to 6 s"),
        ({}, {"fidelity": "catenary", "cells": 4}, "no mesh"),
        ({}, {"fidelity": "nonlinear", "scheme": "as-printed"}, "belongs to the linear"),
        ({}, {"fidelity": "foo"}, "foo"),
        ({"output": Output(6.0, 100.0, (2.0,))}, {}, "at most 1"),
        ({"output": Output(6.0, 100.0, ())}, {}, "gauges is empty"),
        ({"output": Output(-1.0, 100.0, (1.0,))}, {}, "output.duration"),
        ({"gravity": -9.8}, {}, "gravity"),
        ({"cable": replace(SCENE.cable, length=float("nan"))}, {}, "finite"),
        ({"bottom": replace(HEAVE, direction=(1.0,))}, {}, "2 or 3 components"),
        ({"bottom": Bottom("measured")}, {"measured": MeasuredMotion(TIME[::-1], TIME)}, "backwards"),
        ({"bottom": Bottom("measured")}, {"measured": MeasuredMotion(TIME[:300], TIME[:300])}, "covers"),
    ],
)
def test_what_was_built_in_python_is_held_to_the_same_bounds(
    change: dict[str, Any], options: dict[str, Any], words: str
) -> None:
    with pytest.raises(DataError, match=words) as caught:
        solve(replace(SCENE, **change), **options)
    assert caught.value.remedy


def test_the_field_reaches_as_far_as_the_extrapolated_gauges() -> None:
    answer = solve(INCLINED)
    assert "extrapolated" in answer.scheme
    for g, station in ((0, 0), (2, -1)):
        assert np.max(answer.field.maximum[:, station]) >= np.max(answer.tension[:, g])
        assert np.min(answer.field.minimum[:, station]) <= np.min(answer.tension[:, g])


def test_a_sudden_start_at_native_times_is_native() -> None:
    sudden = replace(INCLINED, bottom=Bottom("harmonic", "vertical", amplitude=0.005, frequency=0.5))
    answer = solve(sudden, native_times=True, finest=80)
    assert answer.time[1] == pytest.approx(answer.time_step)


def test_a_march_without_end_is_refused_with_its_steps() -> None:
    short = replace(SCENE.cable, length=0.001, axial_damping_time=1e-4)
    long = replace(INCLINED, cable=short, geometry=Geometry("ends", top=(7e-4, 6e-4)))
    long = replace(long, output=Output(36000.0, 10.0, (0.0, 1.0)), bottom=replace(HEAVE, amplitude=1e-6))
    with pytest.raises(DataError, match="even 10 cells need") as caught:
        solve(long, fidelity="nonlinear")
    assert "duration" in caught.value.remedy


def test_an_upright_march_without_end_is_neither_begun_nor_called_judged() -> None:
    short = replace(SCENE.cable, length=0.001, axial_damping_time=1e-4)
    endless = replace(SCENE, cable=short, air=AIR, output=Output(36000.0, 2.0, (0.0, 1.0)))
    endless = replace(endless, bottom=replace(HEAVE, amplitude=1e-7))
    linear = solve(endless, fidelity="linear")
    assert linear.status is Status.UNJUDGED
    assert linear.error.model is None
    assert any("takes too long" in warning for warning in linear.warnings)
    with pytest.raises(DataError, match="even 10 cells need"):
        solve(endless, fidelity="nonlinear")


def test_a_curved_linear_cable_warns_of_the_drag_that_it_leaves_out() -> None:
    level = replace(SCENE, geometry=Geometry("shallow", tension=50.0), air=AIR)
    answer = solve(replace(level, bottom=replace(HEAVE, direction="tangent")), fidelity="linear")
    assert "the linear model leaves out air drag" in answer.warnings
