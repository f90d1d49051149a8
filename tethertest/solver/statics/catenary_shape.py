"""Elastic catenary: the rest of a uniform cable under a uniform load, in closed form.

Plane (x, z), z upwards, s the unstretched arc length from the bottom end. The force that the upper part
exerts on the lower one is n(s) = n0 - q s for a load q per unstretched length; with T = |n|,

    r(s) = int_0^s (n/EA + n/T) ds.

The end force is the minimum of the convex complementary energy int (T^2/2EA + T) ds - n0 . r(L), so that a
damped Newton iteration finds it from any start, taut or slack.

References
----------
Irvine, H. M., Cable Structures, MIT Press 1981, section 1.4.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from tethertest.errors import DataError
from tethertest.records.arrays import FloatArray, frozen
from tethertest.records.cable import LengthState

#: mean strain above which ends count as out of reach
LARGEST_STRAIN = 2.0
#: largest misfit of the upper end, relative to the length
_CLOSED = 1e-10
#: shortest unstretched length tried, relative to the length at rest
_SHORTEST = 1.0 / (1.0 + 2.0 * LARGEST_STRAIN)


@dataclass(frozen=True, slots=True, eq=False)
class ElasticCatenary:
    """A uniform elastic cable at rest under a uniform load."""

    length: float  #: unstretched [m]
    axial_stiffness: float  #: EA [N]
    load: FloatArray  #: (2,) x and z, per unstretched length [N/m]
    start_force: FloatArray  #: (2,) x and z [N]; the upper part pulls the bottom end with it

    def force(self, arc: FloatArray) -> FloatArray:
        """Return the force (m, 2) [N] with which the upper part pulls at unstretched arc (m,) [m]."""
        return np.asarray(self.start_force - np.asarray(arc)[..., None] * self.load)

    def tension(self, arc: FloatArray) -> FloatArray:
        """Return the tension (m,) [N] at unstretched arc (m,) [m]."""
        return np.asarray(np.linalg.norm(self.force(arc), axis=-1))

    def position(self, arc: FloatArray) -> FloatArray:
        """Return the positions (m, 2) [m] from the bottom end, at unstretched arc (m,) [m]."""
        return _position(np.asarray(arc, dtype=np.float64), self.start_force, self.load, self.axial_stiffness)

    @property
    def stretched_length(self) -> float:
        """Length at rest [m]."""
        weight = float(np.linalg.norm(self.load))
        up, across = _axes(self.load)
        side, low = float(self.start_force @ across), float(self.start_force @ up)
        high = low + weight * self.length
        if weight * self.length <= 1e-9 * max(abs(side), abs(low)):
            mean = float(self.tension(np.array([0.5 * self.length]))[0])
        else:
            mean = (_tension_integral(side, high) - _tension_integral(side, low)) / (high - low)
        return self.length * (1.0 + mean / self.axial_stiffness)


def catenary_between(
    chord: FloatArray, length: float, axial_stiffness: float, load: FloatArray
) -> ElasticCatenary:
    """Return the rest of a cable whose ends are known.

    Parameters
    ----------
    chord : (2,) float64
        Upper end minus bottom end, x and z [m].
    length : float
        Unstretched [m].
    axial_stiffness : float
        EA [N].
    load : (2,) float64
        Weight and side load per unstretched length, x and z [N/m].

    Raises
    ------
    DataError
        The ends are out of reach, or a cable without load is too long to be taut.
    """
    chord, load = np.asarray(chord, dtype=np.float64), np.asarray(load, dtype=np.float64)
    distance, weight = float(np.linalg.norm(chord)), float(np.linalg.norm(load))
    if distance > (1.0 + LARGEST_STRAIN) * length:
        message = f"the ends lie {distance:.6g} m apart, the cable is {length:.6g} m long unstretched"
        raise DataError(message, "lengthen [cable] length or bring the ends closer together")
    if weight == 0.0:
        if distance <= length:
            message = (
                f"a cable of {length:.6g} m without load hangs slack between ends {distance:.6g} m apart"
            )
            raise DataError(message, "shorten [cable] length, or give gravity or wind")
        force = axial_stiffness * (distance / length - 1.0) * chord / distance
        return ElasticCatenary(length, axial_stiffness, frozen(load), frozen(force))
    up, across = _axes(load)
    side, rise = float(chord @ across), float(chord @ up)
    if abs(side) <= 1e-14 * length:
        force = (_upright(rise, length, axial_stiffness, weight) - 0.5 * weight * length) * up
    else:
        guess = _inextensible(abs(side), rise, length, weight, axial_stiffness)
        level, low = _newton(np.array([abs(side), rise]), guess, length, axial_stiffness, weight)
        force = math.copysign(level, side) * across + low * up
    shape = ElasticCatenary(length, axial_stiffness, frozen(load), frozen(force))
    misfit = float(np.linalg.norm(shape.position(np.array([length]))[0] - chord))
    if not misfit <= _CLOSED * (length + distance):
        message = f"no equilibrium found: the upper end misses its place by {misfit:.3g} m"
        raise DataError(message, "check length, stiffness and weight of the cable")
    return shape


def catenary_of_rest_length(
    chord: FloatArray, rest_length: float, axial_stiffness: float, total_load: FloatArray
) -> ElasticCatenary:
    """Return the rest of a cable of known length AT REST and known total load.

    Parameters
    ----------
    chord : (2,) float64
        Upper end minus bottom end, x and z [m].
    rest_length : float
        Length at rest [m].
    axial_stiffness : float
        EA [N].
    total_load : (2,) float64
        Weight and side load of the whole cable, x and z [N].

    Raises
    ------
    DataError
        The ends lie farther apart than the length at rest.
    """
    from scipy.optimize import brentq

    total = np.asarray(total_load, dtype=np.float64)
    distance = float(np.linalg.norm(chord))
    if rest_length <= distance:
        message = f"the cable is {rest_length:.6g} m long at rest, but its ends lie {distance:.6g} m apart"
        raise DataError(message, "give a [cable] length above the distance between the ends")

    def shape(length: float) -> ElasticCatenary:
        return catenary_between(chord, length, axial_stiffness, total / length)

    shortest = max(_SHORTEST * rest_length, distance / (1.0 + LARGEST_STRAIN))
    if shape(shortest).stretched_length > rest_length:
        message = f"a cable {rest_length:.6g} m long at rest would be strained beyond {LARGEST_STRAIN:.0%}"
        raise DataError(message, "check stiffness, mass and length of the cable")
    unstretched = brentq(
        lambda length: shape(length).stretched_length - rest_length,
        shortest,
        rest_length,
        xtol=1e-15 * rest_length,
        rtol=8.9e-16,
    )
    return shape(float(unstretched))


def shallow_catenary(
    length: float,
    length_state: LengthState,
    mass_per_length: float,
    axial_stiffness: float,
    tension: float,
    gravity: float,
) -> ElasticCatenary:
    """Return the rest of a cable with level ends and a given horizontal tension.

    The load per unstretched length is ``mass_per_length * gravity`` of the unstretched state; from length and
    mass per length at equilibrium the unstretched length follows in closed form.

    Parameters
    ----------
    length, mass_per_length : float
        Of ``length_state`` [m], [kg/m].
    length_state : {"unstretched", "equilibrium"}
        State that both belong to.
    axial_stiffness, tension : float
        EA and horizontal tension [N].
    gravity : float
        [m/s^2].
    """
    half = 0.5 * length * mass_per_length * gravity
    unstretched = length
    if length_state == "equilibrium":
        mean = tension if half <= 1e-9 * tension else _tension_integral(tension, half) / half
        unstretched = length / (1.0 + mean / axial_stiffness)
    load = np.array([0.0, -2.0 * half / unstretched])
    return ElasticCatenary(unstretched, axial_stiffness, frozen(load), frozen(np.array([tension, -half])))


def _axes(load: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the unit vectors against the load and across it."""
    weight = float(np.linalg.norm(load))
    up = -load / weight if weight > 0.0 else np.array([0.0, 1.0])
    return up, np.array([up[1], -up[0]])


def _tension_integral(side: float, along: float) -> float:
    """Return the integral of the tension over its component along the load, from 0."""
    tension = math.hypot(side, along)
    arch = side * side * math.asinh(along / abs(side)) if side != 0.0 else 0.0
    return 0.5 * (along * tension + arch)


def _swing(low: FloatArray, high: FloatArray, side: float, weight: float, arc: FloatArray) -> FloatArray:
    """Return int ds/T = (asinh(high/side) - asinh(low/side)) / weight, without cancellation."""
    low_tension, high_tension = np.hypot(side, low), np.hypot(side, high)
    same = low * high > 0.0
    sum_of_products = np.where(same, high * low_tension + low * high_tension, 1.0)
    near = (weight * arc) * (high + low) / sum_of_products
    apart = (high * low_tension - low * high_tension) / (side * side)
    return np.asarray(np.arcsinh(np.where(same, near, apart)) / weight)


def _position(arc: FloatArray, force: FloatArray, load: FloatArray, axial_stiffness: float) -> FloatArray:
    weight = float(np.linalg.norm(load))
    up, across = _axes(load)
    side, low = float(force @ across), float(force @ up)
    high = low + weight * arc
    ends = np.hypot(side, low) + np.hypot(side, high)
    climb = arc * ((low + high) / np.where(ends > 0.0, ends, 1.0) + 0.5 * (low + high) / axial_stiffness)
    reach = arc * (side / axial_stiffness)
    if weight == 0.0:
        reach = reach + arc * (side / math.hypot(side, low))
    elif side != 0.0:
        reach = reach + side * _swing(np.full_like(high, low), high, side, weight, arc)
    return np.asarray(reach[..., None] * across + climb[..., None] * up)


def _upright(rise: float, length: float, axial_stiffness: float, weight: float) -> float:
    """Return the mean force along the load of a cable whose ends lie one above the other."""
    half = 0.5 * weight * length
    folded = rise / (2.0 / weight + length / axial_stiffness)
    if abs(folded) <= half:
        return folded
    return axial_stiffness * (rise - math.copysign(length, rise)) / length


def _inextensible(
    side: float, rise: float, length: float, weight: float, axial_stiffness: float
) -> tuple[float, float]:
    """Return a first end force (across, along the load): from the taut line, or the inextensible catenary."""
    distance, half = math.hypot(side, rise), 0.5 * weight * length
    if distance >= length:
        pull = axial_stiffness * (distance / length - 1.0) + 0.1 * half
        return pull * side / distance, pull * rise / distance - half
    slenderness = math.sqrt(length * length - rise * rise) / side  # sinh(x) / x
    if slenderness < 3.0:
        ratio = max(1e-3, math.sqrt(6.0 * (slenderness - 1.0)))
    else:
        ratio = math.log(2.0 * slenderness) + math.log(math.log(2.0 * slenderness))
    return 0.5 * weight * side / ratio, 0.5 * weight * rise / math.tanh(ratio) - half


def _newton(
    chord: FloatArray, guess: tuple[float, float], length: float, axial_stiffness: float, weight: float
) -> tuple[float, float]:
    """Return the end force (across, along the load) by Newton's method on the convex energy.

    A step is shortened until the energy's slope along it has fallen in size: on a convex function that cannot
    overshoot twice.
    """
    load = np.array([0.0, -weight])
    force = np.array(guess)
    arc = np.array([length])
    misfit = _position(arc, force, load, axial_stiffness)[0] - chord
    for _ in range(200):
        step = -np.linalg.solve(_flexibility(force, length, axial_stiffness, weight), misfit)
        slope, share = abs(float(misfit @ step)), 1.0
        for _ in range(40):
            trial = force + share * step
            new = _position(arc, trial, load, axial_stiffness)[0] - chord
            if trial[0] > 0.0 and abs(float(new @ step)) <= (1.0 - 1e-4 * share) * slope:
                break
            share *= 0.5
        else:
            break
        force, misfit = trial, new
        if float(np.linalg.norm(step)) <= 1e-13 * float(np.linalg.norm(force)):
            break
    return float(force[0]), float(force[1])


def _flexibility(force: FloatArray, length: float, axial_stiffness: float, weight: float) -> FloatArray:
    """Return the derivative (2, 2) of the upper end's position by the end force [m/N]."""
    side, low = float(force[0]), float(force[1])
    high = low + weight * length
    low_tension, high_tension = math.hypot(side, low), math.hypot(side, high)
    swing = float(_swing(np.array([low]), np.array([high]), side, weight, np.array([length]))[0])
    turn = (high / high_tension - low / low_tension) / weight
    cross = side * (1.0 / high_tension - 1.0 / low_tension) / weight
    stretch = length / axial_stiffness
    return np.array(
        [
            [stretch + max(0.0, swing - turn), cross],
            [cross, stretch + max(0.0, turn)],
        ]
    )
