"""A scene by MoorDyn, the lumped-mass code of the field.

It starts from the same discrete equilibrium as our march and is compared at its end tensions. MoorDyn reports
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
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from tethertest.bench.case import Case
from tethertest.errors import DataError
from tethertest.records.arrays import FloatArray
from tethertest.records.scene import Scene
from tethertest.solver.motion import displacement
from tethertest.solver.statics.equilibrium import RestChain, rest_chain
from tethertest.solver.terms import bottom_direction, steady_wind

#: Courant number of rk4, and its limit in time step times diffusion by internal damping
_COURANT, _DIFFUSION = 0.61, 0.55
#: MoorDyn drags what is below its water surface only: the cable hangs this deep [m]
_DEPTH = 500.0
#: the fluid is thinner than air by this factor and the drag coefficients larger: no buoyancy
_THIN = 1000.0


def moordyn_knows(case: Case) -> bool:
    """Return whether MoorDyn, as it is used here, has all that a scene has: a fixed top and no wind."""
    still = case.wind is None and not np.any(steady_wind(case.scene))
    return case.scene.top.kind == "fixed" and case.scene.bottom.motion != "measured" and still


def import_moordyn() -> Any:
    """Return the MoorDyn package, which has no types.

    Raises
    ------
    DataError
        It is not installed.
    """
    try:
        import moordyn
    except ImportError as error:
        message = "MoorDyn is not installed"
        raise DataError(message, "pip install 'tethertest[peers]'") from error
    return moordyn


def moordyn_steps(scene: Scene, segments: int) -> int:
    """Return the steps of a run on so many segments."""
    return _steps_per_row(scene, rest_chain(scene, segments)) * math.floor(
        scene.output.duration * scene.output.rate + 1e-9
    )


def run_moordyn(scene: Scene, segments: int) -> tuple[FloatArray, float]:
    """Return MoorDyn's end tensions (n, 2) [N], their offset removed, and its loop's time [s].

    Parameters
    ----------
    scene : Scene
        Under a fixed top, no wind.
    segments : int
        Of its line.

    Raises
    ------
    DataError
        MoorDyn is not installed or refuses the line.
    """
    moordyn = import_moordyn()
    rest = rest_chain(scene, segments)
    interval = 1.0 / scene.output.rate
    every = _steps_per_row(scene, rest)
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


def _steps_per_row(scene: Scene, rest: RestChain) -> int:
    speed = math.sqrt(rest.stiffness / rest.mass)
    damping = scene.cable.axial_damping_time or 0.0
    diffusive = _DIFFUSION * rest.cell**2 / (damping * speed**2) if damping else math.inf
    return math.ceil(1.0 / scene.output.rate / min(_COURANT * rest.cell / speed, diffusive))


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
