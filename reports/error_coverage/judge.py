"""Stated against true error, tolerance kept, and the time that the automatic choice loses."""

from __future__ import annotations

import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass

import numpy as np

from reports.error_coverage.random_scenes import random_scene
from reports.error_coverage.reference import (
    SLACK_TOLERANCE,
    TAUT_TOLERANCE,
    Reference,
    quasi_static_reference,
    slack_reference,
    taut_reference,
)
from tethertest.errors import DataError
from tethertest.records.response import Response, Status
from tethertest.records.scene import Scene
from tethertest.solver import solve
from tethertest.solver.nonlinear.chain_march import kept_case
from tethertest.solver.nonlinear.snap_peak import SETTLING_DAMPING
from tethertest.solver.solve import Fidelity

#: finest mesh of these solves, so that four times as many cells stay affordable
_FINEST = 160
#: largest error of a reference, over the tolerance
_SURE = 0.1
#: runs of which the fastest counts
_REPEATS = 2


@dataclass(frozen=True, slots=True)
class Judged:
    """One scene's answer and what it is worth."""

    seed: int
    kind: str
    slack: bool
    damped: bool
    fidelity: str
    cells: int
    status: str
    stated: float  #: numerical and model error together, and the imperfections' spread
    true: float
    stated_peak: float  #: the same of the largest 20 ms mean, inf where not stated
    true_peak: float
    reference: str
    reference_error: float
    tolerance: float
    wall: float  #: [s], without the members of the spread
    cheapest: float  #: [s], of the cheapest fidelity whose true error is within the tolerance

    @property
    def covered(self) -> bool:
        """Whether the stated error is at least the true one."""
        return self.stated + self.reference_error >= self.true

    @property
    def ratio(self) -> float:
        """Stated over true error; below the reference's own error the true one is not known."""
        return self.stated / max(self.true, self.reference_error, 1e-300)

    @property
    def honest(self) -> bool:
        """Whether the tolerance is met, or declared unmet."""
        if self.status == Status.PEAKS_ONLY.name:
            return self.true_peak <= self.tolerance
        return self.true <= self.tolerance or self.status != Status.OK.name

    @property
    def kept(self) -> bool:
        """Whether the tolerance is met and said to be, by the tension or, slack, by its peaks."""
        peaks = max(self.stated_peak, self.true_peak) <= self.tolerance
        return max(self.stated, self.true) <= self.tolerance or (self.slack and peaks)


@dataclass(frozen=True, slots=True)
class Skipped:
    """A scene without a verdict, and why."""

    seed: int
    reason: str
    fidelity: str = ""


def judge(seed: int) -> Judged | Skipped:
    """Solve the scene of a seed and hold it against its reference."""
    scene = random_scene(seed)
    try:
        response = solve(scene, finest=_FINEST)
        slack = _goes_slack(response)
        tolerance = SLACK_TOLERANCE if slack else TAUT_TOLERANCE
        if slack:
            response = solve(scene, finest=_FINEST, tolerance=tolerance)
        reference = slack_reference(scene, max(response.cells, 10)) if slack else taut_reference(scene)
        if reference is None and response.fidelity == "catenary":
            reference = quasi_static_reference(scene)
    except DataError as error:
        return Skipped(seed, error.problem)
    if reference is None:
        return Skipped(
            seed,
            f"the reference for a {'slack' if slack else 'taut'} cable takes too long",
            response.fidelity,
        )
    stated = _stated(response, reference)
    true = reference.distance(response.tension)
    if reference.error > _SURE * tolerance:
        return Skipped(seed, f"the reference is not sure enough ({reference.error:.1e})", response.fidelity)
    wall, cheapest = _times(scene, reference, tolerance)
    return Judged(
        seed,
        scene.geometry.kind,
        slack,
        (scene.cable.axial_damping_time or 0.0) >= SETTLING_DAMPING and scene.air is not None,
        response.fidelity,
        response.cells,
        response.status.name,
        stated,
        true,
        *_of_peaks(response, reference),
        reference.kind,
        0.0 if np.isnan(reference.error) else reference.error,
        tolerance,
        wall,
        cheapest,
    )


def judge_until(wanted: int, processes: int = 2) -> list[Judged | Skipped]:
    """Judge scenes, from seed 0 on, until so many have a verdict.

    Parameters
    ----------
    wanted : int
        Scenes with a verdict.
    processes : int
        Of one core each.
    """
    found: list[Judged | Skipped] = []
    with ProcessPoolExecutor(processes) as pool:
        while (judged := sum(isinstance(verdict, Judged) for verdict in found)) < wanted:
            batch = max(2 * processes, wanted - judged)
            found += pool.map(judge, range(len(found), len(found) + batch))
    return found


def _stated(response: Response, reference: Reference) -> float:
    """Return the error that an answer states, of the parts that its reference can see."""
    error = response.error
    if reference.kind == "finite volumes":  # along the same line: what the cable does sideways is not in it
        return error.numerical
    spread = 0.0 if reference.kind == "spectral elements" else (error.spread or 0.0)
    return error.numerical + (error.model or 0.0) + spread


def _of_peaks(response: Response, reference: Reference) -> tuple[float, float]:
    """Return the stated and the true error of a slack cable's peaks."""
    snap = response.snap
    if snap is None or snap.error is None:
        return float("inf"), float("nan")
    return snap.error, reference.peak_distance(snap.tension, response.tension[0])


def _goes_slack(response: Response) -> bool:
    return response.fidelity == "nonlinear" and float(np.min(response.field.minimum)) <= 0.0


def _times(scene: Scene, reference: Reference, tolerance: float) -> tuple[float, float]:
    """Return the time of the automatic choice, and that of the cheapest adequate fidelity."""
    wall, _ = _timed(scene, "auto", tolerance)
    best = np.inf
    for fidelity in ("catenary", "linear", "nonlinear"):
        try:
            taken, response = _timed(scene, fidelity, tolerance)
        except DataError:  # it is none of this scene's models
            continue
        same = response.tension.shape == reference.low.shape
        if same and reference.distance(response.tension) <= tolerance:
            best = min(best, taken)
    return wall, float(best)


def _timed(scene: Scene, fidelity: Fidelity, tolerance: float) -> tuple[float, Response]:
    walls = []
    for _ in range(_REPEATS):
        kept_case.cache_clear()
        began = time.perf_counter()
        response = solve(scene, fidelity=fidelity, tolerance=tolerance, finest=_FINEST, spread=False)
        walls.append(time.perf_counter() - began)
    return min(walls), response
