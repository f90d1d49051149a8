"""How far a slack cable's answer moves with what nobody knows: its damping and its straightness.

The members run on a coarse mesh and are compared with the nominal run on that mesh, so that the mesh's own
error cancels.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from tethertest.records.arrays import FloatArray
from tethertest.solver.nonlinear.chain_march import chain_case, run_chain
from tethertest.solver.norms import finished
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
    bows: float  #: the same over bows of the rest position
    upright: bool  #: the nominal run follows a line, and its members a plane: bows are another model
    peaks: tuple[float, float]  #: lowest and highest peak over the nominal one, of the nominal's own kind
    #: (n, g) [N] each, the nominal run on the members' mesh first; empty where that broke off
    members: tuple[FloatArray, ...] = ()

    @property
    def largest(self) -> float:
        """The largest distance of the members that are of the nominal run's own kind."""
        return max(0.0 if self.upright else self.bows, self.damping or 0.0)


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
    known = scene.cable.axial_damping_time
    upright = len(chain_case(scene, mesh, measured=measured, wind=wind).axes) == 1

    def tension(damping_time: float | None, bow: float) -> FloatArray | None:
        damped = replace(scene, cable=replace(scene.cable, axial_damping_time=damping_time))
        solution = run_chain(damped, mesh, measured=measured, wind=wind, imperfection=bow)
        return solution.tension if finished(solution) else None

    nominal = tension(known, 0.0)
    if nominal is None:
        return Spread(None, np.inf, upright, (0.0, np.inf))
    damped = [tension(time, 0.0) for time in DAMPING_BAND] if known is None else []
    bowed = [tension(known, bow) for bow in IMPERFECTIONS]
    alike = damped if upright else [*damped, *bowed]
    peaks = [1.0, *(float(np.max(member) / np.max(nominal)) for member in alike if member is not None)]

    def farthest(members: list[FloatArray | None]) -> float:
        distances = [np.inf if member is None else problem.apart(member, nominal) for member in members]
        return max(distances, default=0.0)

    return Spread(
        damping=farthest(damped) if known is None else None,
        bows=farthest(bowed),
        upright=upright,
        peaks=(min(peaks), max(peaks)),
        members=(nominal, *(member for member in (*damped, *bowed) if member is not None)),
    )
