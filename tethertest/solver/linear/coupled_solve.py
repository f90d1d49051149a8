"""A shallow or straight scene solved at its gauges by the exact transform."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from tethertest.records.arrays import FloatArray
from tethertest.records.scene import Bottom, MeasuredMotion, Scene
from tethertest.solver.linear.axial_waves import out_of_plane_slope
from tethertest.solver.linear.coupled import CoupledCable, coupled_cable, end_angle, end_body, local_direction
from tethertest.solver.linear.transform import CoupledResponse, refined_response
from tethertest.solver.motion import displacement
from tethertest.solver.terms import leaves_plane

#: steps per traverse of the waves across the plane where a body ends the cable
_STRING_CELLS = 50


@dataclass(frozen=True, slots=True, eq=False)
class CoupledSolution:
    """A response with its error, and where the body at the top goes."""

    response: CoupledResponse
    platform_position: FloatArray  #: (n,) [m] from rest, upwards
    numerical_error: float  #: relative error of the tension, RMS over the record, of the dynamic part
    time_step: float  #: [s] between input samples


def solve_coupled(
    scene: Scene,
    *,
    measured: MeasuredMotion | None = None,
    stations: FloatArray | None = None,
    tolerance: float = 1e-6,
) -> CoupledSolution:
    """Solve a shallow or straight scene at its gauges.

    Parameters
    ----------
    scene : Scene
        Air drag, being quadratic, is left out.
    measured : MeasuredMotion, optional
        Bottom displacement for ``motion = "measured"``.
    stations : (g,) float64, optional
        Fractions of the length from the bottom; the scene's gauges if absent.
    tolerance : float
        The input is sampled finer until its own error is below this, or the finest of `FACTORS` is reached.

    Raises
    ------
    DataError
        The geometry has no uniform tension, the motion starts with a displacement, or with a velocity on a
        damped cable.
    """
    cable = coupled_cable(scene)
    output = scene.output
    rows = math.floor(output.duration * output.rate + 1e-9) + 1
    gauges = np.asarray(output.gauges, dtype=np.float64) if stations is None else stations
    motion = continued(scene.bottom, measured)
    response, error, factor = refined_response(
        cable,
        motion,
        local_direction(scene, cable),
        gauges,
        rows=rows,
        rate=output.rate,
        tolerance=tolerance,
        top=end_body(scene, cable),
    )
    if leaves_plane(scene):
        there = replace(scene, output=replace(output, gauges=tuple(float(gauge) for gauge in gauges)))
        response = swung(response, cable, out_of_plane_slope(there, _STRING_CELLS, measured=measured))
    angle = end_angle(scene, cable, 1.0)
    upwards = response.top_displacement @ np.array([math.sin(angle), math.cos(angle)])
    return CoupledSolution(response, upwards, error, 1.0 / (output.rate * factor))


def swung(response: CoupledResponse, cable: CoupledCable, slope: FloatArray) -> CoupledResponse:
    """Return a response with the strain that an out-of-plane slope u3,s (n, g) adds to it."""
    tangential, normal = response.tangential_strain, response.normal_strain
    flat = tangential + 0.5 * (tangential**2 + normal**2)
    flat_stretch = np.hypot(1.0 + tangential, normal)
    stretch = np.hypot(flat_stretch, slope)
    damping = response.tension - (cable.tension + cable.axial_stiffness * flat) * flat_stretch
    quadratic = flat + 0.5 * slope**2
    return replace(
        response,
        tension=(cable.tension + cable.axial_stiffness * quadratic) * stretch + damping,
        printed_tension=cable.axial_stiffness * quadratic,
        strain=cable.stretch * (stretch - 1.0),
    )


def continued(bottom: Bottom, measured: MeasuredMotion | None) -> Callable[[FloatArray], FloatArray]:
    """Return the motion at any time; data that end with the record go on as their own mirror image."""

    def motion(time: FloatArray) -> FloatArray:
        if measured is None:
            return displacement(bottom, time, measured)
        end = float(measured.time[-1])
        inside = displacement(bottom, np.where(time > end, 2.0 * end - time, time), measured)
        return np.where(time > end, 2.0 * float(measured.displacement[-1]) - inside, inside)

    return motion
