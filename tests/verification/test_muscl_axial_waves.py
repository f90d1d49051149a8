"""Axial finite volumes at rest, against the closed-form steady response and against the leapfrog march."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from tethertest.bench.finite_volumes import kernel as muscl
from tethertest.bench.finite_volumes.march import run_axial_muscl
from tethertest.errors import DataError
from tethertest.records.arrays import FloatArray
from tethertest.records.cable import Air, Cable
from tethertest.records.scene import Bottom, Geometry, MeasuredMotion, Output, Scene, Top
from tethertest.solver.linear.transfer import tension_transfer
from tethertest.solver.motion import displacement
from tethertest.solver.nonlinear.chain_march import run_chain
from tethertest.solver.statics.rest import rest_state

RIG = Scene(
    name="3 m rig",
    cable=Cable(3.0, "unstretched", 0.0484, axial_stiffness=10020.0, axial_damping_time=5e-4),
    geometry=Geometry("vertical"),
    bottom=Bottom("harmonic", amplitude=1e-4, frequency=5.0, start="ramp", ramp=2.0),
    top=Top("platform", mass=0.4, static_tension=5.0, hover_stiffness=50.0, hover_damping=5.0),
    output=Output(12.0, 1000.0, (0.0, 0.5, 1.0)),
)
FIXED = replace(RIG, geometry=Geometry("vertical", tension=50.0), top=Top("fixed"))


def complex_amplitude(time: FloatArray, values: FloatArray, frequency: float) -> complex:
    angle = 2 * np.pi * frequency * time
    design = np.column_stack([np.ones(time.size), np.cos(angle), np.sin(angle)])
    _, cosine, sine = np.linalg.lstsq(design, values, rcond=None)[0]
    return complex(cosine, -sine)


@pytest.mark.parametrize("scene", [RIG, FIXED, replace(FIXED, geometry=Geometry("straight", tension=9.0))])
def test_a_cable_without_motion_stays_at_its_rest_tension(scene: Scene) -> None:
    rest = rest_state(scene)
    output = replace(scene.output, duration=3.0)
    solution = run_axial_muscl(replace(scene, bottom=Bottom("fixed"), output=output), 12)
    expected = [rest.bottom_tension, rest.tension(0.5), rest.top_tension]
    np.testing.assert_allclose(solution.tension, np.broadcast_to(expected, solution.tension.shape), atol=1e-9)
    np.testing.assert_allclose(solution.strain, 0.0, atol=1e-12)
    np.testing.assert_allclose(solution.platform_position, 0.0, atol=1e-12)
    assert solution.steps_done == solution.steps


@pytest.mark.parametrize("damping_time", [0.0, 5e-4])
def test_platform_response_meets_the_closed_form(damping_time: float) -> None:
    scene = replace(RIG, cable=replace(RIG.cable, axial_damping_time=damping_time))
    gauges = np.array(scene.output.gauges)
    exact = tension_transfer(scene, np.array([5.0]), gauges)[0] * 1e-4 * -1j  # the drive is a sine
    errors = []
    for cells in (10, 20, 40):
        solution = run_axial_muscl(scene, cells)
        late = solution.time > 8.0
        found = [complex_amplitude(solution.time[late], solution.tension[late, g], 5.0) for g in range(3)]
        errors.append(np.max(np.abs(np.array(found) - exact) / np.abs(exact)))
    assert errors[-1] < 5e-5
    order = math.log2(errors[0] / errors[-1]) / 2
    assert order == pytest.approx(2.0, abs=0.15) if damping_time == 0.0 else order > 0.9


def test_fixed_end_meets_dalemberts_series_at_second_order() -> None:
    """T(L, t) = T0 - 2 Z sum_n v0(t - (2n + 1) L/c) for a smooth start from rest."""
    wave_speed, impedance = math.sqrt(10020.0 / 0.0484), math.sqrt(10020.0 * 0.0484)
    scene = replace(
        FIXED,
        cable=replace(FIXED.cable, axial_damping_time=None),
        bottom=Bottom("harmonic", amplitude=0.01, frequency=20.0, start="ramp", ramp=0.2),
        output=Output(0.3, 4000.0, (1.0,)),
    )
    scene = replace(scene, geometry=Geometry("vertical", tension=200.0))
    errors = []
    for cells in (20, 40, 80):
        solution = run_axial_muscl(scene, cells)
        exact = np.full(solution.time.size, rest_state(scene).top_tension)
        for n in range(25):
            when = solution.time - (2 * n + 1) * 3.0 / wave_speed
            late, early = (displacement(scene.bottom, when + shift) for shift in (1e-6, -1e-6))
            exact -= 2.0 * impedance * (late - early) / 2e-6
        errors.append(float(np.sqrt(np.mean((solution.tension[:, 0] - exact) ** 2)) / np.std(exact)))
    assert errors[-1] < 5e-6
    assert math.log2(errors[0] / errors[-1]) / 2 == pytest.approx(2.0, abs=0.15)


def test_snapping_rig_with_damping_and_drag_meets_the_leapfrog_march() -> None:
    scene = replace(
        RIG,
        cable=replace(RIG.cable, axial_damping_time=1e-3, diameter=0.006),
        bottom=Bottom("harmonic", amplitude=0.2, frequency=0.3, start="ramp", ramp=4.0),
        output=Output(8.0, 500.0, (0.1, 0.5, 1.0)),
        air=Air(1.225, 1.2, 0.01),
    )
    march, volumes = run_chain(scene, 40), run_axial_muscl(scene, 40)
    assert np.min(volumes.tension) == 0.0
    spread = np.max(np.std(march.tension, axis=0))
    assert np.sqrt(np.mean((march.tension - volumes.tension) ** 2)) < 0.025 * spread
    assert np.max(volumes.tension) == pytest.approx(np.max(march.tension), rel=0.01)
    np.testing.assert_allclose(volumes.platform_position, march.platform_position, atol=1e-3)


def test_tangential_drag_meets_the_leapfrog_march() -> None:
    scene = replace(
        FIXED,
        cable=replace(FIXED.cable, diameter=0.006),
        bottom=Bottom("harmonic", amplitude=0.01, frequency=4.0, start="ramp", ramp=1.0),
        output=Output(2.0, 500.0, (0.3, 0.7)),
        air=Air(1.225, 1.2, 3000.0),
    )
    march, volumes = run_chain(scene, 80), run_axial_muscl(scene, 40)
    without = run_axial_muscl(replace(scene, air=None), 40)
    effect = np.std(without.tension - volumes.tension)
    assert effect > 0.05
    assert np.std(march.tension - volumes.tension) < 0.02 * effect


def test_measured_motion_is_the_motion_it_was_sampled_from() -> None:
    time = np.linspace(-0.1, 2.1, 2201)
    bottom = Bottom("harmonic", amplitude=0.01, frequency=4.0, start="ramp", ramp=1.0)
    scene = replace(FIXED, bottom=bottom, output=Output(2.0, 500.0, (1.0,)))
    sampled = MeasuredMotion(time, displacement(bottom, time))
    replayed = run_axial_muscl(replace(scene, bottom=Bottom("measured")), 20, measured=sampled)
    np.testing.assert_allclose(replayed.tension, run_axial_muscl(scene, 20).tension, atol=2e-3)


def test_kernels_say_the_same_compiled_and_plain(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = replace(
        RIG,
        cable=replace(RIG.cable, axial_damping_time=1e-3, diameter=0.006),
        bottom=Bottom("step", velocity=1.0),
        output=Output(0.05, 500.0, (0.0, 0.3, 1.0)),
        air=Air(1.225, 1.2, 0.01),
    )
    compiled = run_axial_muscl(scene, 6)
    assert np.min(compiled.tension) == 0.0
    for name in ("riemann", "wall_strain", "limited_difference", "fill_rates", "damp", "fill_stations"):
        monkeypatch.setattr(muscl, name, getattr(muscl, name).py_func)
    monkeypatch.setattr("tethertest.bench.finite_volumes.march.march_muscl", muscl.march_muscl.py_func)
    plain = run_axial_muscl(scene, 6)
    np.testing.assert_allclose(plain.tension, compiled.tension, atol=1e-9)
    np.testing.assert_allclose(plain.strain, compiled.strain, atol=1e-12)
    np.testing.assert_allclose(plain.field.maximum, compiled.field.maximum, atol=1e-9)


def test_what_axial_waves_do_not_describe_is_an_error_with_a_remedy() -> None:
    for scene, cells in (
        (replace(RIG, geometry=Geometry("shallow", tension=9.0)), 10),
        (replace(RIG, bottom=replace(RIG.bottom, direction="horizontal")), 10),
        (replace(RIG, air=Air(1.225, wind=3.0)), 10),
        (replace(RIG, top=replace(RIG.top, mass=1e-6)), 10),
        (RIG, 1),
    ):
        with pytest.raises(DataError) as caught:
            run_axial_muscl(scene, cells)
        assert caught.value.remedy
