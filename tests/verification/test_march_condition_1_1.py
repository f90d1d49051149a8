"""The march in the plane on the paper's condition 1.1 against extrapolated extremes and orders of accuracy.

Extremes are those of fourth-order extrapolated and fifth-order finite-volume solutions, which agree to 1e-5.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from tethertest.records.arrays import FloatArray
from tethertest.records.cable import Cable
from tethertest.records.scene import Bottom, Geometry, Output, Scene, Top
from tethertest.solver.nonlinear.chain_march import run_chain
from tethertest.solver.solution import Solution

LENGTH, MASS, STIFFNESS = 149.164, 0.033520, 120.17
COURANT = {False: 1.0, True: 0.9}


def scene_of(frequency: float, courant: float) -> Scene:
    """Rows at the steps of a mesh of 50 cells, which are steps of every finer one."""
    wave_speed = math.sqrt(STIFFNESS / MASS)
    return Scene(
        name="condition 1.1",
        cable=Cable(250.0, "equilibrium", 0.02, youngs_modulus=1.7e7, diameter=0.003),
        geometry=Geometry("shallow", tension=80.0),
        bottom=Bottom("harmonic", amplitude=2.0, frequency=frequency, start="ramp", ramp=10.0),
        top=Top("fixed"),
        output=Output(67.5, 50 * wave_speed / (LENGTH * courant), (0.0, 1.0)),
        gravity=9.81,
    )


@cache
def condition(frequency: float, cells: int, viscous: bool) -> Solution:
    scene = scene_of(frequency, COURANT[viscous])
    return run_chain(scene, cells, viscous=viscous, courant=COURANT[viscous])


def ends(solution: Solution) -> list[float]:
    low, high = solution.field.minimum.min(axis=0), solution.field.maximum.max(axis=0)
    return [float(value) for value in (low[0], high[0], low[-1], high[-1])]


@pytest.mark.parametrize(
    ("frequency", "extremes"),
    [
        (0.10, [81.653, 85.932, 80.223, 86.641]),
        (0.18, [55.350, 123.266, 52.544, 123.685]),
        (0.25, [74.108, 96.367, 73.725, 94.698]),
    ],
)
def test_extremes_at_both_ends(frequency: float, extremes: list[float]) -> None:
    assert ends(condition(frequency, 200, False)) == pytest.approx(extremes, abs=0.02)
    assert ends(condition(frequency, 200, True)) == pytest.approx(extremes, abs=0.02)


def test_largest_top_tension_at_100_cells() -> None:
    assert ends(condition(0.18, 100, False))[3] == pytest.approx(123.685, abs=0.02)


def extrapolated(coarse: Solution, fine: Solution) -> FloatArray:
    return np.asarray((4.0 * fine.tension - coarse.tension) / 3.0)


def error(tension: FloatArray) -> float:
    """RMS over the RMS of the dynamic part, the worse end; reference from 400 and 800 cells."""
    reference = extrapolated(condition(0.18, 400, False), condition(0.18, 800, False))
    rows = min(tension.shape[0], reference.shape[0])
    dynamic = np.sqrt(np.mean((reference[:rows] - reference[0]) ** 2, axis=0))
    return float(np.max(np.sqrt(np.mean((tension[:rows] - reference[:rows]) ** 2, axis=0)) / dynamic))


def test_order_and_error_without_viscosity() -> None:
    errors = [error(condition(0.18, cells, False).tension) for cells in (50, 100, 200)]
    assert errors[1] < 2.5e-3
    assert np.log2(np.array(errors[:-1]) / errors[1:]) == pytest.approx(2.0, abs=0.1)


def test_extrapolation_is_of_fourth_order() -> None:
    assert error(extrapolated(condition(0.18, 50, False), condition(0.18, 100, False))) < 1e-4


def test_order_and_error_with_limited_viscosity() -> None:
    exact = extrapolated(condition(0.18, 400, True), condition(0.18, 800, True))
    errors = []
    for cells in (50, 100, 200, 400):
        tension = condition(0.18, cells, True).tension
        dynamic = np.sqrt(np.mean((exact - exact[0]) ** 2, axis=0))
        errors.append(float(np.max(np.sqrt(np.mean((tension - exact) ** 2, axis=0)) / dynamic)))
    assert errors[1] < 3.5e-3
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.mean(orders) == pytest.approx(2.0, abs=0.1)
    assert np.all(np.abs(orders - 2.0) < 0.2)


def test_a_million_steps_near_resonance_stay_bounded() -> None:
    """The start overshoots to 204 N and settles at 138 N; without viscosity the run pumps itself to 1e5 N."""
    scene = scene_of(0.2, 0.9)
    scene = replace(scene, output=replace(scene.output, duration=44800.0, rate=0.1))
    solution = run_chain(scene, 50, courant=0.9)
    assert solution.steps_done == solution.steps > 990_000
    highest = solution.field.maximum.max(axis=1)
    assert np.max(highest) < 210.0
    assert np.max(highest[-48:]) == pytest.approx(138.0, abs=1.0)
