"""A body at the upper end of a line that carries waves: its motion, step by step.

The waves that come back to the body are its own motion and that of the lower end one round trip and one
traverse earlier, so within a step they are known; between the nodes of a step they are a polynomial, and the
body's answer to a polynomial is exact. Nothing is carried from step to step but the body's state.

Forces in N, velocities in m/s. Shapes: ``k`` steps, ``m`` nodes per step.
"""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt

from tethertest.kernels.jit import compiled

FloatArray: TypeAlias = npt.NDArray[np.float64]


class BodyStep(NamedTuple):
    """The body over one step, from its state (position, velocity) and the waves that arrive at the nodes."""

    round_trip: int  #: steps from the body to the lower end and back
    impedance: float  #: Z [N s/m]
    carry: FloatArray  #: (2, 2) state at the end of the step from that at its start
    gain: FloatArray  #: (2, m) state at the end from the arriving wave at the nodes
    node_carry: FloatArray  #: (m, 2) velocity at the nodes from the state at the start
    node_gain: FloatArray  #: (m, m) velocity at the nodes from the arriving wave there


@compiled
def march_body(sent: FloatArray, step: BodyStep, arriving: FloatArray, state: FloatArray) -> None:
    """Fill the waves that arrive at the body and the body's motion.

    Parameters
    ----------
    sent : (k, m) float64
        ``2 Z v0`` of the lower end one traverse before each node.
    step : BodyStep
        The body and the line.
    arriving : (k, m) float64
        Filled: ``T - Z v`` at the body.
    state : (k + 1, 2) float64
        Position and velocity of the body at the steps' ends, filled from row 1; row 0 is the start.
    """
    steps, nodes = sent.shape
    returned = np.zeros((steps, nodes))
    for k in range(steps):
        position, velocity = state[k, 0], state[k, 1]
        for i in range(nodes):
            before = returned[k - step.round_trip, i] if k >= step.round_trip else 0.0
            arriving[k, i] = before - sent[k, i]
        for i in range(nodes):
            moving = step.node_carry[i, 0] * position + step.node_carry[i, 1] * velocity
            for j in range(nodes):
                moving += step.node_gain[i, j] * arriving[k, j]
            returned[k, i] = arriving[k, i] + 2.0 * step.impedance * moving
        for row in range(2):
            total = step.carry[row, 0] * position + step.carry[row, 1] * velocity
            for j in range(nodes):
                total += step.gain[row, j] * arriving[k, j]
            state[k + 1, row] = total
