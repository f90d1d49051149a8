"""Closed forms of natural frequencies, which the solver's are held against."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from tethertest.records.arrays import FloatArray
from tethertest.solver.linear.coupled import CoupledCable


def irvine_parameter(cable: CoupledCable) -> float:
    """Return Irvine's ``lambda^2 = (rl g L/H)^2 L EA/(H Le)`` with ``Le = L (1 + (rl g L/H)^2/8)``.

    EA is that of the equilibrium cable, EA + P: the force per strain counted from the equilibrium.
    """
    bend = (cable.curvature * cable.length) ** 2
    return bend * cable.axial_square / cable.transverse_square / (1.0 + bend / 8.0)


def irvine_caughey_frequencies(cable: CoupledCable, count: int = 5) -> FloatArray:
    """Return the in-plane frequencies of Irvine and Caughey's shallow cable, ascending [Hz].

    Axial inertia is left out, so this holds where ``c1 >> ct`` and below the first axial frequency.
    """
    symmetric = irvine_caughey_roots(irvine_parameter(cable), count)
    antisymmetric = 2.0 * np.pi * np.arange(1, count + 1)
    both = np.sort(np.concatenate([symmetric, antisymmetric]))[:count]
    return np.asarray(both * cable.transverse_speed / (2.0 * np.pi * cable.length))


def irvine_caughey_roots(parameter: float, count: int) -> FloatArray:
    """Return the symmetric ``wbar = w L/ct``: ``tan(wbar/2) = wbar/2 - (4/lambda^2)(wbar/2)^3``.

    Parameters
    ----------
    parameter : float
        lambda^2, above zero; one root lies between neighbouring poles of the tangent.
    count : int
    """
    from scipy.optimize import brentq

    def balance(half: float) -> float:
        return math.sin(half) - math.cos(half) * (half - 4.0 / parameter * half**3)

    poles = (np.arange(count + 1) + 0.5) * math.pi
    return 2.0 * np.array([brentq(balance, a, b, xtol=1e-14) for a, b in pairwise(poles)])


def hanging_frequencies(
    bottom_tension: float,
    weight_per_length: float,
    length: float,
    count: int = 5,
    *,
    gravity: float = 9.80665,
) -> FloatArray:
    """Return the lateral natural frequencies of a hanging inextensible cable with fixed ends, ascending [Hz].

    Parameters
    ----------
    bottom_tension : float
        T0 of ``T = T0 + rl g s`` [N], above zero.
    weight_per_length : float
        rl g [N/m], above zero.
    length : float
        [m].
    count : int
    gravity : float
        [m/s^2].

    Notes
    -----
    ``J0(a) Y0(b) - J0(b) Y0(a) = 0``, ``a = 2 w sqrt(z0/g)``, ``b = 2 w sqrt((L + z0)/g)``,
    ``z0 = T0/(rl g)``.
    The n-th root lies near ``n pi/(b - a)``: the phase between the ends grows by pi from root to root.
    """
    from scipy.optimize import brentq
    from scipy.special import jv, yv

    offset = bottom_tension / weight_per_length
    near, far = 2.0 * math.sqrt(offset / gravity), 2.0 * math.sqrt((length + offset) / gravity)

    def phase_gap(angular: float, number: int) -> float:
        """Phase travelled between the ends, less number x pi; it grows with the frequency."""
        a, b = near * angular, far * angular
        turned = _bessel_phase(float(jv(0, b)), float(yv(0, b)), b) - _bessel_phase(
            float(jv(0, a)), float(yv(0, a)), a
        )
        return turned - number * math.pi

    estimate = math.pi / (far - near)
    roots = [
        brentq(phase_gap, 0.5 * n * estimate, 1.5 * n * estimate, args=(n,), xtol=1e-14)
        for n in range(1, count + 1)
    ]
    return np.array(roots) / (2.0 * math.pi)


def _bessel_phase(first: float, second: float, argument: float) -> float:
    """Return the continuous angle of (J0, Y0): near ``argument - pi/4``, which tells the turn."""
    angle = math.atan2(second, first)
    return angle + 2.0 * math.pi * round((argument - 0.25 * math.pi - angle) / (2.0 * math.pi))
