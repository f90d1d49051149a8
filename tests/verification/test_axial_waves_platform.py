"""The exact axial waves under a platform against closed forms, limits, other schemes and their own order."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from tethertest.kernels.axial_waves import BodyStep, march_body
from tethertest.records.arrays import FloatArray
from tethertest.records.cable import Cable
from tethertest.records.scene import Bottom, Geometry, Output, Scene, Top
from tethertest.solver.linear import axial_ends
from tethertest.solver.linear.axial_waves import run_axial_waves
from tethertest.solver.linear.transfer import tension_transfer
from tethertest.solver.nonlinear.chain_march import run_chain

LENGTH, MASS, STIFFNESS = 3.0, 0.0484, 10020.0
SPEED, IMPEDANCE = math.sqrt(STIFFNESS / MASS), math.sqrt(STIFFNESS * MASS)
TRAVERSE = LENGTH / SPEED
STEP = Bottom("step", velocity=0.5)
SMOOTH = Bottom("harmonic", amplitude=1e-3, frequency=40.0, start="ramp", ramp=0.5)
LOOP = {"hover_stiffness": 900.0, "hover_damping": 5.0}


def rig(bottom: Bottom, duration: float = 0.4, mass: float = 0.4, **loop: float) -> Scene:
    return Scene(
        name="3 m rig",
        cable=Cable(LENGTH, "unstretched", MASS, axial_stiffness=STIFFNESS),
        geometry=Geometry("vertical"),
        bottom=bottom,
        top=Top("platform", mass=mass, static_tension=5.0, **loop),  # type: ignore[arg-type]
        output=Output(duration, 2000.0, (0.0, 0.37, 1.0), ("position", "velocity")),
    )


def relative(found: FloatArray, reference: FloatArray) -> float:
    dynamic = np.sqrt(np.max(np.mean((reference - reference[0]) ** 2, axis=0)))
    return float(np.sqrt(np.max(np.mean((found - reference) ** 2, axis=0))) / dynamic)


def test_a_step_moves_the_tip_mass_as_the_closed_form_between_its_first_two_fronts() -> None:
    """Oracle 2: v(L) = 2 v0 (1 - exp(-Z (t - L/c)/M)) for L/c < t < 3 L/c."""
    scene = rig(STEP, duration=3.0 * TRAVERSE, mass=0.1)
    scene = replace(scene, output=replace(scene.output, rate=1e5))
    solution = run_axial_waves(scene, 8)
    since = np.maximum(solution.time - TRAVERSE, 0.0)
    rate = IMPEDANCE / 0.1
    decay = np.exp(-rate * since)
    np.testing.assert_allclose(solution.fields["velocity"][:, 2, 2], 1.0 - decay, atol=1e-12)
    np.testing.assert_allclose(solution.platform_position, since - (1.0 - decay) / rate, atol=1e-14)
    acceleration = np.where(since > 0.0, rate * decay, 0.0)
    np.testing.assert_allclose(solution.tension[:, 2], 5.0 - 0.1 * acceleration, atol=1e-9)
    rise = solution.fields["position"][:, 2, 2] - solution.fields["position"][0, 2, 2]
    np.testing.assert_allclose(rise, solution.platform_position, atol=1e-14)


@pytest.mark.parametrize("stiffness", [0.0, 30.0, "critical", 4e5])
def test_the_position_loop_answers_a_step_as_its_own_equation(stiffness: float | str) -> None:
    """M v' + (c + Z) v + k x = 2 Z v0 until the front comes back; overdamped, critical and oscillating."""
    mass, damping = 0.01, 7.0
    loop = (damping + IMPEDANCE) ** 2 / (4.0 * mass) if isinstance(stiffness, str) else stiffness
    scene = rig(STEP, duration=2.99 * TRAVERSE, mass=mass, hover_stiffness=loop, hover_damping=damping)
    scene = replace(scene, output=replace(scene.output, rate=2e4))
    solution = run_axial_waves(scene, 3)
    after = solution.time > TRAVERSE

    def motion(_: float, state: FloatArray) -> list[float]:
        pull = 2.0 * IMPEDANCE * 0.5 - (damping + IMPEDANCE) * state[1] - loop * state[0]
        return [state[1], pull / mass]

    since = solution.time[after] - TRAVERSE
    exact = solve_ivp(
        motion, (0.0, since[-1]), [0.0, 0.0], "DOP853", since, rtol=1e-12, atol=[1e-15, 1e-12]
    ).y
    np.testing.assert_allclose(solution.platform_position[after], exact[0], rtol=0.0, atol=1e-10)
    np.testing.assert_allclose(solution.fields["velocity"][after, 2, 2], exact[1], rtol=0.0, atol=1e-8)


def test_steady_state_meets_the_closed_form_in_amplitude_and_phase() -> None:
    frequency = 40.0
    scene = rig(replace(SMOOTH, ramp=1.0), duration=6.0, mass=0.05, hover_stiffness=50.0, hover_damping=9.0)
    exact = tension_transfer(scene, np.array([frequency]), np.array(scene.output.gauges))[0] * 1e-3
    solution = run_axial_waves(scene, 8)
    steady = solution.time > 5.0
    angle = 2.0 * np.pi * frequency * solution.time[steady]
    design = np.column_stack([np.ones(angle.size), np.cos(angle), np.sin(angle)])
    _, cosine, sine = np.linalg.lstsq(design, solution.tension[steady], rcond=None)[0]
    # the drive is A sin(wt) = A Re(-i exp(iwt))
    np.testing.assert_allclose(cosine - 1j * sine, -1j * exact, rtol=0.0, atol=1e-7 * np.max(np.abs(exact)))


def test_fifth_order_in_the_step_for_a_platform_under_a_ramped_motion() -> None:
    scene = rig(SMOOTH, **LOOP)
    scene = replace(scene, cable=replace(scene.cable, axial_stiffness=300.0))  # a traverse of 38 ms
    solutions = [run_axial_waves(scene, cells) for cells in (8, 16, 32, 128)]
    exact = solutions[-1]
    errors = np.array([relative(each.tension, exact.tension) for each in solutions[:-1]])
    assert np.log2(errors[:-1] / errors[1:]) == pytest.approx(5.0, abs=0.6)
    assert errors[-1] < 1e-5


@pytest.mark.parametrize("native", [True, False])
def test_the_leapfrog_march_meets_it_at_second_order(native: bool) -> None:
    scene = rig(replace(SMOOTH, amplitude=5e-4), **LOOP)  # taut: the march knows no compression
    courant = None
    if native:  # output on the leapfrog's own levels takes its interpolation in time away
        scene, courant = replace(scene, output=replace(scene.output, rate=10.0 / TRAVERSE)), 0.5
    exact = run_axial_waves(scene, 20)
    marches = [run_chain(scene, cells, viscous=False, courant=courant) for cells in (10, 20, 40)]
    for quantity in ("tension", "strain"):
        errors = np.array([relative(getattr(march, quantity), getattr(exact, quantity)) for march in marches])
        assert np.log2(errors[:-1] / errors[1:]) == pytest.approx(2.0, abs=0.1)
    top = [np.max(np.abs(march.platform_position - exact.platform_position)) for march in marches]
    assert np.log2(np.array(top[:-1]) / top[1:]) == pytest.approx(2.0, abs=0.1)


@pytest.mark.parametrize("mass", [0.0, 1e-6, 0.4, 1e3, 1e9])
@pytest.mark.parametrize("loop", [{}, LOOP])
def test_any_mass_stays_within_the_energy_that_the_step_brings(mass: float, loop: dict[str, float]) -> None:
    """With a free top no wave outgrows that of n reflections at a fixed one."""
    solution = run_axial_waves(rig(STEP, duration=2.0, mass=mass, **loop), 5)
    reflections = 2.0 / TRAVERSE + 2.0
    assert np.max(np.abs(solution.tension - solution.tension[0])) < IMPEDANCE * 0.5 * reflections
    assert np.max(np.abs(solution.fields["velocity"])) < 1.01 * reflections
    assert solution.steps_done == solution.steps


def test_without_mass_the_top_keeps_its_tension_and_mirrors_the_wave() -> None:
    solution = run_axial_waves(rig(STEP, duration=3.9 * TRAVERSE, mass=0.0), 10, native_times=True)
    np.testing.assert_allclose(solution.tension[:, 2], 5.0, rtol=0.0, atol=1e-10)
    pull = np.array([-1.0, -1.0, 1.0, 1.0])  # of the front, as it leaves the bottom, every traverse
    bottom = solution.tension[[0, 10, 20, 30], 0] - (5.0 - LENGTH * MASS * 9.80665)
    np.testing.assert_allclose(bottom, 0.5 * IMPEDANCE * pull, rtol=1e-9)
    speeds = solution.fields["velocity"][[0, 9, 10, 29, 30], 2, 2]
    np.testing.assert_allclose(speeds, [0.0, 0.0, 1.0, 1.0, 0.0], atol=1e-9)


@pytest.mark.parametrize("loop", [{}, LOOP])
def test_small_masses_approach_none_in_proportion(loop: dict[str, float]) -> None:
    none = run_axial_waves(rig(SMOOTH, mass=0.0, **loop), 20)
    first, second = (
        np.max(np.abs(run_axial_waves(rig(SMOOTH, mass=mass, **loop), 20).tension - none.tension))
        for mass in (1e-6, 1e-7)
    )
    assert first < 1e-3 * np.max(np.abs(none.tension - none.tension[0]))
    assert first / second == pytest.approx(10.0, rel=0.01)


def test_a_huge_mass_is_a_fixed_top() -> None:
    held = rig(SMOOTH)
    fixed = replace(held, top=Top("fixed", static_tension=5.0))
    heavy = run_axial_waves(replace(held, top=replace(held.top, mass=1e9)), 20)
    np.testing.assert_allclose(heavy.tension, run_axial_waves(fixed, 20).tension, rtol=0.0, atol=1e-7)


def test_a_loop_at_critical_damping_lies_between_its_neighbours() -> None:
    total = IMPEDANCE + 5.0
    critical = total**2 / (4.0 * 0.01)
    below, at, above = (
        run_axial_waves(
            rig(SMOOTH, mass=0.01, hover_stiffness=factor * critical, hover_damping=5.0), 20
        ).tension
        for factor in (0.999, 1.0, 1.001)
    )
    assert relative(0.5 * (below + above), at) < 1e-6
    assert relative(below, at) > 1e-5


def test_bodys_march_is_the_same_compiled_and_plain(monkeypatch: pytest.MonkeyPatch) -> None:
    rng = np.random.default_rng(3)
    step = BodyStep(
        4, 2.0, 0.3 * rng.random((2, 2)), rng.random((2, 3)), rng.random((3, 2)), rng.random((3, 3)) / 40.0
    )
    sent = rng.standard_normal((12, 3))
    results = []
    for kernel in (march_body, march_body.py_func):  # type: ignore[attr-defined]
        arriving, state = np.zeros((12, 3)), np.zeros((13, 2))
        kernel(sent, step, arriving, state)
        results.append((arriving, state))
    np.testing.assert_allclose(results[0][0], results[1][0], rtol=1e-12)
    np.testing.assert_allclose(results[0][1], results[1][1], rtol=1e-12)
    scene = rig(SMOOTH, duration=0.1)
    compiled = run_axial_waves(scene, 4)
    monkeypatch.setattr(axial_ends, "march_body", march_body.py_func)  # type: ignore[attr-defined]
    plain = run_axial_waves(scene, 4)
    np.testing.assert_allclose(plain.tension, compiled.tension, rtol=1e-12)
