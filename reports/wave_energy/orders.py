"""Waves of each order of the drive in a settled replay, along the cable and across it.

Along and across are the directions of the cable at rest: with the force ``T t`` of the moving cable,
``F1 = T t.t0 - T0`` and ``F2 = T t.n0`` do work on ``v1 = V.t0`` and ``v2 = V.n0``; nothing else does. In the
article's linear equations the energy of both kinds of waves together, ``up^2 + down^2`` over impedance and
speed, is the whole energy of the motion: the curvature only hands it over.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from reports.wave_energy.cases import PERIODS, RAMP, SAMPLES, Case, settled
from reports.wave_energy.maps import Largest, TensionMap, largest
from tethertest.records.arrays import FloatArray
from tethertest.records.channel import Window
from tethertest.records.lines import ChannelLines, Line, LineVerdict
from tethertest.records.response import Response
from tethertest.records.waves import OrderWaves
from tethertest.solver import solve
from tethertest.solver.linear.coupled import coupled_cable
from tethertest.spectra.waves import Medium, Station, section_waves

#: orders that are told apart
ORDERS: Final = {"1/2": 0.5, "1": 1.0, "2": 2.0, "3": 3.0}
#: sections at which waves are separated, fractions of the length
SECTIONS: Final = (0.0, 0.5, 1.0)
#: cells of the replays
CELLS: Final = 80
#: a run whose halves differ by more than this has not settled
SETTLED: Final = 0.02
#: orders below this share of the first one are not told
SMALLEST: Final = 1e-3


@dataclass(frozen=True, slots=True)
class Section:
    """Waves at one section."""

    at: float  #: fraction of the length from the bottom
    along: tuple[OrderWaves, ...]
    across: tuple[OrderWaves, ...]


@dataclass(frozen=True, slots=True)
class SettledRun:
    """One drive frequency with one kind of loss."""

    frequency: float  #: [Hz]
    case: str
    sections: tuple[Section, ...]
    work: float  #: mean power of the bottom's motion [W]
    arriving: float  #: mean power that leaves through the top [W]
    largest: Largest
    lowest: float  #: lowest tension, that of rest included [N]
    impedance: float  #: of the axial wave [N s/m]
    change: float  #: of the axial force along the cable between the two halves of the window, relative

    @property
    def is_settled(self) -> bool:
        """Whether the two halves of the window agree."""
        return self.change <= SETTLED

    def order(self, at: float, order: str = "1", *, across: bool = False) -> OrderWaves | None:
        """Return the waves of one order at one section, if it is there."""
        section = next(found for found in self.sections if found.at == at)
        kind = section.across if across else section.along
        return next((waves for waves in kind if waves.order == order), None)


@dataclass(frozen=True, slots=True, eq=False)
class Forces:
    """Force and velocity in the directions of the cable at rest, (n, g) each."""

    along: FloatArray  #: [N], that of rest taken off
    across: FloatArray  #: [N]
    speed_along: FloatArray  #: [m/s]
    speed_across: FloatArray  #: [m/s]

    @property
    def power(self) -> FloatArray:
        """Mean power carried upwards (g,) [W]."""
        flow = self.along * self.speed_along + self.across * self.speed_across
        return np.asarray(-flow.mean(axis=0))


def settled_run(frequency: float, what: Case, cells: int = CELLS) -> SettledRun:
    """Replay condition 1.1 until it has settled and separate its waves.

    Parameters
    ----------
    frequency : float
        [Hz].
    what : Case
        What takes energy out.
    cells : int
        Mesh of the geometrically exact cable.
    """
    scene = settled(frequency, what)
    response = solve(scene, fidelity="nonlinear", cells=cells, spread=False)
    first = int(np.searchsorted(response.time, RAMP))
    rows = slice(first, first + PERIODS * SAMPLES)
    forces = forces_of(response, rows)
    cable, time = coupled_cable(scene), response.time[rows]
    axial = Medium(cable.mass_per_length * cable.axial_speed, cable.axial_speed, cable.length)
    lateral = Medium(cable.mass_per_length * cable.transverse_speed, cable.transverse_speed, cable.length)
    sections = []
    for at in SECTIONS:
        column = int(np.argmin(np.abs(response.gauges - at)))
        along = (forces.along[:, column], forces.speed_along[:, column])
        across = (forces.across[:, column], forces.speed_across[:, column])
        sections.append(
            Section(
                at, _waves(along, time, frequency, at, axial), _waves(across, time, frequency, at, lateral)
            )
        )
    halves = np.split(forces.along, 2)
    sizes = [math.sqrt(float(np.mean(half**2))) for half in halves]
    dynamic = response.tension[rows] - response.tension[0]
    return SettledRun(
        frequency,
        what.name,
        tuple(sections),
        work=float(forces.power[0]),
        arriving=float(forces.power[-1]),
        largest=largest(TensionMap(frequency, "exact", time, response.gauges, dynamic)),
        lowest=float(response.tension.min()),
        impedance=axial.impedance,
        change=abs(sizes[1] - sizes[0]) / max(sizes),
    )


def forces_of(response: Response, rows: slice) -> Forces:
    """Return forces and velocities of a planar response; it carries position and velocity along the cable.

    The direction of the cable comes from central differences of the gauges' positions.
    """
    slope = np.gradient(response.fields["position"], axis=1, edge_order=2)
    tangent = slope / np.linalg.norm(slope, axis=2, keepdims=True)
    rest = tangent[0]
    normal = np.stack([-rest[:, 2], np.zeros(rest.shape[0]), rest[:, 0]], axis=-1)
    force = response.tension[rows, :, None] * tangent[rows]
    velocity = response.fields["velocity"][rows]
    return Forces(
        np.einsum("tgi,gi->tg", force, rest) - response.tension[0],
        np.einsum("tgi,gi->tg", force, normal),
        np.einsum("tgi,gi->tg", velocity, rest),
        np.einsum("tgi,gi->tg", velocity, normal),
    )


def _waves(
    pair: tuple[FloatArray, FloatArray], time: FloatArray, frequency: float, at: float, medium: Medium
) -> tuple[OrderWaves, ...]:
    force, speed = pair
    return section_waves(
        Station(at, _lines("force", "N", force, time, frequency)),
        Station(at, _lines("velocity", "m/s", speed, time, frequency)),
        medium,
    )


def _lines(name: str, unit: str, series: FloatArray, time: FloatArray, frequency: float) -> ChannelLines:
    """Return the lines of a series over whole periods; their error is how far its two halves differ."""
    window = Window(float(time[0]), float(time[-1]))
    size = time.size // 2
    lines = []
    for order, multiple in ORDERS.items():
        turn = np.exp(-2j * np.pi * multiple * frequency * (time - time[0]))
        parts = [2.0 / size * complex(turn[part] @ series[part]) for part in (slice(size), slice(size, None))]
        both = 0.5 * (parts[0] + parts[1])
        error = 0.5 * abs(parts[0] - parts[1])
        lines.append(
            Line(
                order,
                multiple * frequency,
                abs(both),
                float(np.angle(both)),
                (abs(both), abs(both)),
                error,
                0.0,
                LineVerdict.HARMONIC,
                "",
            )
        )
    first = lines[list(ORDERS).index("1")].amplitude
    kept = tuple(line for line in lines if line.amplitude >= SMALLEST * first)
    return ChannelLines(name, unit, window, kept, time.size, 0)
