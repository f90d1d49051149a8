"""Forces in the cells and at the nodes of a discrete cable on a line, in a plane or in space.

Arrays of vectors are (d, n): component first, so that every loop over cells or nodes runs along memory and
vectorises. d is 1 (along the cable, upwards positive), 2 (x, z) or 3 (x, y, z). On a line the stretch keeps
its sign: a folded cell has no other direction. Shapes: ``n`` cells, ``n + 1`` nodes; stretch increments carry
a ghost cell at either end. SI units.
"""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from tethertest.kernels.jit import compiled

FloatArray: TypeAlias = npt.NDArray[np.float64]

#: size below which a vector has no direction
_TINY = 1e-12


@compiled
def stretch_cells(
    position: FloatArray, per_cell: float, stretch: FloatArray, rate: FloatArray, along: FloatArray
) -> None:
    """Fill stretch, its increment and the direction of every cell.

    Parameters
    ----------
    position : (d, n + 1) float64
        Nodes.
    per_cell : float
        Reciprocal cell length [1/m].
    stretch : (n,) float64
        The last step's stretch; updated.
    rate : (n + 2,) float64
        Filled with the stretch increments; the ghosts repeat the second cells from the ends.
    along : (d, n) float64
        Filled with the unit vectors up the cable.
    """
    n = stretch.size
    if position.shape[0] == 1:
        for i in range(n):
            new = (position[0, i + 1] - position[0, i]) * per_cell
            rate[i + 1] = new - stretch[i]
            stretch[i] = new
            along[0, i] = 1.0
    elif position.shape[0] == 2:
        for i in range(n):
            x = (position[0, i + 1] - position[0, i]) * per_cell
            z = (position[1, i + 1] - position[1, i]) * per_cell
            new = np.sqrt(x * x + z * z)
            inverse = np.divide(1.0, max(new, _TINY))  # a plain division would be checked, and not vectorise
            rate[i + 1] = new - stretch[i]
            stretch[i] = new
            along[0, i] = x * inverse
            along[1, i] = z * inverse
    else:
        for i in range(n):
            x = (position[0, i + 1] - position[0, i]) * per_cell
            y = (position[1, i + 1] - position[1, i]) * per_cell
            z = (position[2, i + 1] - position[2, i]) * per_cell
            new = np.sqrt(x * x + y * y + z * z)
            inverse = np.divide(1.0, max(new, _TINY))
            rate[i + 1] = new - stretch[i]
            stretch[i] = new
            along[0, i] = x * inverse
            along[1, i] = y * inverse
            along[2, i] = z * inverse
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
) -> None:
    """Fill the cells' tension; exactly zero where a cell is slack.

    Parameters
    ----------
    stretch : (n,) float64
        Stretch.
    rate : (n + 2,) float64
        Its increments over the last step, with ghosts.
    stiffness, damping, viscosity : float
        EA, Kelvin-Voigt ``EA t_d / dt`` and viscosity ``C1 rho c h / dt`` [N]. The viscosity acts on what a
        cell's increment exceeds the limited mean of its neighbours by: on fronts alone.
    tension : (n + 2,) float64
        The inner ``n`` filled [N].

    References
    ----------
    R. B. Christensen, Godunov methods on a staggered mesh, UCRL-JC-105269 (1990): the limiter.
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
        tension[i + 1] = total if elastic > 0.0 else 0.0


@compiled
def pull_cells_elastic(
    stretch: FloatArray, stiffness: float, along: FloatArray, tension: FloatArray, force: FloatArray
) -> None:
    """As `pull_cells` without damping and viscosity, and fill the cells' force (d, n) too."""
    for i in range(stretch.size):
        tension[i + 1] = max(0.0, stiffness * (stretch[i] - 1.0))
    for c in range(along.shape[0]):
        for i in range(stretch.size):
            force[c, i] = along[c, i] * tension[i + 1]


@compiled
def pull_plane(
    position: FloatArray,
    per_cell: float,
    stiffness: float,
    stretch: FloatArray,
    tension: FloatArray,
    force: FloatArray,
) -> None:
    """Do in one pass what `stretch_cells` and `pull_cells_elastic` do in a plane, without directions.

    Parameters
    ----------
    position : (2, n + 1) float64
        Nodes.
    per_cell, stiffness : float
        Reciprocal cell length [1/m] and EA [N].
    stretch : (n,) float64
        Filled.
    tension : (n + 2,) float64
        The inner ``n`` filled [N].
    force : (2, n) float64
        Filled [N].
    """
    for i in range(stretch.size):
        x = (position[0, i + 1] - position[0, i]) * per_cell
        z = (position[1, i + 1] - position[1, i]) * per_cell
        new = np.sqrt(x * x + z * z)
        total = max(0.0, stiffness * (new - 1.0))
        share = np.divide(total, max(new, _TINY))
        stretch[i] = new
        tension[i + 1] = total
        force[0, i] = share * x
        force[1, i] = share * z


@compiled
def drag_nodes(
    along: FloatArray,
    velocity: FloatArray,
    wind: FloatArray,
    normal: float,
    tangential: float,
    cell: float,
    tangent: FloatArray,
    size: FloatArray,
    slip: FloatArray,
    pull: FloatArray,
    load: FloatArray,
) -> None:
    """Fill the air's force on every node.

    Normal and tangential parts of the relative velocity are resisted apart (Morison type); a node's tangent
    is the mean of its cells' unit vectors, an end's that of its cell.

    Parameters
    ----------
    along : (d, n) float64
        Unit vectors of the cells.
    velocity : (d, n + 1) float64
        Node velocities [m/s].
    wind : (d,) float64
        [m/s].
    normal, tangential : float
        Force per unstretched length and velocity squared [N s^2/m^3].
    cell : float
        Length that belongs to an inner node [m]; 1 for the force per length.
    tangent : (d, n + 1) float64
        Overwritten.
    size, slip, pull : (n + 1,) float64
        Overwritten.
    load : (d, n + 1) float64
        Filled with force per length times ``cell``; half of it at the ends.
    """
    d, n = along.shape
    for i in range(n + 1):
        size[i] = slip[i] = 0.0
    for c in range(d):
        blow = wind[c]
        tangent[c, 0], tangent[c, n] = along[c, 0], along[c, n - 1]
        for i in range(1, n):
            tangent[c, i] = along[c, i - 1] + along[c, i]
        for i in range(n + 1):
            size[i] += tangent[c, i] * tangent[c, i]
            slip[i] += tangent[c, i] * (blow - velocity[c, i])
    for i in range(n + 1):
        slip[i] = np.divide(slip[i], max(size[i], _TINY))  # slip over the size of the tangent
    for i in range(n + 1):
        pull[i] = 0.0
    for c in range(d):
        blow = wind[c]
        for i in range(n + 1):
            load[c, i] = blow - velocity[c, i] - slip[i] * tangent[c, i]
            pull[i] += load[c, i] * load[c, i]
    for i in range(n + 1):
        pull[i] = cell * normal * np.sqrt(pull[i])
        slip[i] = cell * tangential * abs(slip[i]) * np.sqrt(size[i]) * slip[i]
    for c in range(d):
        for i in range(n + 1):
            load[c, i] = pull[i] * load[c, i] + slip[i] * tangent[c, i]
        load[c, 0] *= 0.5
        load[c, n] *= 0.5


@compiled
def bend_nodes(position: FloatArray, stiffness: float, bend: FloatArray, force: FloatArray) -> None:
    """Add the bending force per node of a cable whose ends are hinged.

    Parameters
    ----------
    position : (d, n + 1) float64
        Nodes.
    stiffness : float
        ``EI / h^3`` [N/m].
    bend : (n + 1,) float64
        Overwritten with second differences, zero at the ends.
    force : (d, n + 1) float64
        Added to [N].
    """
    n = position.shape[1] - 1
    for c in range(position.shape[0]):
        node, push = position[c], force[c]
        bend[0], bend[n] = 0.0, 0.0
        for i in range(1, n):
            bend[i] = node[i - 1] - 2.0 * node[i] + node[i + 1]
        for i in range(1, n):
            push[i] -= stiffness * (bend[i - 1] - 2.0 * bend[i] + bend[i + 1])
        push[0] -= stiffness * bend[1]
        push[n] -= stiffness * bend[n - 1]


@compiled
def damp_cells(
    along: FloatArray,
    velocity: FloatArray,
    rate: FloatArray,
    gain: float,
    lag: float,
    share: float,
    end_share: FloatArray,
    work: FloatArray,
    tension: FloatArray,
    force: FloatArray,
) -> None:
    """Add Kelvin-Voigt damping, implicit in time, to tensions, forces and velocities.

    The unknowns are the cells' damping forces: each resists the rate of stretch that is left after all of
    them have acted. Slack cells carry none, and none may push: a cell that would is left without tension.

    Parameters
    ----------
    along : (d, n) float64
        Unit vectors of the cells.
    velocity : (d, n + 1) float64
        Node velocities after all other forces [m/s]; corrected in place, but for the first node's.
    rate : (n + 2,) float64
        Stretch increments over the last step, with ghosts.
    gain : float
        ``theta EA t_d / h`` [N s/m], theta the weight of the new rate of stretch over that of the last step.
    lag : float
        ``(1 - theta) h / (theta dt)`` [m/s].
    share : float
        Velocity that a unit of force gives an inner node in one step [m/(s N)].
    end_share : (d,) float64
        The same for the upper end along each direction; 0 where it is held.
    work : (5, n) float64
        Overwritten.
    tension : (n + 2,) float64
        Tension of the inner ``n`` [N]; corrected in place.
    force : (d, n) float64
        Tension times unit vector [N]; corrected in place.
    """
    d, n = along.shape
    turn, wanted, damping, factor, carried = work[0], work[1], work[2], work[3], work[4]
    turn[:] = 0.0
    end = 0.0
    for i in range(n):
        wanted[i] = lag * rate[i + 1]
    for c in range(d):
        unit, speed = along[c], velocity[c]
        for i in range(n):
            wanted[i] += unit[i] * (speed[i + 1] - speed[i])
        for i in range(1, n):
            turn[i] += unit[i - 1] * unit[i]
        end += end_share[c] * unit[n - 1] * unit[n - 1]
    damping[:] = 0.0
    resist = 1.0 / gain
    for _ in range(3):  # cells that would push join the slack ones
        carry_factor, carry = 0.0, 0.0
        for i in range(n):
            below = 0.0 if i == 0 else share
            above = end if i == n - 1 else share
            lower = below * turn[i]
            upper = share * turn[i + 1] if i < n - 1 else 0.0
            inverse = np.divide(1.0, resist + below + above - lower * carry_factor)
            carry_factor, carry = upper * inverse, (wanted[i] + lower * carry) * inverse
            if tension[i + 1] <= 0.0 or damping[i] <= -tension[i + 1]:
                carry_factor, carry = 0.0, -max(0.0, tension[i + 1])
            factor[i] = carry_factor
            carried[i] = carry
        pushes = False
        for j in range(n):
            i = n - 1 - j
            known = damping[i] <= -tension[i + 1]
            damping[i] = carried[i] + (factor[i] * damping[i + 1] if i < n - 1 else 0.0)
            if damping[i] < -tension[i + 1]:
                damping[i] = -tension[i + 1]
                pushes = pushes or not known
        if not pushes:
            break
    for c in range(d):
        unit, speed, pull = along[c], velocity[c], force[c]
        speed[n] -= end_share[c] * damping[n - 1] * unit[n - 1]
        for i in range(1, n):
            speed[i] += share * (damping[i] * unit[i] - damping[i - 1] * unit[i - 1])
        for i in range(n):
            pull[i] += damping[i] * unit[i]
    for i in range(n):
        tension[i + 1] += damping[i]
