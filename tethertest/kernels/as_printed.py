"""The paper's difference scheme (48)-(55): both families of characteristics from the same nodes.

Its axial wave runs at ``ct``, not at ``c1``: see `tethertest.solver.linear.as_printed`. The variables are
those of `tethertest.kernels.two_grid`, on one grid of ``n`` cells ``ds = ct dt``.
"""

from __future__ import annotations

import numpy as np

from tethertest.kernels.jit import compiled
from tethertest.kernels.two_grid import FloatArray, Record, Tension, fresh_memory, keep_level


@compiled
def step_printed(
    axial: FloatArray,
    transverse: FloatArray,
    turn: float,
    ratio: float,
    next_axial: FloatArray,
    next_transverse: FloatArray,
) -> None:
    """Take one step; the new velocities of the ends must stand in the arrays to be filled.

    Parameters
    ----------
    axial, transverse : (2, n + 1) float64
        v and ``g = c eps``.
    turn : float
        ``kappa ds``.
    ratio : float
        ``c1/ct``.
    next_axial, next_transverse : (2, n + 1) float64
        Filled but for the ends' velocities.
    """
    n = axial.shape[1] - 1
    for i in range(n + 1):
        below, above = max(i - 1, 0), min(i + 1, n)
        rising = axial[0, below] - axial[1, below] + turn * (transverse[0, below] - transverse[1, below])
        falling = axial[0, above] + axial[1, above] - turn * (transverse[0, above] + transverse[1, above])
        climbing = transverse[0, below] - transverse[1, below]
        climbing += turn * (ratio * axial[1, below] - axial[0, below])
        sinking = transverse[0, above] + transverse[1, above]
        sinking += turn * (ratio * axial[1, above] + axial[0, above])
        if i == 0:
            next_axial[1, i] = falling - next_axial[0, i]
            next_transverse[1, i] = sinking - next_transverse[0, i]
        elif i == n:
            next_axial[1, i] = next_axial[0, i] - rising
            next_transverse[1, i] = next_transverse[0, i] - climbing
        else:
            next_axial[0, i], next_axial[1, i] = 0.5 * (falling + rising), 0.5 * (falling - rising)
            next_transverse[0, i] = 0.5 * (sinking + climbing)
            next_transverse[1, i] = 0.5 * (sinking - climbing)


@compiled
def march_printed(
    bottom: FloatArray,
    turn: float,
    ratio: float,
    tension: Tension,
    steps_in: tuple[float, float],
    record: Record,
) -> int:
    """March from rest with a fixed top and fill the record.

    Parameters
    ----------
    bottom : (k + 1, 2) float64
        Velocity of the bottom end along tangent and normal at time levels 0 .. k [m/s].
    turn, ratio : float
        As `step_printed`.
    tension : Tension
        Material.
    steps_in : (float, float)
        The step in time [s] and the cell [m].
    record : Record
        Filled in place.

    Returns
    -------
    int
        Number of steps done; less than ``k`` if the solution stopped being finite.
    """
    nodes = record.station.below.size
    axial, next_axial = np.zeros((2, nodes)), np.zeros((2, nodes))
    transverse, next_transverse = np.zeros((2, nodes)), np.zeros((2, nodes))
    axial[0, 0], axial[1, 0] = bottom[0, 0], -bottom[0, 0]
    transverse[0, 0], transverse[1, 0] = bottom[0, 1], -bottom[0, 1]
    memory, top, steps = fresh_memory(record), np.zeros(2), bottom.shape[0] - 1
    for k in range(steps + 1):
        if k > 0:
            next_axial[0, 0], next_transverse[0, 0] = bottom[k]
            step_printed(axial, transverse, turn, ratio, next_axial, next_transverse)
            axial, next_axial = next_axial, axial
            transverse, next_transverse = next_transverse, transverse
        keep_level(k, k == steps, axial, transverse, top, tension, steps_in, record, memory)
        if not np.isfinite(axial[1, 0] + axial[1, -1] + transverse[1, 0] + transverse[1, -1]):
            return int(max(0, k - 1))
    return int(steps)
