"""The linear model by the scheme that a scene needs, with its numerical error.

Along the cable: exact waves where the start is sudden, the transform where it is smooth. A shallow cable: the
transform, its fronts split off. The two-grid characteristics check the transform, and the paper's printed
scheme reproduces the paper; neither is chosen by itself.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal

import numpy as np

from tethertest.errors import DataError
from tethertest.records.response import Status
from tethertest.solver.linear.axial_waves import run_axial_waves
from tethertest.solver.linear.shallow import solve_shallow
from tethertest.solver.linear.transfer import run_axial_transform
from tethertest.solver.problem import Problem, Refined
from tethertest.solver.solution import Solution
from tethertest.solver.statics.rest import rest_state
from tethertest.solver.terms import bottom_direction

LinearScheme = Literal["auto", "exact", "two-grid", "as-printed"]

#: first meshes of the exact waves and of the characteristics on two grids
_WAVE_MESH, _PAIR_MESH = 25, 55
#: input samples per output time tried by the axial transform
_FACTORS = (1, 2, 4, 8)
#: a grid pair of a second-order scheme overestimates the finer one's error by this factor
_SECOND_ORDER = 3.0
#: rounding that even an exact answer carries
_ROUNDING = 1e-12
#: most time levels of the exact waves, which keep them all
_MOST_LEVELS = 3e6


def refine_linear(problem: Problem, scheme: LinearScheme = "auto") -> Refined:
    """Solve a scene with the linear model.

    Parameters
    ----------
    problem : Problem
    scheme : {"auto", "exact", "two-grid", "as-printed"}
        "auto" and "exact" take waves or transform.

    Raises
    ------
    DataError
        The geometry is not linear, or the scheme does not know what the scene has.
    """
    scene, kind = problem.scene, problem.scene.geometry.kind
    if problem.wind is not None:
        message = f"scene {scene.name!r}: the linear model has no wind"
        raise DataError(message, "leave out [air] wind_file, or use the nonlinear model")
    if scheme in {"two-grid", "as-printed"}:
        return _paired(problem, f"characteristics, {scheme}", _characteristics(problem, scheme))
    if kind in {"vertical", "straight"} and moves_along(problem):
        return _along(problem)
    if kind in {"shallow", "straight"}:
        if problem.native_times:
            message = f"scene {scene.name!r}: the exact transform has no time levels of its own"
            raise DataError(message, "leave out --native-times, or use --scheme two-grid")
        return solve_shallow(problem)
    message = f"scene {scene.name!r}: the linear model knows no geometry {kind!r} with this motion"
    raise DataError(message, "let the fidelity be auto or nonlinear")


def _characteristics(problem: Problem, scheme: LinearScheme) -> Callable[[int], Solution]:
    from tethertest.solver.linear.as_printed import run_as_printed  # seldom asked for, and slow to import
    from tethertest.solver.linear.two_grid import run_two_grid

    run = run_two_grid if scheme == "two-grid" else run_as_printed
    return lambda cells: run(
        problem.scene, cells, measured=problem.measured, native_times=problem.native_times
    )


def moves_along(problem: Problem) -> bool:
    """Return whether the bottom of an upright cable moves along it."""
    direction = bottom_direction(problem.scene, np.array([0.0, 0.0, 1.0]))
    return not np.any(direction[:2])


def _along(problem: Problem) -> Refined:
    scene, measured = problem.scene, problem.measured
    damped = bool(scene.cable.axial_damping_time)
    if problem.native_times or (problem.sudden and not damped):
        return _exact_waves(problem)
    name = "exact transform along the cable"
    if problem.cells is not None:
        solution = run_axial_transform(scene, measured=measured, with_field=problem.with_field)
        return Refined(solution, "linear", name, problem.cells, np.nan, Status.UNJUDGED)
    coarse = run_axial_transform(scene, measured=measured, factor=_FACTORS[0], with_field=False)
    error = np.inf
    for factor in _FACTORS[1:]:
        fine = run_axial_transform(scene, measured=measured, factor=factor, with_field=problem.with_field)
        error = problem.apart(coarse.tension, fine.tension) + _ROUNDING
        coarse = fine
        if error <= problem.tolerance:
            break
    status = Status.OK if error <= problem.tolerance else Status.TOLERANCE_NOT_MET
    return Refined(coarse, "linear", name, 0, error, status)


def _exact_waves(problem: Problem) -> Refined:
    name, scene = "exact waves along the cable", problem.scene
    rest = rest_state(scene)
    levels = scene.output.duration * rest.wave_speed / rest.length * (problem.cells or 2 * _WAVE_MESH)
    if levels > _MOST_LEVELS:
        message = f"scene {scene.name!r}: exact waves would need {levels:.2g} time levels"
        remedy = "shorten [output] duration, or use --fidelity nonlinear without --native-times"
        raise DataError(message, remedy)
    levels = problem.native_times

    def run(cells: int) -> Solution:
        return run_axial_waves(scene, cells, measured=problem.measured, native_times=levels)

    if scene.top.kind == "fixed":  # a sum of delayed velocities, exact on any mesh
        cells = problem.cells or 2 * _WAVE_MESH
        return Refined(run(cells), "linear", name, cells, _ROUNDING, Status.OK)
    return _paired(problem, name, run, first=_WAVE_MESH, order=_SECOND_ORDER)


def _paired(
    problem: Problem,
    name: str,
    run: Callable[[int], Solution],
    *,
    first: int = _PAIR_MESH,
    order: float = _SECOND_ORDER,
) -> Refined:
    """Refine until a pair of meshes agrees."""
    if problem.cells is not None:
        return Refined(run(problem.cells), "linear", name, problem.cells, np.nan, Status.UNJUDGED)
    cells, error = first, np.inf
    coarse = run(cells)
    while 2 * cells <= problem.finest:
        cells *= 2
        fine = run(cells)
        error = _apart(problem, coarse, fine) / order
        coarse = fine
        if error <= problem.tolerance:
            break
    status = Status.OK if error <= problem.tolerance else Status.TOLERANCE_NOT_MET
    return Refined(coarse, "linear", name, cells, error, status)


def _apart(problem: Problem, coarse: Solution, fine: Solution) -> float:
    """Return the relative difference of two runs, at the times of the coarser one."""
    read = [np.interp(coarse.time, fine.time, series) for series in fine.tension.T]
    return problem.apart(coarse.tension, np.column_stack(read))
