"""Fronts of a motion that starts suddenly, split off the transform so that it does not ring at them.

A velocity jump at the bottom sends a jump of strain up the cable. What curvature and a body at the top change
grows from zero behind the front: the jumps are those of the straight cable between fixed ends, whose strain
is d'Alembert's series. The transform is left with the difference, which is continuous.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from tethertest.errors import DataError
from tethertest.records.arrays import FloatArray
from tethertest.solver.linear.coupled import ComplexArray, CoupledCable, EndBody

#: largest share of the motion's velocity that may be there at the first instant and still count as smooth
_SUDDEN = 0.02
#: span over which a motion is differentiated, over the step between its samples
_SPAN = 1e-3


def start_velocity(motion: Callable[[FloatArray], FloatArray], values: FloatArray, step: float) -> float:
    """Return the velocity [m/s] with which a motion starts, 0 if it is small.

    Parameters
    ----------
    motion : callable
        Displacement [m] at times [s].
    values : (n,) float64
        The motion on the record [m], every ``step`` seconds.
    step : float
        [s].

    Raises
    ------
    DataError
        The motion starts with a displacement.
    """
    allowed = _SUDDEN * float(np.max(np.abs(np.diff(values)), initial=0.0))
    if abs(float(values[0])) > allowed:
        message = f"the bottom jumps by {float(values[0]):.3g} m at the start"
        raise DataError(message, "count the bottom displacement from its place at rest")
    velocity = float(velocity_of(motion, np.zeros(1), step)[0])
    return velocity if abs(velocity) * step > allowed else 0.0


def velocity_of(motion: Callable[[FloatArray], FloatArray], time: FloatArray, step: float) -> FloatArray:
    """Return the velocity to fourth order, 0 before the start and from the right at it.

    Parameters
    ----------
    motion : callable
        Displacement [m] at times [s].
    time : (n,) float64
        [s].
    step : float
        Between samples that resolve the motion [s].
    """
    span = _SPAN * step
    near = time < 2.0 * span
    centred = sum(
        weight * motion(time + offset * span)
        for offset, weight in ((-2, 1.0), (-1, -8.0), (1, 8.0), (2, -1.0))
    ) / (12.0 * span)
    start = np.array([0.0, 1.0, 2.0, 3.0, 4.0]) * span
    forward = float(motion(start) @ np.array([-25.0, 48.0, -36.0, 16.0, -3.0])) / (12.0 * span)
    return np.where(time < -1e-9 * step, 0.0, np.where(near, forward, centred))


def check_sudden(cable: CoupledCable, top: EndBody | None, velocity: float) -> None:
    """Refuse a sudden start where the fronts are not those of a straight cable between fixed ends.

    Raises
    ------
    DataError
        The cable is damped along its length, or the body at the top has no mass.
    """
    damped = cable.axial_damping_time > 0.0 or cable.tangential_damping > 0.0 or cable.normal_damping > 0.0
    if damped or (top is not None and top.mass == 0.0):
        reason = "with a damped cable" if damped else "with a platform without mass"
        message = f"the bottom starts at {velocity:.3g} m/s, which the linear model cannot follow {reason}"
        raise DataError(
            message, 'set [bottom] start = "ramp", begin data at rest, or use the nonlinear model'
        )


def kink_spectrum(s: ComplexArray, step: float) -> ComplexArray:
    """Return what a discrete transform of samples misses of ``max(0, t)``: ``1/s^2`` less its sum.

    Parameters
    ----------
    s : (n,) complex128
        [1/s].
    step : float
        Between samples [s].

    Returns
    -------
    (n,) complex128
        To be added to the plain sum over samples, per unit of velocity.
    """
    decay = np.exp(-s * step)
    return np.asarray(1.0 / (s**2 * step) - step * decay / (1.0 - decay) ** 2)


def straight_strains(
    cable: CoupledCable,
    motion: Callable[[FloatArray], FloatArray],
    direction: tuple[float, float],
    stations: FloatArray,
    time: FloatArray,
    step: float,
) -> FloatArray:
    """Return eps1 and eps2 of the cable without curvature and with a fixed top, d'Alembert's series.

    Parameters
    ----------
    cable : CoupledCable
    motion : callable
        Bottom displacement [m] at times [s].
    direction : (float, float)
        Components of the motion along the tangent and the normal.
    stations : (g,) float64
        Fractions of the length from the bottom.
    time : (n,) float64
        [s].
    step : float
        Between samples that resolve the motion [s].

    Returns
    -------
    (2, n, g) float64
    """
    strains = np.zeros((2, time.size, stations.size))
    for component, speed in enumerate((cable.axial_speed, cable.transverse_speed)):
        if direction[component] == 0.0:
            continue
        traverse = cable.length / speed
        for trip in range(math.ceil(0.5 * float(time[-1]) / traverse) + 1):
            for g, station in enumerate(stations):
                for delay in ((2.0 * trip + station) * traverse, (2.0 * trip + 2.0 - station) * traverse):
                    passed = velocity_of(motion, time - delay, step)
                    strains[component, :, g] -= direction[component] / speed * passed
    return strains
