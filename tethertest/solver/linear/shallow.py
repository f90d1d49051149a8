"""The linear model of a shallow cable at its gauges: the exact transform."""

from __future__ import annotations

import numpy as np

from tethertest.errors import DataError
from tethertest.records.response import Status
from tethertest.solver.linear.coupled_solve import solve_coupled
from tethertest.solver.problem import Problem, Refined
from tethertest.solver.solution import Solution, field_of_rows

#: places of the field, both ends included
_STATIONS = 41


def solve_shallow(problem: Problem) -> Refined:
    """Solve a shallow or straight scene by the exact transform.

    Parameters
    ----------
    problem : Problem
        Its cells take no part: the transform has no mesh.

    Raises
    ------
    DataError
        The motion or the geometry is not one that the transform takes, or the scene asks for fields.
    """
    scene, measured = problem.scene, problem.measured
    if scene.output.fields:
        message = f"scene {scene.name!r}: the exact transform gives tension and strain alone"
        raise DataError(message, "leave out [output] fields, or use --scheme two-grid")
    gauges = np.asarray(scene.output.gauges, dtype=np.float64)
    stations = np.linspace(0.0, 1.0, _STATIONS)
    found = solve_coupled(
        scene,
        measured=measured,
        stations=np.concatenate([gauges, stations]),
        tolerance=problem.tolerance,
    )
    response = found.response
    along = response.tension[:, gauges.size :]
    solution = Solution(
        time=response.time,
        tension=np.ascontiguousarray(response.tension[:, : gauges.size]),
        strain=np.ascontiguousarray(response.strain[:, : gauges.size]),
        platform_position=found.platform_position,
        field=field_of_rows(response.time, stations, along),
        time_step=found.time_step,
        steps_done=response.time.size,
        steps=response.time.size,
    )
    status = Status.OK if found.numerical_error <= problem.tolerance else Status.TOLERANCE_NOT_MET
    return Refined(solution, "linear", "exact transform at the gauges", 0, found.numerical_error, status)
