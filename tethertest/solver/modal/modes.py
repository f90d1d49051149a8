"""Natural frequencies of a vertical cable with a body on top: axial, lateral and the body's pendulum."""

from __future__ import annotations

import numpy as np

from tethertest.records.arrays import FloatArray
from tethertest.records.response import Modes, NaturalFrequency
from tethertest.records.scene import Scene
from tethertest.solver.modal.coupled_modes import coupled_modes
from tethertest.solver.statics.rest import RestState, rest_state

#: cells of the chain; the third frequency is then within 0.1 % of the continuous cable's
_CELLS = 200


def modes(scene: Scene, count: int = 3) -> Modes:
    """Return the lowest axial and lateral natural frequencies about rest.

    Parameters
    ----------
    scene : Scene
        Geometry "vertical", "straight" or "shallow".
    count : int
        How many of each kind.

    Returns
    -------
    Modes
        The lowest lateral mode of a body that is free sideways is named "pendulum".
    """
    if scene.geometry.kind == "shallow":
        return coupled_modes(scene, count)
    rest = rest_state(scene)
    centres = (np.arange(_CELLS) + 0.5) / _CELLS
    tension = rest.bottom_tension + centres * rest.weight
    sideways, upright = _hover(scene)
    axial = _chain(scene, rest, np.full(_CELLS, rest.axial_stiffness), upright)
    lateral = _chain(scene, rest, tension / (1.0 + tension / rest.axial_stiffness), sideways)
    pendulum = scene.top.kind == "platform" and sideways == 0.0
    names = [f"axial {i + 1}" for i in range(count)]
    names += ["pendulum"] if pendulum else []
    names += [f"lateral {i + 1}" for i in range(count - 1 if pendulum else count)]
    values = [*axial[:count], *lateral[:count]]
    return Modes(
        tuple(NaturalFrequency(name, float(value)) for name, value in zip(names, values, strict=True))
    )


def _hover(scene: Scene) -> tuple[float, float]:
    stiffness = scene.top.hover_stiffness
    if isinstance(stiffness, tuple):
        return float(stiffness[0]), float(stiffness[-1])
    return stiffness, stiffness


def _chain(scene: Scene, rest: RestState, force_per_strain: FloatArray, hover: float) -> FloatArray:
    """Return the ascending frequencies [Hz] of a chain whose links resist with ``force_per_strain``."""
    from scipy.linalg import eigh_tridiagonal

    cell = rest.length / _CELLS
    link = force_per_strain / cell
    stiffness = link[:-1] + link[1:]
    mass = np.full(_CELLS - 1, rest.mass_per_length * cell)
    coupling = -link[1:-1]
    if scene.top.kind == "platform":
        stiffness = np.append(stiffness, link[-1] + hover)
        mass = np.append(mass, (scene.top.mass or 0.0) + 0.5 * rest.mass_per_length * cell)
        coupling = -link[1:]
    squared = eigh_tridiagonal(
        stiffness / mass,
        coupling / np.sqrt(mass[:-1] * mass[1:]),
        eigvals_only=True,
        select="i",
        select_range=(0, 5),
    )
    return np.asarray(np.sqrt(squared) / (2.0 * np.pi))
