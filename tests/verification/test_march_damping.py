"""Kelvin-Voigt damping solved for, against the same damping taken from the last step, and its own order."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from tethertest.records.arrays import FloatArray
from tethertest.records.cable import Air, Cable
from tethertest.records.scene import Bottom, Geometry, Output, Scene, Top
from tethertest.solver.linear.transfer import run_axial_transform
from tethertest.solver.nonlinear import chain_march
from tethertest.solver.nonlinear.chain_march import chain_case, run_chain
from tethertest.solver.solution import Solution

TAUT = Scene(
    name="3 m rig",
    cable=Cable(3.0, "unstretched", 0.0484, axial_stiffness=10020.0, diameter=0.006, axial_damping_time=5e-4),
    geometry=Geometry("vertical"),
    bottom=Bottom("crank-slider", radius=0.05, rod_ratio=0.25, frequency=2.0, start="ramp", ramp=1.0),
    top=Top("platform", mass=0.4, static_tension=50.0, hover_stiffness=500.0, hover_damping=5.0),
    output=Output(4.0, 1000.0, (0.0, 0.37, 1.0)),
)
SLACK = replace(
    TAUT,
    cable=replace(TAUT.cable, axial_damping_time=1e-3),
    bottom=Bottom("harmonic", amplitude=0.3, frequency=0.3, start="ramp", ramp=4.0),
    top=Top("platform", mass=0.4, static_tension=5.0, hover_stiffness=50.0, hover_damping=5.0),
    output=Output(8.0, 500.0, (0.0, 0.1, 0.5, 1.0)),
)
INCLINED = replace(
    SLACK,
    geometry=Geometry("ends", top=(1.8, 2.375)),
    bottom=replace(SLACK.bottom, amplitude=0.2, frequency=0.8, ramp=2.0),
    top=replace(SLACK.top, static_tension=None),
    air=Air(1.225, 1.2, 0.01),
)
#: what ``t_d c / h`` must exceed for damping to be solved for
WAYS = {"implicit": 0.0, "explicit": math.inf}


def relative(found: FloatArray, reference: FloatArray) -> float:
    dynamic = np.sqrt(np.max(np.mean((reference - reference[0]) ** 2, axis=0)))
    return float(np.sqrt(np.max(np.mean((found - reference) ** 2, axis=0))) / dynamic)


@pytest.fixture(autouse=True)
def forget(monkeypatch: pytest.MonkeyPatch) -> None:
    """Make every case anew: these tests change what it is made of."""
    monkeypatch.setattr(chain_march, "kept_case", chain_march._chain_case)


def both_ways(monkeypatch: pytest.MonkeyPatch, scene: Scene, cells: int) -> tuple[Solution, Solution]:
    solutions = []
    for limit in WAYS.values():
        monkeypatch.setattr(chain_march, "EXPLICIT_DAMPING", limit)
        solutions.append(run_chain(scene, cells))
    implicit, explicit = solutions
    assert explicit.steps > 1.9 * implicit.steps  # explicit damping sets the step
    assert implicit.steps_done == implicit.steps
    return implicit, explicit


def test_taut_cable_both_ways_approach_the_transform(monkeypatch: pytest.MonkeyPatch) -> None:
    exact = run_axial_transform(TAUT, factor=2).tension
    apart, errors = [], []
    for cells in (10, 20, 40):
        implicit, explicit = both_ways(monkeypatch, TAUT, cells)
        apart.append(relative(implicit.tension, explicit.tension))
        errors.append(relative(implicit.tension, exact))
        assert relative(explicit.tension, exact) < 3e-6
    assert errors[-1] < 1.2e-6
    for falling in (apart, errors):
        assert np.all(np.log2(np.array(falling[:-1]) / falling[1:]) > 1.0)


def test_slack_upright_cable_snaps_alike_both_ways(monkeypatch: pytest.MonkeyPatch) -> None:
    implicit, explicit = both_ways(monkeypatch, SLACK, 20)
    assert np.min(explicit.tension) == np.min(implicit.tension) == 0.0
    slack = [np.mean(solution.tension == 0.0, axis=0) for solution in (implicit, explicit)]
    assert slack[0][0] > 0.05
    np.testing.assert_allclose(slack[0], slack[1], atol=3e-3)
    assert relative(implicit.tension, explicit.tension) < 0.03
    np.testing.assert_allclose(np.max(implicit.tension, axis=0), np.max(explicit.tension, axis=0), rtol=0.03)


def test_snapping_inclined_cable_depends_on_the_mesh_more_than_on_the_way(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    (coarse, _), (implicit, explicit) = (both_ways(monkeypatch, INCLINED, cells) for cells in (20, 40))
    assert np.min(explicit.tension) == np.min(implicit.tension) == 0.0
    assert relative(implicit.tension, explicit.tension) < 0.6 * relative(coarse.tension, implicit.tension)
    assert np.max(implicit.tension) == pytest.approx(np.max(explicit.tension), rel=0.05)


def test_without_viscosity_damping_is_centred_and_of_second_order() -> None:
    exact = run_axial_transform(TAUT, factor=4)
    assert chain_case(TAUT, 10, viscous=False).line.implicit == 0.5
    marches = [run_chain(TAUT, cells, viscous=False) for cells in (10, 20, 40)]
    errors = np.array([relative(march.tension, exact.tension) for march in marches])
    assert np.log2(errors[:-1] / errors[1:]) == pytest.approx(2.0, abs=0.1)


@pytest.mark.parametrize("viscous", [True, False])
def test_damping_far_above_the_explicit_limit_stays_stable(viscous: bool) -> None:
    """t_d c / h = 1500: the explicit step would be a thousandth of this one; the cable moves as one piece."""
    scene = replace(TAUT, cable=replace(TAUT.cable, axial_damping_time=0.5))
    solution = run_chain(scene, 20, viscous=viscous)
    assert solution.steps_done == solution.steps
    exact = run_axial_transform(scene, factor=2)
    assert relative(solution.tension, exact.tension) < 1e-4
    held = run_chain(replace(scene, bottom=Bottom("fixed")), 20, viscous=viscous)
    np.testing.assert_allclose(held.tension - held.tension[0], 0.0, atol=1e-6)


def test_explicit_damping_at_the_step_of_the_implicit_one_is_unstable(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    case = chain_case(TAUT, 20)
    assert case.line.implicit == 1.0
    monkeypatch.setattr(chain_march, "EXPLICIT_DAMPING", math.inf)
    monkeypatch.setattr(chain_march, "courant_limit", lambda *_: case.courant)
    assert chain_case(TAUT, 20).line.implicit == 0.0
    wild = run_chain(TAUT, 20)
    assert wild.steps_done < wild.steps or np.max(wild.field.maximum) > 1e3
