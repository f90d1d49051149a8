"""Axial finite volumes with the exact taut-slack Riemann solver, on a vertical or straight cable.

Cell averages of velocity v and stretch p in the material coordinate,

    p_t = v_S,    rl v_t = T_S - rl g - k |v| v,    T = max(0, EA (p - 1)),

reconstructed linearly with the monotonised central limiter about the rest profile, so that a cable at rest
stays at rest, and advanced with Heun's method (SSP-RK2). A front between taut and slack loses the energy that
the bilinear law demands, without any viscosity.

Lengths in m, times in s, forces in N, upwards positive; strains and slacks are e = max(0, p - 1) and
d = max(0, 1 - p). Shapes: ``n`` cells, ``n + 1`` faces, ``n + 2`` stations (bottom end, cell centres, top
end), ``g`` gauges, ``k`` steps.
"""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt

from tethertest.kernels.jit import compiled

FloatArray: TypeAlias = npt.NDArray[np.float64]
IntArray: TypeAlias = npt.NDArray[np.int64]


class MusclCable(NamedTuple):
    """The cable in cells."""

    cell: float  #: unstretched cell length [m]
    mass: float  #: unstretched mass per length [kg/m]
    stiffness: float  #: EA [N]
    damping_time: float  #: Kelvin-Voigt [s]
    gravity: float  #: [m/s^2]
    drag: float  #: tangential drag force per length and velocity squared [N s^2/m^3]


class MusclTop(NamedTuple):
    """The upper end: fixed, or a mass under constant lift with a position loop."""

    fixed: bool
    mass: float  #: [kg], above 0 unless fixed
    lift: float  #: [N]
    hover_stiffness: float  #: [N/m]
    hover_damping: float  #: [N s/m]


class MusclRecord(NamedTuple):
    """What is kept of the march, filled in place."""

    row_steps: int  #: steps per output row
    bin_steps: int  #: steps per bin of the field
    gauge_index: IntArray  #: (g,) station below the gauge
    gauge_weight: FloatArray  #: (g,) weight of the station above
    tension: FloatArray  #: (rows, g) [N]
    strain: FloatArray  #: (rows, g), of the unstretched length
    top: FloatArray  #: (rows,) displacement of the upper end from rest [m]
    field_maximum: FloatArray  #: (bins, n + 2) [N]
    field_minimum: FloatArray  #: (bins, n + 2) [N]


@compiled
def riemann(
    velocity_below: float,
    stretch_below: float,
    velocity_above: float,
    stretch_above: float,
    wave_speed: float,
) -> tuple[float, float]:
    """Return velocity [m/s] and strain between two constant states, each taut or slack.

    With ``b = (v_above - v_below) / c + e_below + e_above`` the strain is
    ``b^2 / (d_below + d_above + 2 sqrt(d_below d_above + b^2))``, and 0 where b <= 0: the two sides then part
    with velocities of their own, of which the mean is returned.
    """
    strain_below, slack_below = max(0.0, stretch_below - 1.0), max(0.0, 1.0 - stretch_below)
    strain_above, slack_above = max(0.0, stretch_above - 1.0), max(0.0, 1.0 - stretch_above)
    approach = (velocity_above - velocity_below) / wave_speed + strain_below + strain_above
    if slack_below == 0.0 and slack_above == 0.0 and approach > 0.0:
        part = strain_above - strain_below
        return 0.5 * (velocity_below + velocity_above + wave_speed * part), 0.5 * approach
    strain = 0.0
    if approach > 0.0:
        square = approach * approach
        strain = square / (slack_below + slack_above + 2.0 * np.sqrt(slack_below * slack_above + square))
    below = strain - strain_below if slack_below == 0.0 else np.sqrt(strain * (strain + slack_below))
    above = strain - strain_above if slack_above == 0.0 else np.sqrt(strain * (strain + slack_above))
    return 0.5 * (velocity_below + velocity_above + wave_speed * (below - above)), strain


@compiled
def wall_strain(approach: float, stretch: float) -> float:
    """Return the strain at an end of prescribed velocity.

    Parameters
    ----------
    approach : float
        Speed with which the end pulls away from the cable next to it, over the wave speed.
    stretch : float
        Of the cable next to the end.
    """
    if stretch >= 1.0:
        return max(0.0, stretch - 1.0 + approach)
    if approach <= 0.0:
        return 0.0
    slack = 1.0 - stretch
    return float(2.0 * approach * approach / (slack + np.sqrt(slack * slack + 4.0 * approach * approach)))


@compiled
def limited_difference(below: float, above: float) -> float:
    """Return the monotonised central difference of two neighbouring differences."""
    if below * above <= 0.0:
        return 0.0
    sign = 1.0 if below > 0.0 else -1.0
    return sign * min(0.5 * sign * (below + above), 2.0 * sign * below, 2.0 * sign * above)


@compiled
def fill_rates(
    velocity: FloatArray,
    stretch: FloatArray,
    bottom: tuple[float, float],
    top: tuple[float, float],
    cable: MusclCable,
    face: FloatArray,
    velocity_rate: FloatArray,
    stretch_rate: FloatArray,
) -> None:
    """Fill the rates of the cell averages from the fluxes between reconstructed states.

    Parameters
    ----------
    velocity, stretch : (n,) float64
        Cell averages, ``n >= 2``.
    bottom, top : (float, float)
        Velocity [m/s] and acceleration [m/s^2] of the ends; the acceleration gives the slope of the tension
        there, ``T_S = rl (a + g)``.
    cable : MusclCable
        Material.
    face : (n + 1,) float64
        Filled with the strains between the cells and at the ends.
    velocity_rate, stretch_rate : (n,) float64
        Filled [m/s^2], [1/s].
    """
    n = velocity.size
    wave_speed = np.sqrt(cable.stiffness / cable.mass)
    per_cell = 1.0 / cable.cell
    rest_rise = cable.cell * cable.mass * cable.gravity / cable.stiffness
    rise = cable.cell * cable.mass / cable.stiffness
    velocity_step = 2.0 * (velocity[0] - bottom[0])
    stretch_step = rise * bottom[1] if stretch[0] > 1.0 else 0.0
    upper_velocity, upper_stretch, flow = 0.0, 0.0, bottom[0]
    for i in range(n):
        if i < n - 1:
            next_velocity_step = velocity[i + 1] - velocity[i]
            next_stretch_step = stretch[i + 1] - stretch[i] - rest_rise
        else:
            next_velocity_step = 2.0 * (top[0] - velocity[i])
            next_stretch_step = rise * top[1] if stretch[i] > 1.0 else 0.0
        half_velocity = 0.5 * limited_difference(velocity_step, next_velocity_step)
        half_stretch = 0.5 * (rest_rise + limited_difference(stretch_step, next_stretch_step))
        lower_velocity, lower_stretch = velocity[i] - half_velocity, stretch[i] - half_stretch
        if i == 0:
            face[0] = wall_strain((lower_velocity - bottom[0]) / wave_speed, lower_stretch)
        else:
            new_flow, face[i] = riemann(
                upper_velocity, upper_stretch, lower_velocity, lower_stretch, wave_speed
            )
            stretch_rate[i - 1] = (new_flow - flow) * per_cell
            flow = new_flow
        upper_velocity, upper_stretch = velocity[i] + half_velocity, stretch[i] + half_stretch
        velocity_step, stretch_step = next_velocity_step, next_stretch_step
    face[n] = wall_strain((top[0] - upper_velocity) / wave_speed, upper_stretch)
    stretch_rate[n - 1] = (top[0] - flow) * per_cell
    pull, drag = cable.stiffness / (cable.mass * cable.cell), cable.drag / cable.mass
    for i in range(n):
        velocity_rate[i] = pull * (face[i + 1] - face[i]) - cable.gravity
        velocity_rate[i] -= drag * abs(velocity[i]) * velocity[i]


@compiled
def damp(
    velocity: FloatArray,
    stretch: FloatArray,
    bottom_velocity: float,
    top_velocity: float,
    top_mass: float,
    cable: MusclCable,
    time_step: float,
) -> float:
    """Let Kelvin-Voigt damping act alone for one step, implicitly; slack faces carry none.

    Damping may release a taut face but not push: where it would, its force is held at minus the elastic one
    and the step is solved again.

    Parameters
    ----------
    velocity, stretch : (n,) float64
        Cell averages; the velocity is changed in place.
    bottom_velocity, top_velocity : float
        [m/s].
    top_mass : float
        Mass that the top face pulls at [kg]; infinite for a fixed end.
    cable : MusclCable
        Material.
    time_step : float
        [s].

    Returns
    -------
    float
        New velocity of the top.
    """
    n = velocity.size
    coefficient = cable.stiffness * cable.damping_time / cable.cell
    per_mass = time_step / (cable.mass * cable.cell)
    per_top_mass = time_step / top_mass
    factor, elastic, held = np.empty(n + 1), np.empty(n + 1), np.zeros(n + 1)
    for i in range(n + 1):
        mean = 0.5 * (stretch[max(i - 1, 0)] + stretch[min(i, n - 1)])
        elastic[i] = cable.stiffness * max(0.0, mean - 1.0)
        factor[i] = coefficient * (2.0 if i in {0, n} else 1.0) if elastic[i] > 0.0 else 0.0
    old, upper, solved = np.append(velocity, top_velocity), np.empty(n + 1), np.empty(n + 1)
    for _ in range(n + 1):
        left_upper, left = 0.0, bottom_velocity
        for i in range(n + 1):
            weight = per_mass if i < n else per_top_mass
            above = factor[i + 1] if i < n else 0.0
            push = (held[i + 1] if i < n else 0.0) - held[i]
            inverse = 1.0 / (1.0 + weight * (factor[i] + above - factor[i] * left_upper))
            left = (old[i] + weight * (push + factor[i] * left)) * inverse
            left_upper = weight * above * inverse
            upper[i], solved[i] = left_upper, left
        for i in range(n - 1, -1, -1):
            solved[i] += upper[i] * solved[i + 1]
        more = False
        for i in range(n + 1):
            force = factor[i] * (solved[i] - (solved[i - 1] if i > 0 else bottom_velocity))
            if force < -elastic[i]:
                factor[i], held[i], more = 0.0, -elastic[i], True
        if not more:
            break
    velocity[:] = solved[:n]
    return float(solved[n])


@compiled
def fill_stations(
    velocity: FloatArray,
    stretch: FloatArray,
    ends: tuple[float, float],
    bottom_velocity: float,
    top_velocity: float,
    cable: MusclCable,
    tension: FloatArray,
    strain: FloatArray,
) -> None:
    """Fill tension (n + 2,) [N] and strain (n + 2,) at the stations, damping included.

    Parameters
    ----------
    velocity, stretch : (n,) float64
        Cell averages.
    ends : (float, float)
        Strains of the boundary Riemann problems.
    bottom_velocity, top_velocity : float
        [m/s].
    cable : MusclCable
        Material.
    tension, strain : (n + 2,) float64
        Filled.
    """
    n = velocity.size
    damping = cable.stiffness * cable.damping_time / cable.cell
    strain[0], strain[n + 1] = ends[0], ends[1]
    for i in range(n):
        strain[i + 1] = max(0.0, stretch[i] - 1.0)
        tension[i + 1] = cable.stiffness * strain[i + 1]
    tension[0], tension[n + 1] = cable.stiffness * ends[0], cable.stiffness * ends[1]
    if damping > 0.0:
        tension[0] += damping * (9.0 * velocity[0] - velocity[1] - 8.0 * bottom_velocity) / 3.0
        tension[n + 1] += damping * (8.0 * top_velocity - 9.0 * velocity[n - 1] + velocity[n - 2]) / 3.0
        for i in range(1, n):  # faces that are slack carry none, see `damp`
            mean = 0.5 * (stretch[i - 1] + stretch[i]) - 1.0
            force = max(damping * (velocity[i] - velocity[i - 1]), -cable.stiffness * mean)
            if mean > 0.0:
                tension[i] += 0.5 * force
                tension[i + 1] += 0.5 * force
        tension[1] += damping * (velocity[0] - bottom_velocity)
        tension[n] += damping * (top_velocity - velocity[n - 1])
        for j in range(n + 2):
            tension[j] = max(0.0, tension[j]) if strain[j] > 0.0 else 0.0


@compiled
def march_muscl(
    bottom: FloatArray,
    stretch: FloatArray,
    cable: MusclCable,
    top: MusclTop,
    time_step: float,
    record: MusclRecord,
) -> int:
    """March from rest and fill the record.

    Parameters
    ----------
    bottom : (k + 4,) float64
        Prescribed bottom displacement at time levels -1 .. k + 2 [m]. Central differences drive the stages,
        so that the cable's length follows the displacement without drift.
    stretch : (n,) float64
        Cell averages at rest; in place, the last ones on return.
    cable, top : MusclCable, MusclTop
        Material and upper end.
    time_step : float
        [s].
    record : MusclRecord
        Filled in place.

    Returns
    -------
    int
        Number of steps done; less than ``k`` if a value stopped being finite.
    """
    n, steps = stretch.size, bottom.size - 4
    velocity, face = np.zeros(n), np.zeros(n + 1)
    velocity_rate, stretch_rate = np.zeros(n), np.zeros(n)
    old_velocity, old_stretch = np.zeros(n), np.zeros(n)
    tension, strain = np.zeros(n + 2), np.zeros(n + 2)
    highest, lowest = np.full(n + 2, -np.inf), np.full(n + 2, np.inf)
    place, speed, old_place, old_speed = 0.0, 0.0, 0.0, 0.0
    top_mass = np.inf if top.fixed else top.mass
    damped = cable.damping_time > 0.0
    weight = top.mass * cable.gravity
    push = 0.0  # acceleration of the top
    for k in range(steps + 1):
        now = (bottom[k + 2] - bottom[k]) / (2.0 * time_step)
        jolt = (bottom[k + 2] - 2.0 * bottom[k + 1] + bottom[k]) / (time_step * time_step)
        fill_rates(velocity, stretch, (now, jolt), (speed, push), cable, face, velocity_rate, stretch_rate)
        fill_stations(velocity, stretch, (face[0], face[n]), now, speed, cable, tension, strain)
        for j in range(n + 2):
            highest[j], lowest[j] = max(highest[j], tension[j]), min(lowest[j], tension[j])
        if (k + 1) % record.bin_steps == 0 or k == steps:
            bin_number = k // record.bin_steps
            record.field_maximum[bin_number], record.field_minimum[bin_number] = highest, lowest
            highest[:], lowest[:] = tension, tension  # a front between two bins belongs to both
        if k % record.row_steps == 0:
            row = k // record.row_steps
            for g in range(record.gauge_index.size):
                j, above = record.gauge_index[g], record.gauge_weight[g]
                record.tension[row, g] = (1.0 - above) * tension[j] + above * tension[j + 1]
                record.strain[row, g] = (1.0 - above) * strain[j] + above * strain[j + 1]
            record.top[row] = place
        if k == steps or not np.isfinite(tension[0] + tension[n + 1] + stretch[n // 2]):
            return k

        if damped:
            speed = damp(velocity, stretch, now, speed, top_mass, cable, 0.5 * time_step)
        old_velocity[:], old_stretch[:], old_place, old_speed = velocity, stretch, place, speed
        for stage in range(2):
            if stage == 1 or damped:
                fill_rates(
                    velocity, stretch, (now, jolt), (speed, push), cable, face, velocity_rate, stretch_rate
                )
            for i in range(n):
                velocity[i] += time_step * velocity_rate[i]
                stretch[i] += time_step * stretch_rate[i]
            if not top.fixed:
                pull = top.lift - weight - cable.stiffness * face[n]
                push = (pull - top.hover_stiffness * place - top.hover_damping * speed) / top.mass
                place += time_step * speed
                speed += time_step * push
            now = (bottom[k + 3] - bottom[k + 1]) / (2.0 * time_step)
            jolt = (bottom[k + 3] - 2.0 * bottom[k + 2] + bottom[k + 1]) / (time_step * time_step)
            if stage == 1:
                for i in range(n):
                    velocity[i] = 0.5 * (velocity[i] + old_velocity[i])
                    stretch[i] = 0.5 * (stretch[i] + old_stretch[i])
                place, speed = 0.5 * (place + old_place), 0.5 * (speed + old_speed)
        if damped:
            speed = damp(velocity, stretch, now, speed, top_mass, cable, 0.5 * time_step)
    return steps
