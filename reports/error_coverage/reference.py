"""The true error of an answer, by a reference of another kind than the solver."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from tethertest.bench.finite_volumes.march import run_axial_muscl
from tethertest.bench.spectral_elements.march import run_spectral, step_count
from tethertest.records.arrays import FloatArray
from tethertest.records.scene import Geometry, Scene
from tethertest.solver.nonlinear.chain_march import chain_case
from tethertest.solver.nonlinear.refine import refine_nonlinear
from tethertest.solver.nonlinear.snap_peak import (
    march_with_peaks,
    peaks_apart,
    running_peaks,
    with_close_rows,
)
from tethertest.solver.norms import finished, relative_difference
from tethertest.solver.numbers import scene_numbers
from tethertest.solver.problem import Problem
from tethertest.solver.statics.equilibrium import rest_chain

#: most element-steps of a spectral reference, and cell-steps of finite volumes and of a march in a band
_MOST_ELEMENT_STEPS, _MOST_VOLUME_STEPS, _MOST_CELL_STEPS = 5.0e6, 4.0e7, 2.5e8
#: relative errors asked for: a slack cable's answer is not smooth enough for less
TAUT_TOLERANCE, SLACK_TOLERANCE = 0.01, 0.05
#: tolerance of a march that judges the quasi-static model
_MARCH_TOLERANCE = 1e-3
#: elements of the coarser spectral run, and how many more the finer has
_ELEMENTS, _MORE = 3, 2
#: cells of the finite volumes
_VOLUMES = 320
#: cells of the chain whose end gives the place of a hovering platform
_FINE_CHAIN = 400
#: bows of the rest position over the length that make the band of a slack cable
_BOWS = (5e-4, -5e-4, 1e-3, -1e-3, 2e-3)


@dataclass(frozen=True, slots=True, eq=False)
class Reference:
    """What the tension really does: one series, or the band that imperfections open."""

    kind: str
    low: FloatArray  #: (n, g) [N]
    high: FloatArray  #: (n, g) [N]
    error: float  #: of the reference itself, relative; NaN where unknown
    first_gauge: int = 0  #: gauges below this one are left out
    #: lowest and highest peaks (g,) of the 20 ms mean [N], of a slack cable
    peaks: tuple[FloatArray, FloatArray] | None = None

    def distance(self, tension: FloatArray) -> float:
        """Return how far a tension (n, g) lies off, relative, in the RMS of the dynamic part."""
        middle = 0.5 * (self.low + self.high)
        off = middle + (tension - np.clip(tension, self.low, self.high))
        return relative_difference(off[:, self.first_gauge :], middle[:, self.first_gauge :])

    def peak_distance(self, peaks: FloatArray, rest: FloatArray) -> float:
        """Return how far the peaks of the 20 ms mean (g,) lie off, over the largest rise above rest."""
        if self.peaks is None:
            return float("nan")
        low, high = self.peaks
        off = peaks - np.clip(peaks, low, high)
        return peaks_apart(
            (high + off)[self.first_gauge :], high[self.first_gauge :], rest[self.first_gauge :]
        )


def taut_reference(scene: Scene) -> Reference | None:
    """Return the spectral elements' answer; None where they go slack or would take too long."""
    scene = _between_ends(scene)
    extra = int(np.ceil(_drive_waves(scene)))
    elements = _ELEMENTS + extra
    if step_count(scene, elements + _MORE) * (elements + _MORE) > _MOST_ELEMENT_STEPS:
        return None
    coarse, fine = run_spectral(scene, elements), run_spectral(scene, elements + _MORE)
    if not (finished(coarse) and finished(fine)):
        return None
    error = relative_difference(coarse.tension, fine.tension)
    return Reference("spectral elements", fine.tension, fine.tension, error)


def quasi_static_reference(scene: Scene) -> Reference:
    """Return the march's extrapolated answer, for judging the quasi-static model where elements take long."""
    march = refine_nonlinear(Problem(scene, _MARCH_TOLERANCE), scene_numbers(scene))
    return Reference("march", march.solution.tension, march.solution.tension, march.error)


def slack_reference(scene: Scene, cells: int) -> Reference | None:
    """Return the finite volumes' answer along a line, or the band of imperfections in a plane."""
    case = chain_case(scene, 4 * cells)
    if len(case.axes) == 1:
        scene = _upright(scene)
    if len(case.axes) == 1:
        if (scene.top.mass or 1.0) < 0.5 * case.rest.mass * case.rest.cell:
            return None
        if _VOLUMES * chain_case(scene, _VOLUMES).steps > _MOST_VOLUME_STEPS:
            return None
        close, finer = with_close_rows(scene)
        volumes = run_axial_muscl(close, _VOLUMES)
        tension, peaks = volumes.tension[::finer], running_peaks(volumes.time, volumes.tension)
        # where a damped slack cable is struck its tension is infinite for an instant, as 1/sqrt(t)
        first = 1 if scene.cable.axial_damping_time else 0
        return Reference("finite volumes", tension, tension, np.nan, first, (peaks, peaks))
    if 4 * cells * case.steps > _MOST_CELL_STEPS:
        return None
    problem = Problem(scene, SLACK_TOLERANCE)
    runs = [march_with_peaks(problem, 4 * cells, imperfection=bow) for bow in _BOWS]
    if not all(finished(run) for run, _ in runs):
        return None
    members, peaks = np.array([run.tension for run, _ in runs]), np.array([peaks for _, peaks in runs])
    return Reference(
        "band of imperfections",
        members.min(axis=0),
        members.max(axis=0),
        np.nan,
        peaks=(peaks.min(axis=0), peaks.max(axis=0)),
    )


def _upright(scene: Scene) -> Scene:
    """Return a scene whose platform hovers straight above as a vertical one."""
    if scene.geometry.kind != "hovering":
        return scene
    return replace(scene, geometry=Geometry("vertical"), bottom=replace(scene.bottom, direction="tangent"))


def _between_ends(scene: Scene) -> Scene:
    """Return a hovering scene as one whose platform rests at a known place."""
    if scene.geometry.kind != "hovering":
        return scene
    fine, finer = (rest_chain(scene, cells).nodes[-1] for cells in (_FINE_CHAIN, 2 * _FINE_CHAIN))
    place = finer + (finer - fine) / 3.0
    top = replace(scene.top, static_tension=None, lift=None)
    geometry = Geometry("ends", top=tuple(float(component) for component in place))
    return replace(scene, geometry=geometry, top=top)


def _drive_waves(scene: Scene) -> float:
    """Return how many half waves of the drive lie along the cable, about."""
    return 0.5 * scene_numbers(scene).drive_over_first
