"""March of a cable on its material mesh, taut or slack, on a line, in a plane or in space.

Leapfrog on the mesh of the axial characteristics: at Courant number 1 and without viscosity every axial
characteristic runs from node to node and the scheme is d'Alembert's solution axially. Slope-limited linear
viscosity makes re-tightening lose the energy that the bilinear law demands; a slack cell carries no force at
all. Positions live at the time levels, velocities half a step earlier.

Shapes as in `tethertest.kernels.cells`; ``n + 2`` stations (bottom end, cell centres, top end), ``g`` gauges,
``k`` steps. SI units.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tethertest.kernels.cells import (
    FloatArray,
    bend_nodes,
    damp_cells,
    drag_nodes,
    pull_cells,
    pull_cells_elastic,
    pull_plane,
    stretch_cells,
)
from tethertest.kernels.jit import compiled
from tethertest.kernels.record import Record, sample_motion, sample_tension, widen


class Line(NamedTuple):
    """The discrete cable and the air's hold on it."""

    cell: float  #: unstretched cell length [m]
    mass: float  #: unstretched mass per length [kg/m]
    stiffness: float  #: EA [N]
    damping_time: float  #: Kelvin-Voigt [s]
    #: weight of the new rate of stretch in the damping: 0 explicit, which limits the time step, 1/2 centred
    #: and of second order, 1 backward, which suits slack cables
    implicit: float
    viscosity: float  #: C1 of the limited linear viscosity
    bending: float  #: EI [N m^2]
    gravity: FloatArray  #: (d,) [m/s^2], negative downwards
    normal_drag: float  #: force per unstretched length and velocity squared [N s^2/m^3]
    tangential_drag: float  #: [N s^2/m^3]


class UpperEnd(NamedTuple):
    """The upper end: fixed, or a mass under constant lift with a position loop about its rest position."""

    fixed: bool
    mass: float  #: [kg]
    lift: FloatArray  #: (d,) [N]
    stiffness: FloatArray  #: (d,) [N/m]
    damping: FloatArray  #: (d,) [N s/m]
    body_axes: FloatArray  #: (3, d) or empty: the body's x, y and z axes; x and y share the speed across z
    body_drag: FloatArray  #: (3,) or empty: force per velocity squared along them [N s^2/m^2]


@compiled
def march(
    bottom: FloatArray,
    direction: FloatArray,
    position: FloatArray,
    line: Line,
    top: UpperEnd,
    wind: FloatArray,
    time_step: float,
    record: Record,
) -> int:
    """March from rest and fill the record.

    Parameters
    ----------
    bottom : (k + 2,) float64
        Prescribed bottom displacement from rest at time levels 0 .. k + 1 [m].
    direction : (d,) float64
        Unit vector of that displacement.
    position : (d, n + 1) float64
        Rest positions; in place, the last positions on return.
    line, top : Line, UpperEnd
        Material, air and upper end.
    wind : (d, 1) or (d, k + 2) float64
        Steady, or at the time levels [m/s].
    time_step : float
        [s].
    record : Record
        Filled in place.

    Returns
    -------
    int
        Number of steps done; less than ``k`` if a position stopped being finite.
    """
    d, n = position.shape[0], position.shape[1] - 1
    steps = bottom.size - 2
    per_cell, per_step = 1.0 / line.cell, 1.0 / time_step
    per_mass = time_step / (line.mass * line.cell)
    half_mass = 0.5 * line.mass * line.cell
    wave_speed = np.sqrt(line.stiffness / line.mass)
    damping = 0.0 if line.implicit > 0.0 else line.stiffness * line.damping_time * per_step
    viscosity = line.viscosity * line.mass * wave_speed * line.cell * per_step
    lossless = damping == 0.0 and viscosity == 0.0
    windy = line.normal_drag > 0.0 or line.tangential_drag > 0.0 or top.body_drag.size > 0
    loaded = windy or line.bending > 0.0
    lean = lossless and not loaded and d == 2 and record.rows.shape[2] == 2 and line.implicit == 0.0
    lift, end_stiffness, end_damping, gravity = top.lift, top.stiffness, top.damping, line.gravity
    body_axes, body_drag, rows, tops = top.body_axes, top.body_drag, record.rows, record.top
    field_maximum, field_minimum = record.field_maximum, record.field_minimum
    gauge_index, gauge_weight = record.gauge_index, record.gauge_weight
    fall = time_step * gravity
    start, rest = position[:, 0].copy(), position[:, n].copy()
    velocity, old_end = np.zeros((d, n + 1)), np.zeros(d)
    scratch = (np.zeros((d, n + 1)), np.zeros(n + 1), np.zeros(n + 1), np.zeros(n + 1))
    load = np.zeros((d, n + 1))  #: force per node that depends on shape and motion
    along, force = np.zeros((d, n)), np.zeros((d, n))
    stretch, rate, work = np.zeros(n), np.zeros(n + 2), np.zeros((5, n))
    slip = np.zeros(3)
    end_share, end_mass = np.zeros(d), np.full(d, top.mass + half_mass)
    if not top.fixed:
        end_mass += 0.5 * time_step * top.damping
        end_share[:] = time_step / end_mass
    pull, pushed, gust = np.zeros(d), np.zeros(d), wind[:, 0].copy()
    station = np.zeros(n + 2)
    levels, older = np.zeros((d, n + 1)), np.zeros((d, n + 1))  # velocities at the time level, one step ago
    now, last = np.zeros((rows.shape[1], rows.shape[2])), np.zeros((rows.shape[1], rows.shape[2]))
    highest, lowest = np.full(n + 2, -np.inf), np.full(n + 2, np.inf)
    for c in range(d):
        position[c, 0] = start[c] + bottom[0] * direction[c]
    stretch_cells(position, per_cell, stretch, rate, along)
    before, last_top = bottom[1], position[d - 1, n]  # the motion goes on backwards as its mirror image
    row, bin_number, bin_end, next_row = 0, 0, record.bin_steps, 0.0
    for k in range(steps):
        if lean:
            pull_plane(position, per_cell, line.stiffness, stretch, station, force)
        elif lossless:
            stretch_cells(position, per_cell, stretch, rate, along)
            pull_cells_elastic(stretch, line.stiffness, along, station, force)
        else:
            stretch_cells(position, per_cell, stretch, rate, along)
            pull_cells(stretch, rate, line.stiffness, damping, viscosity, station)
            for c in range(d):
                for i in range(n):
                    force[c, i] = along[c, i] * station[i + 1]
        # a sudden start has its speed from the first instant on
        bottom_speed = (0.5 * (bottom[k + 1] - before) if k > 0 else bottom[1] - bottom[0]) * per_step
        if wind.shape[1] > 1:
            for c in range(d):
                gust[c] = wind[c, k]
        if loaded:
            if windy:
                for c in range(d):
                    for i in range(1, n + 1):
                        levels[c, i] = 1.5 * velocity[c, i] - 0.5 * older[c, i]
                        older[c, i] = velocity[c, i]
                    levels[c, 0] = bottom_speed * direction[c]
                drag_nodes(
                    along, levels, gust, line.normal_drag, line.tangential_drag, line.cell, *scratch, load
                )
            else:
                load[:] = 0.0
            if line.bending > 0.0:
                bend_nodes(position, line.bending * per_cell**3, scratch[1], load)

        for c in range(d):
            old_end[c] = velocity[c, n]
        if not top.fixed:
            for c in range(d):
                pull[c] = lift[c] + (top.mass + half_mass) * gravity[c] + load[c, n]
                pull[c] -= force[c, n - 1] + end_stiffness[c] * (position[c, n] - rest[c])
            for j in range(body_drag.size):
                slip[j] = 0.0
                for c in range(d):
                    slip[j] += body_axes[j, c] * (gust[c] - levels[c, n])
            across = np.sqrt(slip[0] * slip[0] + slip[1] * slip[1])  # the body is round about its z axis
            for j in range(body_drag.size):
                push = body_drag[j] * (abs(slip[j]) if j == 2 else across) * slip[j]
                for c in range(d):
                    pull[c] += push * body_axes[j, c]
            for c in range(d):
                brake = time_step * end_damping[c] / end_mass[c]
                velocity[c, n] += time_step * pull[c] / end_mass[c] - brake * velocity[c, n]
        for c in range(d):
            drop = fall[c]
            if loaded:
                for i in range(1, n):
                    velocity[c, i] += per_mass * (force[c, i] - force[c, i - 1] + load[c, i]) + drop
            elif lean:  # nothing looks at the positions any more
                for i in range(1, n):
                    velocity[c, i] += per_mass * (force[c, i] - force[c, i - 1]) + drop
                    position[c, i] += time_step * velocity[c, i]
            else:
                for i in range(1, n):
                    velocity[c, i] += per_mass * (force[c, i] - force[c, i - 1]) + drop
        if line.implicit > 0.0:
            for c in range(d):
                velocity[c, 0] = (bottom[k + 1] - bottom[k]) * per_step * direction[c]
            gain = line.implicit * line.stiffness * line.damping_time * per_cell
            lag = (1.0 - line.implicit) / line.implicit * line.cell * per_step
            damp_cells(along, velocity, rate, gain, lag, per_mass, end_share, work, station, force)

        # momentum of the half cells at the ends; a slack cell's, or one that would push, is no tension
        shake = (bottom[k + 1] - 2.0 * bottom[k] + before) * per_step * per_step
        for c in range(d):
            pull[c] = force[c, 0] - half_mass * (shake * direction[c] - gravity[c]) + load[c, 0]
            gained = (velocity[c, n] - old_end[c]) * per_step
            pushed[c] = force[c, n - 1] + half_mass * (gained - gravity[c]) - load[c, n]
        station[0] = end_tension(pull, force, 0)
        station[n + 1] = end_tension(pushed, force, n - 1)

        widen(station, highest, lowest)
        if k + 1 == bin_end or k + 1 == steps:
            for i in range(n + 2):
                field_maximum[bin_number, i] = highest[i]
                field_minimum[bin_number, i] = lowest[i]
            for i in range(n + 2):
                highest[i] = lowest[i] = station[i]  # a front between two bins belongs to both
            bin_number += 1
            bin_end += record.bin_steps
        due = next_row <= k * time_step * (1.0 + 1e-12)
        sampled = due or next_row <= (k + 1) * time_step * (1.0 + 1e-12)
        if sampled:
            if now.shape[1] > 2:
                for c in range(d):
                    for i in range(1, n):
                        gain = per_mass * (force[c, i] - force[c, i - 1] + load[c, i]) + fall[c]
                        levels[c, i] = velocity[c, i] - 0.5 * gain
                    levels[c, 0] = bottom_speed * direction[c]
                    levels[c, n] = 0.5 * (velocity[c, n] + old_end[c])
                places = (record.node_index, record.node_weight)
                sample_motion(places, position, levels, along, stretch, line.cell, now)
            sample_tension(gauge_index, gauge_weight, station, stretch, line.stiffness, now)
        while due and row < tops.size:
            weight = min(1.0, max(0.0, 1.0 - (k - next_row * per_step))) if k > 0 else 1.0
            if record.interval == 0.0:
                weight = 1.0
            for g in range(now.shape[0]):
                for m in range(now.shape[1]):
                    rows[row, g, m] = last[g, m] + weight * (now[g, m] - last[g, m])
            tops[row] = last_top + weight * (position[d - 1, n] - last_top)
            row += 1
            next_row = row * record.interval
            due = record.interval > 0.0 and next_row <= k * time_step * (1.0 + 1e-12)
        if sampled:
            now, last = last, now
        last_top = position[d - 1, n]

        before = bottom[k]
        for c in range(d):
            if not lean:
                for i in range(1, n):
                    position[c, i] += time_step * velocity[c, i]
            position[c, n] += time_step * velocity[c, n]
            position[c, 0] = start[c] + bottom[k + 1] * direction[c]
        if not np.isfinite(station[0] + station[n + 1] + position[d - 1, 1] + position[d - 1, n]):
            return k
    return steps


@compiled
def end_tension(balance: FloatArray, force: FloatArray, cell: int) -> float:
    """Return the tension at an end from its half cell's momentum balance; none where the cell has none.

    Parameters
    ----------
    balance : (d,) float64
        Force at the end [N].
    force : (d, n) float64
        Force in the cells [N].
    cell : int
        The cell beside the end.
    """
    square, along = 0.0, 0.0
    for c in range(balance.size):
        square += balance[c] * balance[c]
        along += balance[c] * force[c, cell]
    return float(np.sqrt(square)) if along > 0.0 else 0.0
