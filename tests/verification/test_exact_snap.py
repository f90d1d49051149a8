"""Taut-slack fronts against the closed form of the bilinear law, whose front loses energy."""

from __future__ import annotations

import math

import numpy as np
import pytest

from tethertest.kernels.march import Line, UpperEnd, march
from tethertest.kernels.record import Record
from tethertest.records.cable import Cable
from tethertest.records.scene import Bottom, Geometry, Output, Scene, Top
from tethertest.solver.nonlinear.chain_march import run_chain
from tethertest.solver.nonlinear.limits import VISCOSITY, courant_limit

STIFFNESS, MASS, LENGTH = 10020.0, 0.0484, 3.0


def pulled_slack_cable(slack: float, speed: float, cells: int) -> tuple[np.ndarray, np.ndarray]:
    """Pull the bottom end of a slack straight cable at rest downwards; tension at the fixed top over time."""
    cell, wave_speed = LENGTH / cells, math.sqrt(STIFFNESS / MASS)
    none, nothing = np.zeros(1), np.zeros((0, 1))
    line = Line(cell, MASS, STIFFNESS, 0.0, 0.0, VISCOSITY, 0.0, none, 0.0, 0.0)
    top = UpperEnd(True, 0.0, none, none, none, nothing, np.zeros(0))
    step = courant_limit(line, top) * cell / wave_speed
    strain = 0.5 * (-slack + math.sqrt(slack**2 + 4 * speed**2 / wave_speed**2))
    front = speed / (strain + slack)
    steps = int(1.5 * LENGTH / front / step)
    bottom = -speed * step * np.arange(steps + 2)
    position = (1.0 - slack) * cell * np.arange(cells + 1)[None]
    rows = steps - 2
    record = Record(
        step,
        steps,
        np.array([cells // 2, cells], dtype=np.int64),
        np.array([0.0, 1.0]),
        np.array([0, cells - 1], dtype=np.int64),
        np.ones(2),
        np.zeros((rows, 2, 2)),
        np.zeros(rows),
        np.full((1, cells + 2), -np.inf),
        np.full((1, cells + 2), np.inf),
    )
    assert march(bottom, np.ones(1), position, line, top, np.zeros((1, 1)), step, record) == steps
    return step * np.arange(rows), record.rows[..., 0]


@pytest.mark.parametrize(("slack", "speed"), [(1e-4, 1.0), (1e-3, 1.0), (1e-2, 1.0), (0.05, 2.5)])
def test_front_and_fixed_end_tension_are_exact(slack: float, speed: float) -> None:
    wave_speed, impedance = math.sqrt(STIFFNESS / MASS), math.sqrt(STIFFNESS * MASS)
    strain = 0.5 * (-slack + math.sqrt(slack**2 + 4 * speed**2 / wave_speed**2))
    tension, front = STIFFNESS * strain, speed / (strain + slack)
    fixed_end = tension + impedance * speed
    time, found = pulled_slack_cable(slack, speed, 400)
    before = (time > 0.7 * LENGTH / front) & (time < 0.95 * LENGTH / front)
    assert np.mean(found[before, 0]) == pytest.approx(tension, rel=2e-3)
    assert np.all(found[before, 1] == 0.0)  # slack carries no force at all
    arrived = LENGTH / front
    plateau = (time > arrived + 0.25 * LENGTH / wave_speed) & (time < arrived + 0.45 * LENGTH / wave_speed)
    assert np.mean(found[plateau, 1]) == pytest.approx(fixed_end, rel=2e-3)
    assert np.max(found[time < arrived + 0.45 * LENGTH / wave_speed, 1]) < 1.02 * fixed_end


def test_vertical_snap_meets_the_entropy_solution_and_not_the_one_without_dissipation() -> None:
    """150 m cable, 50 N, 2 m at 0.2 Hz: 20 ms mean peaks at 332 +- 3 N; a lossless scheme says 417 N."""
    scene = Scene(
        name="vertical snap",
        cable=Cable(150.0, "unstretched", 0.0484, axial_stiffness=STIFFNESS),
        geometry=Geometry("vertical", tension=50.0),
        bottom=Bottom("harmonic", amplitude=2.0, frequency=0.2, start="ramp", ramp=10.0),
        top=Top("fixed"),
        output=Output(40.0, 1000.0, (1.0,)),
    )
    tension = run_chain(scene, 1280).tension[:, 0]
    assert np.max(np.convolve(tension, np.full(20, 0.05), "valid")) == pytest.approx(332.0, abs=4.0)
