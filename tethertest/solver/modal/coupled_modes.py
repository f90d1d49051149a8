"""Natural frequencies and shapes of the linear coupled cable, none missed and none spurious.

How many natural frequencies lie below a given one is counted exactly (Wittrick and Williams), and each is
found by bisection on that count: pairs however close are told apart, and no determinant is searched.

References
----------
Wittrick & Williams, Q. J. Mech. Appl. Math. 24 (1971) 263.
Irvine & Caughey, Proc. R. Soc. Lond. A 341 (1974) 299.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from tethertest.records.arrays import FloatArray
from tethertest.records.response import Modes, NaturalFrequency
from tethertest.records.scene import Scene
from tethertest.solver.linear.coupled import CoupledCable, EndBody, coupled_cable, end_body, undamped_transfer

#: halvings of a bracket; the frequencies are then exact to rounding
_HALVINGS = 52
#: two frequencies closer than this relative gap share one plane of shapes
_DOUBLE = 1e-10


@dataclass(frozen=True, slots=True, eq=False)
class CoupledMode:
    """One in-plane mode; the larger of its two largest displacements is 1."""

    frequency: float  #: [Hz]
    position: FloatArray  #: (m,) fraction of the length from the bottom
    tangential: FloatArray  #: (m,) displacement along the cable
    normal: FloatArray  #: (m,) displacement towards the centre of curvature
    axial_strain: FloatArray  #: (m,) eps1 [1/m]
    axial_share: float  #: part of the kinetic energy that moves along the cable, 0-1


def coupled_modes(scene: Scene, count: int = 5) -> Modes:
    """Return the lowest in-plane and out-of-plane natural frequencies of a shallow scene.

    Raises
    ------
    DataError
        The geometry has no uniform tension, or its tension is missing.
    """
    cable = coupled_cable(scene)
    hover = scene.top.hover_stiffness
    sideways = hover if isinstance(hover, float | int) else float(hover[1 if len(hover) == 3 else 0])
    mass = None if scene.top.kind == "fixed" else scene.top.mass or 0.0
    named = {
        "in-plane": in_plane_frequencies(cable, count, end_body(scene, cable)),
        "out-of-plane": out_of_plane_frequencies(cable, count, mass=mass, stiffness=sideways),
    }
    return Modes(
        tuple(
            NaturalFrequency(f"{name} {number}", float(frequency))
            for name, frequencies in named.items()
            for number, frequency in enumerate(frequencies, start=1)
        )
    )


def in_plane_count(cable: CoupledCable, frequency: FloatArray, top: EndBody | None = None) -> FloatArray:
    """Return how many in-plane natural frequencies of the undamped cable lie below each frequency.

    A piece of length x with both ends held has none below ``ct/2x``: its energy is at least that of a
    string in each direction, since the curvature only turns the frame. Two pieces joined have those of both
    plus the negative eigenvalues of the dynamic stiffness at the joint; a body at the top counts as well.

    Parameters
    ----------
    cable : CoupledCable
        Bottom fixed.
    frequency : (n,) float64
        [Hz], above zero.
    top : EndBody, optional
        Body at the top; fixed if absent.

    Returns
    -------
    (n,) float64
        Whole numbers.
    """
    angular = 2.0 * np.pi * np.atleast_1d(np.asarray(frequency, dtype=np.float64))
    string_modes = float(np.max(angular)) * cable.length / (math.pi * cable.transverse_speed)
    doublings = max(0, math.ceil(math.log2(string_modes * 1.01)) + 1) if string_modes > 0.0 else 0
    count = np.zeros(angular.size)
    piece = cable.length / 2**doublings
    for _ in range(doublings):
        bottom, upper = _end_stiffness(cable, angular, piece)
        count = 2.0 * count + _negatives(bottom + upper)
        piece *= 2.0
    if top is not None:
        _, upper = _end_stiffness(cable, angular, cable.length)
        body = np.asarray(top.stiffness)[None] - (top.mass * angular**2)[:, None, None] * np.eye(2)
        count = count + _negatives(cable.mass_per_length * upper + body)
    return count


def in_plane_frequencies(cable: CoupledCable, count: int = 5, top: EndBody | None = None) -> FloatArray:
    """Return the lowest in-plane natural frequencies of the undamped cable, ascending [Hz].

    Parameters
    ----------
    cable : CoupledCable
        Bottom fixed.
    count : int
        How many; a double frequency appears twice.
    top : EndBody, optional
        Body at the top; fixed if absent. Its damping takes no part.

    Returns
    -------
    (count,) float64
    """
    high = cable.transverse_speed / (2.0 * cable.length)
    while in_plane_count(cable, np.array([high]), top)[0] < count:
        high *= 2.0
    upper = np.full(count, high)
    lower = np.zeros(count)
    wanted = np.arange(1, count + 1)
    for _ in range(_HALVINGS):
        middle = 0.5 * (lower + upper)
        reached = in_plane_count(cable, middle, top) >= wanted
        upper = np.where(reached, middle, upper)
        lower = np.where(reached, lower, middle)
    return np.asarray(0.5 * (lower + upper))


def in_plane_modes(
    cable: CoupledCable, count: int = 5, top: EndBody | None = None, stations: int = 201
) -> tuple[CoupledMode, ...]:
    """Return the lowest in-plane modes with their shapes.

    Parameters
    ----------
    cable, count, top
        As in `in_plane_frequencies`.
    stations : int
        Equidistant stations of the shapes, ends included.
    """
    frequencies = in_plane_frequencies(cable, count, top)
    modes: list[CoupledMode] = []
    for index, frequency in enumerate(frequencies):
        angular = 2.0 * math.pi * float(frequency)
        end = undamped_transfer(cable, np.array([angular]), cable.length)[0]
        rows = end[:2, 2:]
        if top is not None:
            body = np.asarray(top.stiffness) - top.mass * angular**2 * np.eye(2)
            rows = body @ end[:2, 2:] + cable.mass_per_length * end[2:, 2:]
        vectors = np.linalg.svd(rows)[2]
        twin = index > 0 and frequency - frequencies[index - 1] < _DOUBLE * frequency
        modes.append(_shape(cable, float(frequency), vectors[0 if twin else 1], stations, top))
    return tuple(modes)


def _shape(
    cable: CoupledCable, frequency: float, force: FloatArray, stations: int, top: EndBody | None
) -> CoupledMode:
    position = np.linspace(0.0, 1.0, stations)
    angular = np.full(stations, 2.0 * math.pi * frequency)
    states = undamped_transfer(cable, angular, position * cable.length)[:, :, 2:] @ force
    displacements = states[:, :2]
    largest = displacements.flat[np.argmax(np.abs(displacements))]
    states = states / largest
    squares = np.trapezoid(states[:, :2] ** 2, dx=cable.length / (stations - 1), axis=0)
    energy = cable.mass_per_length * np.asarray(squares)
    if top is not None:
        energy = energy + top.mass * states[-1, :2] ** 2
    return CoupledMode(
        frequency=frequency,
        position=position,
        tangential=states[:, 0],
        normal=states[:, 1],
        axial_strain=states[:, 2] / cable.axial_square,
        axial_share=float(energy[0] / (energy[0] + energy[1])),
    )


def _end_stiffness(cable: CoupledCable, angular: FloatArray, length: float) -> tuple[FloatArray, FloatArray]:
    """Return the stiffness over rl at the lower and upper end of a piece, the other end held, (n, 2, 2)."""
    transfer = undamped_transfer(cable, angular, length)
    flexible = transfer[:, :2, 2:]
    inverse = np.empty_like(flexible)
    inverse[:, 0, 0], inverse[:, 1, 1] = flexible[:, 1, 1], flexible[:, 0, 0]
    inverse[:, 0, 1], inverse[:, 1, 0] = -flexible[:, 0, 1], -flexible[:, 1, 0]
    determinant = flexible[:, 0, 0] * flexible[:, 1, 1] - flexible[:, 0, 1] * flexible[:, 1, 0]
    inverse /= np.where(determinant == 0.0, np.finfo(np.float64).tiny, determinant)[:, None, None]
    return inverse @ transfer[:, :2, :2], transfer[:, 2:, 2:] @ inverse


def _negatives(matrix: FloatArray) -> FloatArray:
    """Return the number of negative eigenvalues of symmetric 2 x 2 matrices."""
    determinant = matrix[:, 0, 0] * matrix[:, 1, 1] - matrix[:, 0, 1] * matrix[:, 1, 0]
    trace = matrix[:, 0, 0] + matrix[:, 1, 1]
    return np.where(determinant < 0.0, 1.0, np.where(trace < 0.0, 2.0, 0.0))


def out_of_plane_frequencies(
    cable: CoupledCable, count: int = 5, *, mass: float | None = None, stiffness: float = 0.0
) -> FloatArray:
    """Return the lowest out-of-plane natural frequencies, equation (27), ascending [Hz].

    Parameters
    ----------
    cable : CoupledCable
        Bottom fixed.
    count : int
    mass : float, optional
        Of the body at the top [kg]; without it the top is fixed, and the frequencies are ``n ct/2L``.
    stiffness : float
        With which the body is held out of the plane [N/m].
    """
    string = cable.transverse_speed / (2.0 * cable.length)
    numbers = np.arange(1, count + 1)
    if mass is None:
        return np.asarray(numbers * string)
    impedance = cable.mass_per_length * cable.transverse_speed
    lower, upper = string * (numbers - 1.0), string * numbers  # the body adds one frequency to those below
    for _ in range(_HALVINGS):
        middle = 0.5 * (lower + upper)
        angular = 2.0 * np.pi * middle
        spring = impedance * angular / np.tan(np.pi * middle / string) + stiffness - mass * angular**2
        lower, upper = np.where(spring > 0.0, middle, lower), np.where(spring > 0.0, upper, middle)
    return np.asarray(0.5 * (lower + upper))
