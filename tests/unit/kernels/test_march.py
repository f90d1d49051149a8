"""The march against closed forms of a body that its slack cable leaves alone, and against rest itself."""

from __future__ import annotations

import json
import math
import os
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tethertest.kernels.march import Line, UpperEnd, end_tension, march
from tethertest.records.arrays import FloatArray
from tethertest.records.cable import Air, Cable
from tethertest.records.scene import Bottom, Geometry, Output, Scene, Top, WindSeries
from tethertest.solver.motion import velocity
from tethertest.solver.nonlinear.chain_march import chain_case, empty_record, run_chain
from tethertest.solver.terms import body_axes

Run = Callable[[Any], Any]
MASS, CELL, BODY = 0.05, 0.5, 0.4
#: body and the half cell that moves with it
MOVED = BODY + 0.5 * MASS * CELL


def body(d: int, **parts: Any) -> UpperEnd:
    values = {
        "fixed": False,
        "mass": BODY,
        "lift": np.zeros(d),
        "stiffness": np.zeros(d),
        "damping": np.zeros(d),
        "body_axes": np.zeros((0, d)),
        "body_drag": np.zeros(0),
    }
    return UpperEnd(**{**values, **parts})


def flown(
    run: Run, top: UpperEnd, gravity: FloatArray, wind: FloatArray, steps: int, time_step: float
) -> tuple[FloatArray, FloatArray]:
    """Positions (steps, d) of a body above a slack cable, from rest; and heights as the record's own rows."""
    d = gravity.size
    line = Line(CELL, MASS, 1000.0, 0.0, 0.0, 0.1, 0.0, gravity, 0.0, 0.0)
    position = np.zeros((d, 4))
    position[-1] = 0.1 * np.arange(4)  # far shorter than its cells of 0.5 m
    output = Output((steps - 2) * time_step, 1.0 / time_step, (1.0,), ("position",))
    record = empty_record(output, 3, steps, d, time_step, native_times=True)
    done = run(march)(np.zeros(steps + 2), np.eye(d)[-1], position, line, top, wind, time_step, record)
    assert done == steps
    return record.rows[:, 0, 2 : 2 + d] - record.rows[0, 0, 2 : 2 + d], record.top - record.top[0]


@pytest.mark.parametrize("d", [1, 2, 3])
def test_a_body_under_lift_and_gravity_falls_freely_while_its_cable_is_slack(run: Run, d: int) -> None:
    gravity, lift = np.linspace(-2.0, -9.81, d) if d > 1 else np.array([-9.81]), np.linspace(1.0, 3.0, d)
    away, height = flown(run, body(d, lift=lift), gravity, np.zeros((d, 1)), 20, 1e-3)
    k = np.arange(away.shape[0])
    free = 1e-6 * 0.5 * k * (k + 1)  # the velocities start half a step before the positions
    np.testing.assert_allclose(away, np.outer(free, gravity + lift / MOVED), atol=1e-15)
    np.testing.assert_allclose(height, away[:, -1], atol=1e-15)


@pytest.mark.parametrize("wind", [(7.0, 0.0, 0.0), (0.0, -3.0, 0.0), (8.0, 4.0, -1.0)])
@pytest.mark.parametrize("tilt", [0.0, 0.3, -0.2])
def test_air_pushes_a_tilted_body_along_its_own_axes(run: Run, wind: tuple[float, ...], tilt: float) -> None:
    """Equations (13)-(16): 1/2 rho CD A V |V| along axes that lean down by the tilt, round about z."""
    scene = replace(SCENE, top=Top("platform", mass=BODY, drag_area=(0.1, 0.25), tilt=tilt))
    axes, drag = body_axes(scene)
    away, _ = flown(run, body(3, body_axes=axes, body_drag=drag), np.zeros(3), np.array([wind]).T, 4, 1e-3)
    u, v, w = wind
    forward, upward = u * math.cos(tilt) - w * math.sin(tilt), u * math.sin(tilt) + w * math.cos(tilt)
    across = math.hypot(forward, v)
    along = 0.5 * 1.225 * 0.1 * forward * across
    above = 0.5 * 1.225 * 0.25 * upward * abs(upward)
    push = [
        along * math.cos(tilt) + above * math.sin(tilt),
        0.5 * 1.225 * 0.1 * v * across,
        -along * math.sin(tilt) + above * math.cos(tilt),
    ]
    np.testing.assert_allclose(away[1], 1e-6 * np.array(push) / MOVED, rtol=1e-9, atol=1e-15)


def test_a_body_is_carried_along_by_the_wind_until_it_moves_with_it() -> None:
    """v = W q/(1 + q), q = K W t/M: relative speed counts, not the wind's."""
    top = body(2, body_axes=np.array([[1.0, 0.0]]), body_drag=np.array([3.0]))
    errors = []
    for steps in (100, 200):
        time_step = 0.1 / steps
        away, _ = flown(lambda kernel: kernel, top, np.zeros(2), np.array([[6.0], [0.0]]), steps, time_step)
        time = (np.arange(away.shape[0]) + 0.5) * time_step  # velocity stands half a step later
        rate = 3.0 * 6.0 / MOVED
        exact = 6.0 * time - 6.0 / rate * np.log1p(rate * time)
        speed = 6.0 * rate * time / (1.0 + rate * time)
        errors.append(float(np.max(np.abs(np.diff(away[:, 0]) / time_step - speed[:-1]))))
        np.testing.assert_allclose(away[:, 0], exact - exact[0], atol=0.01)
        assert speed[-1] > 4.8
    assert errors[1] < 0.6 * errors[0]
    assert errors[1] < 0.1


@pytest.mark.parametrize("d", [1, 2, 3])
def test_hover_damping_slows_a_body_to_force_over_damping(run: Run, d: int) -> None:
    """M v' = F - c v, one constant per direction."""
    lift, damping = np.linspace(1.0, 2.0, d), np.linspace(0.5, 4.0, d)
    steps, time_step = 200, 2e-3
    away, _ = flown(run, body(d, lift=lift, damping=damping), np.zeros(d), np.zeros((d, 1)), steps, time_step)
    time = np.arange(away.shape[0])[1:] * time_step
    decay = np.exp(-np.outer(time, damping) / MOVED)
    speed = lift / damping * (1.0 - decay)
    found = (away[1:] - away[:-1]) / time_step  # half a step earlier than `time`, begun half a step early
    np.testing.assert_allclose(found, speed, rtol=5e-3, atol=1e-4)


@pytest.mark.parametrize("d", [1, 2, 3])
def test_a_position_loop_swings_a_body_about_force_over_stiffness(run: Run, d: int) -> None:
    lift, stiffness = np.linspace(1.0, -2.0, d), np.linspace(30.0, 80.0, d)
    steps, time_step = 1000, 1e-3
    top = body(d, lift=lift, stiffness=stiffness, damping=np.full(d, 0.8))
    away, _ = flown(run, top, np.zeros(d), np.zeros((d, 1)), steps, time_step)
    time = (np.arange(away.shape[0])[:, None] + 0.5) * time_step
    decay = 0.4 / MOVED
    swing = np.sqrt(stiffness / MOVED - decay**2)
    exact = 1.0 - np.exp(-decay * time) * (np.cos(swing * time) + decay / swing * np.sin(swing * time))
    np.testing.assert_allclose(away, lift / stiffness * exact, atol=4e-3 * np.max(np.abs(lift / stiffness)))


def test_a_gust_begins_when_the_series_says(run: Run) -> None:
    wind = np.zeros((2, 22))
    wind[0, 10:] = 6.0
    top = body(2, body_axes=np.array([[1.0, 0.0]]), body_drag=np.array([0.3]))
    away, _ = flown(run, top, np.zeros(2), wind, 20, 1e-3)
    assert not np.any(away[:11])
    assert away[11, 0] == pytest.approx(1e-6 * 0.3 * 36.0 / MOVED)


@pytest.mark.parametrize(
    ("balance", "expected"),
    [((3.0, 4.0), 5.0), ((-3.0, -4.0), 0.0), ((4.0, -3.0), 0.0), ((0.0, 0.0), 0.0)],
)
def test_an_end_pulls_with_its_balance_or_not_at_all(
    run: Run, balance: tuple[float, float], expected: float
) -> None:
    force = np.array([[0.0, 0.6], [0.0, 0.8]])
    assert run(end_tension)(np.array(balance), force, 1) == pytest.approx(expected)
    assert run(end_tension)(np.array(balance), force, 0) == 0.0  # a slack cell's end


AIR = Air(1.225, 1.2, 0.02, wind=(4.0, 2.0, 0.5))
SCENE = Scene(
    name="3 m, inclined, in wind",
    cable=Cable(
        3.0,
        "unstretched",
        0.0484,
        axial_stiffness=10020.0,
        diameter=0.006,
        axial_damping_time=1e-3,
        bending_stiffness=0.01,
    ),
    geometry=Geometry("ends", top=(1.5, 0.5, 2.5)),
    bottom=Bottom(
        "harmonic", direction=(0.3, 0.1, 0.9), amplitude=0.05, frequency=2.0, start="ramp", ramp=0.5
    ),
    top=Top(
        "platform",
        mass=BODY,
        hover_stiffness=(50.0, 40.0, 20.0),
        hover_damping=(5.0, 4.0, 3.0),
        drag_area=(0.02, 0.05),
        tilt=0.2,
    ),
    output=Output(1.0, 100.0, (0.0, 0.3, 1.0), ("position", "velocity", "curvature")),
    air=AIR,
)


@pytest.mark.parametrize("viscous", [True, False])
@pytest.mark.parametrize("cells", [2, 3, 20])
def test_rest_in_wind_and_bending_stays_at_rest_in_space(viscous: bool, cells: int) -> None:
    still = replace(SCENE, bottom=Bottom("fixed"))
    rest = chain_case(still, cells, viscous=viscous).rest
    solution = run_chain(still, cells, viscous=viscous)
    ends = [float(np.linalg.norm(force)) for force in (rest.start_force, rest.end_force)]
    np.testing.assert_allclose(solution.tension[:, [0, 2]] - ends, 0.0, atol=1e-7)
    np.testing.assert_allclose(solution.strain, 0.0, atol=1e-10)
    np.testing.assert_allclose(solution.platform_position, 0.0, atol=1e-9)
    np.testing.assert_allclose(solution.fields["velocity"], 0.0, atol=1e-7)
    np.testing.assert_allclose(solution.fields["position"][:, [0, 2]] - rest.nodes[[0, -1]], 0.0, atol=1e-9)
    assert rest.nodes[1, 1] != 0.0


def test_a_series_of_one_wind_is_that_wind() -> None:
    steady = run_chain(SCENE, 8)
    calm = replace(SCENE, air=replace(AIR, wind=0.0))
    gusts = WindSeries(np.array([0.0, 0.3, 0.7]), np.tile([4.0, 2.0, 0.5], (3, 1)))
    series = run_chain(calm, 8, wind=gusts)
    np.testing.assert_array_equal(series.tension, steady.tension)
    np.testing.assert_array_equal(series.platform_position, steady.platform_position)
    assert np.ptp(steady.tension) > 1.0


def test_a_rising_wind_blows_the_cable_over_to_its_rest_in_that_wind() -> None:
    """From the rest in 1 m/s to that in 6 m/s, under a fixed top, with drag enough to settle."""
    still = replace(
        SCENE, bottom=Bottom("fixed"), top=Top("fixed"), output=replace(SCENE.output, duration=6.0)
    )
    air = replace(AIR, normal_drag=30.0)
    rising = WindSeries(
        np.array([0.0, 0.5, 1.5]), np.array([[0.0, 1.0, 0.0], [0.0, 1.0, 0.0], [6.0, 1.0, 0.0]])
    )
    blown = run_chain(replace(still, air=air), 8, wind=rising)
    before = chain_case(replace(still, air=replace(air, wind=(0.0, 1.0, 0.0))), 8).rest
    after = chain_case(replace(still, air=replace(air, wind=(6.0, 1.0, 0.0))), 8).rest
    first, last = (np.linalg.norm(rest.end_force) for rest in (before, after))
    np.testing.assert_allclose(blown.tension[:50, -1], first, atol=1e-7)
    assert blown.tension[-1, -1] == pytest.approx(last, rel=1e-3)
    assert abs(last - first) > 0.1 * first


def test_air_holds_half_a_cell_back_at_a_moving_bottom_end() -> None:
    """Drag on the last half cell holds it up against the exciter that pulls it down, in its tension too."""
    upright = replace(
        SCENE,
        cable=replace(SCENE.cable, axial_damping_time=0.0, bending_stiffness=0.0),
        geometry=Geometry("vertical", tension=80.0),
        bottom=Bottom("step", velocity=-2.0),
        top=Top("fixed"),
        output=Output(0.01, 100.0, (0.0,)),
        air=Air(1.225, 0.0, 20.0),
    )
    rows = [
        run_chain(replace(upright, air=air), 10, courant=0.5, native_times=True).tension[:2, 0]
        for air in (upright.air, None)
    ]
    drag = 0.5 * 1.225 * math.pi * 0.006 * 20.0 * 2.0**2
    np.testing.assert_allclose(rows[0] - rows[1], 0.5 * 0.3 * drag, rtol=1e-9)


@pytest.mark.parametrize("cells", [8, 30])
def test_velocities_are_the_growth_of_positions_at_both_ends_and_between(cells: int) -> None:
    solution = run_chain(SCENE, cells, native_times=True)
    place, speed = solution.fields["position"], solution.fields["velocity"]
    growth = (place[2:] - place[:-2]) / (2.0 * solution.time_step)
    np.testing.assert_allclose(speed[1:-1], growth, atol=1e-9)
    along = np.array([0.3, 0.1, 0.9]) / math.sqrt(0.91)
    bottom = velocity(SCENE.bottom, solution.time)[:, None] * along
    np.testing.assert_allclose(speed[:, 0], bottom, atol=1e-4)
    assert np.max(np.abs(bottom)) > 0.5


SNAP = replace(
    SCENE,
    bottom=Bottom("step", direction="vertical", velocity=1.0),
    output=replace(SCENE.output, duration=0.05, rate=200.0),
)


def numbers(scene: Scene, viscous: bool) -> FloatArray:
    solution = run_chain(scene, 4, viscous=viscous)
    parts = (solution.tension, solution.strain, solution.platform_position, solution.field.maximum)
    return np.concatenate([part.ravel() for part in (*parts, *solution.fields.values())])


#: on a line, in the plane, in space; explicit and implicit damping
TRIED = {
    "line": replace(
        SNAP,
        geometry=Geometry("vertical", tension=2.0),
        air=None,
        cable=replace(SNAP.cable, bending_stiffness=0.0),
    ),
    "plane": replace(SNAP, geometry=Geometry("ends", top=(1.5, 2.55)), air=replace(AIR, wind=(4.0, 0.5))),
    "space": SNAP,
    "explicit": replace(SNAP, cable=replace(SNAP.cable, axial_damping_time=1e-4)),
}


def test_the_march_says_the_same_compiled_and_plain() -> None:
    """The same scenes in a process that compiles nothing."""
    code = (
        "import importlib.util, json, sys, numba;"
        "assert numba.config.DISABLE_JIT;"
        f"spec = importlib.util.spec_from_file_location('plain_march', {__file__!r});"
        "module = importlib.util.module_from_spec(spec); spec.loader.exec_module(module);"
        "json.dump([module.numbers(scene, viscous).tolist() for scene in module.TRIED.values()"
        " for viscous in (True, False)], sys.stdout)"
    )
    environment = {**os.environ, "NUMBA_DISABLE_JIT": "1"}
    done = subprocess.run(
        [sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    compiled = [numbers(scene, viscous) for scene in TRIED.values() for viscous in (True, False)]
    for plain, fast in zip(json.loads(done.stdout), compiled, strict=True):
        np.testing.assert_allclose(plain, fast, rtol=1e-7, atol=1e-8)
    assert any(np.any(values == 0.0) for values in compiled)


def test_a_motion_that_leaves_the_range_of_numbers_is_noticed(run: Run) -> None:
    line = Line(CELL, MASS, 1000.0, 0.0, 0.0, 0.0, 0.0, np.zeros(1), 0.0, 0.0)
    position = 0.6 * np.arange(4.0)[None]
    record = empty_record(Output(1.0, 10.0, (1.0,)), 3, 400, 1, 1.0, native_times=False)
    bottom = 1e-3 * np.arange(402.0) ** 2
    top = body(1, fixed=True)
    with np.errstate(all="ignore"):
        done = run(march)(bottom, np.ones(1), position, line, top, np.zeros((1, 1)), 1.0, record)
    assert 0 < done < 400
