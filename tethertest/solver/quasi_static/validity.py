"""How wrong the quasi-static cable is, from its own output, and whether it may be used."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from tethertest.records.arrays import FloatArray
from tethertest.records.scene import MeasuredMotion, Scene
from tethertest.solver.motion import smooth_step
from tethertest.solver.quasi_static.moved_ends import MovedEnds, moved_ends
from tethertest.solver.quasi_static.neglected import (
    CELLS,
    NeglectedLoad,
    neglected_load,
    tension_response,
)
from tethertest.solver.quasi_static.rest_case import RestCase, rest_case

#: factor on the prediction that makes it cover nearly every scene measured (docs/quasi-static.md)
MARGIN = 1.5
#: swing beyond which a cable is too near slack, or too easily pumped by its own changing tension, for an
#: answer that is linear about one of its states
LARGEST_SWING = 10.0
#: tension below which a cable counts as slack, relative to its largest at rest
_SLACK = 1e-6
#: most rows that the neglected load is answered over; a longer record is judged by its stretch of most motion
_MOST_ROWS = 2**13
#: share of such a stretch over which its load is brought on
_BROUGHT_ON = 0.05
#: stations at which the corrected tension is looked at for slack, as fractions of the length
_STATIONS = np.linspace(0.0, 1.0, CELLS + 1)


@dataclass(frozen=True, slots=True)
class QuasiStaticEstimate:
    """The predicted error of the quasi-static model for one scene.

    Errors are relative as in `tethertest.records.response.ErrorBudget`: the largest RMS error of a gauge over
    the largest RMS of a gauge's dynamic part, here that of the corrected tension.
    """

    error: float  #: the largest of the three; infinite where the quasi-static cable itself goes slack
    about_rest: float  #: neglected load answered by the cable at rest
    about_weakest: float  #: by the cable at its lowest tension
    about_strongest: float  #: by the cable at its highest tension
    lowest_tension: float  #: of the cable with the neglected load's answer added, anywhere, ever [N]
    swing: float  #: highest over lowest tension of one place on the cable, the worst of all places
    #: third harmonic of the drive over the first lateral frequency at lowest tension; 0 without one frequency
    frequency_ratio: float

    @property
    def slack(self) -> bool:
        """Whether the cable goes slack, in the model or with its neglected load."""
        return self.lowest_tension <= 0.0


@dataclass(frozen=True, slots=True)
class Permission:
    """Whether the quasi-static model may stand for a scene, and why."""

    allowed: bool
    reason: str
    estimate: QuasiStaticEstimate


def quasi_static_error(scene: Scene, *, measured: MeasuredMotion | None = None) -> QuasiStaticEstimate:
    """Return the predicted error of `tethertest.solver.quasi_static.catenary_run.run_catenary`.

    The motion of the quasi-static cable implies inertia and drag that it leaves out. A linear chain about one
    of its states answers these forces, dynamic amplification and drag damping included; that answer is the
    error to first order. The states are rest, lowest and highest tension of the record: the true cable lies
    between them, and the largest of the three answers counts.

    Parameters
    ----------
    scene : Scene
        As for `run_catenary`; a measured motion must be sampled finely enough by the output rate.
    measured : MeasuredMotion, optional
        Bottom displacement for ``motion = "measured"``.

    Raises
    ------
    DataError
        As `run_catenary`.
    """
    case = rest_case(scene)
    ends = moved_ends(scene, case, measured)
    weakest = float(np.min(case.cable.lowest_tension(ends.force)))
    ratio = _frequency_ratio(scene, case, weakest)
    if weakest <= _SLACK * float(np.linalg.norm(case.top_force)):
        return QuasiStaticEstimate(math.inf, math.inf, math.inf, math.inf, 0.0, math.inf, ratio)
    gauges = np.asarray(scene.output.gauges, dtype=np.float64)
    points = np.concatenate([gauges, _STATIONS])
    stretch, load = _loudest(case, ends)
    tension = case.cable.tension(stretch.force, points)
    dynamic = tension - case.cable.tension(case.force[None], points)
    errors = []
    lowest = np.min(tension, axis=0)
    for state in _states(case, ends):
        answer = tension_response(case, load, state, points)
        errors.append(_relative(answer[:, : gauges.size], dynamic[:, : gauges.size]))
        lowest = np.minimum(lowest, np.min(tension + answer, axis=0))
    least = max(0.0, float(np.min(lowest)))
    swing = float(np.max(np.max(tension, axis=0) / lowest)) if least > 0.0 else math.inf
    rest, weak, strong = errors
    return QuasiStaticEstimate(max(errors), rest, weak, strong, least, swing, ratio)


def quasi_static_allowed(
    scene: Scene, *, tolerance: float | None = None, measured: MeasuredMotion | None = None
) -> Permission:
    """Return whether the quasi-static model meets a scene's tolerance, with the margin of the estimate.

    Never where the cable goes slack, in the model or with its neglected load, or comes near to it.

    Parameters
    ----------
    scene : Scene
    tolerance : float, optional
        Relative error wanted; the scene's own if absent.
    measured : MeasuredMotion, optional
        Bottom displacement for ``motion = "measured"``.

    Raises
    ------
    DataError
        As `quasi_static_error`.
    """
    wanted = scene.accuracy.tolerance if tolerance is None else tolerance
    estimate = quasi_static_error(scene, measured=measured)
    if estimate.slack:
        return Permission(False, "the cable goes slack; use --fidelity nonlinear", estimate)
    if estimate.swing > LARGEST_SWING:
        swing = f"the tension swings by a factor of {estimate.swing:.3g}, close to slack"
        return Permission(False, f"{swing}; use --fidelity nonlinear", estimate)
    bound = MARGIN * estimate.error
    says = f"the quasi-static model is within {bound:.2g} of the dynamic tension, {wanted:.2g} is wanted"
    if not bound <= wanted:
        return Permission(False, f"{says}; use --fidelity nonlinear", estimate)
    return Permission(True, says, estimate)


def _loudest(case: RestCase, ends: MovedEnds) -> tuple[MovedEnds, NeglectedLoad]:
    """Return the rows to be judged, all of a record that is not too long, and their neglected load."""
    rows = ends.time.size
    if rows <= _MOST_ROWS:
        return ends, neglected_load(case, ends)
    summed = np.concatenate([[0.0], np.cumsum(np.sum(ends.bottom**2, axis=1))])
    start = int(np.argmax(summed[_MOST_ROWS:] - summed[:-_MOST_ROWS]))
    kept = slice(start, start + _MOST_ROWS)
    stretch = MovedEnds(ends.time[kept], ends.every, ends.bottom[kept], ends.top[kept], ends.force[kept])
    load = neglected_load(case, stretch)
    share = smooth_step(np.arange(_MOST_ROWS) / (_BROUGHT_ON * _MOST_ROWS))[:, None, None]
    return stretch, NeglectedLoad(load.force * share, load.velocity * share, load.interval)


def _states(case: RestCase, ends: MovedEnds) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the bottom forces (3,) at rest, at the lowest and at the highest tension."""
    middle = case.cable.tension(ends.force, np.array([0.5]))[:, 0]
    return case.force, ends.force[np.argmin(middle)], ends.force[np.argmax(middle)]


def _relative(answer: FloatArray, dynamic: FloatArray) -> float:
    """Return the largest RMS of the answer over that of the corrected dynamic part."""
    error, corrected = (
        math.sqrt(float(np.max(np.mean(values**2, axis=0)))) for values in (answer, dynamic + answer)
    )
    return error / corrected if corrected > 0.0 else 0.0


def _frequency_ratio(scene: Scene, case: RestCase, lowest: float) -> float:
    """Return the drive's third harmonic over the first lateral frequency of a fixed cable."""
    if lowest <= 0.0:
        return math.inf
    first = math.sqrt(lowest / case.mass) / (2.0 * case.cable.length)
    return 3.0 * (scene.bottom.frequency or 0.0) / first
