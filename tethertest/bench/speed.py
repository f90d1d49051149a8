"""Speed against error of every model and mesh on a scene, by a reference of another kind."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Annotated

import numpy as np

from tethertest.bench.case import Case
from tethertest.bench.moordyn import import_moordyn, moordyn_knows, moordyn_steps, run_moordyn
from tethertest.bench.reference_for import Reference, is_sudden, reference_for
from tethertest.bench.timing import timed
from tethertest.errors import DataError
from tethertest.records.arrays import FloatArray
from tethertest.records.described import Doc
from tethertest.records.response import Response
from tethertest.solver import solve
from tethertest.solver.nonlinear.chain_march import chain_case, run_chain
from tethertest.solver.norms import finished, relative_difference
from tethertest.solver.quasi_static.catenary_run import run_catenary
from tethertest.solver.resample import resampled
from tethertest.solver.solution import Solution

#: meshes of the nonlinear model and of the two-grid characteristics
MESHES, PAIR_MESHES = (10, 20, 40, 80, 160, 320), (27, 55, 110, 220)
#: window of the mean whose peak is steadier than the raw one [s]
MEAN_WINDOW = 0.02
#: rows per window below which such a mean says nothing
_ROWS_PER_WINDOW = 4
#: steps per output row below which rows are read by a cubic
_FEW_STEPS = 8.0
#: damping that makes a slack cable's tension converge [s], and the time over which a jump is spread [s]
SNAP_DAMPING, SPREAD_JUMP = 1e-3, 0.2
#: longest march that the table is worth, and the longest one of MoorDyn [cells x steps]
_WORTH, _PEER_WORTH = 3e9, 2e7
#: segments of MoorDyn's cable
SEGMENTS = (25, 50, 100, 200)


@dataclass(frozen=True, slots=True)
class Entry:
    """One run of one model."""

    curve: Annotated[str, Doc("what the runs of one line in the figure have in common")]
    cells: Annotated[int, Doc("of the mesh; 0 without one")]
    wall: Annotated[float, Doc("time that the solve took [s]")]
    error: Annotated[float | None, Doc("RMS of the difference over that of the dynamic part")]
    peak: Annotated[float | None, Doc("largest tension over the reference's, less 1")]
    mean_peak: Annotated[float | None, Doc("peak of the 20 ms mean; null: rows are too far apart")]


@dataclass(frozen=True, slots=True)
class Chosen:
    """What the solver chose by itself, and its own word on the error."""

    fidelity: Annotated[str, Doc("catenary, linear or nonlinear")]
    scheme: Annotated[str, Doc("of the model")]
    status: Annotated[str, Doc("ok, or what is wrong with the answer")]
    numerical: Annotated[float | None, Doc("stated error from successive meshes, relative")]
    model: Annotated[float | None, Doc("stated error against the next fidelity, relative")]
    spread: Annotated[float | None, Doc("stated, from unknown damping and straightness, relative")]
    run: Entry


@dataclass(frozen=True, slots=True)
class SceneSpeed:
    """A scene's runs."""

    scene: Annotated[str, Doc("name of the scene's file")]
    title: Annotated[str, Doc("name in the file")]
    reference: Annotated[str, Doc("what all runs are held against")]
    reference_kind: Annotated[str, Doc("how the reference solves")]
    reference_error: Annotated[float | None, Doc("from the next coarser reference of its kind")]
    chosen: Chosen
    entries: Annotated[tuple[Entry, ...], Doc("every model and mesh that was run")]
    remark: Annotated[str, Doc("how a variant differs from the scene")] = ""


@dataclass(frozen=True, slots=True)
class Measured:
    """What ``bench --json`` prints."""

    scenes: Annotated[tuple[SceneSpeed, ...], Doc("in the order given, variants after their scene")]


def measure_cases(cases: Iterable[Case], *, with_peers: bool = False) -> tuple[SceneSpeed, ...]:
    """Measure scenes, and their variants where a scene itself cannot say all.

    Parameters
    ----------
    cases : iterable of Case
    with_peers : bool
        Also run MoorDyn where it knows the scene.

    Raises
    ------
    DataError
        A scene has no rest, or MoorDyn is asked for and not installed.
    """
    if with_peers:
        import_moordyn()  # told before minutes are spent
    found = []
    for case in cases:
        measured = scene_speed(case, with_peers=with_peers)
        found.append(measured)
        for variant, remark in variants(case, measured):
            found.append(scene_speed(variant, remark=remark, with_peers=with_peers))
    return tuple(found)


def scene_speed(
    case: Case, *, remark: str = "", meshes: tuple[int, ...] = MESHES, with_peers: bool = False
) -> SceneSpeed:
    """Measure a scene.

    Parameters
    ----------
    case : Case
    remark : str
        Goes into the table.
    meshes : tuple of int
        Of the nonlinear model, each twice the one before.
    with_peers : bool
        Also run MoorDyn where it knows the scene.

    Raises
    ------
    DataError
        The scene has no rest.
    """
    reference = reference_for(case)
    response, wall = timed(lambda: solve(case.scene, measured=case.measured, wind=case.wind))
    return SceneSpeed(
        scene=case.name,
        title=case.scene.name,
        reference=reference.name,
        reference_kind=reference.kind,
        reference_error=reference.own_error,
        chosen=_chosen(response, wall, case, reference),
        entries=(*_forced(case, reference, meshes), *(_by_moordyn(case, reference) if with_peers else ())),
        remark=remark,
    )


def variants(case: Case, measured: SceneSpeed) -> Iterator[tuple[Case, str]]:
    """Yield the scenes that say what a scene itself cannot: a damped snap, a jump spread over some time.

    Parameters
    ----------
    case : Case
    measured : SceneSpeed
        Its own figures.
    """
    scene = case.scene
    slack = measured.chosen.spread is not None
    if slack and scene.cable.axial_damping_time is None:
        cable = replace(scene.cable, axial_damping_time=SNAP_DAMPING)
        remark = "axial damping time 1 ms, which an undamped snap needs to converge pointwise"
        yield replace(case, name=f"{case.name}, damped", scene=replace(scene, cable=cable)), remark
    if measured.reference_kind == "same scheme" and scene.bottom.motion == "harmonic" and is_sudden(case):
        bottom = replace(scene.bottom, start="ramp", ramp=SPREAD_JUMP)
        remark = f"the jump spread over {SPREAD_JUMP:g} s, which another discretisation can follow"
        yield replace(case, name=f"{case.name}, spread jump", scene=replace(scene, bottom=bottom)), remark


def marched(case: Case, cells: int, *, viscous: bool, smooth: bool) -> Solution:
    """March a scene once; where steps are few and the start is smooth, rows are read by a cubic."""
    known = {"measured": case.measured, "wind": case.wind}
    chain = chain_case(case.scene, cells, viscous=viscous, **known)  # type: ignore[arg-type]
    few = smooth and chain.time_step * case.scene.output.rate * _FEW_STEPS > 1.0
    run = run_chain(case.scene, cells, viscous=viscous, native_times=few, **known)  # type: ignore[arg-type]
    return resampled(run, case.scene.output) if few else run


def _chosen(response: Response, wall: float, case: Case, reference: Reference) -> Chosen:
    error = response.error
    return Chosen(
        fidelity=response.fidelity,
        scheme=response.scheme,
        status=response.status.name.lower(),
        numerical=_number(error.numerical),
        model=_number(error.model),
        spread=_number(error.spread),
        run=_entry("auto", response.cells, response.tension, wall, case, reference),
    )


def _forced(case: Case, reference: Reference, meshes: tuple[int, ...]) -> Iterator[Entry]:
    """Yield every model that takes the scene."""
    scene, measured, wind = case.scene, case.measured, case.wind

    def add(curve: str, cells: int, job: Callable[[], Solution | Response]) -> Iterator[Entry]:
        try:
            answer, wall = timed(job)
        except DataError:  # the scene has what this model leaves out
            return
        done = not isinstance(answer, Solution) or finished(answer)
        tension = answer.tension if done else np.full_like(reference.tension, np.nan)
        yield _entry(curve, cells, tension, wall, case, reference)

    if wind is None:
        yield from add("catenary", 0, lambda: run_catenary(scene, measured=measured))
    yield from add(
        "linear, exact", 0, lambda: solve(scene, measured=measured, wind=wind, scheme="exact", cells=50)
    )
    for cells in PAIR_MESHES:
        for scheme in ("two-grid", "as-printed"):
            yield from add(
                f"linear, {scheme}",
                cells,
                lambda cells=cells, scheme=scheme: solve(  # type: ignore[misc]
                    scene, measured=measured, wind=wind, scheme=scheme, cells=cells
                ),
            )
    smooth = not is_sudden(case)
    slack = solve(scene, measured=measured, wind=wind, fidelity="nonlinear", cells=40, spread=False)
    taut = float(np.min(slack.field.minimum)) > 0.0
    for viscous in (False, True):
        name = "nonlinear, viscous" if viscous else "nonlinear, plain"
        for cells in meshes:
            if _work(case, cells, viscous) <= _WORTH:
                yield from add(
                    name,
                    cells,
                    lambda cells=cells, viscous=viscous: marched(  # type: ignore[misc]
                        case, cells, viscous=viscous, smooth=smooth
                    ),
                )
    if not (taut and smooth):
        return
    for coarse, fine in pairwise(meshes):
        if _work(case, fine, False) <= _WORTH:
            yield from add(
                "nonlinear, extrapolated",
                fine,
                lambda pair=(coarse, fine): extrapolated(case, *pair),  # type: ignore[misc]
            )


def extrapolated(case: Case, coarse: int, fine: int) -> Solution:
    """Return what two marches without viscosity tend to, the finer having twice the cells."""
    first, second = (marched(case, cells, viscous=False, smooth=True) for cells in (coarse, fine))
    return replace(second, tension=second.tension + (second.tension - first.tension) / 3.0)


def _work(case: Case, cells: int, viscous: bool) -> float:
    chain = chain_case(case.scene, cells, viscous=viscous, measured=case.measured, wind=case.wind)
    return float(cells) * chain.steps


def _entry(
    curve: str, cells: int, tension: FloatArray, wall: float, case: Case, reference: Reference
) -> Entry:
    first = reference.first_gauge
    return _compared(curve, cells, wall, tension[:, first:], reference.tension[:, first:], case)


def _by_moordyn(case: Case, reference: Reference) -> Iterator[Entry]:
    """Yield MoorDyn's runs, compared at the gauges that stand at an end of the cable."""
    gauges = np.asarray(case.scene.output.gauges)
    at_end = np.flatnonzero((gauges == 0.0) | (gauges == 1.0))
    at_end = at_end[at_end >= reference.first_gauge]
    if at_end.size == 0 or not moordyn_knows(case):
        return
    end_of = gauges[at_end].astype(np.intp)  # MoorDyn's columns: bottom, top
    for segments in SEGMENTS:
        if segments * moordyn_steps(case.scene, segments) > _PEER_WORTH:
            return
        try:
            tension, wall = run_moordyn(case.scene, segments)
        except DataError:  # it refuses the line, or there is no rest on so few segments
            return
        yield _compared("MoorDyn", segments, wall, tension[:, end_of], reference.tension[:, at_end], case)


def _compared(curve: str, cells: int, wall: float, found: FloatArray, exact: FloatArray, case: Case) -> Entry:
    window = round(MEAN_WINDOW * case.scene.output.rate)
    peak = float(np.max(found)) / float(np.max(exact)) - 1.0
    mean = mean_peak(found, window) / mean_peak(exact, window) - 1.0 if window >= _ROWS_PER_WINDOW else None
    return Entry(curve, cells, wall, _number(relative_difference(found, exact)), _number(peak), _number(mean))


def mean_peak(tension: FloatArray, window: int) -> float:
    """Return the largest running mean of any gauge over so many rows."""
    sums = np.cumsum(np.vstack([np.zeros(tension.shape[1]), tension]), axis=0)
    return float(np.max(sums[window:] - sums[:-window])) / window


def _number(value: float | None) -> float | None:
    return value if value is not None and np.isfinite(value) else None
