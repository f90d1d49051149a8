"""Spectral elements on curved taut scenes: at rest, refined, turned, and with the leapfrog march."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from tethertest.bench.spectral_elements.march import run_spectral
from tethertest.bench.spectral_elements.rest import spectral_rest
from tethertest.errors import DataError
from tethertest.records.arrays import FloatArray
from tethertest.records.cable import Air, Cable
from tethertest.records.scene import Bottom, Geometry, Output, Scene, Top
from tethertest.solver.nonlinear.chain_march import run_chain
from tethertest.solver.solution import Solution
from tethertest.solver.statics.catenary_shape import catenary_between, catenary_of_rest_length

WAVE_SPEED = math.sqrt(120.17 / 0.03352)
#: rows at the leapfrog's steps on 50 cells, which are steps of every finer mesh at Courant number 1
RATE = 50 * WAVE_SPEED / 149.164

INCLINED = Scene(
    name="inclined rig",
    cable=Cable(3.0, "unstretched", 0.0484, axial_stiffness=10020.0, diameter=0.006),
    geometry=Geometry("ends", top=(1.8, 2.3)),
    bottom=Bottom(
        "crank-slider",
        direction="vertical",
        radius=0.02,
        rod_ratio=0.25,
        frequency=0.6,
        start="ramp",
        ramp=1.0,
    ),
    top=Top("platform", mass=0.4, hover_stiffness=50.0, hover_damping=5.0),
    output=Output(3.0, 50.0, (0.0, 0.3, 1.0)),
    air=Air(1.225, 1.2, 0.01, wind=(6.0, 0.0)),
)


@cache
def condition(frequency: float, elements: int) -> Solution:
    return run_spectral(condition_scene(frequency), elements)


def condition_scene(frequency: float) -> Scene:
    return Scene(
        name="condition 1.1",
        cable=Cable(250.0, "equilibrium", 0.02, youngs_modulus=1.7e7, diameter=0.003),
        geometry=Geometry("shallow", tension=80.0),
        bottom=Bottom("harmonic", amplitude=2.0, frequency=frequency, start="ramp", ramp=10.0),
        top=Top("fixed"),
        output=Output(67.5, RATE, (0.0, 0.3, 1.0)),
        gravity=9.81,
    )


def distance(tension: FloatArray, reference: FloatArray) -> float:
    """RMS over the RMS of the dynamic part, the worst gauge."""
    rows = min(tension.shape[0], reference.shape[0])
    dynamic = np.sqrt(np.mean((reference - reference[0]) ** 2, axis=0))
    return float(np.max(np.sqrt(np.mean((tension[:rows] - reference[:rows]) ** 2, axis=0)) / dynamic))


@pytest.mark.parametrize(
    ("frequency", "extremes"),
    [
        (0.10, [81.653, 85.932, 80.223, 86.641]),
        (0.18, [55.350, 123.266, 52.544, 123.685]),
        (0.25, [74.108, 96.367, 73.725, 94.698]),
    ],
)
def test_published_extremes_and_two_resolutions(frequency: float, extremes: list[float]) -> None:
    """The published figures belong to a length and mass rounded to 4 digits, hence 0.02 N."""
    coarse, fine = condition(frequency, 6), condition(frequency, 9)
    low, high = fine.field.minimum.min(axis=0), fine.field.maximum.max(axis=0)
    assert [low[0], high[0], low[-1], high[-1]] == pytest.approx(extremes, abs=0.02)
    assert distance(coarse.tension, fine.tension) < 5e-6


def test_order_under_refinement() -> None:
    reference = condition(0.18, 9).tension
    errors = [distance(condition(0.18, elements).tension, reference) for elements in (2, 4)]
    assert errors[1] < 1e-5
    assert math.log2(errors[0] / errors[1]) > 4.0


def test_leapfrog_march_converges_to_it_at_second_order() -> None:
    scene, reference = condition_scene(0.18), condition(0.18, 6).tension
    errors = [
        distance(run_chain(scene, cells, viscous=False, courant=1.0).tension, reference)
        for cells in (100, 200, 400)
    ]
    assert errors[-1] < 2e-4
    assert np.log2(np.array(errors[:-1]) / errors[1:]) == pytest.approx(2.0, abs=0.05)


@pytest.mark.parametrize("damping_time", [None, 1e-3])
def test_leapfrog_march_in_wind_converges_to_it_at_second_order(damping_time: float | None) -> None:
    scene = replace(INCLINED, cable=replace(INCLINED.cable, axial_damping_time=damping_time))
    reference = run_spectral(scene, 2)
    assert distance(run_spectral(scene, 1).tension, reference.tension) < 1e-3
    errors = [distance(run_chain(scene, cells).tension, reference.tension) for cells in (20, 40, 80)]
    assert np.log2(np.array(errors[:-1]) / errors[1:]) == pytest.approx(2.0, abs=0.2)
    march = run_chain(scene, 80)
    np.testing.assert_allclose(march.strain, reference.strain, atol=5e-7)
    np.testing.assert_allclose(march.platform_position, reference.platform_position, atol=1e-4)


def test_a_scene_turned_about_the_vertical_has_the_same_tension() -> None:
    angle = 0.7
    turned = replace(
        INCLINED,
        geometry=Geometry("ends", top=(1.8 * math.cos(angle), 1.8 * math.sin(angle), 2.3)),
        air=replace(INCLINED.air, wind=(6.0 * math.cos(angle), 6.0 * math.sin(angle), 0.0)),
    )
    plane, space = run_spectral(INCLINED, 1), run_spectral(turned, 1)
    assert np.ptp(plane.tension[:, 0]) > 0.1
    np.testing.assert_allclose(space.tension, plane.tension, atol=1e-7)
    np.testing.assert_allclose(space.platform_position, plane.platform_position, atol=1e-9)


def test_side_wind_in_space_meets_the_leapfrog_march() -> None:
    scene = replace(INCLINED, air=Air(1.225, 1.2, 0.01, wind=(3.0, 5.0, 0.0)))
    reference = run_spectral(scene, 2).tension
    errors = [distance(run_chain(scene, cells).tension, reference) for cells in (40, 80)]
    assert errors[0] / errors[1] == pytest.approx(4.0, abs=0.5)
    assert distance(run_spectral(replace(scene, air=INCLINED.air), 2).tension, reference) > 10 * errors[1]


@pytest.mark.parametrize("wind", [0.0, (6.0, 0.0), (3.0, 5.0, 0.5)])
@pytest.mark.parametrize("state", ["unstretched", "equilibrium"])
def test_a_cable_without_motion_stays_at_rest(wind: float | tuple[float, ...], state: str) -> None:
    scene = replace(
        INCLINED,
        cable=replace(INCLINED.cable, length_state=state, axial_damping_time=1e-4),  # type: ignore[arg-type]
        bottom=Bottom("fixed"),
        air=replace(INCLINED.air, wind=wind),
        output=Output(1.0, 50.0, (0.0, 0.3, 1.0)),
    )
    solution = run_spectral(scene, 2)
    assert solution.steps_done == solution.steps
    assert np.max(np.ptp(solution.tension, axis=0)) < 1e-8
    assert np.max(np.abs(solution.strain)) < 1e-12
    if state == "equilibrium":
        rest = spectral_rest(scene, 2)
        assert rest.mesh.stretched_length(rest.position) == pytest.approx(3.0, abs=1e-9)


def test_rest_without_wind_is_the_elastic_catenary() -> None:
    chord, load = np.array([1.8, 2.3]), np.array([0.0, -0.0484 * INCLINED.gravity])
    still = replace(INCLINED, air=None, bottom=Bottom("fixed"))
    shape = catenary_between(chord, 3.0, 10020.0, load)
    found = run_spectral(still, 3).tension[0]
    np.testing.assert_allclose(found, shape.tension(np.array([0.0, 0.9, 3.0])), rtol=1e-6)
    cut = catenary_of_rest_length(chord, 3.0, 10020.0, 3.0 * load)
    scene = replace(still, cable=replace(INCLINED.cable, length_state="equilibrium"))
    rest = spectral_rest(scene, 3)
    assert rest.mesh.length == pytest.approx(cut.length, rel=1e-9)
    np.testing.assert_allclose(rest.start_force[[0, 2]], cut.start_force, rtol=1e-6)


def test_what_it_does_not_know_is_an_error_with_a_remedy() -> None:
    for scene, elements in (
        (replace(INCLINED, bottom=Bottom("step", velocity=1.0)), 1),
        (replace(INCLINED, geometry=Geometry("hovering")), 1),
        (replace(INCLINED, geometry=Geometry("ends")), 1),
        (replace(INCLINED, top=replace(INCLINED.top, drag_area=(0.1, 0.1))), 1),
        (replace(INCLINED, air=Air(1.225, wind_file="gusts.csv")), 1),
        (replace(INCLINED, cable=replace(INCLINED.cable, bending_stiffness=0.02)), 1),
        (INCLINED, 0),
    ):
        with pytest.raises(DataError) as caught:
            run_spectral(scene, elements)
        assert caught.value.remedy
