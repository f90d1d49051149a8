"""Where the ends of the quasi-static cable are, and the force between them, at every row of time."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from tethertest.errors import DataError
from tethertest.records.arrays import FloatArray
from tethertest.records.scene import MeasuredMotion, Scene
from tethertest.solver.motion import displacement
from tethertest.solver.quasi_static.rest_case import RestCase

IndexArray: TypeAlias = npt.NDArray[np.intp]

#: rows per period of the drive; second differences then miss 0.1 % of an acceleration
_ROWS_PER_PERIOD = 64
#: passes with the platform's acceleration and velocity from the pass before
_PASSES = 2
#: rows beyond the record's end, so that its last accelerations are central differences too
_BEYOND = 2 * (_PASSES + 1)
#: largest imbalance of the platform, relative to the force at rest
_BALANCED = 1e-9
_ITERATIONS = 60
_HALVINGS = 30


@dataclass(frozen=True, slots=True, eq=False)
class MovedEnds:
    """Rows of the quasi-static solution."""

    time: FloatArray  #: (n,) [s], evenly spaced
    every: int  #: rows between two output times
    bottom: FloatArray  #: (n, 3) displacement from rest [m]
    top: FloatArray  #: (n, 3) displacement from rest [m]
    force: FloatArray  #: (n, 3) of the cable on its bottom end, up the cable [N]

    @property
    def interval(self) -> float:
        """Time between rows [s]."""
        return float(self.time[1] - self.time[0])


def moved_ends(scene: Scene, case: RestCase, measured: MeasuredMotion | None = None) -> MovedEnds:
    """Return the ends and the force between them over the scene's duration.

    The rows are the output times, with as many rows between them as 64 per period of the drive ask for.
    A platform carries its own inertia and half of the cable's, as the force ``(M + m/2) a``, and its hover
    damping, from acceleration and velocity of the pass before: two passes after the one without.

    Raises
    ------
    DataError
        No equilibrium was found somewhere, or the motion is incomplete.
    """
    output = scene.output
    per_output = _ROWS_PER_PERIOD * (scene.bottom.frequency or 0.0) / output.rate
    every = max(1, math.ceil(per_output - 1e-9))
    outputs = max(1, math.floor(output.duration * output.rate + 1e-9))
    rows = outputs * every + 1
    time = np.arange(rows + _BEYOND * case.platform, dtype=np.float64) / (output.rate * every)
    moved = displacement(scene.bottom, time, measured)
    bottom = (moved - moved[0])[:, None] * case.direction
    if not case.platform:
        return MovedEnds(time, every, bottom, np.zeros_like(bottom), case.cable.between(case.chord - bottom))
    inertia = case.body_mass + 0.5 * case.mass * case.cable.length
    force = np.broadcast_to(case.force, bottom.shape)
    pull = np.broadcast_to(case.top_force, bottom.shape)
    for _ in range(_PASSES + 1):
        force = _balance(case, bottom, pull, force)
        top = bottom + case.cable.position(force, np.ones(1))[:, 0] - case.chord
        velocity, acceleration = rates(top, float(time[1]))
        pull = case.top_force - inertia * acceleration - case.hover_damping * velocity
    return MovedEnds(time[:rows], every, bottom[:rows], top[:rows], force[:rows])


def rates(position: FloatArray, interval: float) -> tuple[FloatArray, FloatArray]:
    """Return velocity and acceleration (n, ...) of rows that start from rest; both vanish in row 0.

    A velocity that jumps at the start is an acceleration in row 1 of the right impulse.
    """
    before = np.concatenate([position[:1], position[:-1]])
    after = np.concatenate([position[1:], 2.0 * position[-1:] - position[-2:-1]])
    velocity = (after - before) / (2.0 * interval)
    acceleration = (after - 2.0 * position + before) / interval**2
    acceleration[1] += acceleration[0]
    velocity[0], acceleration[0] = 0.0, 0.0
    acceleration[-1] = acceleration[-2]
    return velocity, acceleration


def _balance(case: RestCase, bottom: FloatArray, pull: FloatArray, start: FloatArray) -> FloatArray:
    """Return the bottom forces (n, 3) for which cable, pull and hover spring balance on the platform.

    Newton's method on the sum of forces, each step halved until that sum has shrunk.
    """
    cable, spring = case.cable, case.hover_stiffness
    hanging = cable.length * cable.load

    def imbalance(force: FloatArray, rows: IndexArray) -> FloatArray:
        away = bottom[rows] + cable.position(force, np.ones(1))[:, 0] - case.chord
        return np.asarray(force - hanging - pull[rows] + spring * away)

    force = pull + hanging if not np.any(spring) else start.copy()
    residual = imbalance(force, np.arange(force.shape[0]))
    allowed = _BALANCED * float(np.linalg.norm(case.top_force))
    size = np.linalg.norm(residual, axis=1)
    for _ in range(_ITERATIONS):
        rows = np.flatnonzero(size > 1e-2 * allowed)
        if rows.size == 0:
            break
        slope = np.eye(3) + spring[:, None] * cable.flexibility(force[rows])
        step = -np.linalg.solve(slope, residual[rows][..., None])[..., 0]
        share = np.ones(rows.size)
        for _ in range(_HALVINGS):
            trial = force[rows] + share[:, None] * step
            new = imbalance(trial, rows)
            new_size = np.linalg.norm(new, axis=1)
            smaller = new_size <= (1.0 - 1e-4 * share) * size[rows]
            if np.all(smaller):
                break
            share = np.where(smaller, share, 0.5 * share)
        kept = rows[smaller]
        force[kept], residual[kept], size[kept] = trial[smaller], new[smaller], new_size[smaller]
        if kept.size == 0:
            break
    if not np.all(size <= allowed):
        failed = np.count_nonzero(~(size <= allowed))
        message = f"the quasi-static platform finds no balance in {failed} of {size.size} rows"
        raise DataError(message, "use --fidelity nonlinear, or a smaller motion")
    return force
