"""The largest 20 ms mean of the tension of a cable that snaps.

Instant by instant the tension of a slack cable depends on the mesh however fine it is; what a load cell's
bandwidth leaves of a snap settles.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from tethertest.records.arrays import FloatArray
from tethertest.records.scene import Scene
from tethertest.solver.nonlinear.chain_march import run_chain
from tethertest.solver.problem import Problem
from tethertest.solver.solution import Solution

#: averaging time: what the bandwidth of a load cell leaves of a snap [s]
SNAP_WINDOW = 0.02
#: rows that an averaging window needs
_ROWS_PER_WINDOW = 8
#: most values kept of one march for its peaks
_MOST_VALUES = 4e7
#: axial damping time from which the peaks of a cable in air settle [s]
SETTLING_DAMPING = 3e-4
#: how much of the change between the two meshes before still counts
_MEMORY = 0.5
#: margin on that change in a plane, and for marches along a line; from 12 random scenes
_MARGIN, _MARGIN_ALONG = 1.25, 2.0


def march_with_peaks(
    problem: Problem, cells: int, *, imperfection: float = 0.0
) -> tuple[Solution, FloatArray]:
    """March with viscosity and take the peaks of the running mean, from rows close enough for it.

    Parameters
    ----------
    problem : Problem
    cells : int
    imperfection : float
        Sideways bow of the rest position over the length.

    Returns
    -------
    tuple
        The solution at the output times, and the peaks (g,) [N].
    """
    scene, finer = with_close_rows(problem.scene)
    solution = run_chain(
        scene, cells, measured=problem.measured, wind=problem.wind, imperfection=imperfection
    )
    return _thinned(solution, finer), running_peaks(solution.time, solution.tension)


def with_close_rows(scene: Scene) -> tuple[Scene, int]:
    """Return a scene whose rows are close enough for 20 ms means, and how many of them make one of before."""
    values = scene.output.duration * scene.output.rate * max(1, len(scene.output.gauges))
    finer = math.ceil(_ROWS_PER_WINDOW / (SNAP_WINDOW * scene.output.rate))
    finer = max(1, min(finer, math.floor(_MOST_VALUES / max(values, 1.0))))
    # the nudge keeps the last row where rounding lets it fall just behind the end
    duration = scene.output.duration + (1e-9 / scene.output.rate if finer > 1 else 0.0)
    output = replace(scene.output, duration=duration, rate=finer * scene.output.rate)
    return replace(scene, output=output), finer


def running_peaks(time: FloatArray, tension: FloatArray) -> FloatArray:
    """Return the largest mean of the tension over 20 ms.

    Parameters
    ----------
    time : (n,) float64
        Equally spaced [s].
    tension : (n, g) float64
        [N]; a shorter record has the mean of the whole.

    Returns
    -------
    (g,) float64
        [N].
    """
    if time.size < 2:
        return np.asarray(tension[0], dtype=np.float64)
    rows = min(max(1, round(SNAP_WINDOW / float(time[1] - time[0]))), len(tension))
    sums = np.concatenate([np.zeros((1, tension.shape[1])), np.cumsum(tension, axis=0)])
    return np.asarray(np.max(sums[rows:] - sums[:-rows], axis=0) / rows)


def peaks_apart(peaks: FloatArray, reference: FloatArray, rest: FloatArray) -> float:
    """Return the largest difference of a gauge's peak over the largest rise of a peak above rest.

    Parameters
    ----------
    peaks, reference, rest : (g,) float64
        [N].
    """
    rise = float(np.max(reference - rest))
    return float(np.max(np.abs(peaks - reference))) / rise if rise > 0.0 else float("inf")


def peak_error(scene: Scene, differences: list[float], *, along: bool) -> float | None:
    """Return the error of the finest mesh's peaks from what they changed between meshes.

    Along a line they converge to first order, in a plane irregularly. None where nothing is known: without
    drag and damping the peaks go on changing by a per cent a mesh.
    """
    damped = scene.air is not None and (scene.cable.axial_damping_time or 0.0) >= SETTLING_DAMPING
    if not damped or not differences:
        return None
    before = _MEMORY * differences[-2] if differences[1:] else 0.0
    return (_MARGIN_ALONG if along else _MARGIN) * max(differences[-1], before)


def _thinned(solution: Solution, finer: int) -> Solution:
    if finer == 1:
        return solution
    rows = slice(None, None, finer)
    return replace(
        solution,
        time=solution.time[rows],
        tension=solution.tension[rows],
        strain=solution.strain[rows],
        platform_position=solution.platform_position[rows],
        fields={name: values[rows] for name, values in solution.fields.items()},
    )
