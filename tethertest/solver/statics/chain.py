"""The discrete cable at rest: what is asked of it, and its rest under its own weight alone.

Cell forces follow from the first one by subtracting the loads of the nodes passed; the first one is known
from the upper end's force, or found so that the chain ends where it is held.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tethertest.errors import DataError
from tethertest.records.arrays import FloatArray
from tethertest.solver.statics.catenary_shape import catenary_between, catenary_of_rest_length

#: tension below which a cell has no direction, relative to the largest
_TINY = 1e-14
#: largest misfit of the upper end, relative to the length
_CLOSED = 1e-10


@dataclass(frozen=True, slots=True, eq=False)
class ChainLoad:
    """A chain's material and what acts on it; the bottom end is held at the origin."""

    cells: int
    length: float  #: unstretched, or at rest where ``fixed_rest_length`` [m]
    fixed_rest_length: bool
    stiffness: float  #: EA [N]
    bending: float  #: EI [N m^2]
    weight: FloatArray  #: (3,) of the whole cable [N]
    wind: FloatArray  #: (3,), zero where nothing resists it [m/s]
    drag: tuple[float, float]  #: normal and tangential, per unstretched length [N s^2/m^3]
    chord: FloatArray | None  #: (3,) position of the upper end; None where its force is known [m]
    end_force: FloatArray  #: (3,) that the upper end exerts; without meaning where it is held [N]

    @property
    def windy(self) -> bool:
        """Whether the air pushes the cable."""
        return bool(np.any(self.wind))


@dataclass(frozen=True, slots=True, eq=False)
class ChainState:
    """A chain of equal cells."""

    cell: float  #: unstretched [m]
    force: FloatArray  #: (n, 3) elastic pull of the upper part on the lower [N]

    def along(self) -> FloatArray:
        """Return the cells' unit vectors (n, 3) up the cable."""
        return self.force / _sizes(self.force)[:, None]

    def nodes(self, stiffness: float) -> FloatArray:
        """Return the nodes (n + 1, 3) [m] under the stiffness EA [N]."""
        steps = self.force * (self.cell * (1.0 / _sizes(self.force) + 1.0 / stiffness))[:, None]
        return np.concatenate([np.zeros((1, 3)), np.cumsum(steps, axis=0)])

    @property
    def sharpest_turn(self) -> float:
        """Cosine of the largest angle between neighbouring cells; -1 where the chain is folded."""
        along = self.along()
        return float(np.min(np.einsum("ij,ij->i", along[:-1], along[1:])))


def still_chain(load: ChainLoad) -> ChainState:
    """Return the rest of a chain without bending under its weight alone, whatever the wind.

    Raises
    ------
    DataError
        The upper end is out of reach, or no rest was found.
    """
    below = load.weight / load.cells
    passed = np.arange(load.cells)[:, None] * below
    if load.chord is None:
        force = load.end_force + 0.5 * below + passed[::-1]
        return ChainState(cell_length(load, force), force)
    return _held(load, load.chord, passed, _first_guess(load, load.weight, load.chord))


def leaning_chain(load: ChainLoad, chord: FloatArray, push: FloatArray) -> ChainState:
    """Return the rest of a held chain under a uniform load besides its weight: a start for the wind's.

    Parameters
    ----------
    load : ChainLoad
        What is asked.
    chord : (3,) float64
        Its upper end [m].
    push : (3,) float64
        On the whole cable [N].

    Raises
    ------
    DataError
        As `still_chain`.
    """
    total = load.weight + push
    passed = np.arange(load.cells)[:, None] * (total / load.cells)
    return _held(load, chord, passed, _first_guess(load, total, chord))


def cell_length(load: ChainLoad, force: FloatArray) -> float:
    """Return the unstretched cell length [m] under cell forces (n, 3) [N]."""
    if not load.fixed_rest_length:
        return load.length / load.cells
    return load.length / float(np.sum(1.0 + np.linalg.norm(force, axis=1) / load.stiffness))


def _sizes(force: FloatArray) -> FloatArray:
    tension = np.sqrt(np.einsum("ij,ij->i", force, force))
    return np.asarray(np.maximum(tension, _TINY * float(np.max(tension)) + 1e-300))


def _first_guess(load: ChainLoad, total: FloatArray, chord: FloatArray) -> FloatArray:
    """Return the bottom cell's force (3,) of the continuous cable, in the plane of chord and load."""
    pull = float(np.linalg.norm(total))
    up = -total / pull if pull > 0.0 else chord / float(np.linalg.norm(chord))
    across = chord - (chord @ up) * up
    side = float(np.linalg.norm(across))
    if side > 0.0:
        across = across / side
    else:
        across = np.cross(up, [0.0, 1.0, 0.0] if abs(up[1]) < 0.9 else [1.0, 0.0, 0.0])
        across = across / float(np.linalg.norm(across))
    flat, level_load = np.array([side, float(chord @ up)]), np.array([0.0, -pull])
    if load.fixed_rest_length:
        shape = catenary_of_rest_length(flat, load.length, load.stiffness, level_load)
    else:
        shape = catenary_between(flat, load.length, load.stiffness, level_load / load.length)
    first = shape.force(np.array([0.5 * shape.length / load.cells]))[0]
    return np.asarray(first[0] * across + first[1] * up)


def _held(load: ChainLoad, chord: FloatArray, passed: FloatArray, first: FloatArray) -> ChainState:
    """Return the chain that ends at the chord, by Newton's method on the bottom cell's force.

    For a known unstretched length the misfit is the gradient of a convex energy: a step is shortened until
    the slope along it has fallen, and cannot overshoot twice.
    """
    state = ChainState(cell_length(load, first - passed), first - passed)
    misfit = _steps(load, state).sum(axis=0) - chord
    for _ in range(100):
        step = -np.linalg.solve(_flexibility(load, state), misfit)
        slope, share = abs(float(misfit @ step)), 1.0
        for _ in range(40):
            force = first + share * step - passed
            trial = ChainState(cell_length(load, force), force)
            new = _steps(load, trial).sum(axis=0) - chord
            if abs(float(new @ step)) <= (1.0 - 1e-4 * share) * slope:
                break
            share *= 0.5
        else:
            break
        first, state, misfit = first + share * step, trial, new
        if float(np.linalg.norm(step)) <= 1e-13 * float(np.linalg.norm(first)):
            break
    if not float(np.linalg.norm(misfit)) <= _CLOSED * load.length:
        message = (
            f"the cable cannot be taut: it hangs in a fold narrower than its {load.cells} cells can follow "
            f"(the upper end misses by {float(np.linalg.norm(misfit)):.3g} m)"
        )
        raise DataError(message, "shorten [cable] length, move [geometry] top aside, or use more cells")
    return state


def _steps(load: ChainLoad, state: ChainState) -> FloatArray:
    """Return the vectors (n, 3) along the cells [m]."""
    stretched = state.cell * (1.0 / _sizes(state.force) + 1.0 / load.stiffness)
    return np.asarray(state.force * stretched[:, None])


def _flexibility(load: ChainLoad, state: ChainState) -> FloatArray:
    """Return the derivative (3, 3) of the upper end's position by the force [m/N]."""
    sizes, along = _sizes(state.force), state.along()
    bend = np.eye(3) * float(np.sum(1.0 / sizes)) - (along / sizes[:, None]).T @ along
    result = state.cell * (bend + np.eye(3) * (load.cells / load.stiffness))
    if load.fixed_rest_length:
        shortening = -(state.cell**2) / load.length / load.stiffness * along.sum(axis=0)
        result = result + np.outer(_steps(load, state).sum(axis=0) / state.cell, shortening)
    return np.asarray(result)
