"""Exact waves of the bilinear cable in its plane: travelling shapes and transverse impact."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from tethertest.kernels import cells as kernel
from tethertest.records.arrays import FloatArray
from tethertest.records.cable import Cable
from tethertest.records.scene import Bottom, Geometry, Output, Scene, Top
from tethertest.solver.motion import displacement
from tethertest.solver.nonlinear.chain_march import run_chain

STRAIN = 0.3


def travelling(arc: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return a hump's unit tangent (m, 2) and position (m, 2): r = G(S - a t) with |G'| = 1 + e."""
    fine = np.linspace(-6.0, 6.0, 24001)
    angle = 1.6 * fine * np.exp(-4.0 * fine**2)
    tangent = np.column_stack([np.cos(angle), np.sin(angle)])
    step = fine[1] - fine[0]
    area = np.concatenate([np.zeros((1, 2)), np.cumsum(0.5 * step * (tangent[1:] + tangent[:-1]), axis=0)])
    columns = [
        np.column_stack([np.interp(arc, fine, array[:, j]) for j in (0, 1)]) for array in (tangent, area)
    ]
    return columns[0], (1.0 + STRAIN) * columns[1]


def travelled_error(cells: int, *, viscous: bool) -> float:
    """March a hump over 2 m of a 10 m cable (EA = rho = 1) and return its largest misplacement."""
    cell = 10.0 / cells
    speed = math.sqrt(STRAIN / (1.0 + STRAIN))
    steps = 2 * math.ceil(2.0 / speed / cell)
    time_step = 2.0 / speed / steps
    arc = np.linspace(-5.0, 5.0, cells + 1) + 1.0
    drift = (
        speed * (1.0 + STRAIN) * np.array([1.0, 0.0])
    )  # seen from the straight ends, which then stand still
    tangent, position = travelling(arc + 0.5 * speed * time_step)
    velocity = -speed * (1.0 + STRAIN) * tangent + drift
    position = travelling(arc)[1]
    place, speeds = np.ascontiguousarray(position.T), np.ascontiguousarray(velocity.T)
    stretch, along, force = np.zeros(cells), np.zeros((2, cells)), np.zeros((2, cells))
    rate, tension = np.zeros(cells + 2), np.zeros(cells + 2)
    kernel.stretch_cells(place, 1.0 / cell, stretch, rate, along)
    for _ in range(steps):
        kernel.stretch_cells(place, 1.0 / cell, stretch, rate, along)
        if viscous:
            kernel.pull_cells(stretch, rate, 1.0, 0.0, 0.1 * cell / time_step, tension)
            force[:] = along * tension[1:-1]
        else:
            kernel.pull_cells_elastic(stretch, 1.0, along, tension, force)
        speeds[:, 1:-1] += time_step / cell * np.diff(force, axis=1)
        place[:, 1:-1] += time_step * speeds[:, 1:-1]
    exact = travelling(arc - 2.0)[1] + drift * (2.0 / speed)
    return float(np.max(np.hypot(place[0] - exact[:, 0], place[1] - exact[:, 1])))


@pytest.mark.parametrize("viscous", [False, True])
def test_a_shape_travels_unchanged_at_second_order(viscous: bool) -> None:
    errors = [travelled_error(cells, viscous=viscous) for cells in (160, 320, 640)]
    assert errors[-1] < 2e-3
    assert np.log2(np.array(errors[:-1]) / errors[1:]) == pytest.approx(2.0, abs=0.2)


STRAIGHT = Scene(
    name="level cable without gravity",
    cable=Cable(149.164, "unstretched", 0.03352, axial_stiffness=120.17),
    geometry=Geometry("shallow", tension=80.0),
    bottom=Bottom("harmonic", amplitude=2.0, frequency=0.18, start="ramp", ramp=10.0),
    top=Top("fixed"),
    output=Output(67.5, 1.0, (0.0, 1.0)),
    gravity=0.0,
)


def test_straight_cable_meets_dalemberts_series_at_the_fixed_end() -> None:
    """T(L, t) = T0 - 2 Z sum_n v0(t - (2n + 1) L/c); what is left is the end's differencing, (w dt)^2 / 6."""
    wave_speed, impedance = math.sqrt(120.17 / 0.03352), math.sqrt(120.17 * 0.03352)
    traverse = 149.164 / wave_speed
    scene = replace(STRAIGHT, output=Output(67.5, 100.0 / traverse, (1.0,)))
    solution = run_chain(scene, 100, viscous=False)
    exact = np.full(solution.time.size, 80.0)
    for n in range(15):
        when = solution.time - (2 * n + 1) * traverse
        late, early = (displacement(scene.bottom, when + shift) for shift in (1e-4, -1e-4))
        exact -= 2.0 * impedance * (late - early) / 2e-4
    dynamic = np.max(np.abs(exact - 80.0))
    assert dynamic > 15.0
    np.testing.assert_allclose(solution.tension[:, 0], exact, atol=1.6e-4 * dynamic)


def test_straight_cable_at_resonance_grows_by_two_impedances_per_round_trip() -> None:
    wave_speed, impedance = math.sqrt(120.17 / 0.03352), math.sqrt(120.17 * 0.03352)
    traverse = 149.164 / wave_speed
    frequency = 0.5 / traverse
    bottom = Bottom("harmonic", amplitude=0.2, frequency=frequency, start="jump")
    scene = replace(STRAIGHT, bottom=bottom, output=Output(17.5 * traverse, 100.0 / traverse, (1.0,)))
    solution = run_chain(scene, 100, viscous=False)
    step = 2.0 * impedance * 0.2 * 2.0 * math.pi * frequency
    for trip in range(8):
        rows = np.arange(3, 98) + 100 * (2 * trip + 1)
        phase = 2.0 * math.pi * frequency * (solution.time[rows] - (2 * trip + 1) * traverse)
        exact = 80.0 - (trip + 1) * step * np.cos(phase)
        np.testing.assert_allclose(solution.tension[rows, 0], exact, atol=1e-3 * (trip + 1) * step)


@pytest.mark.parametrize("strain", [0.01, 0.1])
def test_transverse_impact_meets_smiths_strain_and_wave_speeds(strain: float) -> None:
    """V = c sqrt(2 e sqrt(e (1 + e)) - e^2); the strain e jumps with the axial front, not with the kink."""
    wave_speed = 100.0
    speed = wave_speed * math.sqrt(2.0 * strain * math.sqrt(strain * (1.0 + strain)) - strain**2)
    if strain == 0.01:
        assert speed / wave_speed == pytest.approx(0.0437033, abs=1e-7)
    scene = Scene(
        name="transverse impact",
        cable=Cable(100.0, "unstretched", 0.01, axial_stiffness=0.01 * wave_speed**2),
        geometry=Geometry("ends", top=(100.0 * (1.0 + 1e-9), 0.0)),
        bottom=Bottom("step", direction="vertical", velocity=speed),
        top=Top("fixed"),
        output=Output(0.8, 1000.0, (0.0, 0.02, 0.4, 0.95)),
        gravity=0.0,
    )
    solution = run_chain(scene, 800)
    late = (solution.time > 0.6) & (solution.time < 0.75)
    assert np.mean(solution.strain[late, :3], axis=0) == pytest.approx(strain, rel=5e-3)
    assert np.mean(solution.tension[late, :3], axis=0) == pytest.approx(strain * 100.0, rel=5e-3)
    assert np.all(solution.tension[late, 3] < 1e-3 * strain * 100.0)  # ahead of the axial front
    arrival = float(np.interp(0.5 * strain, solution.strain[:600, 2], solution.time[:600]))
    assert arrival == pytest.approx(0.4, abs=0.004)
