"""The steady state of the article's linear cable in closed form: what the replays are held against.

Per frequency the state ``y = (u1, u2, q1, q2)`` obeys ``y' = M y`` with a constant matrix
(`tethertest.solver.linear.coupled`): ``y(x) = exp(M x) y(0)`` and two conditions at each end.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from tethertest.records.scene import Scene
from tethertest.solver.linear.coupled import (
    ComplexArray,
    CoupledCable,
    coupled_cable,
    end_body,
    local_direction,
    system_matrix,
)


@dataclass(frozen=True, slots=True, eq=False)
class Parts:
    """Complex amplitudes of force and velocity, as waves going up and down."""

    up: ComplexArray  #: (m,) [N]
    down: ComplexArray  #: (m,) [N]
    impedance: float  #: [N s/m]

    @property
    def power(self) -> np.ndarray:
        """Mean power carried upwards (m,) [W]."""
        return np.asarray((np.abs(self.up) ** 2 - np.abs(self.down) ** 2) / (2.0 * self.impedance))


@dataclass(frozen=True, slots=True, eq=False)
class Steady:
    """Waves of both kinds along the cable."""

    axial: Parts
    transverse: Parts
    work: float  #: mean power of the bottom's motion [W]


def steady_state(scene: Scene, stations: int = 81) -> Steady:
    """Return the forced motion of a shallow or straight scene's linear cable under its harmonic bottom.

    Parameters
    ----------
    scene : Scene
        Air drag takes no part.
    stations : int
        Equidistant, ends included.

    Raises
    ------
    DataError
        The geometry has no uniform tension.
    """
    from scipy.linalg import expm

    cable, bottom = coupled_cable(scene), scene.bottom
    angular = 2.0 * math.pi * (bottom.frequency or 0.0)
    s = 1j * angular
    step = expm(system_matrix(cable, np.array([s]))[0] * (cable.length / (stations - 1)))
    transfer = np.empty((stations, 4, 4), dtype=np.complex128)
    transfer[0] = np.eye(4)
    for number in range(1, stations):
        transfer[number] = step @ transfer[number - 1]
    moved = (bottom.amplitude or 0.0) * np.array(local_direction(scene, cable), dtype=np.complex128)
    force = np.linalg.solve(*_top_rows(scene, cable, s, transfer[-1], moved))
    state = transfer @ np.concatenate([moved, force])
    axial = _parts(cable.mass_per_length, cable.axial_speed, state[:, 0], state[:, 2], s)
    transverse = _parts(cable.mass_per_length, cable.transverse_speed, state[:, 1], state[:, 3], s)
    work = -0.5 * cable.mass_per_length * float(np.real(np.vdot(s * moved, force)))
    return Steady(axial, transverse, work)


def _top_rows(
    scene: Scene, cable: CoupledCable, s: complex, whole: ComplexArray, moved: ComplexArray
) -> tuple[ComplexArray, ComplexArray]:
    """Return matrix and right side for the forces at the bottom that the upper end asks for."""
    body = end_body(scene, cable)
    rows: ComplexArray = whole[:2]
    if body is not None:
        stiffness = np.asarray(body.stiffness) + s * np.asarray(body.damping) + s**2 * body.mass * np.eye(2)
        rows = stiffness @ whole[:2] + cable.mass_per_length * whole[2:]
    return rows[:, 2:], -rows[:, :2] @ moved


def _parts(mass: float, speed: float, moved: ComplexArray, force: ComplexArray, s: complex) -> Parts:
    impedance = mass * speed
    tension, share = mass * force, impedance * s * moved
    return Parts(0.5 * (tension - share), 0.5 * (tension + share), impedance)
