"""The truth: MoorDyn's lumped-mass cable under the rig's base motion."""

from __future__ import annotations

import contextlib
import os
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import moordyn
import numpy as np
from numpy.typing import NDArray

from .deck import DEPTH, FAR, LOOP_DENSITY, coupled_points, input_file, rest_state
from .equilibrium import rest_shape
from .rig import GAUGES, GRAVITY, Hover, Rig

Floats = NDArray[np.float64]
Motion = Callable[[Floats], Floats]

COURANT = 0.61
DIFFUSION = 0.55
"""Step times damping over mass per length and spacing squared; rk4 diverges above 0.69."""
RECORD_RATE = 2500.0


@dataclass(frozen=True)
class Truth:
    """True signals at `RECORD_RATE`, free of any instrument.

    Parameters
    ----------
    time, heave : ndarray
        Seconds from the start of the run and the base's height in m.
    tension_bottom, tension_top : ndarray
        Vertical pull at the two ends in N, negative in compression.
    strain : ndarray
        Tension strain at the gauges, one row per gauge.
    top : ndarray
        Position of the UAV relative to its rest position, rows x and z.
    """

    time: Floats
    heave: Floats
    tension_bottom: Floats
    tension_top: Floats
    strain: Floats
    top: Floats


def time_step(rig: Rig, cells: int) -> float:
    """Return the integration step: an integer part of the record's step."""
    record = 1.0 / RECORD_RATE
    spacing = rig.length / cells
    diffusive = DIFFUSION * rig.mass_per_length * spacing**2 / rig.axial_damping
    wanted = min(COURANT * spacing / rig.wave_speed, diffusive)
    return record / int(np.ceil(record / wanted))


def simulate(
    rig: Rig, hover: Hover, motion: Motion, duration: float, cells: int, offset: float = 0.0
) -> Truth:
    """Integrate one run from its exact rest state.

    Parameters
    ----------
    rig, hover : Rig, Hover
        The rig and the UAV's position loop.
    motion : callable
        Height of the base in m at the times given in s.
    duration : float
        Length of the run in s.
    cells : int
        Number of cable segments.
    offset : float
        How far the top stands to the side at rest, in m.
    """
    step = time_step(rig, cells)
    every = round(1.0 / (RECORD_RATE * step))
    records = round(duration * RECORD_RATE) + 1
    clock = np.arange(-1, (records - 1) * every + 2) * step
    height = motion(clock)
    watched = sorted({*_gauge_nodes(cells), 0, 1, cells - 1, cells})
    position = np.zeros((records, len(watched), 3))
    velocity = np.zeros((records, len(watched), 3))
    with _system(rig, hover, cells, offset, step) as system:
        line = moordyn.GetLine(system, 1)
        points = coupled_points(rig, hover, cells, offset)
        speeds = [0.0] * len(points)
        mean_speed = np.diff(height[1:]) / step
        for record in range(records):
            for column, node in enumerate(watched):
                position[record, column] = moordyn.GetLineNodePos(line, node)
                velocity[record, column] = moordyn.GetLineNodeVel(line, node)
            if record == records - 1:
                break
            for index in range(record * every, (record + 1) * every):
                points[2] = height[index + 1] - DEPTH
                speeds[2] = mean_speed[index]
                moordyn.Step(system, points, speeds, index * step, step)
    shape, _ = rest_shape(rig, cells, offset)
    position[0, :, [0, 2]] = (shape[watched] - [0.0, DEPTH]).T  # loaded, not yet read back
    velocity[0] = 0.0
    velocity[:, 0, 2] = (height[2:] - height[:-2])[::every] / (2.0 * step)  # not the step's mean
    acceleration = np.diff(height, 2) / step**2
    base = height[1:-1:every], acceleration[::every]
    return _signals(rig, hover, cells, offset, watched, position, velocity, base)


@contextlib.contextmanager
def _system(rig: Rig, hover: Hover, cells: int, offset: float, step: float) -> Iterator[object]:
    """Yield a MoorDyn system at rest."""
    points = coupled_points(rig, hover, cells, offset)
    with tempfile.TemporaryDirectory() as folder, _silence():
        deck = Path(folder, "tether.txt")
        deck.write_text(input_file(rig, hover, cells, offset, step))
        system = moordyn.Create(str(deck))
        moordyn.SetVerbosity(system, moordyn.LEVEL_ERR)
        if moordyn.Init_NoIC(system, points, [0.0] * len(points)):
            msg = "MoorDyn refused the tether"
            raise RuntimeError(msg)
        state = Path(folder, "rest.state")
        state.write_bytes(rest_state(rig, hover, cells, offset))
        moordyn.LoadState(system, str(state))
        try:
            yield system
        finally:
            moordyn.Close(system)


@contextlib.contextmanager
def _silence() -> Iterator[None]:
    """Send what MoorDyn's library prints to nowhere."""
    kept = os.dup(1)
    with Path(os.devnull).open("w") as nowhere:
        os.dup2(nowhere.fileno(), 1)
    try:
        yield
    finally:
        os.dup2(kept, 1)
        os.close(kept)


def _gauge_nodes(cells: int) -> set[int]:
    """Return the nodes of the segments around every gauge."""
    nodes: set[int] = set()
    for gauge in GAUGES:
        first = int(np.floor(gauge * cells - 0.5))
        nodes |= {first, first + 1, first + 2}
    return {node for node in nodes if 0 <= node <= cells}


def _segment_force(
    rig: Rig, spacing: float, lower: tuple[Floats, Floats], upper: tuple[Floats, Floats]
) -> tuple[Floats, Floats]:
    """Return a segment's signed tension and its vertical part, from its nodes."""
    chord = upper[0] - lower[0]
    length = np.linalg.norm(chord, axis=1)
    rate = np.sum(chord * (upper[1] - lower[1]), axis=1) / length / spacing
    elastic = np.maximum(rig.axial_stiffness * (length / spacing - 1.0), 0.0)
    tension = elastic + rig.axial_damping * rate
    return tension, tension * chord[:, 2] / length


def _signals(
    rig: Rig,
    hover: Hover,
    cells: int,
    offset: float,
    watched: list[int],
    position: Floats,
    velocity: Floats,
    base: tuple[Floats, Floats],
) -> Truth:
    """Turn node positions and velocities into what ideal sensors would read."""
    spacing = rig.length / cells
    column = {node: index for index, node in enumerate(watched)}

    def segment(lower: int) -> tuple[Floats, Floats]:
        a, b = column[lower], column[lower + 1]
        return _segment_force(
            rig,
            spacing,
            (position[:, a], velocity[:, a]),
            (position[:, b], velocity[:, b]),
        )

    half_cell = 0.5 * rig.mass_per_length * spacing
    bottom = segment(0)[1] - half_cell * (base[1] + GRAVITY)
    shape, _ = rest_shape(rig, cells, offset)
    rest = np.array([shape[-1, 0], 0.0, shape[-1, 1] - DEPTH])
    moved = position[:, column[cells]] - rest
    last = segment(cells - 1)[1]
    top = top_tension(rig, hover, half_cell, last, moved, velocity[:, column[cells], 2])
    strain = np.zeros((len(GAUGES), len(position)))
    for row, gauge in enumerate(GAUGES):
        place = gauge * cells - 0.5
        first = int(np.floor(place))
        weight = place - first
        pair = segment(first)[0], segment(min(first + 1, cells - 1))[0]
        strain[row] = ((1.0 - weight) * pair[0] + weight * pair[1]) / rig.axial_stiffness
    time = np.arange(len(position)) / RECORD_RATE
    return Truth(time, base[0], bottom, top, strain, moved[:, [0, 2]].T)


def top_tension(
    rig: Rig, hover: Hover, half_cell: float, last: Floats, moved: Floats, climb: Floats
) -> Floats:
    """Return the pull on the UAV from the last segment's pull and the half cell above it.

    Parameters
    ----------
    rig, hover : Rig, Hover
        The rig and the UAV's position loop.
    half_cell : float
        Mass of half a segment in kg.
    last : ndarray
        Vertical pull of the last segment in N.
    moved, climb : ndarray
        The UAV's displacement from rest (rows of x, y, z) and its vertical speed.
    """
    loop = -hover.stiffness * moved[:, 2] - hover.damping * climb
    net = rig.static_tension + loop - half_cell * GRAVITY - last
    carried = half_cell + (0.5 * LOOP_DENSITY * FAR if hover.stiffness else 0.0)
    acceleration = net / (rig.uav_mass + carried)
    return last + half_cell * (acceleration + GRAVITY)
