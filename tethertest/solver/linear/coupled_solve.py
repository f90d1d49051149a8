"""A shallow or straight scene solved at its gauges by the exact transform."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from tethertest.records.arrays import FloatArray
from tethertest.records.scene import MeasuredMotion, Scene
from tethertest.solver.linear.coupled import coupled_cable, end_angle, end_body, local_direction
from tethertest.solver.motion import displacement
from tethertest.solver.linear.transform import CoupledResponse, refined_response


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
    motion = _continued(scene, measured)
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
    angle = end_angle(scene, cable, 1.0)
    upwards = response.top_displacement @ np.array([math.sin(angle), math.cos(angle)])
    return CoupledSolution(response, upwards, error, 1.0 / (output.rate * factor))


def _continued(scene: Scene, measured: MeasuredMotion | None) -> Callable[[FloatArray], FloatArray]:
    """Return the motion at any time; data that end with the record go on as their own mirror image."""

    def motion(time: FloatArray) -> FloatArray:
        if measured is None or measured.time[-1] < scene.output.duration:
            return displacement(scene.bottom, time, measured)
        end = float(measured.time[-1])
        inside = displacement(scene.bottom, np.where(time > end, 2.0 * end - time, time), measured)
        return np.where(time > end, 2.0 * float(measured.displacement[-1]) - inside, inside)

    return motion
