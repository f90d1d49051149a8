"""A scene in, a response with its error out: choose the model, run it on two meshes, check it."""

from __future__ import annotations

import time
from dataclasses import replace
from typing import Literal

import numpy as np

from tethertest.records.arrays import FloatArray
from tethertest.records.response import ErrorBudget, Response, Status
from tethertest.records.scene import MeasuredMotion, Scene
from tethertest.solver.axial import AxialSolution, run_axial, step_count

Fidelity = Literal["auto", "linear", "nonlinear"]

#: meshes tried, coarse to fine; each answer is the finer of a neighbouring pair
MESHES = (10, 20, 40, 80, 160)
#: node-steps allowed in one march, about a minute
_NODE_STEP_LIMIT = 1.2e10
#: axial damping times tried when the cable goes slack and its damping is unknown [s]
_DAMPING_BAND = (3e-4, 1e-3, 3e-3)
#: a grid pair of a second-order scheme overestimates the finer one's error by this factor
_SECOND_ORDER = 3.0


def solve(
    scene: Scene,
    *,
    measured: MeasuredMotion | None = None,
    fidelity: Fidelity = "auto",
    tolerance: float | None = None,
    cells: int | None = None,
    finest: int = MESHES[-1],
) -> Response:
    """Solve a vertical or straight scene.

    Parameters
    ----------
    scene : Scene
        What is to be solved.
    measured : MeasuredMotion, optional
        Bottom displacement, for ``motion = "measured"``.
    fidelity : {"auto", "linear", "nonlinear"}
        "auto" runs the linear model and moves up when the cable went slack in it.
    tolerance : float, optional
        Relative error wanted; the scene's own if absent.
    cells : int, optional
        Solve on this mesh alone, without an error estimate (``error.numerical`` is NaN).
    finest : int
        Finest mesh that may be tried.

    Returns
    -------
    Response
        With `Status.OK`, or a status whose text is advice.

    Raises
    ------
    DataError
        The scene is not one that axial waves alone describe.
    """
    began = time.perf_counter()
    wanted = scene.accuracy.tolerance if tolerance is None else tolerance
    meshes = (cells,) if cells is not None else tuple(mesh for mesh in MESHES if mesh <= finest)
    warnings: list[str] = []
    unilateral = fidelity == "nonlinear"
    if not unilateral:
        response = _refined(scene, measured, wanted, meshes, unilateral=False)
        lowest = float(np.min(response.field.minimum))
        if lowest > 0.0 or response.status is Status.NOT_FINITE:
            return replace(response, wall=time.perf_counter() - began)
        if fidelity == "linear":
            return replace(response, status=Status.SLACK_IN_LINEAR, wall=time.perf_counter() - began)
    response = _refined(scene, measured, wanted, meshes, unilateral=True)
    spread = None
    if float(np.min(response.field.minimum)) <= 0.0:
        if scene.air is None:
            warnings.append("the cable goes slack and the scene has no air drag: peaks may be far too high")
        warnings.append(
            "the cable goes slack: this replay moves along the cable only, a slack cable also bows sideways, "
            "and its peaks may be off by tens of percent"
        )
        if scene.cable.axial_damping_time is None:
            spread = _damping_spread(scene, measured)
    return replace(
        response,
        wall=time.perf_counter() - began,
        warnings=tuple(warnings),
        error=replace(response.error, spread=spread),
    )


def _refined(
    scene: Scene,
    measured: MeasuredMotion | None,
    tolerance: float,
    meshes: tuple[int, ...],
    *,
    unilateral: bool,
) -> Response:
    """Refine until two neighbouring meshes agree, the meshes end, or the steps run out."""
    coarse = run_axial(scene, meshes[0], unilateral=unilateral, measured=measured)
    if len(meshes) == 1:
        return _response(scene, coarse, meshes[0], np.nan, Status.OK, unilateral=unilateral)
    error, status, used = np.inf, Status.TOLERANCE_NOT_MET, meshes[0]
    for cells_now in meshes[1:]:
        if cells_now * step_count(scene, cells_now, unilateral=unilateral) > _NODE_STEP_LIMIT:
            status = Status.STEP_LIMIT
            break
        fine = run_axial(scene, cells_now, unilateral=unilateral, measured=measured)
        slack = unilateral and float(np.min(fine.field.minimum)) <= 0.0
        error = relative_difference(coarse.tension, fine.tension) / (1.0 if slack else _SECOND_ORDER)
        coarse, used = fine, cells_now
        if error <= tolerance:
            status = Status.OK
            break
    return _response(scene, coarse, used, error, status, unilateral=unilateral)


def relative_difference(tension: FloatArray, reference: FloatArray) -> float:
    """Return the largest RMS difference of a gauge over the RMS of the largest dynamic part.

    Parameters
    ----------
    tension, reference : (n, g) float64
        [N].
    """
    dynamic = float(np.sqrt(np.max(np.mean((reference - reference[0]) ** 2, axis=0))))
    difference = float(np.sqrt(np.max(np.mean((tension - reference) ** 2, axis=0))))
    if dynamic <= 1e-9 * float(np.max(np.abs(reference[0]))):
        return 0.0 if difference <= 1e-9 * float(np.max(np.abs(reference[0]))) else float("inf")
    return difference / dynamic


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


def _damping_spread(scene: Scene, measured: MeasuredMotion | None) -> float:
    """Return the largest relative change of the peak over the believable damping times.

    On the coarsest mesh: an explicit march pays for damping with steps in proportion to the mesh squared.
    """

    def peak(damping_time: float) -> float:
        damped = replace(scene, cable=replace(scene.cable, axial_damping_time=damping_time))
        return float(np.max(run_axial(damped, MESHES[0], unilateral=True, measured=measured).tension))

    nominal = peak(0.0)
    return max(abs(peak(damping_time) - nominal) for damping_time in _DAMPING_BAND) / nominal


def _response(
    scene: Scene, solution: AxialSolution, cells: int, error: float, status: Status, *, unilateral: bool
) -> Response:
    if solution.steps_done < solution.steps:
        status = Status.NOT_FINITE
    gauges = np.asarray(scene.output.gauges, dtype=np.float64)
    return Response(
        scene=scene,
        status=status,
        fidelity="nonlinear" if unilateral else "linear",
        scheme="leapfrog on the material mesh" + (", limited viscosity" if unilateral else ""),
        cells=cells,
        time_step=solution.time_step,
        wall=0.0,
        time=solution.time,
        gauges=gauges,
        tension=solution.tension,
        strain=solution.strain,
        platform_position=solution.platform_position,
        field=solution.field,
        error=ErrorBudget(numerical=error),
        slack={
            float(gauge): slack_intervals(solution.time, solution.tension[:, g]) if unilateral else ()
            for g, gauge in enumerate(gauges)
        },
    )
