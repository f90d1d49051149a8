"""Finite volumes with the taut-slack Riemann solver against root finding and the exact snap fronts."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

from tethertest.bench.finite_volumes import kernel as muscl
from tethertest.bench.finite_volumes.kernel import MusclCable, MusclRecord, MusclTop
from tethertest.bench.finite_volumes.march import run_axial_muscl
from tethertest.records.cable import Cable
from tethertest.records.scene import Bottom, Geometry, Output, Scene, Top

STIFFNESS, MASS, LENGTH = 10020.0, 0.0484, 3.0
SPEED, IMPEDANCE = math.sqrt(STIFFNESS / MASS), math.sqrt(STIFFNESS * MASS)

SNAP = Scene(
    name="vertical snap",
    cable=Cable(150.0, "unstretched", MASS, axial_stiffness=STIFFNESS),
    geometry=Geometry("vertical", tension=50.0),
    bottom=Bottom("harmonic", amplitude=2.0, frequency=0.2, start="ramp", ramp=10.0),
    top=Top("fixed"),
    output=Output(40.0, 1000.0, (0.0, 1.0)),
)


def side(strain: float, stretch: float, speed: float) -> float:
    """Return how much slower a side moves towards its neighbour when its strain becomes ``strain``."""
    if stretch >= 1.0:
        return speed * (strain - (stretch - 1.0))
    return speed * math.sqrt(strain * (strain + 1.0 - stretch))


@pytest.mark.parametrize("seed", range(200))
def test_riemann_solver_against_root_finding(seed: int) -> None:
    """Jump conditions s [p] = -[V], rl s [V] = -[T] on either side; wave speed 1."""
    random = np.random.default_rng(seed)
    below, above = random.normal(scale=0.1, size=2)
    stretches = 1.0 + random.choice([-1.0, 1.0], 2) * 10.0 ** random.uniform(-4.0, -0.5, 2)

    def gap(strain: float) -> float:
        return (above - side(strain, stretches[1], 1.0)) - (below + side(strain, stretches[0], 1.0))

    velocity, strain = muscl.riemann(below, stretches[0], above, stretches[1], 1.0)
    if gap(0.0) <= 0.0:
        assert strain == 0.0
        ends = below + side(0.0, stretches[0], 1.0), above - side(0.0, stretches[1], 1.0)
        assert velocity == pytest.approx(0.5 * sum(ends), abs=1e-15)
    else:
        exact = brentq(gap, 0.0, 10.0, xtol=1e-16, rtol=8.9e-16, maxiter=500)
        assert strain == pytest.approx(exact, abs=1e-14)
        assert velocity == pytest.approx(below + side(exact, stretches[0], 1.0), abs=1e-14)


@pytest.mark.parametrize("seed", range(50))
def test_end_strain_against_root_finding(seed: int) -> None:
    random = np.random.default_rng(seed)
    pull = random.normal(scale=0.1)
    stretch = 1.0 + random.choice([-1.0, 1.0]) * 10.0 ** random.uniform(-4.0, -0.5)
    found = muscl.wall_strain(pull, stretch)
    if side(0.0, stretch, 1.0) >= pull:
        assert found == 0.0
    else:
        exact = brentq(lambda e: side(e, stretch, 1.0) - pull, 0.0, 10.0, xtol=1e-16, rtol=8.9e-16)
        assert found == pytest.approx(exact, abs=1e-14)


def pulled_slack_cable(slack: float, speed: float, cells: int) -> tuple[np.ndarray, np.ndarray]:
    """Pull the bottom end of a slack cable at rest downwards; tension mid-cable and at the fixed top."""
    cell = LENGTH / cells
    step = 0.4 * cell / SPEED
    strain = 0.5 * (-slack + math.sqrt(slack**2 + 4 * speed**2 / SPEED**2))
    steps = int(1.5 * LENGTH * (strain + slack) / speed / step)
    bottom = -speed * step * np.maximum(0.0, np.arange(-1, steps + 3))
    record = MusclRecord(
        1,
        steps + 1,
        np.array([cells // 2, cells], dtype=np.int64),
        np.array([0.0, 1.0]),
        np.zeros((steps + 1, 2)),
        np.zeros((steps + 1, 2)),
        np.zeros(steps + 1),
        np.full((1, cells + 2), -np.inf),
        np.full((1, cells + 2), np.inf),
    )
    cable = MusclCable(cell, MASS, STIFFNESS, 0.0, 0.0, 0.0)
    top = MusclTop(True, 0.0, 0.0, 0.0, 0.0)
    assert muscl.march_muscl(bottom, np.full(cells, 1.0 - slack), cable, top, step, record) == steps
    return step * np.arange(steps + 1), record.tension


@pytest.mark.parametrize(("slack", "speed"), [(1e-4, 1.0), (1e-3, 1.0), (1e-2, 1.0), (0.05, 2.5)])
def test_front_and_fixed_end_plateau_are_exact(slack: float, speed: float) -> None:
    strain = 0.5 * (-slack + math.sqrt(slack**2 + 4 * speed**2 / SPEED**2))
    tension, front = STIFFNESS * strain, speed / (strain + slack)
    time, found = pulled_slack_cable(slack, speed, 400)
    before = (time > 0.7 * LENGTH / front) & (time < 0.95 * LENGTH / front)
    assert np.mean(found[before, 0]) == pytest.approx(tension, rel=1e-3)
    assert np.all(found[before, 1] == 0.0)
    arrived = LENGTH / front
    plateau = (time > arrived + 0.25 * LENGTH / SPEED) & (time < arrived + 0.45 * LENGTH / SPEED)
    assert np.mean(found[plateau, 1]) == pytest.approx(tension + IMPEDANCE * speed, rel=1e-3)


def peaks(cells: int) -> tuple[float, float]:
    solution = run_axial_muscl(SNAP, cells)
    assert np.min(solution.field.minimum) == 0.0
    mean = np.convolve(solution.tension[:, 1], np.full(20, 0.05), "valid")
    return float(np.max(solution.field.maximum[:, -1])), float(np.max(mean))


def test_vertical_snap_at_320_cells_meets_the_published_334_9_newtons() -> None:
    """The scheme converges to 334 N; a scheme without dissipation says 417 N."""
    raw, mean = peaks(320)
    assert raw == pytest.approx(334.9, abs=0.5)
    assert mean == pytest.approx(332.9, abs=1.0)


@pytest.mark.verify
@pytest.mark.parametrize("cells", [640, 1280])
def test_vertical_snap_converges_to_334_newtons(cells: int) -> None:
    raw, mean = peaks(cells)
    assert raw == pytest.approx(334.0, abs=2.0)
    assert 331.4 <= mean <= 332.9


def test_damped_vertical_snap_peaks_at_305_newtons() -> None:
    scene = replace(SNAP, cable=replace(SNAP.cable, axial_damping_time=1e-3))
    peak = [np.max(run_axial_muscl(scene, cells).field.maximum[:, -1]) for cells in (80, 160)]
    assert peak == pytest.approx([305.3, 305.3], abs=1.5)
