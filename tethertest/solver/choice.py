"""Which model a scene needs: the cheapest that its dimensionless numbers allow, checked after it has run."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from tethertest.errors import DataError
from tethertest.records.response import Status
from tethertest.solver.linear.refine import moves_along, refine_linear
from tethertest.solver.nonlinear.chain_march import chain_case, run_chain
from tethertest.solver.nonlinear.refine import FIRST_MESH, is_affordable, refine_nonlinear
from tethertest.solver.norms import goes_slack
from tethertest.solver.numbers import SceneNumbers
from tethertest.solver.problem import Problem, Refined
from tethertest.solver.quasi_static.catenary_run import run_catenary
from tethertest.solver.quasi_static.validity import MARGIN, quasi_static_allowed, quasi_static_error
from tethertest.solver.statics.equilibrium import rest_tension

#: time of one node-step of the nonlinear march, for the choice alone [s]
_NODE_STEP = 8e-9
#: cells that a taut scene takes, and what its coarser meshes add to their steps
_USUAL_CELLS, _LADDER = 40, 1.4
#: expected time of the nonlinear march from which another model is looked for [s]
_WORTH_A_CHOICE = 0.06
#: drive over first natural frequency above which a quasi-static cable is out of the question
_TOO_FAST = 0.15
#: share of the tolerance that the model-form error of a simpler model may take
_SHARE = 0.7
#: amplitude of the bottom over length above which a shallow cable's linear model is not tried
_LINEAR_AMPLITUDE = 2e-3
#: margin on what drag changes on the coarsest mesh
_DRAG_MARGIN = 1.5
#: finest mesh on which the nonlinear model judges the linear one
_JUDGING_MESH = 40


@dataclass(frozen=True, slots=True, eq=False)
class Chosen:
    """A refined solution with the error of its model's form."""

    refined: Refined
    model_error: float | None
    warnings: tuple[str, ...] = ()


def choose(problem: Problem, numbers: SceneNumbers) -> Chosen:
    """Solve with the cheapest adequate model, moving up where its assumptions broke."""
    for attempt in (_try_waves, _try_catenary, _try_shallow):
        found = attempt(problem, numbers)
        if found is not None:
            return found
    return Chosen(refine_nonlinear(problem, numbers), None)


def judged_linear(problem: Problem, numbers: SceneNumbers, refined: Refined) -> Chosen:
    """Return a linear solution with its distance from the nonlinear model on coarse meshes."""
    scene = problem.scene
    warnings = ("the linear model leaves out air drag",) if scene.air is not None else ()
    upright = scene.geometry.kind in {"vertical", "straight"} and moves_along(problem)
    if upright and scene.air is None:
        return Chosen(refined, 0.0)
    if not is_affordable(problem, FIRST_MESH):
        warnings = (*warnings, "the march that would tell the linear model's error takes too long")
        return Chosen(replace(refined, status=Status.UNJUDGED), None, warnings)
    if upright:
        return Chosen(refined, _drag_along(problem), warnings)
    coarse = replace(problem, finest=_JUDGING_MESH, native_times=False, cells=None)
    nonlinear = refine_nonlinear(coarse, numbers)
    rows, found = refined.solution, nonlinear.solution
    read = [np.interp(rows.time, found.time, series) for series in found.tension.T]
    return Chosen(refined, problem.apart(rows.tension, np.column_stack(read)), warnings)


def judged_catenary(problem: Problem) -> Chosen:
    """Solve quasi-statically, with the error that its own neglected forces make."""
    if problem.wind is not None:
        message = f"scene {problem.scene.name!r}: the quasi-static cable has no gusts"
        raise DataError(message, "leave out the wind series, or use the nonlinear model")
    if problem.cells is not None:
        message = f"scene {problem.scene.name!r}: the quasi-static cable has no mesh"
        raise DataError(message, "leave out the cells, or use the nonlinear model")
    estimate = quasi_static_error(problem.scene, measured=problem.measured)
    refined = _catenary(problem)
    warnings: tuple[str, ...] = ()
    if estimate.slack:
        warnings = ("the quasi-static cable goes slack: its error has no bound",)
    return Chosen(refined, MARGIN * estimate.error + _rest_error(problem, refined), warnings)


def _try_waves(problem: Problem, numbers: SceneNumbers) -> Chosen | None:
    """Try the waves along an upright cable: taut, they are linear, and only drag is left out."""
    scene = problem.scene
    upright = scene.geometry.kind in {"vertical", "straight"} and moves_along(problem)
    if not upright or problem.wind is not None or _blown(problem) or scene.cable.bending_stiffness > 0.0:
        return None
    if problem.sudden and scene.cable.axial_damping_time:
        return None
    if scene.top.drag_area is not None and any(scene.top.drag_area) and scene.air is not None:
        return None
    if not is_affordable(problem, FIRST_MESH):
        return None
    quick = run_chain(scene, FIRST_MESH, measured=problem.measured)
    if goes_slack(quick):
        return None
    try:
        refined = refine_linear(problem)
    except DataError:  # the march takes what the exact waves do not
        return None
    if goes_slack(refined.solution):
        return None
    chosen = judged_linear(problem, numbers, refined)
    adequate = (chosen.model_error or 0.0) <= _SHARE * problem.tolerance
    return chosen if adequate and refined.good else None


def _try_catenary(problem: Problem, numbers: SceneNumbers) -> Chosen | None:
    if problem.wind is not None or numbers.drive_over_first > _TOO_FAST or problem.sudden:
        return None
    if nonlinear_time(problem) < _WORTH_A_CHOICE:
        return None
    try:
        permission = quasi_static_allowed(
            problem.scene, tolerance=_SHARE * problem.tolerance, measured=problem.measured
        )
    except DataError:  # it has what the quasi-static model leaves out
        return None
    if not permission.allowed:
        return None
    refined = _catenary(problem)
    error = MARGIN * permission.estimate.error + _rest_error(problem, refined)
    return Chosen(refined, error) if error <= problem.tolerance else None


def _try_shallow(problem: Problem, numbers: SceneNumbers) -> Chosen | None:
    """Try the transform of a shallow cable, where its nonlinear march is dear and its motion small."""
    scene = problem.scene
    if scene.geometry.kind != "shallow" or problem.wind is not None or problem.native_times:
        return None
    amplitude = scene.bottom.amplitude or scene.bottom.radius
    if amplitude is None or amplitude > _LINEAR_AMPLITUDE * scene.cable.length or scene.output.fields:
        return None
    if nonlinear_time(problem) < _WORTH_A_CHOICE or scene.air is not None:
        return None
    try:
        refined = refine_linear(problem)
    except DataError:  # it has what the linear model leaves out
        return None
    chosen = judged_linear(problem, numbers, refined)
    adequate = chosen.model_error is not None and chosen.model_error <= _SHARE * problem.tolerance
    return chosen if adequate and refined.good else None


def nonlinear_time(problem: Problem) -> float:
    """Return about how long the nonlinear model of a taut scene takes [s]."""
    case = chain_case(problem.scene, _USUAL_CELLS, measured=problem.measured, wind=problem.wind)
    return _LADDER * _USUAL_CELLS * case.steps * _NODE_STEP


def _catenary(problem: Problem) -> Refined:
    solution = run_catenary(problem.scene, measured=problem.measured, native_times=problem.native_times)
    return Refined(solution, "catenary", "elastic catenary through the ends", 0, 0.0, Status.OK)


def _rest_error(problem: Problem, refined: Refined) -> float:
    """Return how far the rest in wind is off, which the quasi-static cable takes as a uniform load."""
    scene = problem.scene
    if scene.air is None or not np.any(scene.air.wind):
        return 0.0
    tension = refined.solution.tension
    off = float(np.max(np.abs(tension[0] - rest_tension(scene))))
    dynamic = float(np.sqrt(np.max(np.mean((tension - tension[0]) ** 2, axis=0))))
    return off / dynamic if dynamic > 0.0 else float("inf")


def _blown(problem: Problem) -> bool:
    """Return whether steady wind bows the cable."""
    return len(chain_case(problem.scene, FIRST_MESH, measured=problem.measured).axes) > 1


def _drag_along(problem: Problem) -> float:
    """Return what drag along an upright cable changes, on the coarsest mesh, where mesh errors cancel."""
    scene, measured = problem.scene, problem.measured
    courant = chain_case(scene, FIRST_MESH, measured=measured).courant
    dragged = run_chain(scene, FIRST_MESH, measured=measured, courant=courant)
    still = run_chain(replace(scene, air=None), FIRST_MESH, measured=measured, courant=courant)
    return _DRAG_MARGIN * problem.apart(still.tension, dragged.tension)
