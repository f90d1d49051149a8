"""A scene in, a response with its error out: choose the model, refine it, check it."""

from __future__ import annotations

import time
from dataclasses import replace
from typing import TYPE_CHECKING, Literal, get_args

import numpy as np

from tethertest.errors import DataError
from tethertest.records.arrays import FloatArray
from tethertest.records.response import ErrorBudget, Response, Status
from tethertest.records.scene import MeasuredMotion, Scene, WindSeries
from tethertest.solver.checks import check_scene
from tethertest.solver.choice import Chosen, choose, judged_catenary, judged_linear
from tethertest.solver.linear.refine import LinearScheme, refine_linear
from tethertest.solver.nonlinear.refine import refine_nonlinear
from tethertest.solver.norms import goes_slack
from tethertest.solver.numbers import SceneNumbers, scene_numbers
from tethertest.solver.problem import Problem
from tethertest.solver.spread import Spread, slack_spread
from tethertest.solver.statics.equilibrium import rest_tension

if TYPE_CHECKING:
    import pandas as pd

Fidelity = Literal["auto", "catenary", "linear", "nonlinear"]


def solve(
    scene: Scene,
    *,
    measured: MeasuredMotion | pd.Series[float] | None = None,
    wind: WindSeries | None = None,
    fidelity: Fidelity = "auto",
    scheme: LinearScheme = "auto",
    tolerance: float | None = None,
    cells: int | None = None,
    finest: int = 1280,
    native_times: bool = False,
    spread: bool = True,
    with_field: bool = True,
) -> Response:
    """Solve a scene.

    Parameters
    ----------
    scene : Scene
        What is to be solved.
    measured : MeasuredMotion or pandas.Series, optional
        Bottom displacement, for ``motion = "measured"``; the velocity is made consistent with it. A pandas
        Series is taken as `MeasuredMotion.of_series` does.
    wind : WindSeries, optional
        Gusts, in place of the scene's steady wind.
    fidelity : {"auto", "catenary", "linear", "nonlinear"}
        "auto" takes the cheapest model that the scene's numbers allow, checks its assumptions on the result
        and moves up where they broke.
    scheme : {"auto", "exact", "two-grid", "as-printed"}
        Of the linear model; "as-printed" reproduces the source article's scheme, which converges to the
        wrong wave speed.
    tolerance : float, optional
        Relative error wanted; the scene's own if absent.
    cells : int, optional
        Solve on this mesh alone, without an error estimate (``error.numerical`` is NaN).
    finest : int
        Finest mesh that may be tried.
    native_times : bool
        Rows at the scheme's own time levels instead of k/rate.
    spread : bool
        Run the members that tell how far unknown damping and straightness move a slack cable's answer.
    with_field : bool
        Follow the tension along the whole cable; without, models that need not do so leave it out, and the
        field is that of the gauges.

    Returns
    -------
    Response
        With `Status.OK`, or a status whose text is advice.

    Raises
    ------
    DataError
        The scene has no rest, or has what the model asked for leaves out.
    """
    began = time.perf_counter()
    wanted = scene.accuracy.tolerance if tolerance is None else tolerance
    if not 0.0 < wanted <= 1.0:
        message = f"found a tolerance of {wanted:g}, expected more than 0 and at most 1"
        raise DataError(message, "give a relative error such as 0.01")
    motion = (
        measured
        if measured is None or isinstance(measured, MeasuredMotion)
        else MeasuredMotion.of_series(measured)
    )
    check_scene(scene, motion, wind)
    if wind is None and scene.air is not None and scene.air.wind_file is not None:
        message = f"scene {scene.name!r}: its wind is in a file that has not been read"
        raise DataError(message, "give solve(scene, wind=read_wind(scene)), or leave out [air] wind_file")
    problem = Problem(
        scene, wanted, motion, wind, cells, finest, native_times=native_times, with_field=with_field
    )
    if problem.sudden:
        problem = replace(problem, rest=rest_tension(scene))
    numbers = scene_numbers(scene, motion)
    chosen = _chosen(problem, numbers, fidelity, scheme)
    refined = chosen.refined
    slack = refined.fidelity == "nonlinear" and goes_slack(refined.solution)
    members: Spread | None = None
    model_error = chosen.model_error
    warnings = list(chosen.warnings)
    if slack:
        warnings += _slack_warnings(scene)
        if spread and cells is None and refined.status is not Status.NOT_FINITE:
            members = slack_spread(problem, refined.cells)
            if members.upright:
                model_error = members.bows
                warnings.append(_sideways_warning(model_error))
    chosen = replace(chosen, model_error=model_error, warnings=tuple(warnings))
    return _response(problem, numbers, chosen, members, began)


def _chosen(problem: Problem, numbers: SceneNumbers, fidelity: Fidelity, scheme: LinearScheme) -> Chosen:
    if fidelity not in get_args(Fidelity) or scheme not in get_args(LinearScheme):
        message = f"found fidelity {fidelity!r} and scheme {scheme!r}"
        known = f"{', '.join(get_args(Fidelity))}; {', '.join(get_args(LinearScheme))}"
        raise DataError(message, f"they are: {known}")
    if fidelity in {"catenary", "nonlinear"} and scheme != "auto":
        message = f"the scheme {scheme!r} belongs to the linear model, not to {fidelity!r}"
        raise DataError(message, "leave out the scheme, or set the fidelity to linear")
    if fidelity == "catenary":
        return judged_catenary(problem)
    if fidelity == "linear" or scheme != "auto":
        refined = refine_linear(problem, scheme)
        if problem.cells is not None:
            return Chosen(refined, None)
        return judged_linear(problem, numbers, refined)
    if fidelity == "nonlinear" or problem.cells is not None:
        return Chosen(refine_nonlinear(problem, numbers), None)
    return choose(problem, numbers)


def _slack_warnings(scene: Scene) -> list[str]:
    if scene.air is None:
        return ["slack without drag: the scene has no air drag, and peaks may be several times too high"]
    return []


def _sideways_warning(error: float) -> str:
    return (
        "the cable goes slack: this march moves along the cable only, a slack cable also bows sideways, "
        f"which changes its tension by about {error:.0%} of its dynamic part"
    )


def _response(
    problem: Problem,
    numbers: SceneNumbers,
    chosen: Chosen,
    members: Spread | None,
    began: float,
) -> Response:
    refined, scene = chosen.refined, problem.scene
    solution = refined.solution
    kept = slice(None)
    if problem.native_times:
        kept = slice(0, int(np.searchsorted(solution.time, scene.output.duration * (1.0 + 1e-12), "right")))
    gauges = np.asarray(scene.output.gauges, dtype=np.float64)
    tension = solution.tension[kept]
    taut_model = refined.fidelity != "nonlinear"
    status = refined.status
    if taut_model and status is not Status.NOT_FINITE and goes_slack(solution):
        status = Status.SLACK_IN_LINEAR if refined.fidelity == "linear" else Status.SLACK_IN_CATENARY
    elif (
        status is Status.OK
        and chosen.model_error is not None
        and (refined.error + chosen.model_error) > problem.tolerance
    ):
        status = Status.MODEL_ERROR
    rest = tension[0] if problem.rest is None else problem.rest
    return Response(
        scene=scene,
        status=status,
        fidelity=refined.fidelity,
        scheme=refined.scheme,
        cells=refined.cells,
        time_step=solution.time_step,
        wall=time.perf_counter() - began,
        time=solution.time[kept],
        gauges=gauges,
        tension=tension,
        strain=solution.strain[kept],
        platform_position=solution.platform_position[kept],
        field=solution.field,
        error=ErrorBudget(
            numerical=refined.error,
            model=chosen.model_error,
            spread=None if members is None else members.largest,
            peak_range=None if members is None else members.peaks,
        ),
        slack={
            float(gauge): () if taut_model else slack_intervals(solution.time[kept], tension[:, g])
            for g, gauge in enumerate(gauges)
        },
        warnings=chosen.warnings,
        fields={name: values[kept] for name, values in solution.fields.items()},
        native_times=problem.native_times,
        snap=refined.snap,
        members=() if members is None or problem.native_times else members.members,
        numbers={
            "drive_over_first_transverse": numbers.drive_over_first,
            "drive_over_first_axial": numbers.drive_over_axial,
            "dynamic_over_static": float(np.max(np.abs(tension - rest)) / np.max(rest)),
            "largest_strain_change": float(np.max(np.abs(solution.strain))),
        },
    )


def slack_intervals(time_axis: FloatArray, tension: FloatArray) -> tuple[tuple[float, float], ...]:
    """Return the spans in which the tension is exactly zero.

    Parameters
    ----------
    time_axis, tension : (n,) float64
        [s], [N].
    """
    slack = np.concatenate([[False], tension <= 0.0, [False]])
    edges = np.flatnonzero(np.diff(slack.astype(np.int8)))
    return tuple(
        (float(time_axis[start]), float(time_axis[stop - 1]))
        for start, stop in zip(edges[::2], edges[1::2], strict=True)
    )
