"""The linear model of a shallow cable as a Response: the exact transform at its gauges."""

from __future__ import annotations

import math

import numpy as np

from tethertest.records.response import ErrorBudget, Field, Response, Status
from tethertest.records.scene import MeasuredMotion, Scene
from tethertest.solver.linear.coupled_solve import solve_coupled

#: places of the field, both ends included
_STATIONS = 41
#: rows of the field kept over the record
_FIELD_BINS = 480


def solve_shallow(scene: Scene, measured: MeasuredMotion | None, tolerance: float) -> Response:
    """Solve a shallow scene by the exact transform; taut cables only.

    Parameters
    ----------
    scene : Scene
        Geometry "shallow".
    measured : MeasuredMotion, optional
        Bottom displacement for ``motion = "measured"``.
    tolerance : float
        Relative error wanted.

    Raises
    ------
    DataError
        The motion or the geometry is not one that the transform takes.
    """
    found = solve_coupled(scene, measured=measured, tolerance=tolerance)
    along = solve_coupled(
        scene, measured=measured, stations=np.linspace(0.0, 1.0, _STATIONS), tolerance=tolerance
    )
    tension = along.response.tension
    rows = max(1, math.ceil(tension.shape[0] / _FIELD_BINS))
    starts = np.arange(0, tension.shape[0], rows)
    field = Field(
        time=along.response.time[starts],
        position=along.response.stations,
        maximum=np.maximum.reduceat(tension, starts, axis=0),
        minimum=np.minimum.reduceat(tension, starts, axis=0),
    )
    status = Status.OK if found.numerical_error <= tolerance else Status.TOLERANCE_NOT_MET
    if float(np.min(field.minimum)) <= 0.0:
        status = Status.SLACK_IN_LINEAR
    warnings = ("the linear model leaves out air drag",) if scene.air is not None else ()
    return Response(
        scene=scene,
        status=status,
        fidelity="linear",
        scheme="exact transform at the gauges",
        cells=0,
        time_step=found.time_step,
        wall=0.0,
        time=found.response.time,
        gauges=found.response.stations,
        tension=found.response.tension,
        strain=found.response.strain,
        platform_position=found.platform_position,
        field=field,
        error=ErrorBudget(numerical=found.numerical_error),
        slack={float(gauge): () for gauge in found.response.stations},
        warnings=warnings,
    )
