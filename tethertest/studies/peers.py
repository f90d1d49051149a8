"""The same scenes by MoorDyn, the lumped-mass code of the field, in the same run: error against wall time.

Both codes start from the same discrete equilibrium and are compared at their end tensions. MoorDyn reports
the tension of its end segments, half a segment from the end; that offset is removed by the momentum balance
of the half segment, from the positions of its end nodes, as `tethertest.kernels.march` does it.
"""

from __future__ import annotations

import contextlib
import math
import os
import struct
import tempfile
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from tethertest.errors import DataError
from tethertest.records.arrays import FloatArray
from tethertest.records.scene import Scene
from tethertest.solver.motion import displacement
from tethertest.solver.nonlinear.chain_march import run_chain
from tethertest.solver.norms import relative_difference
from tethertest.solver.statics.equilibrium import RestChain, rest_chain
from tethertest.solver.terms import bottom_direction
from tethertest.studies.reference_for import closed_form
from tethertest.studies.references.spectral import run_spectral
from tethertest.studies.scenes import Case, condition, condition_upright, prototype
from tethertest.studies.speed import extrapolated, marched
from tethertest.studies.timing import timed

#: segments of MoorDyn's cable, and cells of ours
SEGMENTS, CELLS = (25, 50, 100, 200, 400), (12, 25, 50, 100, 200, 400)
#: Courant number of rk4, and its limit in time step times diffusion by internal damping
_COURANT, _DIFFUSION = 0.61, 0.55
#: MoorDyn drags what is below its water surface only: the cable hangs this deep [m]
_DEPTH = 500.0
#: the fluid is thinner than air by this factor and the drag coefficients larger: no buoyancy
_THIN = 1000.0
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


def run_moordyn(scene: Scene, segments: int) -> tuple[FloatArray, float]:
    """Return MoorDyn's end tensions (n, 2) [N], their offset removed, and its loop's time [s].

    Parameters
    ----------
    scene : Scene
        In one plane under a fixed top, gauges at both ends, no wind.
    segments : int
        Of its line.

    Raises
    ------
    DataError
        MoorDyn is not installed or refuses the line.
    """
    moordyn = _moordyn()
    rest = rest_chain(scene, segments)
    interval = 1.0 / scene.output.rate
    every = math.ceil(interval / _largest_step(scene, rest))
    step = interval / every
    rows = math.floor(scene.output.duration * scene.output.rate + 1e-9) + 1
    moved = displacement(scene.bottom, np.arange(-1.0, (rows - 1) * every + 2, dtype=np.float64) * step)
    direction = bottom_direction(scene, rest.start_force)
    nodes = (0, 1, segments - 1, segments)
    place, speed = np.zeros((2, rows, 4, 3))
    with _system(moordyn, scene, rest, step) as system:
        line = moordyn.GetLine(system, 1)
        fixed = [*_deep(rest.nodes[-1])]
        began = time.perf_counter()
        for row in range(rows):
            for column, node in enumerate(nodes):
                place[row, column] = moordyn.GetLineNodePos(line, node)
                speed[row, column] = moordyn.GetLineNodeVel(line, node)
            if row == rows - 1:
                break
            for level in range(row * every, (row + 1) * every):
                points = [*_deep(moved[level + 1] * direction), *fixed]  # at the step's start
                speeds = [*((moved[level + 2] - moved[level + 1]) / step * direction), 0.0, 0.0, 0.0]
                moordyn.Step(system, points, speeds, level * step, step)
        wall = time.perf_counter() - began
    place[0] = rest.nodes[list(nodes)] - [0.0, 0.0, _DEPTH]  # loaded, not yet read back
    speed[0] = 0.0
    speed[:, 0] = ((moved[2:] - moved[:-2])[::every] / (2.0 * step))[
        :, None
    ] * direction  # not the step's mean
    acceleration = (np.diff(moved, 2)[::every] / step**2)[:, None] * direction
    return _ends(scene, rest, place, speed, acceleration), wall


def _ends(
    scene: Scene, rest: RestChain, place: FloatArray, speed: FloatArray, acceleration: FloatArray
) -> FloatArray:
    """Return the end tensions (n, 2) [N] from the end segments and the balance of half a segment.

    ``F(0) = F_1/2 - (m h/2)(a - g)``, ``F(L) = F_n-1/2 + (m h/2)(0 - g)``.
    """
    half, gravity = 0.5 * rest.mass * rest.cell, np.array([0.0, 0.0, -scene.gravity])
    damping = rest.stiffness * (scene.cable.axial_damping_time or 0.0)
    pulls = []
    for lower in (0, 2):
        chord = place[:, lower + 1] - place[:, lower]
        length = np.linalg.norm(chord, axis=1)
        rate = np.sum(chord * (speed[:, lower + 1] - speed[:, lower]), axis=1) / length / rest.cell
        elastic = rest.stiffness * np.maximum(length / rest.cell - 1.0, 0.0)
        tension = np.where(elastic > 0.0, np.maximum(elastic + damping * rate, 0.0), 0.0)
        pulls.append((tension / length)[:, None] * chord)
    ends = (pulls[0] - half * (acceleration - gravity), pulls[1] - half * gravity)
    slack = [np.linalg.norm(pull, axis=1) == 0.0 for pull in pulls]
    return np.column_stack(
        [np.where(none, 0.0, np.linalg.norm(end, axis=1)) for end, none in zip(ends, slack, strict=True)]
    )


def _largest_step(scene: Scene, rest: RestChain) -> float:
    speed = math.sqrt(rest.stiffness / rest.mass)
    damping = scene.cable.axial_damping_time or 0.0
    diffusive = _DIFFUSION * rest.cell**2 / (damping * speed**2) if damping else math.inf
    return min(_COURANT * rest.cell / speed, diffusive)


def _moordyn() -> Any:  # the package has no types
    try:
        import moordyn
    except ImportError as error:
        message = "MoorDyn is not installed"
        raise DataError(message, "pip install 'tethertest[peers]'") from error
    return moordyn


@contextlib.contextmanager
def _system(moordyn: Any, scene: Scene, rest: RestChain, step: float) -> Iterator[Any]:
    """Yield a MoorDyn system at the chain's rest."""
    points = [*_deep(rest.nodes[0]), *_deep(rest.nodes[-1])]
    with tempfile.TemporaryDirectory() as folder, _silence():
        deck, state = Path(folder, "cable.txt"), Path(folder, "rest.state")
        deck.write_text(_deck(scene, rest, step), encoding="utf-8")
        state.write_bytes(_state(rest))
        system = moordyn.Create(str(deck))
        moordyn.SetVerbosity(system, moordyn.LEVEL_ERR)
        if moordyn.Init_NoIC(system, points, [0.0] * 6):
            message = f"MoorDyn refused scene {scene.name!r}"
            raise DataError(message, "report this")
        moordyn.LoadState(system, str(state))
        try:
            yield system
        finally:
            moordyn.Close(system)


def _deck(scene: Scene, rest: RestChain, step: float) -> str:
    """Return MoorDyn's input file; both ends are coupled, for a fixed one would stay at height 0."""
    segments, air = rest.force.shape[0], scene.air
    normal, tangential, density = (0.0, 0.0, 0.0) if air is None else (
        air.normal_drag * _THIN, air.tangential_drag * _THIN, air.density / _THIN
    )  # fmt: skip
    damping = rest.stiffness * (scene.cable.axial_damping_time or 0.0)
    line = (
        scene.cable.diameter or 1e-3,
        rest.mass,
        rest.stiffness,
        damping,
        0.0,
        normal,
        0.0,
        tangential,
        0.0,
    )
    ends = [" ".join(repr(float(x)) for x in _deep(node)) for node in (rest.nodes[0], rest.nodes[-1])]
    rows = [
        "--- cable between two moved ends",
        "--- LINE TYPES ---",
        "Name Diam Mass EA BA EI Cd Ca CdAx CaAx",
        "(-) (m) (kg/m) (N) (N-s) (-) (-) (-) (-) (-)",
        "cable " + " ".join(repr(float(value)) for value in line),
        "--- POINTS ---",
        "ID Type X Y Z Mass Vol CdA Ca",
        "(-) (-) (m) (m) (m) (kg) (m3) (m2) (-)",
        f"1 Coupled {ends[0]} 0 0 0 0",
        f"2 Coupled {ends[1]} 0 0 0 0",
        "--- LINES ---",
        "ID Type A B Length Segments Out",
        "(-) (-) (-) (-) (m) (-) (-)",
        f"1 cable 1 2 {rest.cell * segments!r} {segments} -",
        "--- OPTIONS ---",
        "rk4 tScheme",
        f"{step!r} dtM",
        f"{scene.gravity!r} gravity",
        f"{max(density, 1e-12)!r} WtrDnsty",
        "5000 WtrDpth",
        "0 writeLog",
        "--- OUTPUTS ---",
        "--- END ---",
    ]
    return "\n".join(rows) + "\n"


def _state(rest: RestChain) -> bytes:
    """Return MoorDyn's state file of the chain at rest."""
    nodes = rest.nodes - [0.0, 0.0, _DEPTH]

    def block(positions: FloatArray) -> bytes:
        state = np.hstack((positions, np.zeros_like(positions)))
        return struct.pack("<QQ", len(positions), 6) + state.astype("<f8").tobytes()

    body = b"".join(block(part) for part in (nodes[:1], nodes[-1:], nodes[1:-1]))
    return b"MoorDyn\x02\x07" + struct.pack("<QQ", len(body) // 8 + 1, 3) + body


def _deep(position: FloatArray) -> list[float]:
    return [float(position[0]), float(position[1]), float(position[2]) - _DEPTH]


@contextlib.contextmanager
def _silence() -> Iterator[None]:
    """Send what MoorDyn's library prints to nowhere."""
    kept = os.dup(1)
    with Path(os.devnull).open("w", encoding="utf-8") as nowhere:
        os.dup2(nowhere.fileno(), 1)
    try:
        yield
    finally:
        os.dup2(kept, 1)
        os.close(kept)
