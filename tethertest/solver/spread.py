"""How far a slack cable's answer moves with what nobody knows: its damping and its straightness.

The members run on a coarse mesh and are compared with the nominal run on that mesh, so that the mesh's own
error cancels.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from tethertest.records.arrays import FloatArray
from tethertest.solver.nonlinear.chain_march import chain_case, run_chain
from tethertest.solver.norms import finished, relative_difference
from tethertest.solver.problem import Problem

#: axial damping times tried where the damping is unknown [s]; a judged range, not measured
DAMPING_BAND = (3e-4, 1e-3, 3e-3)
#: bows of the rest position over the length
IMPERFECTIONS = (5e-4, -1e-3, 2e-3)
#: cells of the members, at most
_COARSE = 20


@dataclass(frozen=True, slots=True, eq=False)
class Spread:
    """Distance of the members from the nominal run, and the range of their largest tension over its own."""

    damping: float | None  #: relative, RMS of the dynamic part; None where the damping is known
    imperfections: float
    peaks: tuple[float, float]  #: lowest and highest peak over the nominal one

    @property
    def largest(self) -> float:
        """The larger of the two."""
        return max(self.imperfections, self.damping or 0.0)


def slack_spread(problem: Problem, cells: int) -> Spread:
    """Run the members of a scene that goes slack.

    Parameters
    ----------
    problem : Problem
    cells : int
        Cells of the solution; the members take at most `_COARSE`.
    """
    scene, measured, wind = problem.scene, problem.measured, problem.wind
    mesh = min(cells, _COARSE)

    def tension(damping_time: float | None, bow: float) -> FloatArray | None:
        cable = replace(scene.cable, axial_damping_time=damping_time)
        solution = run_chain(
            replace(scene, cable=cable), mesh, measured=measured, wind=wind, imperfection=bow
        )
        return solution.tension if finished(solution) else None

    known = scene.cable.axial_damping_time
    nominal = tension(known, 0.0)
    if nominal is None:
        return Spread(None, np.inf, (0.0, np.inf))
    flat = len(chain_case(scene, mesh, measured=measured, wind=wind).axes) > 1
    damped = [tension(time, 0.0) for time in DAMPING_BAND] if known is None else []
    bowed = [tension(known, bow) for bow in IMPERFECTIONS] if flat else []
    peak = float(np.max(nominal))
    peaks = [1.0, *(float(np.max(member)) / peak for member in (*damped, *bowed) if member is not None)]
    return Spread(
        damping=_farthest(damped, nominal) if known is None else None,
        imperfections=_farthest(bowed, nominal),
        peaks=(min(peaks), max(peaks)),
    )


def sideways_error(problem: Problem, cells: int) -> float:
    """Return what an upright cable's march along its line misses: slack, it also bows sideways."""
    mesh = min(cells, _COARSE)
    nominal = run_chain(problem.scene, mesh, measured=problem.measured, wind=problem.wind)
    bowed = []
    for bow in IMPERFECTIONS:
        member = run_chain(
            problem.scene, mesh, measured=problem.measured, wind=problem.wind, imperfection=bow
        )
        bowed.append(member.tension if finished(member) else None)
    return _farthest(bowed, nominal.tension)


def _farthest(members: list[FloatArray | None], nominal: FloatArray) -> float:
    distances = [np.inf if member is None else relative_difference(member, nominal) for member in members]
    return max(distances, default=0.0)
