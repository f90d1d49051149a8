"""Spectral elements for the geometrically exact taut cable, in one, two or three dimensions.

Nodes are the Gauss-Lobatto-Legendre points of every element, and the forces on them the derivative of the
elastic energy by their positions r(S), both integrated with those points:

    M r_tt = -sum_q w_q F_q D_qi + M g + w f_air,   F = T p/|p|,   p = r_S,
    T = EA (|p| - 1 + t_d p.p_t/|p|).

The semi-discrete cable is a mechanical system with that energy: nothing is filtered and nothing drifts. The
force along the cable is summed from the reaction at the bottom end and the nodes' momentum: EA times the
error of the stretch, large in a stiff cable, never enters it. Steps are of classical Runge-Kutta.

Lengths in m, times in s, forces in N. Shapes: ``d`` dimensions, ``m`` nodes, ``q`` points per element,
``g`` gauges, ``k`` steps. Nodes shared by two elements appear once.
"""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt

from tethertest.kernels.jit import compiled

FloatArray: TypeAlias = npt.NDArray[np.float64]
IntArray: TypeAlias = npt.NDArray[np.int64]


class SpectralCable(NamedTuple):
    """The cable in elements and the air around it."""

    mass: float  #: per unstretched length [kg/m]
    stiffness: float  #: EA [N]
    damping_time: float  #: Kelvin-Voigt [s]
    gravity: FloatArray  #: (d,) [m/s^2]
    normal_drag: float  #: force per unstretched length and velocity squared [N s^2/m^3]
    tangential_drag: float  #: [N s^2/m^3]
    wind: FloatArray  #: (d,) [m/s]
    derivative: FloatArray  #: (q, q) by the unstretched arc, rows are points [1/m]
    points: FloatArray  #: (q,) quadrature weights of an element [m]
    integral: FloatArray  #: (q, q) from an element's start to its points, rows are points [m]
    nodes: FloatArray  #: (m,) quadrature weights of the nodes [m]


class SpectralTop(NamedTuple):
    """The upper end: fixed, or a mass under constant lift with a position loop about its rest position."""

    fixed: bool
    mass: float  #: [kg]
    lift: FloatArray  #: (d,) [N]
    stiffness: FloatArray  #: (d,) [N/m]
    damping: FloatArray  #: (d,) [N s/m]
    rest: FloatArray  #: (d,) [m]


class SpectralRecord(NamedTuple):
    """What is kept of the march, filled in place."""

    row_steps: int  #: steps per output row
    bin_steps: int  #: steps per bin of the field
    gauge_element: IntArray  #: (g,) element of the gauge
    gauge_basis: FloatArray  #: (g, q) the element's Lagrange polynomials at the gauge
    tension: FloatArray  #: (rows, g) [N]
    strain: FloatArray  #: (rows, g), of the unstretched length
    top: FloatArray  #: (rows,) height of the upper end [m]
    field_maximum: FloatArray  #: (bins, m) [N]
    field_minimum: FloatArray  #: (bins, m) [N]


@compiled
def pull_nodes(
    position: FloatArray,
    velocity: FloatArray,
    cable: SpectralCable,
    inner: FloatArray,
    force: FloatArray,
) -> float:
    """Fill the force of the cable, and that of cable, gravity and air, on the nodes.

    Parameters
    ----------
    position, velocity : (d, m) float64
        Of the nodes [m], [m/s].
    cable : SpectralCable
        Material, air and elements.
    inner, force : (d, m) float64
        Filled [N]: of the cable alone, and of all.

    Returns
    -------
    float
        Smallest stretch of all points.
    """
    d, m = position.shape
    q = cable.points.size
    damped = cable.damping_time > 0.0
    windy = cable.normal_drag > 0.0 or cable.tangential_drag > 0.0
    slope, slope_rate = np.zeros((d, q)), np.zeros((d, q))
    smallest = np.inf
    for c in range(d):
        for i in range(m):
            inner[c, i] = 0.0
            force[c, i] = cable.mass * cable.nodes[i] * cable.gravity[c]
    for first in range(0, m - 1, q - 1):
        for c in range(d):
            for i in range(q):
                slope[c, i] = 0.0
                slope_rate[c, i] = 0.0
            for j in range(q):
                place = position[c, first + j]
                for i in range(q):
                    slope[c, i] += cable.derivative[i, j] * place
            if damped:
                for j in range(q):
                    speed = velocity[c, first + j]
                    for i in range(q):
                        slope_rate[c, i] += cable.derivative[i, j] * speed
        for i in range(q):
            square, stretching, slip = 0.0, 0.0, 0.0
            for c in range(d):
                square += slope[c, i] * slope[c, i]
                stretching += slope[c, i] * slope_rate[c, i]
                slip += slope[c, i] * (cable.wind[c] - velocity[c, first + i])
            stretch = np.sqrt(square)
            smallest = min(smallest, stretch)
            pull = cable.stiffness * (stretch - 1.0 + cable.damping_time * stretching / stretch)
            if windy:
                slip /= square  # slip along the cable is slip * slope
                across = 0.0
                for c in range(d):
                    part = cable.wind[c] - velocity[c, first + i] - slip * slope[c, i]
                    across += part * part
                normal = cable.points[i] * cable.normal_drag * np.sqrt(across)
                along = cable.points[i] * cable.tangential_drag * abs(slip) * stretch
                for c in range(d):
                    relative = cable.wind[c] - velocity[c, first + i]
                    force[c, first + i] += normal * relative + (along - normal) * slip * slope[c, i]
            factor = cable.points[i] * pull / stretch
            for c in range(d):
                slope[c, i] *= factor
        for c in range(d):
            for j in range(q):
                flux = slope[c, j]
                for i in range(q):
                    inner[c, first + i] -= flux * cable.derivative[j, i]
    for c in range(d):
        for i in range(m):
            force[c, i] += inner[c, i]
    return smallest


@compiled
def accelerate_nodes(
    position: FloatArray,
    velocity: FloatArray,
    force: FloatArray,
    bottom: FloatArray,
    cable: SpectralCable,
    top: SpectralTop,
    acceleration: FloatArray,
) -> None:
    """Fill the acceleration (d, m) [m/s^2] of the nodes; that of the bottom end (d,) is prescribed.

    Parameters
    ----------
    position, velocity, force : (d, m) float64
        Of the nodes [m], [m/s], [N].
    bottom : (d,) float64
        [m/s^2].
    cable, top : SpectralCable, SpectralTop
        Mass of the nodes and what acts on the last one.
    acceleration : (d, m) float64
        Filled.
    """
    d, m = position.shape
    for c in range(d):
        acceleration[c, 0] = bottom[c]
        for i in range(1, m - 1):
            acceleration[c, i] = force[c, i] / (cable.mass * cable.nodes[i])
        acceleration[c, m - 1] = 0.0
        if not top.fixed:
            hold = top.stiffness[c] * (position[c, m - 1] - top.rest[c]) + top.damping[c] * velocity[c, m - 1]
            pull = force[c, m - 1] + top.lift[c] + top.mass * cable.gravity[c] - hold
            acceleration[c, m - 1] = pull / (top.mass + cable.mass * cable.nodes[m - 1])


@compiled
def fill_tension(
    inner: FloatArray, force: FloatArray, acceleration: FloatArray, cable: SpectralCable, tension: FloatArray
) -> None:
    """Fill the tension (m,) [N] of the nodes, the ends' reactions included.

    The force along the cable obeys ``F_S = rl r_tt - rl g - f_air``; the right side is the cable's own force
    on a node over the node's weight, plus the reaction at either end.

    Parameters
    ----------
    inner, force, acceleration : (d, m) float64
        From `pull_nodes` and `accelerate_nodes`.
    cable : SpectralCable
        Mass and elements.
    tension : (m,) float64
        Filled.
    """
    d, m = inner.shape
    q = cable.points.size
    rise = np.zeros(m)
    for i in range(m):
        tension[i] = 0.0
    for c in range(d):
        for i in range(m):
            rise[i] = inner[c, i] / cable.nodes[i]
        pull = force[c, 0] - cable.mass * cable.nodes[0] * acceleration[c, 0]
        above = cable.mass * cable.nodes[m - 1] * acceleration[c, m - 1] - force[c, m - 1]
        rise[0] -= pull / cable.nodes[0]
        rise[m - 1] += above / cable.nodes[m - 1]
        tension[0] += pull * pull
        for first in range(0, m - 1, q - 1):
            start = pull
            for i in range(1, q):
                pull = start
                for j in range(q):
                    pull += cable.integral[i, j] * rise[first + j]
                tension[first + i] += pull * pull
    for i in range(m):
        tension[i] = np.sqrt(tension[i])


@compiled
def keep_row(
    record: SpectralRecord,
    row: int,
    position: FloatArray,
    velocity: FloatArray,
    tension: FloatArray,
    cable: SpectralCable,
) -> None:
    """Write one output row; the strain is that of the tension without its damping part."""
    d, q = position.shape[0], cable.points.size
    for g in range(record.gauge_element.size):
        first = record.gauge_element[g] * (q - 1)
        pull, square, stretching = 0.0, 0.0, 0.0
        for i in range(q):
            pull += record.gauge_basis[g, i] * tension[first + i]
        for c in range(d):
            slope, slope_rate = 0.0, 0.0
            for i in range(q):
                for j in range(q):
                    weight = record.gauge_basis[g, i] * cable.derivative[i, j]
                    slope += weight * position[c, first + j]
                    slope_rate += weight * velocity[c, first + j]
            square += slope * slope
            stretching += slope * slope_rate
        record.tension[row, g] = pull
        record.strain[row, g] = pull / cable.stiffness - cable.damping_time * stretching / np.sqrt(square)
    record.top[row] = position[d - 1, position.shape[1] - 1]


@compiled
def march_spectral(
    position: FloatArray,
    velocity: FloatArray,
    place: FloatArray,
    speed: FloatArray,
    jolt: FloatArray,
    cable: SpectralCable,
    top: SpectralTop,
    time_step: float,
    first_step: int,
    last: bool,
    record: SpectralRecord,
) -> int:
    """March a block of steps and fill the record.

    Parameters
    ----------
    position, velocity : (d, m) float64
        Of the nodes when the block begins; in place, those of its end on return.
    place, speed : (d, k + 1) float64
        Position and velocity of the bottom end at the block's time levels [m], [m/s].
    jolt : (d, 2 k + 1) float64
        Its acceleration at these levels and halfway between them [m/s^2].
    cable, top : SpectralCable, SpectralTop
        Material, elements and upper end.
    time_step : float
        [s].
    first_step : int
        Number of steps before this block.
    last : bool
        Whether the last level is recorded too; otherwise the next block does it.
    record : SpectralRecord
        Filled in place.

    Returns
    -------
    int
        Number of steps done in this block; less than ``k`` if the cable went slack or a value stopped being
        finite.
    """
    d, m = position.shape
    steps = len(place[0]) - 1
    inner, force, tension = np.zeros((d, m)), np.zeros((d, m)), np.zeros(m)
    rate, trial_rate = np.zeros((d, m)), np.zeros((d, m))
    trial, trial_velocity = np.zeros((d, m)), np.zeros((d, m))
    moved, sped = np.zeros((d, m)), np.zeros((d, m))
    for k in range(steps + 1 if last else steps):
        for c in range(d):
            position[c, 0], velocity[c, 0] = place[c, k], speed[c, k]
        smallest = pull_nodes(position, velocity, cable, inner, force)
        accelerate_nodes(position, velocity, force, jolt[:, 2 * k], cable, top, rate)
        fill_tension(inner, force, rate, cable, tension)
        if not smallest > 1.0 or not np.isfinite(tension[0] + tension[m - 1]):
            return k
        step = first_step + k
        bin_number = step // record.bin_steps
        for i in range(m):
            record.field_maximum[bin_number, i] = max(record.field_maximum[bin_number, i], tension[i])
            record.field_minimum[bin_number, i] = min(record.field_minimum[bin_number, i], tension[i])
        if step % record.row_steps == 0:
            keep_row(record, step // record.row_steps, position, velocity, tension, cable)
        if k == steps:
            break

        for c in range(d):
            for i in range(m):
                moved[c, i], sped[c, i] = velocity[c, i], rate[c, i]
                trial[c, i] = position[c, i] + 0.5 * time_step * velocity[c, i]
                trial_velocity[c, i] = velocity[c, i] + 0.5 * time_step * rate[c, i]
        for stage in range(1, 4):
            level = 2 * k + (2 if stage == 3 else 1)
            pull_nodes(trial, trial_velocity, cable, inner, force)
            accelerate_nodes(trial, trial_velocity, force, jolt[:, level], cable, top, trial_rate)
            weight = 1.0 if stage == 3 else 2.0
            ahead = time_step if stage == 2 else 0.5 * time_step
            for c in range(d):
                for i in range(m):
                    moved[c, i] += weight * trial_velocity[c, i]
                    sped[c, i] += weight * trial_rate[c, i]
                    trial[c, i] = position[c, i] + ahead * trial_velocity[c, i]
                    trial_velocity[c, i] = velocity[c, i] + ahead * trial_rate[c, i]
        sixth = time_step / 6.0
        for c in range(d):
            for i in range(m):
                position[c, i] += sixth * moved[c, i]
                velocity[c, i] += sixth * sped[c, i]
    return steps
