"""A scene in, a response with its error out: choose the model, run it on two meshes, check it."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from tethertest.errors import DataError
from tethertest.records.arrays import FloatArray
from tethertest.records.response import ErrorBudget, Response, Status
from tethertest.records.scene import MeasuredMotion, Scene
from tethertest.solver.nonlinear.axial import AxialSolution, run_axial, step_count
from tethertest.solver.nonlinear.planar import planar_case, planar_step, run_planar
from tethertest.solver.linear.shallow import solve_shallow

Fidelity = Literal["auto", "linear", "nonlinear"]

#: meshes tried, coarse to fine; each answer is the finer of a neighbouring pair
MESHES = (10, 20, 40, 80, 160)
#: node-steps allowed in one march, about a minute
_NODE_STEP_LIMIT = 1.2e10
#: axial damping times tried when the cable goes slack and its damping is unknown [s]
_DAMPING_BAND = (3e-4, 1e-3, 3e-3)
#: a grid pair of a second-order scheme overestimates the finer one's error by this factor
_SECOND_ORDER = 3.0
#: geometries whose cable is curved: it is marched in its plane
_CURVED = ("shallow", "ends")


@dataclass(frozen=True, slots=True)
class _Plan:
    """Which march solves the scene; everything but the mesh."""

    scene: Scene
    measured: MeasuredMotion | None
    curved: bool
    unilateral: bool

    def march(self, cells: int) -> AxialSolution:
        """March on one mesh."""
        if self.curved:
            return run_planar(self.scene, cells, viscous=True, measured=self.measured)
        return run_axial(self.scene, cells, unilateral=self.unilateral, measured=self.measured)

    def steps(self, cells: int) -> int:
        """Return the number of steps on a mesh."""
        if self.curved:
            step = planar_step(planar_case(self.scene, cells, viscous=True))
            return int(self.scene.output.duration / step) + 2
        return step_count(self.scene, cells, unilateral=self.unilateral)

    @property
    def scheme(self) -> str:
        """Name of the scheme."""
        base = "leapfrog on the material mesh" + (" in the plane" if self.curved else "")
        return base + (", limited viscosity" if self.unilateral else "")


def solve(
    scene: Scene,
    *,
    measured: MeasuredMotion | None = None,
    fidelity: Fidelity = "auto",
    tolerance: float | None = None,
    cells: int | None = None,
    finest: int = MESHES[-1],
) -> Response:
    """Solve a scene: vertical and straight cables along their axis, curved ones in their plane.

    Parameters
    ----------
    scene : Scene
        What is to be solved.
    measured : MeasuredMotion, optional
        Bottom displacement, for ``motion = "measured"``.
    fidelity : {"auto", "linear", "nonlinear"}
        "auto" runs the linear model of a vertical or straight cable and moves up when it went slack in it,
        and the nonlinear model of a curved one. "linear" takes a shallow cable to the exact transform.
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
        The scene is not one that these models describe.
    """
    began = time.perf_counter()
    wanted = scene.accuracy.tolerance if tolerance is None else tolerance
    meshes = (cells,) if cells is not None else tuple(mesh for mesh in MESHES if mesh <= finest)
    warnings: list[str] = []
    if scene.geometry.kind == "shallow" and fidelity == "linear":
        return replace(solve_shallow(scene, measured, wanted), wall=time.perf_counter() - began)
    curved = scene.geometry.kind in _CURVED
    if curved:
        _check_curved(scene, fidelity)
    if not curved and fidelity != "nonlinear":
        response = _refined(_Plan(scene, measured, False, False), wanted, meshes)
        lowest = float(np.min(response.field.minimum))
        if lowest > 0.0 or response.status is Status.NOT_FINITE:
            return replace(response, wall=time.perf_counter() - began)
        if fidelity == "linear":
            return replace(response, status=Status.SLACK_IN_LINEAR, wall=time.perf_counter() - began)
    plan = _Plan(scene, measured, curved, True)
    response = _refined(plan, wanted, meshes)
    spread = None
    if float(np.min(response.field.minimum)) <= 0.0:
        if scene.air is None:
            warnings.append("the cable goes slack and the scene has no air drag: peaks may be far too high")
        if not curved:
            warnings.append(
                "the cable goes slack: this replay moves along the cable only, a slack cable also bows "
                "sideways, and its peaks may be off by tens of percent"
            )
        if scene.cable.axial_damping_time is None:
            spread = _damping_spread(plan)
    return replace(
        response,
        wall=time.perf_counter() - began,
        warnings=tuple(warnings),
        error=replace(response.error, spread=spread),
    )


def _check_curved(scene: Scene, fidelity: Fidelity) -> None:
    """Refuse what the planar march would leave out."""
    left_out = {
        "the linear model of a cable between two ends": fidelity == "linear",
        "a lift given as a force": scene.top.lift is not None,
        "bending stiffness": scene.cable.bending_stiffness > 0.0,
    }
    for what in (name for name, wanted in left_out.items() if wanted):
        message = f"scene {scene.name!r}: {what} is not in this version"
        raise DataError(message, "leave it out, and let the fidelity be auto or nonlinear")


def _refined(plan: _Plan, tolerance: float, meshes: tuple[int, ...]) -> Response:
    """Refine until two neighbouring meshes agree, the meshes end, or the steps run out."""
    coarse = plan.march(meshes[0])
    if len(meshes) == 1:
        return _response(plan, coarse, meshes[0], np.nan, Status.OK)
    error, status, used = np.inf, Status.TOLERANCE_NOT_MET, meshes[0]
    for cells_now in meshes[1:]:
        if cells_now * plan.steps(cells_now) > _NODE_STEP_LIMIT:
            status = Status.STEP_LIMIT
            break
        fine = plan.march(cells_now)
        slack = plan.unilateral and float(np.min(fine.field.minimum)) <= 0.0
        error = relative_difference(coarse.tension, fine.tension) / (1.0 if slack else _SECOND_ORDER)
        coarse, used = fine, cells_now
        if error <= tolerance:
            status = Status.OK
            break
    return _response(plan, coarse, used, error, status)


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


def _damping_spread(plan: _Plan) -> float:
    """Return the largest relative change of the peak over the believable damping times.

    On the coarsest mesh: an explicit march pays for damping with steps in proportion to the mesh squared.
    """

    def peak(damping_time: float) -> float:
        cable = replace(plan.scene.cable, axial_damping_time=damping_time)
        damped = replace(plan, scene=replace(plan.scene, cable=cable))
        return float(np.max(damped.march(MESHES[0]).tension))

    nominal = peak(0.0)
    return max(abs(peak(damping_time) - nominal) for damping_time in _DAMPING_BAND) / nominal


def _response(plan: _Plan, solution: AxialSolution, cells: int, error: float, status: Status) -> Response:
    if solution.steps_done < solution.steps:
        status = Status.NOT_FINITE
    gauges = np.asarray(plan.scene.output.gauges, dtype=np.float64)
    return Response(
        scene=plan.scene,
        status=status,
        fidelity="nonlinear" if plan.unilateral else "linear",
        scheme=plan.scheme,
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
            float(gauge): slack_intervals(solution.time, solution.tension[:, g]) if plan.unilateral else ()
            for g, gauge in enumerate(gauges)
        },
    )
