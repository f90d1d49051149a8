"""Cell forces of the march against a manufactured motion: tension, curvature and gravity vary.

Oracle 11: a motion r(S, t) is chosen, the force that it needs beside the cable's own follows exactly, and the
leapfrog under both must return the motion at second order.
"""

from __future__ import annotations

import numpy as np
import pytest

from tethertest.kernels.cells import pull_cells_elastic, stretch_cells
from tethertest.records.arrays import FloatArray

LENGTH, MASS, STIFFNESS, GRAVITY = 2.0, 0.7, 60.0, 9.81
SWING, DURATION = 3.0, 0.6


def place(arc: FloatArray, time: float) -> FloatArray:
    x = 1.3 * arc + 0.05 * np.sin(2.0 * arc) * np.cos(SWING * time)
    z = 0.2 * arc**2 + 0.04 * np.cos(1.5 * arc) * np.sin(SWING * time)
    return np.stack([x, z])


def slope(arc: FloatArray, time: float) -> FloatArray:
    x = 1.3 + 0.1 * np.cos(2.0 * arc) * np.cos(SWING * time)
    z = 0.4 * arc - 0.06 * np.sin(1.5 * arc) * np.sin(SWING * time)
    return np.stack([x, z])


def bend(arc: FloatArray, time: float) -> FloatArray:
    x = -0.2 * np.sin(2.0 * arc) * np.cos(SWING * time)
    z = 0.4 - 0.09 * np.cos(1.5 * arc) * np.sin(SWING * time)
    return np.stack([x, z])


def acceleration(arc: FloatArray, time: float) -> FloatArray:
    x = -0.05 * SWING**2 * np.sin(2.0 * arc) * np.cos(SWING * time)
    z = -0.04 * SWING**2 * np.cos(1.5 * arc) * np.sin(SWING * time)
    return np.stack([x, z])


def missing_force(arc: FloatArray, time: float) -> FloatArray:
    """Force per length and mass per length that the motion needs beside ``(T p/|p|),S / rl + g``."""
    p, turned = slope(arc, time), bend(arc, time)
    size = np.linalg.norm(p, axis=0)
    cable = (1.0 - 1.0 / size) * turned + np.sum(p * turned, axis=0) / size**3 * p
    own = STIFFNESS * cable / MASS + np.array([[0.0], [-GRAVITY]])
    return np.asarray(acceleration(arc, time) - own)


def error(cells: int) -> float:
    arc, cell = np.linspace(0.0, LENGTH, cells + 1), LENGTH / cells
    steps = int(np.ceil(DURATION / (0.5 * cell * np.sqrt(MASS / STIFFNESS))))
    step = DURATION / steps
    position = np.ascontiguousarray(place(arc, 0.0))
    velocity = (position - place(arc, -step)) / step
    stretch, rate, along = np.ones(cells), np.zeros(cells + 2), np.zeros((2, cells))
    tension, force = np.zeros(cells + 2), np.zeros((2, cells))
    for k in range(steps):
        stretch_cells(position, 1.0 / cell, stretch, rate, along)
        pull_cells_elastic(stretch, STIFFNESS, along, tension, force)
        pull = np.diff(force, axis=1) / (MASS * cell) + missing_force(arc[1:-1], k * step)
        pull[1] -= GRAVITY
        velocity[:, 1:-1] += step * pull
        position[:, 1:-1] += step * velocity[:, 1:-1]
        position[:, [0, -1]] = place(arc[[0, -1]], (k + 1) * step)
    assert np.min(tension[1:-1]) > 0.2 * np.max(tension)
    assert np.ptp(tension[1:-1]) > 3.0
    return float(np.max(np.abs(position - place(arc, DURATION))))


def test_a_manufactured_motion_under_gravity_is_met_at_second_order() -> None:
    errors = [error(cells) for cells in (20, 40, 80)]
    assert errors[0] < 1e-3
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert orders == pytest.approx(2.0, abs=0.15)
