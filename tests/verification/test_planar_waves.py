"""Exact waves of the bilinear cable in its plane: travelling shapes and transverse impact."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from tethertest.kernels import planar
from tethertest.records.arrays import FloatArray
from tethertest.records.cable import Air, Cable
from tethertest.records.scene import Bottom, Geometry, Output, Scene, Top
from tethertest.solver.nonlinear import planar as planar_solver
from tethertest.solver.motion import displacement
from tethertest.solver.nonlinear.planar import run_planar

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
    x, z = position[:, 0].copy(), position[:, 1].copy()
    velocity_x, velocity_z = velocity[:, 0].copy(), velocity[:, 1].copy()
    stretch, force_x, force_z = np.zeros(cells), np.zeros(cells), np.zeros(cells)
    rate, tension = np.zeros(cells + 2), np.zeros(cells + 2)
    planar.stretch_cells(x, z, 1.0 / cell, stretch, rate, force_x, force_z)
    for _ in range(steps):
        planar.stretch_cells(x, z, 1.0 / cell, stretch, rate, force_x, force_z)
        if viscous:
            planar.pull_cells(stretch, rate, 1.0, 0.0, 0.1 * cell / time_step, tension, force_x, force_z)
        else:
            planar.pull_cells_elastic(stretch, 1.0, tension, force_x, force_z)
        planar.move_nodes(
            x, z, velocity_x, velocity_z, force_x, force_z, time_step / cell, (0.0, 0.0), time_step
        )
    exact = travelling(arc - 2.0)[1] + drift * (2.0 / speed)
    return float(np.max(np.hypot(x - exact[:, 0], z - exact[:, 1])))


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
    solution = run_planar(scene, 100, viscous=False)
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
    solution = run_planar(scene, 100, viscous=False)
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
    solution = run_planar(scene, 800, viscous=True)
    late = (solution.time > 0.6) & (solution.time < 0.75)
    assert np.mean(solution.strain[late, :3], axis=0) == pytest.approx(strain, rel=5e-3)
    assert np.mean(solution.tension[late, :3], axis=0) == pytest.approx(strain * 100.0, rel=5e-3)
    assert np.all(solution.tension[late, 3] < 1e-3 * strain * 100.0)  # ahead of the axial front
    arrival = float(np.interp(0.5 * strain, solution.strain[:600, 2], solution.time[:600]))
    assert arrival == pytest.approx(0.4, abs=0.004)


def test_kernels_say_the_same_compiled_and_plain() -> None:
    random = np.random.default_rng(2)
    cells = 12
    x, z = np.cumsum(random.uniform(0.5, 1.5, cells + 1)), random.normal(size=cells + 1)
    results = []
    for plain in (False, True):

        def kernel(name: str, plain: bool = plain):
            compiled = getattr(planar, name)
            return compiled.py_func if plain else compiled

        stretch, rate, tension = np.full(cells, 1.1), np.zeros(cells + 2), np.zeros(cells + 2)
        force_x, force_z = np.zeros(cells), np.zeros(cells)
        nodes = [x.copy(), z.copy(), np.full(cells + 1, 0.3), np.full(cells + 1, -0.2)]
        air_x, air_z = np.zeros(cells + 1), np.zeros(cells + 1)
        highest, lowest = np.full(cells + 2, -np.inf), np.full(cells + 2, np.inf)
        kernel("stretch_cells")(x, z, 1.0, stretch, rate, force_x, force_z)
        kernel("drag_nodes")(force_x, force_z, nodes[2], nodes[3], (4.0, 1.0), (0.3, 0.1), air_x, air_z)
        kernel("blow_nodes")(nodes[2], air_x, 0.1)
        kernel("pull_cells")(stretch, rate, 10.0, 0.5, 0.8, tension, force_x, force_z)
        kernel("move_nodes")(*nodes, force_x, force_z, 0.1, (0.0, -0.1), 0.05)
        kernel("widen")(tension, highest, lowest)
        results.append(np.concatenate([stretch, rate, tension, air_x, air_z, *nodes, highest, lowest]))
    np.testing.assert_allclose(results[0], results[1], rtol=1e-13)
    assert np.any(results[0][26:38] == 0.0)  # some cell was slack


def test_drag_pushes_with_the_wind_and_splits_into_normal_and_tangential() -> None:
    """A cable along (0.6, 0.8): 5 m/s of wind is 3 m/s along and 4 m/s across."""
    along_x, along_z, still = np.full(4, 0.6), np.full(4, 0.8), np.zeros(5)
    air_x, air_z = np.zeros(5), np.zeros(5)
    planar.drag_nodes(along_x, along_z, still, still.copy(), (5.0, 0.0), (0.25, 0.5), air_x, air_z)
    normal, tangential = 0.25 * 16.0, 0.5 * 9.0
    assert air_x == pytest.approx(normal * 0.8 + tangential * 0.6)
    assert air_z == pytest.approx(-normal * 0.6 + tangential * 0.8)


def test_the_march_says_the_same_compiled_and_plain(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = Scene(
        name="inclined rig in wind",
        cable=Cable(
            3.0, "unstretched", 0.0484, axial_stiffness=10020.0, diameter=0.006, axial_damping_time=1e-4
        ),
        geometry=Geometry("ends", top=(1.8, 2.3)),
        bottom=Bottom("step", direction="vertical", velocity=1.0),
        top=Top("platform", mass=0.4, hover_stiffness=(50.0, 20.0), hover_damping=5.0),
        output=Output(0.1, 500.0, (0.0, 0.3, 1.0)),
        air=Air(1.225, 1.2, 0.01, wind=5.0),
    )
    compiled = run_planar(scene, 5, viscous=True)
    monkeypatch.setattr(planar_solver, "march_plane", planar.march_plane.py_func)
    for name in (
        "stretch_cells",
        "pull_cells",
        "drag_nodes",
        "blow_nodes",
        "move_nodes",
        "widen",
        "keep_row",
    ):
        monkeypatch.setattr(planar, name, getattr(planar, name).py_func)
    plain = run_planar(scene, 5, viscous=True)
    assert np.min(compiled.tension) == 0.0
    np.testing.assert_allclose(plain.tension, compiled.tension, atol=1e-8)
    np.testing.assert_allclose(plain.strain, compiled.strain, atol=1e-11)
    np.testing.assert_allclose(plain.field.maximum, compiled.field.maximum, atol=1e-8)
