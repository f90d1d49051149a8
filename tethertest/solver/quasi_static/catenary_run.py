"""Fidelity "catenary": the elastic catenary through the instantaneous ends, for every row at once."""

from __future__ import annotations

import numpy as np

from tethertest.records.arrays import FloatArray
from tethertest.records.response import Field
from tethertest.records.scene import MeasuredMotion, Scene
from tethertest.solver.quasi_static.moved_ends import MovedEnds, moved_ends
from tethertest.solver.quasi_static.rest_case import RestCase, rest_case
from tethertest.solver.solution import Solution, field_of_rows

#: stations of the tension field, as fractions of the length
_STATIONS = np.linspace(0.0, 1.0, 41)


def run_catenary(
    scene: Scene, *, measured: MeasuredMotion | None = None, native_times: bool = False
) -> Solution:
    """Solve a scene as if its cable had no inertia and no drag of its own motion.

    Every row is the elastic catenary through the ends where they are at that time, in the plane of chord and
    load; steady wind acts as the uniform load that is its mean over the rest shape. A platform stands where
    cable, lift, weight and hover spring balance, with ``(M + m/2) a`` and its hover damping from the pass
    before (`tethertest.solver.quasi_static.moved_ends`); axial damping of the cable is left out.

    Parameters
    ----------
    scene : Scene
        Of any geometry. Whether the model is adequate is a question for
        `tethertest.solver.quasi_static.validity`.
    measured : MeasuredMotion, optional
        Bottom displacement for ``motion = "measured"``.
    native_times : bool
        Rows at the model's own times, at least 64 per period of the drive, instead of the output times.

    Returns
    -------
    Solution
        Row 0 is the rest.

    Raises
    ------
    DataError
        The scene has what the model leaves out, has no rest, or finds no equilibrium on its way.
    """
    case = rest_case(scene)
    ends = moved_ends(scene, case, measured)
    gauges = np.asarray(scene.output.gauges, dtype=np.float64)
    every = 1 if native_times else ends.every
    force = ends.force[::every]
    tension = case.cable.tension(force, gauges)
    rest = case.cable.tension(case.force[None], gauges)
    rows = ends.time.size
    return Solution(
        time=ends.time[::every],
        tension=tension,
        strain=(tension - rest) / case.cable.stiffness,
        platform_position=ends.top[::every, 2],
        field=_field(case, ends),
        time_step=ends.interval,
        steps_done=rows,
        steps=rows,
        fields=_fields(scene, case, ends, gauges, every),
    )


def _field(case: RestCase, ends: MovedEnds) -> Field:
    """Return the extremes of the tension over bins that share their edges."""
    return field_of_rows(ends.time, _STATIONS, case.cable.tension(ends.force, _STATIONS))


def _fields(
    scene: Scene, case: RestCase, ends: MovedEnds, gauges: FloatArray, every: int
) -> dict[str, FloatArray]:
    """Return what the scene asks for beside the tension, at the gauges."""
    fields: dict[str, FloatArray] = {}
    if "position" in scene.output.fields or "velocity" in scene.output.fields:
        position = ends.bottom[:, None] + case.cable.position(ends.force, gauges)
        if "position" in scene.output.fields:
            fields["position"] = position[::every]
        if "velocity" in scene.output.fields:
            fields["velocity"] = np.gradient(position, ends.interval, axis=0)[::every]
    if "curvature" in scene.output.fields:
        fields["curvature"] = _curvature(case, ends.force[::every], gauges)
    return fields


def _curvature(case: RestCase, force: FloatArray, gauges: FloatArray) -> FloatArray:
    """Return the size of the curvature (n, g) [1/m] per stretched length: ``|n x q| / T^2 / (1 + T/EA)``."""
    tension = np.maximum(case.cable.tension(force, gauges), 1e-100)
    turning = np.linalg.norm(np.cross(force, case.cable.load), axis=1)[:, None]
    return np.asarray(turning / tension**2 / (1.0 + tension / case.cable.stiffness))
