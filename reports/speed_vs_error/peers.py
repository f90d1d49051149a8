"""The same scenes by MoorDyn, the lumped-mass code of the field, in the same run: error against wall time.

How MoorDyn is run, and what its end tensions are, stands in `tethertest.bench.moordyn`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from reports.scenes import condition, condition_upright, prototype
from tethertest.bench.case import Case
from tethertest.bench.moordyn import run_moordyn
from tethertest.bench.reference_for import closed_form
from tethertest.bench.spectral_elements.march import run_spectral
from tethertest.bench.speed import extrapolated, marched
from tethertest.bench.timing import timed
from tethertest.errors import DataError
from tethertest.records.arrays import FloatArray
from tethertest.records.scene import Scene
from tethertest.solver.nonlinear.chain_march import run_chain
from tethertest.solver.norms import relative_difference

#: segments of MoorDyn's cable, and cells of ours
SEGMENTS, CELLS = (25, 50, 100, 200, 400), (12, 25, 50, 100, 200, 400)
#: cells of the finest march, which the slack case is measured with
_FINEST = 1280
#: segments above which a stiff slack case would take minutes
_SLACK_SEGMENTS = 200


@dataclass(frozen=True, slots=True)
class PeerRun:
    """One run of one code."""

    code: str
    cells: int
    wall: float  #: [s]
    error: float  #: against the reference
    apart: float | None = None  #: of MoorDyn from ours on as many cells, where no third code knows the scene


@dataclass(frozen=True, slots=True)
class PeerScene:
    """A scene by both codes."""

    scene: str
    reference: str
    runs: tuple[PeerRun, ...]

    def ratios(self) -> tuple[tuple[int, float, str, int], ...]:
        """Return, per run of MoorDyn, its time over that of our cheapest run that is at least as accurate."""
        ours = [run for run in self.runs if run.code != "MoorDyn"]
        found = []
        for run in self.runs:
            if run.code == "MoorDyn":
                good = [one for one in ours if one.error <= run.error]
                if good:
                    best = min(good, key=lambda one: one.wall)
                    found.append((run.cells, run.wall / best.wall, best.code, best.cells))
        return tuple(found)


def peers(segments: Sequence[int] = SEGMENTS, cells: Sequence[int] = CELLS) -> tuple[PeerScene, ...]:
    """Run the three scenes by both codes.

    Raises
    ------
    DataError
        MoorDyn is not installed.
    """
    upright, level = condition_upright(0.25), condition(0.18)
    exact = closed_form(upright)
    if exact is None:
        message = "the upright cable of condition 1.1 goes slack, which it should not"
        raise DataError(message, "report this")
    return (
        _taut("taut, vertical, 0.25 Hz", upright, "d'Alembert's series", exact, segments, cells),
        _taut(
            "condition 1.1, level, 0.18 Hz",
            level,
            "12 spectral elements of degree 8",
            run_spectral(level, 12).tension,
            segments,
            cells,
        ),
        _slack(segments),
    )


def _taut(
    name: str, scene: Scene, reference: str, exact: FloatArray, segments: Sequence[int], cells: Sequence[int]
) -> PeerScene:
    case = Case(name, scene)
    runs = []
    for mesh in cells:
        solution, wall = timed(lambda mesh=mesh: marched(case, mesh, viscous=False, smooth=True))  # type: ignore[misc]
        runs.append(PeerRun("plain", mesh, wall, relative_difference(solution.tension, exact)))
        if mesh % 2 == 0:
            solution, wall = timed(lambda mesh=mesh: extrapolated(case, mesh // 2, mesh))  # type: ignore[misc]
            runs.append(PeerRun("extrapolated", mesh, wall, relative_difference(solution.tension, exact)))
    for mesh in segments:
        tension, wall = run_moordyn(scene, mesh)
        runs.append(PeerRun("MoorDyn", mesh, wall, relative_difference(tension, exact)))
    return PeerScene(name, reference, tuple(runs))


def _slack(segments: Sequence[int]) -> PeerScene:
    """Run the tether at 45 degrees in air, damped: MoorDyn also against our march on as many cells."""
    scene = prototype(45.0)
    scene = replace(scene, cable=replace(scene.cable, axial_damping_time=1e-3))
    finest = run_chain(scene, _FINEST).tension
    meshes = [mesh for mesh in segments if mesh <= _SLACK_SEGMENTS]
    runs, ours = [], {}
    for mesh in (12, *meshes, 2 * meshes[-1]):
        solution, wall = timed(lambda mesh=mesh: run_chain(scene, mesh))  # type: ignore[misc]
        ours[mesh] = solution.tension
        runs.append(PeerRun("viscous", mesh, wall, relative_difference(solution.tension, finest)))
    for mesh in meshes:
        tension, wall = run_moordyn(scene, mesh)
        apart = relative_difference(tension, ours[mesh])
        runs.append(PeerRun("MoorDyn", mesh, wall, relative_difference(tension, finest), apart))
    reference = f"our own march on {_FINEST} cells; in brackets, MoorDyn from ours on as many cells"
    return PeerScene("slack, 45 degrees in air, damping time 1 ms", reference, tuple(runs))
