"""Characteristics of the linear coupled cable on two grids, one for each wave speed.

In the energy variables ``v1, g1 = c1 eps1`` and ``v2, g2 = ct eps2`` the equations (30)-(33) are two string
equations, coupled by two rotations::

    v1,t = c1 g1,s - kappa ct g2      v2,t = ct g2,s + kappa c1 g1
    g1,t = c1 v1,s - kappa c1 v2      g2,t = ct v2,s + kappa ct v1

``v1`` turns with ``g2`` at ``kappa ct``, ``g1`` with ``v2`` at ``kappa c1``. The axial fields live on ``n1``
cells, the transverse ones on ``n2``, so that both waves run exactly one cell per step. The rotation of the
half steps takes the other grid's fields by the overlap of the two grids' hat functions. Seen in the two
grids' trapezoidal norms the transfers there and back are adjoint and neither enlarges: between fixed ends the
energy never grows, whatever the step, and what it loses is of second order.

Lengths in m, times in s, forces in N. Shapes: ``n1 + 1`` axial and ``n2 + 1`` transverse nodes, ``m`` pairs
of nodes that overlap, ``g`` gauges, ``k`` steps.
"""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt

from tethertest.kernels.jit import compiled

FloatArray: TypeAlias = npt.NDArray[np.float64]
IntArray: TypeAlias = npt.NDArray[np.int64]


class Overlap(NamedTuple):
    """Pairs of an axial and a transverse node whose hat functions overlap."""

    axial: IntArray  #: (m,)
    transverse: IntArray  #: (m,)
    axial_weight: FloatArray  #: (m,) share of the transverse node in the axial one; sums to 1
    transverse_weight: FloatArray  #: (m,) share of the axial node in the transverse one; sums to 1


class Body(NamedTuple):
    """One step of the top end's displacement and velocity ``y = (u1, u2, v1, v2)``; zeros where it is fixed.

    ``y`` becomes ``carry y + before a + after b`` with the waves ``v - g`` that arrive at both its ends.
    """

    carry: FloatArray  #: (4, 4)
    before: FloatArray  #: (4, 2)
    after: FloatArray  #: (4, 2)


class Tension(NamedTuple):
    """What turns the energy variables into tension."""

    rest: float  #: P [N]
    stiffness: float  #: EA [N]
    axial_speed: float  #: c1 [m/s]
    transverse_speed: float  #: ct [m/s]


class Place(NamedTuple):
    """Places between nodes."""

    below: IntArray  #: (g,) node below
    weight: FloatArray  #: (g,) weight of the node above


class Record(NamedTuple):
    """What is kept of the march, filled in place."""

    level: FloatArray  #: (rows,) time of each row over the step, ascending
    axial: Place  #: gauges on the axial grid
    transverse: Place  #: gauges on the transverse grid
    station: Place  #: axial nodes on the transverse grid
    gauges: FloatArray  #: (rows, g, 7) v1, g1, v2, g2 [m/s], g2,s [1/s], u1, u2 [m]
    top: FloatArray  #: (rows, 2) displacement of the top end [m]
    bin_steps: int  #: time levels per bin of the field
    field_maximum: FloatArray  #: (bins, n1 + 1) [N]
    field_minimum: FloatArray  #: (bins, n1 + 1) [N]


class Memory(NamedTuple):
    """What recording carries from one time level to the next."""

    now: FloatArray  #: (g, 7) as ``Record.gauges``
    last: FloatArray  #: (g, 7)
    last_top: FloatArray  #: (2,) [m]
    highest: FloatArray  #: (n1 + 1,) [N], of the bin so far
    lowest: FloatArray  #: (n1 + 1,) [N]
    written: IntArray  #: (2,) rows and bins written


@compiled
def couple(
    axial: FloatArray,
    transverse: FloatArray,
    overlap: Overlap,
    angles: tuple[float, float],
    on_axial: FloatArray,
    on_transverse: FloatArray,
) -> None:
    """Turn v1 with g2 and g1 with v2; the velocities of the ends stay, they belong to what holds them.

    Parameters
    ----------
    axial : (2, n1 + 1) float64
        v1 and g1; changed.
    transverse : (2, n2 + 1) float64
        v2 and g2; changed.
    overlap : Overlap
    angles : (float, float)
        ``kappa ct`` and ``kappa c1`` times the time that passes.
    on_axial, on_transverse : as axial and transverse
        Scratch: the other grid's fields.
    """
    on_axial[:] = 0.0
    on_transverse[:] = 0.0
    for pair in range(overlap.axial.size):
        i, j = overlap.axial[pair], overlap.transverse[pair]
        to_axial, to_transverse = overlap.axial_weight[pair], overlap.transverse_weight[pair]
        on_axial[0, i] += to_axial * transverse[0, j]
        on_axial[1, i] += to_axial * transverse[1, j]
        on_transverse[0, j] += to_transverse * axial[0, i]
        on_transverse[1, j] += to_transverse * axial[1, i]
    n1, n2 = axial.shape[1] - 1, transverse.shape[1] - 1
    slow_cosine, slow_sine = np.cos(angles[0]), np.sin(angles[0])
    fast_cosine, fast_sine = np.cos(angles[1]), np.sin(angles[1])
    for i in range(1, n1):
        axial[0, i] = slow_cosine * axial[0, i] - slow_sine * on_axial[1, i]
    for i in range(n1 + 1):
        axial[1, i] = fast_cosine * axial[1, i] - fast_sine * on_axial[0, i]
    for j in range(1, n2):
        transverse[0, j] = fast_cosine * transverse[0, j] + fast_sine * on_transverse[1, j]
    for j in range(n2 + 1):
        transverse[1, j] = slow_cosine * transverse[1, j] + slow_sine * on_transverse[0, j]


@compiled
def shift(field: FloatArray, bottom: float, top: float, shifted: FloatArray) -> None:
    """Let the waves ``v - g`` and ``v + g`` run one cell up and down.

    Parameters
    ----------
    field : (2, n + 1) float64
        v and g.
    bottom, top : float
        New velocities of the ends [m/s].
    shifted : (2, n + 1) float64
        Filled.
    """
    n = field.shape[1] - 1
    for i in range(1, n):
        rising = field[0, i - 1] - field[1, i - 1]
        falling = field[0, i + 1] + field[1, i + 1]
        shifted[0, i] = 0.5 * (falling + rising)
        shifted[1, i] = 0.5 * (falling - rising)
    shifted[0, 0] = bottom
    shifted[1, 0] = field[0, 1] + field[1, 1] - bottom
    shifted[0, n] = top
    shifted[1, n] = top - (field[0, n - 1] - field[1, n - 1])


@compiled
def complete_ends(axial: FloatArray, transverse: FloatArray, angles: tuple[float, float]) -> None:
    """Add to g at the ends the half step of coupling that the wave arriving there still lacks.

    The ends' velocities do not turn, so a wave reaches an end with only what turned ``g``. The wave that
    leaves lacks the opposite, and the march is right without this; the force at the end is not.

    Parameters
    ----------
    axial, transverse : (2, n + 1) float64
        v and g after a step; g of the ends changed.
    angles : (float, float)
        ``kappa ct`` and ``kappa c1`` times half a step.
    """
    for end, sign in ((0, -1.0), (-1, 1.0)):
        along, across = axial[1, end], transverse[1, end]
        axial[1, end] += sign * angles[0] * across
        transverse[1, end] -= sign * angles[1] * along


@compiled
def arrive(axial: FloatArray, transverse: FloatArray, angles: tuple[float, float], waves: FloatArray) -> None:
    """Fill the waves ``v - g`` (2,) [m/s] that reach the top in the coming shift, their coupling complete.

    Parameters are those of `complete_ends`, before the shift.
    """
    waves[0] = axial[0, -2] - axial[1, -2] - angles[0] * transverse[1, -1] + angles[1] * transverse[0, -1]
    waves[1] = transverse[0, -2] - transverse[1, -2] + angles[1] * axial[1, -1] - angles[0] * axial[0, -1]


@compiled
def move_body(body: Body, state: FloatArray, before: FloatArray, after: FloatArray) -> None:
    """Move the top end by one step, in place, under the waves that arrive at it.

    Parameters
    ----------
    body : Body
    state : (4,) float64
        u1, u2 [m], v1, v2 [m/s]; changed.
    before, after : (2,) float64
        ``v - g`` of both motions at the step's two ends [m/s].
    """
    first, second, third, fourth = state
    for row in range(4):
        carry = body.carry[row]
        total = carry[0] * first + carry[1] * second + carry[2] * third + carry[3] * fourth
        for column in range(2):
            total += body.before[row, column] * before[column] + body.after[row, column] * after[column]
        state[row] = total


@compiled
def march(
    bottom: FloatArray,
    overlap: Overlap,
    angles: tuple[float, float],
    body: Body,
    tension: Tension,
    steps_in: tuple[float, float],
    record: Record,
) -> int:
    """March from rest and fill the record.

    Parameters
    ----------
    bottom : (k + 1, 2) float64
        Velocity of the bottom end along tangent and normal at time levels 0 .. k [m/s].
    overlap : Overlap
    angles : (float, float)
        ``kappa ct`` and ``kappa c1`` times half a step.
    body, tension : Body, Tension
        The top end, and the material.
    steps_in : (float, float)
        The step in time [s] and the transverse cell [m].
    record : Record
        Filled in place.

    Returns
    -------
    int
        Number of steps done; less than ``k`` if the solution stopped being finite.
    """
    n1, n2 = record.station.below.size - 1, int(overlap.transverse.max())
    axial, next_axial, on_axial = np.zeros((2, n1 + 1)), np.zeros((2, n1 + 1)), np.zeros((2, n1 + 1))
    transverse, on_transverse = np.zeros((2, n2 + 1)), np.zeros((2, n2 + 1))
    next_transverse = np.zeros((2, n2 + 1))
    state, before, after = np.zeros(4), np.zeros(2), np.zeros(2)
    axial[0, 0], axial[1, 0] = bottom[0, 0], -bottom[0, 0]
    transverse[0, 0], transverse[1, 0] = bottom[0, 1], -bottom[0, 1]
    memory = fresh_memory(record)
    steps = bottom.shape[0] - 1
    for k in range(steps + 1):
        if k > 0:
            couple(axial, transverse, overlap, angles, on_axial, on_transverse)
            arrive(axial, transverse, angles, after)
            move_body(body, state, before, after)
            shift(axial, bottom[k, 0], state[2], next_axial)
            shift(transverse, bottom[k, 1], state[3], next_transverse)
            axial, next_axial = next_axial, axial
            transverse, next_transverse = next_transverse, transverse
            couple(axial, transverse, overlap, angles, on_axial, on_transverse)
        next_axial[:], next_transverse[:] = axial, transverse  # as seen from outside
        complete_ends(next_axial, next_transverse, angles)
        before[0] = axial[0, n1] - next_axial[1, n1]
        before[1] = transverse[0, n2] - next_transverse[1, n2]
        keep_level(k, k == steps, next_axial, next_transverse, state, tension, steps_in, record, memory)
        if not np.isfinite(axial[1, 0] + axial[1, n1] + transverse[1, 0] + transverse[1, n2]):
            return int(max(0, k - 1))
    return int(steps)


@compiled
def fresh_memory(record: Record) -> Memory:
    """Return what recording starts from."""
    gauges, stations = record.gauges.shape[1], record.station.below.size
    return Memory(
        np.zeros((gauges, 7)),
        np.zeros((gauges, 7)),
        np.zeros(2),
        np.full(stations, -np.inf),
        np.full(stations, np.inf),
        np.zeros(2, dtype=np.int64),
    )


@compiled
def keep_level(
    level: int,
    final: bool,
    axial: FloatArray,
    transverse: FloatArray,
    top: FloatArray,
    tension: Tension,
    steps_in: tuple[float, float],
    record: Record,
    memory: Memory,
) -> None:
    """Record one time level; rows that lie since the last one are linear in time.

    Parameters
    ----------
    level, final : int, bool
        Number of the level, and whether it is the last.
    axial, transverse : (2, n + 1) float64
        v and g.
    top : (2 or more,) float64
        Displacement of the top end [m].
    tension : Tension
        Material.
    steps_in : (float, float)
        The step in time [s] and the transverse cell [m].
    record, memory : Record, Memory
        Filled in place.
    """
    observe(axial, transverse, steps_in, record, memory)
    row, bin_number = memory.written
    while row < record.level.size and record.level[row] <= level:
        weight = 1.0 - (level - record.level[row])
        for g in range(memory.now.shape[0]):
            for part in range(memory.now.shape[1]):
                before = memory.last[g, part]
                record.gauges[row, g, part] = before + weight * (memory.now[g, part] - before)
        for part in range(2):
            before = memory.last_top[part]
            record.top[row, part] = before + weight * (top[part] - before)
        row += 1
    memory.last[:] = memory.now
    memory.last_top[:] = top[:2]
    widen(axial, transverse, tension, record.station, memory.highest, memory.lowest)
    if (level + 1) % record.bin_steps == 0 or final:
        record.field_maximum[bin_number] = memory.highest
        record.field_minimum[bin_number] = memory.lowest
        memory.highest[:], memory.lowest[:] = -np.inf, np.inf
        widen(axial, transverse, tension, record.station, memory.highest, memory.lowest)  # in both bins
        bin_number += 1
    memory.written[0], memory.written[1] = row, bin_number


@compiled
def observe(
    axial: FloatArray,
    transverse: FloatArray,
    steps_in: tuple[float, float],
    record: Record,
    memory: Memory,
) -> None:
    """Fill the gauges' values of this time level, linear between nodes; displacements add up.

    Parameters
    ----------
    axial, transverse : (2, n + 1) float64
        v and g.
    steps_in : (float, float)
        The step in time [s] and the transverse cell [m].
    record : Record
        Where the gauges are.
    memory : Memory
        ``last`` is known, ``now`` filled.
    """
    now, last = memory.now, memory.last
    half_step, per_cell = 0.5 * steps_in[0], 1.0 / steps_in[1]
    n2 = transverse.shape[1] - 1
    for g in range(now.shape[0]):
        i, upper = record.axial.below[g], record.axial.weight[g]
        now[g, 0] = (1.0 - upper) * axial[0, i] + upper * axial[0, i + 1]
        now[g, 1] = (1.0 - upper) * axial[1, i] + upper * axial[1, i + 1]
        j, upper = record.transverse.below[g], record.transverse.weight[g]
        now[g, 2] = (1.0 - upper) * transverse[0, j] + upper * transverse[0, j + 1]
        now[g, 3] = (1.0 - upper) * transverse[1, j] + upper * transverse[1, j + 1]
        first = min(max(j - 1, 0), n2 - 3)  # of four nodes, the gauge among them
        middle = transverse[1, first + 2] - transverse[1, first + 1]
        low = 0.5 * (middle + transverse[1, first + 1] - transverse[1, first])
        high = 0.5 * (middle + transverse[1, first + 3] - transverse[1, first + 2])
        slope = low + (j + upper - first - 1.0) * (high - low)
        now[g, 4] = slope * per_cell
        now[g, 5] = last[g, 5] + half_step * (last[g, 0] + now[g, 0])
        now[g, 6] = last[g, 6] + half_step * (last[g, 2] + now[g, 2])


@compiled
def widen(
    axial: FloatArray,
    transverse: FloatArray,
    tension: Tension,
    station: Place,
    highest: FloatArray,
    lowest: FloatArray,
) -> None:
    """Widen the extremes (n1 + 1,) [N] by the tension at the axial nodes."""
    per_axial, per_transverse = 1.0 / tension.axial_speed, 1.0 / tension.transverse_speed
    for i in range(highest.size):
        j, upper = station.below[i], station.weight[i]
        along = axial[1, i] * per_axial
        across = ((1.0 - upper) * transverse[1, j] + upper * transverse[1, j + 1]) * per_transverse
        pull = tension.rest + tension.stiffness * (along + 0.5 * (along * along + across * across))
        pull *= np.sqrt((1.0 + along) * (1.0 + along) + across * across)
        highest[i] = max(highest[i], pull)
        lowest[i] = min(lowest[i], pull)
