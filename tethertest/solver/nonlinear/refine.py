"""The nonlinear model refined until its error is within the tolerance, and that error.

A taut cable is marched without viscosity; pairs of meshes then extrapolate to fourth order. As soon as any
cell goes slack such a march is wrong however fine its mesh, and the viscous scheme takes over.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from tethertest.errors import DataError
from tethertest.records.arrays import FloatArray
from tethertest.records.response import SnapPeak, Status
from tethertest.solver.motion import velocity
from tethertest.solver.nonlinear.chain_march import chain_case, run_chain
from tethertest.solver.nonlinear.snap_peak import SNAP_WINDOW, march_with_peaks, peak_error, peaks_apart
from tethertest.solver.norms import finished, goes_slack
from tethertest.solver.numbers import SceneNumbers
from tethertest.solver.problem import Problem, Refined
from tethertest.solver.resample import resampled
from tethertest.solver.solution import Solution, widened

TAUT, VISCOUS = "leapfrog on the material mesh", "leapfrog on the material mesh, limited viscosity"
EXTRAPOLATED = "leapfrog on the material mesh, extrapolated from two meshes"
#: coarsest mesh, and the cells that half a wave of the drive needs on it
FIRST_MESH, CELLS_PER_HALF_WAVE = 10, 4.0
#: steps per output row below which rows are interpolated by a cubic instead of a straight line
_FEW_STEPS = 8.0
#: ratio of axial to transverse speed near which a march at Courant number 1 resonates with its own mesh
_RESONANT, _OFF_RESONANCE = (1.6, 2.5), 0.9
#: ratio of successive differences from which the scheme counts as being at its order
_AT_ORDER = (3.8, 4.2)
#: what a difference of extrapolated answers overestimates the finer one's error by: at order, and before it
_FOURTH_ORDER, _BEFORE_ORDER = 3.0, 0.75
#: what rows between time levels and rounding leave of any extrapolated answer
_FLOOR = 5e-8
#: differences that shrink by less than this twice running do not settle
_SETTLES = 0.75
#: cells x steps above which no further mesh is tried where the tolerance is out of reach
_ENOUGH = 6e7
#: margin on the difference of two meshes when the cable goes slack: errors there do not fall smoothly
_SLACK_MARGIN = 2.0


def refine_nonlinear(problem: Problem, numbers: SceneNumbers) -> Refined:
    """Solve a scene with the nonlinear model.

    Parameters
    ----------
    problem : Problem
    numbers : SceneNumbers
        Of the scene; they set the coarsest mesh.

    Raises
    ------
    DataError
        The scene has no rest.
    """
    if problem.cells is not None:
        solution = run_chain(
            problem.scene,
            problem.cells,
            measured=problem.measured,
            wind=problem.wind,
            native_times=problem.native_times,
        )
        status = _ended(solution, Status.UNJUDGED)
        return Refined(solution, "nonlinear", VISCOUS, problem.cells, np.nan, status)
    case = chain_case(problem.scene, FIRST_MESH, measured=problem.measured, wind=problem.wind)
    along = len(case.axes) == 1
    ratio = numbers.drive_over_axial if along else numbers.drive_over_first
    needed = CELLS_PER_HALF_WAVE * ratio
    first = FIRST_MESH * 2 ** max(0, int(np.ceil(np.log2(max(1.0, needed / FIRST_MESH)))))
    first = min(first, max(2, problem.finest // 4))  # an error needs three meshes
    meshes = [first]
    while 2 * meshes[-1] <= max(problem.finest, 8):
        meshes.append(2 * meshes[-1])
    taut = _refine_taut(problem, meshes)
    return _refine_viscous(problem, meshes, along=along) if taut is None else taut


def _refine_taut(problem: Problem, meshes: list[int]) -> Refined | None:
    """Refine without viscosity; None as soon as the cable goes slack."""
    sudden, courant = problem.sudden, _common_courant(problem, meshes[0])
    runs: list[Solution] = []
    extrapolated: list[Solution] = []
    differences: list[float] = []
    error, status = np.inf, Status.TOLERANCE_NOT_MET
    for cells in _affordable(problem, meshes, viscous=False):
        run = _march_taut(problem, cells, courant)
        if goes_slack(run) or not finished(run):
            return None
        runs.append(run)
        if len(runs) > 1:
            differences.append(problem.apart(runs[-2].tension, run.tension))
            extrapolated.append(_extrapolated(runs[-2], run))
        if len(runs) > 2:
            if sudden:
                error = max(_error_of_falling(differences), _front_error(problem, run, cells))
            else:
                apart = problem.apart(extrapolated[-2].tension, extrapolated[-1].tension)
                ratio = differences[-2] / max(differences[-1], 1e-300)
                at_order = _AT_ORDER[0] < ratio < _AT_ORDER[1]
                error = apart / (_FOURTH_ORDER if at_order else _BEFORE_ORDER) + _FLOOR
                if problem.native_times:  # its rows are the finest mesh's own
                    error += problem.apart(run.tension, extrapolated[-1].tension)
            if not sudden and _stalls(differences):
                return None
            if error <= problem.tolerance:
                status = Status.OK
                break
    if not runs:
        raise _too_long(problem, meshes[0])
    used = meshes[len(runs) - 1]
    if len(runs) < 3:
        status = Status.STEP_LIMIT
        error = differences[-1] if differences else np.inf
    if problem.native_times:
        run = run_chain(problem.scene, used, viscous=False, courant=courant, measured=problem.measured,
                        wind=problem.wind, native_times=True)  # fmt: skip
        return Refined(run, "nonlinear", TAUT, used, error, status)
    if sudden or not extrapolated:
        return Refined(runs[-1], "nonlinear", TAUT, used, error, status)
    best = extrapolated[-1]
    gauges = np.asarray(problem.scene.output.gauges, dtype=np.float64)
    best = replace(best, field=widened(best.field, best.time, gauges, best.tension))
    return Refined(best, "nonlinear", EXTRAPOLATED, used, error, status)


def _refine_viscous(problem: Problem, meshes: list[int], *, along: bool) -> Refined:
    """Refine with viscosity until the tension is within the tolerance or, slack, at least its peaks are."""
    differences: list[float] = []
    peak_changes: list[float] = []
    before: tuple[Solution, FloatArray] | None = None
    solution: Solution | None = None
    peaks = np.empty(0)
    of_peaks: float | None = None
    error, status, used = np.inf, Status.TOLERANCE_NOT_MET, meshes[0]
    for cells in _affordable(problem, meshes, viscous=True):
        solution, peaks = march_with_peaks(problem, cells)
        used = cells
        if not finished(solution):
            break
        if before is not None:
            rest = solution.tension[0] if problem.rest is None else problem.rest
            differences.append(problem.apart(before[0].tension, solution.tension))
            peak_changes.append(peaks_apart(before[1], peaks, rest))
            of_peaks = peak_error(problem.scene, peak_changes, along=along)
            error = _SLACK_MARGIN * max(differences[-1], 0.5 * differences[-2] if differences[1:] else 0.0)
            if differences[1:]:
                error = max(error, _error_of_falling(differences))
                status = _kept(problem, solution, differences, error, of_peaks)
            if status is not Status.TOLERANCE_NOT_MET:
                break
            next_work = 4 * cells * solution.steps
            left = len(meshes) - meshes.index(cells) - 1
            if next_work > _ENOUGH and _hopeless(problem, differences, error, left):
                break
        before = solution, peaks
    if solution is None:
        raise _too_long(problem, meshes[0])
    if not differences and status is Status.TOLERANCE_NOT_MET:
        status = Status.STEP_LIMIT
    elif status is Status.TOLERANCE_NOT_MET and goes_slack(solution):
        status = Status.NOT_SETTLED
    snap = SnapPeak(SNAP_WINDOW, peaks, of_peaks) if goes_slack(solution) else None
    if problem.native_times:
        solution = run_chain(problem.scene, used, measured=problem.measured, wind=problem.wind,
                             native_times=True)  # fmt: skip
    return Refined(solution, "nonlinear", VISCOUS, used, error, _ended(solution, status), snap)


def _kept(
    problem: Problem, solution: Solution, differences: list[float], error: float, of_peaks: float | None
) -> Status:
    """Return OK where the tolerance is kept, and PEAKS_ONLY where a slack cable keeps it in its peaks.

    One more mesh is worth its time where the tension itself would then be within the tolerance.
    """
    if error <= problem.tolerance:
        return Status.OK
    next_error = error * min(1.0, differences[-1] / max(differences[-2], 1e-300))
    if of_peaks is not None and goes_slack(solution) and of_peaks <= problem.tolerance < next_error:
        return Status.PEAKS_ONLY
    return Status.TOLERANCE_NOT_MET


def _too_long(problem: Problem, cells: int) -> DataError:
    case = chain_case(problem.scene, cells, measured=problem.measured, wind=problem.wind)
    message = (
        f"scene {problem.scene.name!r}: even {cells} cells need {case.steps:.2g} steps of "
        f"{case.time_step:.2g} s, more than {problem.node_steps:.2g} cells times steps"
    )
    return DataError(message, "shorten [output] duration, or use --fidelity catenary or linear")


def is_affordable(problem: Problem, cells: int, *, viscous: bool = True) -> bool:
    """Return whether a march on so many cells stays within the problem's cells times steps."""
    case = chain_case(problem.scene, cells, viscous=viscous, measured=problem.measured, wind=problem.wind)
    return cells * case.steps <= problem.node_steps


def _affordable(problem: Problem, meshes: list[int], *, viscous: bool) -> Iterator[int]:
    for cells in meshes:
        if not is_affordable(problem, cells, viscous=viscous):
            return
        yield cells


def _march_taut(problem: Problem, cells: int, largest: float) -> Solution:
    """March without viscosity at a Courant number of at most ``largest``; rows at the output times."""
    scene, measured, wind = problem.scene, problem.measured, problem.wind
    case = chain_case(scene, cells, viscous=False, measured=measured, wind=wind)
    courant = min(case.courant, largest)
    step = case.time_step * courant / case.courant
    few = step * scene.output.rate * _FEW_STEPS > 1.0 and not problem.sudden
    run = run_chain(
        scene, cells, viscous=False, courant=courant, measured=measured, wind=wind, native_times=few
    )
    return resampled(run, scene.output) if few else run


def _common_courant(problem: Problem, cells: int) -> float:
    """Return a Courant number for this mesh and all finer ones: the error's law in the mesh is then clean."""
    case = chain_case(problem.scene, cells, viscous=False, measured=problem.measured, wind=problem.wind)
    tension, stiffness = case.rest.tension, case.rest.stiffness
    ratio = np.sqrt(stiffness * (1.0 + tension / stiffness) / tension)
    resonant = len(case.axes) > 1 and np.any((ratio > _RESONANT[0]) & (ratio < _RESONANT[1]))
    return case.courant * (_OFF_RESONANCE if resonant else 1.0)


def _extrapolated(coarse: Solution, fine: Solution) -> Solution:
    """Return what a second-order scheme tends to, from a mesh and one of half its cells."""

    def limit(low: FloatArray, high: FloatArray) -> FloatArray:
        return np.asarray(high + (high - low) / 3.0)

    return replace(
        fine,
        tension=limit(coarse.tension, fine.tension),
        strain=limit(coarse.strain, fine.strain),
        platform_position=limit(coarse.platform_position, fine.platform_position),
        fields={name: limit(coarse.fields[name], values) for name, values in fine.fields.items()},
    )


def _front_error(problem: Problem, run: Solution, cells: int) -> float:
    """Return what rows that lie on a front may be off by, on all meshes alike.

    A sudden start sends a front of ``Z v`` along the cable, twice as high at a fixed end. A row within a step
    of its arrival may miss half of it.
    """
    case = chain_case(problem.scene, cells, viscous=False, measured=problem.measured, wind=problem.wind)
    speed = float(np.abs(velocity(problem.scene.bottom, np.zeros(1), problem.measured))[0])
    jump = float(np.sqrt(case.rest.stiffness * case.rest.mass)) * speed
    traverse = cells * case.time_step / case.courant
    gauges = np.asarray(problem.scene.output.gauges)
    trips = np.mod(run.time[1:, None] / traverse, 2.0)
    away = np.minimum(np.abs(trips - gauges), np.abs(trips - (2.0 - gauges)))
    away = np.minimum(away, np.minimum(2.0 - trips + gauges, trips + gauges))  # arrivals a round trip apart
    hit = float(np.max(np.mean(away * cells < 1.5, axis=0)))
    rest = run.tension[0] if problem.rest is None else problem.rest
    dynamic = float(np.sqrt(np.max(np.mean((run.tension - rest) ** 2, axis=0))))
    return jump * float(np.sqrt(hit)) / max(dynamic, 1e-300)


def _error_of_falling(differences: list[float]) -> float:
    """Return the finest mesh's error if differences keep falling as the last two did."""
    ratio = float(np.clip(differences[-2] / max(differences[-1], 1e-300), 1.3, 4.0))
    return differences[-1] / (ratio - 1.0)


def _stalls(differences: list[float]) -> bool:
    if len(differences) < 3:
        return False
    return differences[-1] > _SETTLES * differences[-2] and differences[-2] > _SETTLES * differences[-3]


def _hopeless(problem: Problem, differences: list[float], error: float, left: int) -> bool:
    """Return whether the error, falling as it did, stays above the tolerance on all meshes that are left."""
    if len(differences) < 3 or error <= problem.tolerance:
        return False
    ratio = np.sqrt(differences[-1] / max(differences[-3], 1e-300))
    return bool(error * min(ratio, 1.0) ** left > problem.tolerance)


def _ended(solution: Solution, status: Status) -> Status:
    return status if finished(solution) else Status.NOT_FINITE
