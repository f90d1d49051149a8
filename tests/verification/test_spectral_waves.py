"""Spectral elements against exact waves and closed forms, and their kernels compiled and plain."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from tethertest.bench.finite_volumes.march import run_axial_muscl
from tethertest.bench.spectral_elements import kernel as spectral
from tethertest.bench.spectral_elements.kernel import SpectralCable, SpectralRecord, SpectralTop
from tethertest.bench.spectral_elements.march import run_spectral, step_count
from tethertest.bench.spectral_elements.mesh import SpectralMesh
from tethertest.records.arrays import FloatArray
from tethertest.records.cable import Air, Cable
from tethertest.records.scene import Bottom, Geometry, Output, Scene, Top
from tethertest.solver.linear.transfer import tension_transfer
from tethertest.solver.motion import displacement
from tethertest.solver.statics.rest import rest_state

RIG = Scene(
    name="3 m rig",
    cable=Cable(3.0, "unstretched", 0.0484, axial_stiffness=10020.0, axial_damping_time=5e-4),
    geometry=Geometry("vertical"),
    bottom=Bottom("harmonic", amplitude=1e-4, frequency=5.0, start="ramp", ramp=2.0),
    top=Top("platform", mass=0.4, static_tension=5.0, hover_stiffness=50.0, hover_damping=5.0),
    output=Output(12.0, 200.0, (0.0, 0.3, 0.5, 1.0)),
)
STRAIN = 0.3


def bare_cable(mesh: SpectralMesh, d: int, drag: tuple[float, float] = (0.0, 0.0)) -> SpectralCable:
    """Return a cable of EA = rl = 1 without gravity, in a wind of 5 m/s along the first axis."""
    wind = np.zeros(d)
    wind[0] = 5.0 if any(drag) else 0.0
    derivative, integral = map(np.ascontiguousarray, (mesh.derivative, mesh.integral))
    arrays = (derivative, mesh.points, integral, mesh.nodes)
    return SpectralCable(1.0, 1.0, 0.0, np.zeros(d), *drag, wind, *arrays)


def travelling(arc: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return a hump's unit tangent (2, m) and position (2, m): r = G(S - a t) with |G'| = 1 + e."""
    fine = np.linspace(-7.0, 7.0, 140001)
    angle = 0.8 * fine * np.exp(-(fine**2))
    tangent = np.array([np.cos(angle), np.sin(angle)])
    step = fine[1] - fine[0]
    area = np.cumsum(0.5 * step * (tangent[:, 1:] + tangent[:, :-1]), axis=1)
    area = np.concatenate([np.zeros((2, 1)), area], axis=1)
    unit, place = (np.array([np.interp(arc, fine, row) for row in array]) for array in (tangent, area))
    return unit, (1.0 + STRAIN) * place


def travelled_error(elements: int) -> float:
    """March a hump over 2 m of a 10 m cable and return its largest misplacement."""
    mesh = SpectralMesh(10.0, elements)
    cable = bare_cable(mesh, 2)
    speed = math.sqrt(STRAIN / (1.0 + STRAIN))
    steps = math.ceil(2.0 / speed * mesh.highest_wavenumber)
    step = 2.0 / speed / steps
    arc = mesh.arc - 4.0
    drift = speed * (1.0 + STRAIN) * np.array([[1.0], [0.0]])  # the straight ends then stand still
    tangent, position = travelling(arc)
    velocity = drift - speed * (1.0 + STRAIN) * tangent
    ends = np.repeat(position[:, :1], steps + 1, axis=1)
    still = np.zeros((2, 2 * steps + 1))
    nothing = np.zeros(2)
    top = SpectralTop(True, 0.0, nothing, nothing, nothing, nothing)
    record = SpectralRecord(
        steps,
        steps + 1,
        np.zeros(1, dtype=np.int64),
        np.full((1, 9), 1.0 / 9.0),
        np.zeros((2, 1)),
        np.zeros((2, 1)),
        np.zeros(2),
        np.full((1, arc.size), -np.inf),
        np.full((1, arc.size), np.inf),
    )
    done = spectral.march_spectral(
        position, velocity, ends, 0.0 * ends, still, cable, top, step, 0, True, record
    )
    assert done == steps
    assert record.field_maximum[0] == pytest.approx(STRAIN, abs=0.05)  # the tension is constant
    exact = travelling(arc - 2.0)[1] + drift * (2.0 / speed)
    return float(np.max(np.abs(position - exact)))


def test_a_shape_travels_unchanged_at_high_order() -> None:
    """r = G(S - a t) is an exact motion when EA e / (1 + e) = rl a^2."""
    errors = [travelled_error(elements) for elements in (6, 9, 12)]
    assert errors[-1] < 1e-5
    assert math.log(errors[0] / errors[-1]) / math.log(2.0) > 4.0


def complex_amplitude(time: FloatArray, values: FloatArray, frequency: float) -> complex:
    angle = 2 * np.pi * frequency * time
    design = np.column_stack([np.ones(time.size), np.cos(angle), np.sin(angle)])
    _, cosine, sine = np.linalg.lstsq(design, values, rcond=None)[0]
    return complex(cosine, -sine)


@pytest.mark.parametrize("damping_time", [0.0, 5e-4])
@pytest.mark.parametrize("kind", ["platform", "fixed"])
def test_vertical_rig_meets_the_closed_form_in_amplitude_and_phase(damping_time: float, kind: str) -> None:
    scene = replace(RIG, cable=replace(RIG.cable, axial_damping_time=damping_time))
    if kind == "fixed":
        scene = replace(scene, geometry=Geometry("vertical", tension=5.0), top=Top("fixed"))
    exact = tension_transfer(scene, np.array([5.0]), np.array(scene.output.gauges))[0] * 1e-4 * -1j
    solution = run_spectral(scene, 1)
    late = solution.time > 8.0
    found = [complex_amplitude(solution.time[late], solution.tension[late, g], 5.0) for g in range(4)]
    np.testing.assert_allclose(found, exact, rtol=3e-6)
    if kind == "platform":  # M x'' + c x' + k x = -T of the steady part
        lifted = complex_amplitude(solution.time[late], solution.platform_position[late], 5.0)
        omega = 2.0 * np.pi * 5.0
        assert lifted * (50.0 + 5j * omega - 0.4 * omega**2) == pytest.approx(-exact[-1], rel=3e-6)


def test_strain_of_a_damped_cable_is_the_elastic_one() -> None:
    solution = run_spectral(RIG, 1)
    late = solution.time > 8.0
    for g in range(4):
        pull, strain = (
            complex_amplitude(solution.time[late], array[late, g], 5.0)
            for array in (solution.tension, solution.strain)
        )
        assert strain * 10020.0 * (1.0 + 2j * np.pi * 5.0 * 5e-4) == pytest.approx(pull, rel=1e-6)


def test_straight_cable_meets_dalemberts_series_at_the_fixed_end() -> None:
    """T(L, t) = T0 - 2 Z sum_n v0(t - (2n + 1) L/c) for a smooth start from rest."""
    wave_speed, impedance = math.sqrt(10020.0 / 0.0484), math.sqrt(10020.0 * 0.0484)
    scene = replace(
        RIG,
        cable=replace(RIG.cable, axial_damping_time=None),
        geometry=Geometry("straight", tension=200.0),
        bottom=Bottom("harmonic", amplitude=0.01, frequency=20.0, start="ramp", ramp=0.2),
        top=Top("fixed"),
        output=Output(0.3, 4000.0, (1.0,)),
    )
    errors = []
    for elements in (1, 3):
        solution = run_spectral(scene, elements)
        exact = np.full(solution.time.size, 200.0)
        for n in range(25):
            when = solution.time - (2 * n + 1) * 3.0 / wave_speed
            late, early = (displacement(scene.bottom, when + shift) for shift in (1e-6, -1e-6))
            exact -= 2.0 * impedance * (late - early) / 2e-6
        errors.append(float(np.sqrt(np.mean((solution.tension[:, 0] - exact) ** 2)) / np.std(exact)))
    assert errors[1] < 2e-6
    assert errors[0] < 2e-4


def test_finite_volumes_of_a_taut_rig_converge_to_it_at_second_order() -> None:
    scene = replace(RIG, cable=replace(RIG.cable, axial_damping_time=None))
    scene = replace(
        scene, bottom=replace(scene.bottom, amplitude=1e-3), output=Output(3.0, 200.0, (0.0, 1.0))
    )
    reference = run_spectral(scene, 2).tension
    errors = [float(np.std(run_axial_muscl(scene, cells).tension - reference)) for cells in (10, 20, 40)]
    assert errors[-1] < 1e-4 * np.std(reference)
    assert np.log2(np.array(errors[:-1]) / errors[1:]) == pytest.approx(2.0, abs=0.15)


def test_a_cable_that_goes_slack_ends_early() -> None:
    scene = replace(RIG, bottom=replace(RIG.bottom, amplitude=0.05, frequency=2.0))
    solution = run_spectral(scene, 1)
    assert 0 < solution.steps_done < solution.steps == step_count(scene, 1)
    rest = rest_state(scene)
    assert np.min(solution.tension) < 0.2 * rest.bottom_tension
    assert solution.tension.shape[0] == solution.time.size < 12.0 * 200.0
    assert np.all(np.isfinite(solution.tension))


def test_drag_pushes_with_the_wind_and_splits_into_normal_and_tangential() -> None:
    """A cable along (0.6, 0.8): 5 m/s of wind is 3 m/s along and 4 m/s across."""
    mesh = SpectralMesh(2.0, 2)
    cable = bare_cable(mesh, 2, (0.25, 0.5))
    position = np.array([[0.6], [0.8]]) * (1.1 * mesh.arc)
    inner, force = np.zeros_like(position), np.zeros_like(position)
    assert spectral.pull_nodes(position, 0.0 * position, cable, inner, force) == pytest.approx(1.1)
    air = (force - inner) / mesh.nodes
    normal, tangential = 0.25 * 16.0, 0.5 * 9.0
    assert air[0] == pytest.approx(normal * 0.8 + tangential * 0.6)
    assert air[1] == pytest.approx(-normal * 0.6 + tangential * 0.8)
    assert inner[:, 0] == pytest.approx(0.1 * np.array([0.6, 0.8]))  # the cable pulls its bottom end up
    assert inner[:, 1:-1] == pytest.approx(0.0, abs=1e-13)  # rounding, which differs between processors


def test_kernels_say_the_same_compiled_and_plain(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = Scene(
        name="inclined rig in wind",
        cable=Cable(
            3.0, "unstretched", 0.0484, axial_stiffness=100.0, diameter=0.006, axial_damping_time=1e-3
        ),
        geometry=Geometry("ends", top=(1.8, 0.5, 2.6)),
        bottom=Bottom("crank-slider", direction="vertical", radius=0.02, rod_ratio=0.25, frequency=2.0),
        top=Top("platform", mass=0.4, hover_stiffness=(50.0, 20.0), hover_damping=5.0),
        output=Output(0.2, 50.0, (0.0, 0.3, 1.0)),
        air=Air(1.225, 1.2, 0.01, wind=5.0),
    )
    compiled = run_spectral(scene, 1)
    assert np.ptp(compiled.tension[:, 0]) > 0.1
    for name in ("pull_nodes", "accelerate_nodes", "fill_tension", "keep_row"):
        monkeypatch.setattr(spectral, name, getattr(spectral, name).py_func)
    monkeypatch.setattr(
        "tethertest.bench.spectral_elements.march.march_spectral", spectral.march_spectral.py_func
    )
    plain = run_spectral(scene, 1)
    np.testing.assert_allclose(plain.tension, compiled.tension, rtol=1e-9)
    np.testing.assert_allclose(plain.strain, compiled.strain, atol=1e-11)
    np.testing.assert_allclose(plain.field.minimum, compiled.field.minimum, rtol=1e-9)
