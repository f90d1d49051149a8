"""MoorDyn's input file and initial state for the tethered UAV."""

from __future__ import annotations

import struct

import numpy as np
from numpy.typing import NDArray

from .equilibrium import rest_shape
from .rig import GRAVITY, Hover, Rig

DEPTH = 500.0
"""MoorDyn drags only what is below its water surface: the rig stands this deep."""
FAR = 1e5
"""Distance of the anchors that the position loop's springs hang on, in m."""
PRELOAD = 100.0
"""Pull in each of those springs at rest, in N, so that they never go slack."""
THIN = 1000.0
"""The fluid is thinner than air by this factor, the drag coefficients larger: no buoyancy."""
LOOP_DENSITY = 1e-12
"""Mass per length of those springs: 0.05 mg of each rides on the UAV."""


def _row(*words: object) -> str:
    """Return one row of the input file; numbers keep all their digits."""
    return " ".join(repr(float(word)) if isinstance(word, float) else str(word) for word in words)


def input_file(rig: Rig, hover: Hover, cells: int, offset: float, step: float) -> str:
    """Return MoorDyn's input file.

    Parameters
    ----------
    rig : Rig
        Cable, UAV and air.
    hover : Hover
        The UAV's position loop: long massless springs with dampers, one upwards and, where the
        tether leans, one sideways, whose pull at rest is taken off the constant lift.
    cells : int
        Number of cable segments.
    offset : float
        How far the top stands to the side at rest, in m.
    step : float
        Integration step in s.
    """
    shape, sideways = rest_shape(rig, cells, offset)
    x, z = float(shape[-1, 0]), float(shape[-1, 1]) - DEPTH
    held = hover.stiffness > 0.0
    leaning = float(offset != 0.0)
    preload = PRELOAD if held else 0.0
    lift = rig.static_tension + rig.uav_mass * GRAVITY - preload
    rows = [
        "--- tethered UAV on the 3 m rig",
        "--- LINE TYPES ---",
        "Name Diam Mass EA BA EI Cd Ca CdAx CaAx",
        "(-) (m) (kg/m) (N) (N-s) (-) (-) (-) (-) (-)",
        _row("cable", rig.diameter, rig.mass_per_length, rig.axial_stiffness, rig.axial_damping, 0,
             rig.normal_drag * THIN, 0, rig.tangential_drag * THIN, 0),
    ]  # fmt: skip
    points = [
        _row(1, "Coupled", 0.0, 0.0, -DEPTH, 0, 0, 0, 0),
        _row(2, "Free", x, 0.0, z, rig.uav_mass, 0, sideways - leaning * preload, 0.0, lift, 0, 0),
    ]
    cables = [_row(1, "cable", 1, 2, rig.length, cells, "-")]
    if held:
        length = FAR - PRELOAD / hover.stiffness
        spring, damper = hover.stiffness * length, hover.damping * length
        rows.append(_row("loop", 1e-6, LOOP_DENSITY, spring, damper, 0, 0, 0, 0, 0))
        points.append(_row(3, "Coupled", x, 0.0, z + FAR, 0, 0, 0, 0))
        cables.append(_row(2, "loop", 2, 3, length, 1, "-"))
        if leaning:
            points.append(_row(4, "Coupled", x + FAR, 0.0, z, 0, 0, 0, 0))
            cables.append(_row(3, "loop", 2, 4, length, 1, "-"))
    rows += [
        "--- POINTS ---",
        "ID Type X Y Z Mass Vol Fx Fy Fz CdA Ca",
        "(-) (-) (m) (m) (m) (kg) (m3) (N) (N) (N) (m2) (-)",
        *points,
        "--- LINES ---",
        "ID Type A B Length Segments Out",
        "(-) (-) (-) (-) (m) (-) (-)",
        *cables,
        "--- OPTIONS ---",
        "rk4 tScheme",
        _row(step, "dtM"),
        _row(GRAVITY, "gravity"),
        _row(rig.air_density / THIN, "WtrDnsty"),
        "5000 WtrDpth",
        "0 writeLog",
        "--- OUTPUTS ---",
        "--- END ---",
    ]
    return "\n".join(rows) + "\n"


def coupled_points(rig: Rig, hover: Hover, cells: int, offset: float) -> list[float]:
    """Return the rest positions of the points whose motion is prescribed."""
    shape, _ = rest_shape(rig, cells, offset)
    x, z = float(shape[-1, 0]), float(shape[-1, 1]) - DEPTH
    base = [0.0, 0.0, -DEPTH]
    if hover.stiffness <= 0.0:
        return base
    above = [*base, x, 0.0, z + FAR]
    return [*above, x + FAR, 0.0, z] if offset else above


def rest_state(rig: Rig, hover: Hover, cells: int, offset: float) -> bytes:
    """Return MoorDyn's state file for the exact rest state of the chain."""
    shape, _ = rest_shape(rig, cells, offset)
    nodes = np.column_stack((shape[:, 0], np.zeros(cells + 1), shape[:, 1] - DEPTH))
    anchors = np.array(coupled_points(rig, hover, cells, offset)).reshape(-1, 3)
    points = [anchors[0], nodes[-1], *anchors[1:]]
    springs = len(anchors) - 1
    chunks = [_block(point[None, :]) for point in points]
    chunks.append(_block(nodes[1:-1]))
    chunks += [_block(np.zeros((0, 3))) for _ in range(springs)]
    body = b"".join(chunks)
    count = struct.pack("<Q", len(points) + 1 + springs)
    return b"MoorDyn\x02\x07" + struct.pack("<Q", len(body) // 8 + 1) + count + body


def _block(positions: NDArray[np.float64]) -> bytes:
    """Return one instance of the state file: positions at rest."""
    state = np.hstack((positions, np.zeros_like(positions)))
    return struct.pack("<QQ", len(positions), 6) + state.astype("<f8").tobytes()
