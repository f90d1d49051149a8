"""March of a cable in its plane on the material mesh, taut or slack.

Leapfrog on the mesh of the axial characteristics: at Courant number 1 and without viscosity every axial
characteristic runs from node to node and the scheme is d'Alembert's solution axially. Slope-limited linear
viscosity (after Christensen) makes re-tightening lose the energy that the bilinear law demands; a slack cell
carries no force at all. Positions live at the time levels, velocities half a step earlier.

Plane (x, z), z upwards. Lengths in m, times in s, forces in N. Shapes: ``n`` cells, ``n + 1`` nodes,
``n + 2`` stations (bottom end, cell centres, top end), ``g`` gauges, ``k`` steps. Increments carry a ghost
cell at either end. The loops over cells and nodes are separate functions: each vectorises.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tethertest.kernels.axial import FloatArray, Record
from tethertest.kernels.jit import compiled

#: stretch below which a folded cell has no direction
_TINY = 1e-12


class PlanarLine(NamedTuple):
    """The discrete cable and the air around it."""

    cell: float  #: unstretched cell length [m]
    mass: float  #: unstretched mass per length [kg/m]
    stiffness: float  #: EA [N]
    damping_time: float  #: Kelvin-Voigt [s]
    viscosity: float  #: C1 of the limited linear viscosity
    gravity_x: float  #: [m/s^2]
    gravity_z: float  #: [m/s^2], negative downwards
    normal_drag: float  #: force per unstretched length and velocity squared [N s^2/m^3]
    tangential_drag: float  #: [N s^2/m^3]
    wind_x: float  #: [m/s]
    wind_z: float  #: [m/s]


class PlanarTop(NamedTuple):
    """The upper end: fixed, or a mass under constant lift with a position loop about its rest position."""

    fixed: bool
    mass: float  #: [kg]
    lift_x: float  #: [N]
    lift_z: float  #: [N]
    stiffness_x: float  #: [N/m]
    stiffness_z: float  #: [N/m]
    damping_x: float  #: [N s/m]
    damping_z: float  #: [N s/m]


@compiled
def stretch_cells(
    x: FloatArray,
    z: FloatArray,
    per_cell: float,
    stretch: FloatArray,
    rate: FloatArray,
    along_x: FloatArray,
    along_z: FloatArray,
) -> None:
    """Fill stretch, its increment and the direction of every cell.

    Parameters
    ----------
    x, z : (n + 1,) float64
        Node positions.
    per_cell : float
        Reciprocal cell length [1/m].
    stretch : (n,) float64
        The last step's stretch; updated.
    rate : (n + 2,) float64
        Filled with the stretch increments; the ghosts repeat the end cells.
    along_x, along_z : (n,) float64
        Filled with the unit vectors up the cable.
    """
    n = stretch.size
    for i in range(n):
        x_slope = (x[i + 1] - x[i]) * per_cell
        z_slope = (z[i + 1] - z[i]) * per_cell
        new = np.sqrt(x_slope * x_slope + z_slope * z_slope)
        inverse = np.divide(1.0, max(new, _TINY))  # a plain division would be checked, and not vectorise
        rate[i + 1] = new - stretch[i]
        stretch[i] = new
        along_x[i] = x_slope * inverse
        along_z[i] = z_slope * inverse
    rate[0] = rate[min(2, n)]
    rate[n + 1] = rate[max(n - 1, 1)]


@compiled
def pull_cells(
    stretch: FloatArray,
    rate: FloatArray,
    stiffness: float,
    damping: float,
    viscosity: float,
    tension: FloatArray,
    force_x: FloatArray,
    force_z: FloatArray,
) -> None:
    """Fill the cells' tension and turn their unit vectors into forces.

    Parameters
    ----------
    stretch : (n,) float64
        Stretch.
    rate : (n + 2,) float64
        Its increments over the last step, with ghosts.
    stiffness, damping, viscosity : float
        EA, Kelvin-Voigt ``EA t_d / dt`` and limited viscosity ``C1 rho c h / dt`` [N].
    tension : (n + 2,) float64
        The inner ``n`` filled [N]; exactly zero where the cell is slack.
    force_x, force_z : (n,) float64
        Unit vectors; multiplied by the tension.
    """
    for i in range(stretch.size):
        centre, below, above = rate[i + 1], rate[i], rate[i + 2]
        sign = 1.0 if centre >= 0.0 else -1.0
        steepest = min(2.0 * below * sign, 2.0 * above * sign)
        mean = min(0.5 * (below + above) * sign, centre * sign)
        mean = min(mean, steepest)
        elastic = stiffness * (stretch[i] - 1.0)
        excess = centre - sign * max(0.0, mean)
        total = max(0.0, elastic + damping * centre + viscosity * excess)
        total = total if elastic > 0.0 else 0.0
        tension[i + 1] = total
        force_x[i] *= total
        force_z[i] *= total


@compiled
def pull_cells_elastic(
    stretch: FloatArray,
    stiffness: float,
    tension: FloatArray,
    force_x: FloatArray,
    force_z: FloatArray,
) -> None:
    """As `pull_cells`, without damping and viscosity."""
    for i in range(stretch.size):
        total = max(0.0, stiffness * (stretch[i] - 1.0))
        tension[i + 1] = total
        force_x[i] *= total
        force_z[i] *= total


@compiled
def drag_nodes(
    along_x: FloatArray,
    along_z: FloatArray,
    velocity_x: FloatArray,
    velocity_z: FloatArray,
    wind: tuple[float, float],
    drag: tuple[float, float],
    air_x: FloatArray,
    air_z: FloatArray,
) -> None:
    """Fill the air's force per unstretched length at every node.

    Normal and tangential parts of the relative velocity are resisted apart (Morison type); a node's tangent
    is the mean of its cells' unit vectors, an end's that of its cell.

    Parameters
    ----------
    along_x, along_z : (n,) float64
        Unit vectors of the cells.
    velocity_x, velocity_z : (n + 1,) float64
        Node velocities [m/s].
    wind : (float, float)
        x and z [m/s].
    drag : (float, float)
        Normal and tangential, per length and velocity squared [N s^2/m^3].
    air_x, air_z : (n + 1,) float64
        Filled [N/m].
    """
    n = along_x.size
    air_x[0], air_z[0] = _push(along_x[0], along_z[0], wind[0] - velocity_x[0], wind[1] - velocity_z[0], drag)
    for i in range(1, n):
        x, z = along_x[i - 1] + along_x[i], along_z[i - 1] + along_z[i]
        inverse = np.divide(1.0, max(np.sqrt(x * x + z * z), _TINY))
        air_x[i], air_z[i] = _push(
            x * inverse, z * inverse, wind[0] - velocity_x[i], wind[1] - velocity_z[i], drag
        )
    air_x[n], air_z[n] = _push(
        along_x[n - 1], along_z[n - 1], wind[0] - velocity_x[n], wind[1] - velocity_z[n], drag
    )


@compiled
def _push(x: float, z: float, wind_x: float, wind_z: float, drag: tuple[float, float]) -> tuple[float, float]:
    """Return the air's force per length on a cable along (x, z) in a relative wind."""
    slip = wind_x * x + wind_z * z
    across_x, across_z = wind_x - slip * x, wind_z - slip * z
    across = drag[0] * np.sqrt(across_x * across_x + across_z * across_z)
    along = drag[1] * abs(slip) * slip
    return across * across_x + along * x, across * across_z + along * z


@compiled
def blow_nodes(velocity: FloatArray, air: FloatArray, per_mass: float) -> None:
    """Add the air's push over one step to the inner nodes' velocity."""
    for i in range(1, velocity.size - 1):
        velocity[i] += per_mass * air[i]


@compiled
def move_nodes(
    x: FloatArray,
    z: FloatArray,
    velocity_x: FloatArray,
    velocity_z: FloatArray,
    force_x: FloatArray,
    force_z: FloatArray,
    per_mass: float,
    fall: tuple[float, float],
    time_step: float,
) -> None:
    """Advance the inner nodes by one step under the cells' forces and the fall per step [m/s]."""
    for i in range(1, x.size - 1):
        velocity_x[i] += per_mass * (force_x[i] - force_x[i - 1]) + fall[0]
        velocity_z[i] += per_mass * (force_z[i] - force_z[i - 1]) + fall[1]
        x[i] += time_step * velocity_x[i]
        z[i] += time_step * velocity_z[i]


@compiled
def widen(station: FloatArray, highest: FloatArray, lowest: FloatArray) -> None:
    """Widen the extremes by the stations' tension."""
    for i in range(station.size):
        highest[i] = max(highest[i], station[i])
        lowest[i] = min(lowest[i], station[i])


@compiled
def march_plane(
    bottom: FloatArray,
    direction: tuple[float, float],
    x: FloatArray,
    z: FloatArray,
    line: PlanarLine,
    top: PlanarTop,
    time_step: float,
    record: Record,
) -> int:
    """March from rest and fill the record.

    Parameters
    ----------
    bottom : (k + 2,) float64
        Prescribed bottom displacement from rest at time levels 0 .. k + 1 [m].
    direction : (float, float)
        Unit vector of that displacement.
    x, z : (n + 1,) float64
        Rest positions; in place, the last positions on return.
    line, top : PlanarLine, PlanarTop
        Material, air and upper end.
    time_step : float
        [s].
    record : Record
        Filled in place; ``top`` with the height of the upper end.

    Returns
    -------
    int
        Number of steps done; less than ``k`` if a position stopped being finite.
    """
    n = x.size - 1
    steps = bottom.size - 2
    per_cell = 1.0 / line.cell
    per_mass = time_step / (line.mass * line.cell)
    half_mass = 0.5 * line.mass * line.cell
    wave_speed = np.sqrt(line.stiffness / line.mass)
    damping = line.stiffness * line.damping_time / time_step
    viscosity = line.viscosity * line.mass * wave_speed * line.cell / time_step
    lossless = damping == 0.0 and viscosity == 0.0
    windy = line.normal_drag > 0.0 or line.tangential_drag > 0.0
    fall = (time_step * line.gravity_x, time_step * line.gravity_z)
    wind, drag = (line.wind_x, line.wind_z), (line.normal_drag, line.tangential_drag)
    start_x, start_z, rest_x, rest_z = x[0], z[0], x[n], z[n]
    velocity_x, velocity_z = np.zeros(n + 1), np.zeros(n + 1)
    air_x, air_z = np.zeros(n + 1), np.zeros(n + 1)
    stretch, force_x, force_z = np.zeros(n), np.zeros(n), np.zeros(n)
    rate = np.zeros(n + 2)
    x[0], z[0] = start_x + bottom[0] * direction[0], start_z + bottom[0] * direction[1]
    stretch_cells(x, z, per_cell, stretch, rate, force_x, force_z)
    station, last_station = np.zeros(n + 2), np.zeros(n + 2)
    highest, lowest = np.full(n + 2, -np.inf), np.full(n + 2, np.inf)
    before, last_top = bottom[0], z[n]
    row, bin_number, bin_end, next_row = 0, 0, record.bin_steps, 0.0
    for k in range(steps):
        stretch_cells(x, z, per_cell, stretch, rate, force_x, force_z)
        if windy:
            speed = (bottom[k] - before) / time_step
            velocity_x[0], velocity_z[0] = speed * direction[0], speed * direction[1]
            drag_nodes(force_x, force_z, velocity_x, velocity_z, wind, drag, air_x, air_z)
            blow_nodes(velocity_x, air_x, time_step / line.mass)
            blow_nodes(velocity_z, air_z, time_step / line.mass)
        if lossless:
            pull_cells_elastic(stretch, line.stiffness, station, force_x, force_z)
        else:
            pull_cells(stretch, rate, line.stiffness, damping, viscosity, station, force_x, force_z)

        end_x, end_z = 0.0, 0.0  # acceleration of the upper end
        if not top.fixed:
            mass = top.mass + half_mass
            pull_x = top.lift_x + mass * line.gravity_x - force_x[n - 1] + 0.5 * line.cell * air_x[n]
            pull_z = top.lift_z + mass * line.gravity_z - force_z[n - 1] + 0.5 * line.cell * air_z[n]
            pull_x -= top.stiffness_x * (x[n] - rest_x)
            pull_z -= top.stiffness_z * (z[n] - rest_z)
            half_x, half_z = 0.5 * time_step * top.damping_x, 0.5 * time_step * top.damping_z
            new_x = ((mass - half_x) * velocity_x[n] + time_step * pull_x) / (mass + half_x)
            new_z = ((mass - half_z) * velocity_z[n] + time_step * pull_z) / (mass + half_z)
            end_x, end_z = (new_x - velocity_x[n]) / time_step, (new_z - velocity_z[n]) / time_step
            velocity_x[n], velocity_z[n] = new_x, new_z

        # momentum of the half cells at the ends; a slack cell's, or one that would push, is no tension
        start = (bottom[k + 1] - 2.0 * bottom[k] + before) / (time_step * time_step)
        before = bottom[k]
        pull_x = force_x[0] - half_mass * (start * direction[0] - line.gravity_x) + 0.5 * line.cell * air_x[0]
        pull_z = force_z[0] - half_mass * (start * direction[1] - line.gravity_z) + 0.5 * line.cell * air_z[0]
        taut = pull_x * force_x[0] + pull_z * force_z[0] > 0.0
        station[0] = np.sqrt(pull_x * pull_x + pull_z * pull_z) if taut else 0.0
        pull_x = force_x[n - 1] + half_mass * (end_x - line.gravity_x) - 0.5 * line.cell * air_x[n]
        pull_z = force_z[n - 1] + half_mass * (end_z - line.gravity_z) - 0.5 * line.cell * air_z[n]
        taut = pull_x * force_x[n - 1] + pull_z * force_z[n - 1] > 0.0
        station[n + 1] = np.sqrt(pull_x * pull_x + pull_z * pull_z) if taut else 0.0

        widen(station, highest, lowest)
        if k + 1 == bin_end or k + 1 == steps:
            record.field_maximum[bin_number] = highest
            record.field_minimum[bin_number] = lowest
            highest[:], lowest[:] = station, station  # a front between two bins belongs to both
            bin_number += 1
            bin_end += record.bin_steps
        while next_row <= k * time_step * (1.0 + 1e-12) and row < record.top.size:
            weight = 1.0 if k == 0 else 1.0 - (k * time_step - next_row) / time_step
            weight = min(1.0, max(0.0, weight))
            keep_row(record, row, weight, station, last_station, stretch, rate, line.stiffness)
            record.top[row] = last_top + weight * (z[n] - last_top)
            row += 1
            next_row = row * record.interval
        if next_row <= (k + 1) * time_step * (1.0 + 1e-12):
            last_station[:] = station
            last_top = z[n]

        move_nodes(x, z, velocity_x, velocity_z, force_x, force_z, per_mass, fall, time_step)
        x[0], z[0] = start_x + bottom[k + 1] * direction[0], start_z + bottom[k + 1] * direction[1]
        x[n] += time_step * velocity_x[n]
        z[n] += time_step * velocity_z[n]
        if not np.isfinite(x[n] + z[n] + x[1] + z[1] + station[0]):
            return k
    return steps


@compiled
def keep_row(
    record: Record,
    row: int,
    weight: float,
    station: FloatArray,
    last_station: FloatArray,
    stretch: FloatArray,
    rate: FloatArray,
    stiffness: float,
) -> None:
    """Write one output row, ``weight`` of the way from the last step to this one.

    The cells know their stretch; at an end the strain follows the tension's slope over the last half cell.
    """
    n = stretch.size
    for g in range(record.gauge_index.size):
        j = record.gauge_index[g]
        upper = record.gauge_weight[g]
        now = (1.0 - upper) * station[j] + upper * station[j + 1]
        then = (1.0 - upper) * last_station[j] + upper * last_station[j + 1] if weight < 1.0 else now
        record.tension[row, g] = then + weight * (now - then)
        low, high = min(max(j - 1, 0), n - 1), min(j, n - 1)
        low_strain = stretch[low] - (1.0 - weight) * rate[low + 1] - 1.0
        high_strain = stretch[high] - (1.0 - weight) * rate[high + 1] - 1.0
        if j == 0:
            low_strain += (station[0] - station[1]) / stiffness
        if j == n:
            high_strain += (station[n + 1] - station[n]) / stiffness
        record.strain[row, g] = max(0.0, (1.0 - upper) * low_strain + upper * high_strain)
