"""Axial march of a vertical or straight cable on its material mesh, taut or slack.

Leapfrog on the mesh of the axial characteristics: at Courant number 1 and without viscosity every
characteristic runs from node to node and the scheme is d'Alembert's solution. Slope-limited linear viscosity
(after Christensen) makes re-tightening lose the energy that the bilinear law demands. Positions live at the
time levels, velocities half a step earlier.

Lengths in m, times in s, forces in N, upwards positive. Shapes: ``n`` cells, ``n + 1`` nodes, ``n + 2``
stations (bottom end, cell centres, top end), ``g`` gauges, ``k`` steps.
"""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt

from tethertest.kernels.jit import compiled

FloatArray: TypeAlias = npt.NDArray[np.float64]
IntArray: TypeAlias = npt.NDArray[np.int64]


class Line(NamedTuple):
    """The discrete cable."""

    cell: float  #: unstretched cell length [m]
    mass: float  #: unstretched mass per length [kg/m]
    stiffness: float  #: EA [N]
    damping_time: float  #: Kelvin-Voigt [s]
    viscosity: float  #: C1 of the limited linear viscosity
    gravity: float  #: [m/s^2]
    drag: float  #: tangential drag force per length and velocity squared [N s^2/m^3]
    unilateral: bool  #: no force at all when slack


class TopEnd(NamedTuple):
    """The upper end: fixed, or a mass under lift with a position loop."""

    fixed: bool
    mass: float  #: [kg]
    lift: float  #: constant upward force [N]
    hover_stiffness: float  #: [N/m]
    hover_damping: float  #: [N s/m]
    rest: float  #: rest position [m]


class Record(NamedTuple):
    """What is kept of the march, filled in place."""

    interval: float  #: between output rows [s]
    bin_steps: int  #: steps per bin of the field
    gauge_index: IntArray  #: (g,) station below the gauge
    gauge_weight: FloatArray  #: (g,) weight of the station above
    tension: FloatArray  #: (rows, g) [N]
    strain: FloatArray  #: (rows, g), of the unstretched length
    top: FloatArray  #: (rows,) position of the upper end [m]
    field_maximum: FloatArray  #: (bins, n + 2) [N]
    field_minimum: FloatArray  #: (bins, n + 2) [N]


@compiled
def limited(rate: FloatArray, excess: FloatArray) -> None:
    """Take from each cell's stretch increment the part that its neighbours explain.

    Parameters
    ----------
    rate : (n,) float64
        Stretch increment of each cell in the last step.
    excess : (n,) float64
        Filled with ``rate - limited mean``; zero where the motion is smooth, so that the viscosity acts on
        fronts alone.
    """
    n = rate.size
    for i in range(n):
        below = rate[i - 1] if i > 0 else rate[min(1, n - 1)]
        above = rate[i + 1] if i < n - 1 else rate[max(n - 2, 0)]
        sign = 1.0 if rate[i] >= 0.0 else -1.0
        mean = min(0.5 * sign * (below + above), 2.0 * sign * below, 2.0 * sign * above, sign * rate[i])
        excess[i] = rate[i] - sign * max(0.0, mean)


@compiled
def cell_tension(
    stretch: FloatArray,
    rate: FloatArray,
    excess: FloatArray,
    line: Line,
    time_step: float,
    tension: FloatArray,
) -> None:
    """Fill the cells' tension from stretch and stretch increments.

    Parameters
    ----------
    stretch, rate, excess : (n,) float64
        Stretch of each cell, its increment over the last step, and the increment left by `limited`.
    line : Line
        Material.
    time_step : float
        [s].
    tension : (n,) float64
        Filled [N]; exactly zero where the cell is slack.
    """
    wave_speed = np.sqrt(line.stiffness / line.mass)
    damping = line.stiffness * line.damping_time / time_step
    viscosity = line.viscosity * line.mass * wave_speed * line.cell / time_step
    for i in range(stretch.size):
        elastic = line.stiffness * (stretch[i] - 1.0)
        total = elastic + damping * rate[i] + viscosity * excess[i]
        if line.unilateral:
            total = max(0.0, total) if elastic > 0.0 else 0.0
        tension[i] = total


@compiled
def march(
    bottom: FloatArray, position: FloatArray, line: Line, top: TopEnd, time_step: float, record: Record
) -> int:
    """March from rest and fill the record.

    Parameters
    ----------
    bottom : (k + 2,) float64
        Prescribed bottom position at time levels 0 .. k + 1 [m].
    position : (n + 1,) float64
        Rest positions; in place, the last positions on return.
    line, top : Line, TopEnd
        Material and upper end.
    time_step : float
        [s].
    record : Record
        Filled in place.

    Returns
    -------
    int
        Number of steps done; less than ``k`` if a position stopped being finite.
    """
    n = position.size - 1
    steps = bottom.size - 2
    per_cell = 1.0 / line.cell
    per_mass = time_step / (line.mass * line.cell)
    fall = time_step * line.gravity
    slow = time_step * line.drag / line.mass
    half_mass = 0.5 * line.mass * line.cell
    velocity = np.zeros(n + 1)
    stretch = np.empty(n)
    for i in range(n):
        stretch[i] = (position[i + 1] - position[i]) * per_cell
    rate = np.zeros(n)
    excess = np.zeros(n)
    tension = np.empty(n)
    station = np.empty(n + 2)
    last_station = np.empty(n + 2)
    highest = np.full(n + 2, -np.inf)
    lowest = np.full(n + 2, np.inf)
    before, last_top = bottom[0], position[n]
    row, bin_number, bin_end, next_row = 0, 0, record.bin_steps, 0.0
    for k in range(steps):
        for i in range(n):
            new = (position[i + 1] - position[i]) * per_cell
            rate[i] = new - stretch[i]
            stretch[i] = new
        if line.viscosity > 0.0:
            limited(rate, excess)
        cell_tension(stretch, rate, excess, line, time_step, tension)

        end_velocity = velocity[n]
        for i in range(1, n):
            pull = per_mass * (tension[i] - tension[i - 1])
            velocity[i] += pull - fall - slow * abs(velocity[i]) * velocity[i]
        end_acceleration = 0.0
        if not top.fixed:
            mass = top.mass + half_mass
            pull = top.lift - mass * line.gravity - tension[n - 1]
            pull -= top.hover_stiffness * (position[n] - top.rest)
            half_damping = 0.5 * time_step * top.hover_damping
            velocity[n] = ((mass - half_damping) * end_velocity + time_step * pull) / (mass + half_damping)
            end_acceleration = (velocity[n] - end_velocity) / time_step

        start_acceleration = (bottom[k + 1] - 2.0 * bottom[k] + before) / (time_step * time_step)
        before = bottom[k]
        last_station[:] = station
        station[1 : n + 1] = tension
        station[0] = tension[0] - half_mass * (start_acceleration + line.gravity)
        station[n + 1] = tension[n - 1] + half_mass * (end_acceleration + line.gravity)
        if line.unilateral:  # the momentum balance of half a slack cell is no tension
            station[0] = max(0.0, station[0]) if tension[0] > 0.0 else 0.0
            station[n + 1] = max(0.0, station[n + 1]) if tension[n - 1] > 0.0 else 0.0

        for i in range(n + 2):
            highest[i] = max(highest[i], station[i])
            lowest[i] = min(lowest[i], station[i])
        if k + 1 == bin_end or k + 1 == steps:
            record.field_maximum[bin_number] = highest
            record.field_minimum[bin_number] = lowest
            highest[:], lowest[:] = station, station  # a front between two bins belongs to both
            bin_number += 1
            bin_end += record.bin_steps
        while next_row <= k * time_step * (1.0 + 1e-12) and row < record.top.size:
            weight = 1.0 if k == 0 else 1.0 - (k * time_step - next_row) / time_step
            weight = min(1.0, max(0.0, weight))
            _keep(record, row, weight, station, last_station, stretch, rate, line)
            record.top[row] = last_top + weight * (position[n] - last_top)
            row += 1
            next_row = row * record.interval
        last_top = position[n]

        for i in range(1, n + 1):
            position[i] += time_step * velocity[i]
        position[0] = bottom[k + 1]
        if not np.isfinite(position[n] + position[1] + station[0]):
            return k
    return steps


@compiled
def _keep(
    record: Record,
    row: int,
    weight: float,
    station: FloatArray,
    last_station: FloatArray,
    stretch: FloatArray,
    rate: FloatArray,
    line: Line,
) -> None:
    """Write one output row, ``weight`` of the way from the last step to this one."""
    for g in range(record.gauge_index.size):
        j = record.gauge_index[g]
        upper = record.gauge_weight[g]
        now = (1.0 - upper) * station[j] + upper * station[j + 1]
        then = (1.0 - upper) * last_station[j] + upper * last_station[j + 1] if weight < 1.0 else now
        record.tension[row, g] = then + weight * (now - then)
        part = _strain_at(j, upper, station, stretch, rate, weight, line)
        record.strain[row, g] = max(0.0, part) if line.unilateral else part


@compiled
def _strain_at(
    j: int,
    upper: float,
    station: FloatArray,
    stretch: FloatArray,
    rate: FloatArray,
    weight: float,
    line: Line,
) -> float:
    """Strain between stations ``j`` and ``j + 1``, of the unstretched length.

    The cells know their stretch; at an end the strain follows the tension's slope over the last half cell.
    """
    n = stretch.size
    low = min(max(j - 1, 0), n - 1)
    high = min(j, n - 1)
    strain_low = stretch[low] - (1.0 - weight) * rate[low] - 1.0
    strain_high = stretch[high] - (1.0 - weight) * rate[high] - 1.0
    if j == 0:
        strain_low += (station[0] - station[1]) / line.stiffness
    if j == n:
        strain_high += (station[n + 1] - station[n]) / line.stiffness
    return float((1.0 - upper) * strain_low + upper * strain_high)
