"""Rest of the discrete cable: the chain of cells that a march starts from.

The sampled catenary is not at rest on the mesh; this chain is, to rounding. Cell forces follow from the
first one by subtracting the loads of the nodes passed, so that two unknowns remain. Drag of a steady wind
depends on the shape and is found by repeated substitution.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tethertest.errors import DataError
from tethertest.kernels.planar import PlanarLine, drag_nodes
from tethertest.records.arrays import FloatArray, frozen
from tethertest.solver.statics.catenary_shape import ElasticCatenary

#: relative change of the wind's drag at which its shape counts as found
_SETTLED = 1e-12
#: most substitutions of the drag
_SUBSTITUTIONS = 400
#: cell force below which a cell has no direction, relative to the largest
_TINY = 1e-14


@dataclass(frozen=True, slots=True, eq=False)
class ChainRest:
    """A chain at rest."""

    x: FloatArray  #: (n + 1,) node positions from the bottom end [m]
    z: FloatArray  #: (n + 1,) [m], upwards
    force: FloatArray  #: (n, 2) x and z, the upper part on the lower [N]
    start_force: FloatArray  #: (2,) at the bottom end [N]
    end_force: FloatArray  #: (2,) at the upper end [N]

    @property
    def tension(self) -> FloatArray:
        """Tension of the cells (n,) [N]."""
        return np.asarray(np.linalg.norm(self.force, axis=1))


def chain_rest(shape: ElasticCatenary, cells: int, line: PlanarLine, chord: FloatArray) -> ChainRest:
    """Return the chain of ``cells`` cells at rest between given ends, in the line's gravity and wind.

    Parameters
    ----------
    shape : ElasticCatenary
        Rest of the continuous cable, the start of the iteration.
    cells : int
        Number of cells.
    line : PlanarLine
        Its cell, mass, stiffness, gravity, drag and wind.
    chord : (2,) float64
        Upper end minus bottom end [m].

    Raises
    ------
    DataError
        No rest was found: the wind folds the cable over.
    """
    chord = np.asarray(chord, dtype=np.float64)
    first = np.asarray(shape.force(np.array([0.5 * line.cell]))[0])
    weight = line.mass * np.array([line.gravity_x, line.gravity_z])
    air = np.zeros((cells + 1, 2))
    windy = (line.wind_x != 0.0 or line.wind_z != 0.0) and (
        line.normal_drag > 0.0 or line.tangential_drag > 0.0
    )
    for _ in range(_SUBSTITUTIONS if windy else 1):
        passed = _passed(line.cell * (weight + air))
        first = _first_force(first, passed, line, chord)
        if not windy:
            break
        blown = _air_at_rest(first - passed, line)
        change, air = float(np.max(np.abs(blown - air))), blown
        if change <= _SETTLED * float(np.max(np.abs(blown))):
            break
    else:
        message = "no rest found in this wind: its drag folds the cable over"
        raise DataError(message, "lower [air] wind, or raise the tension of the cable")
    force = first - passed
    steps = _steps(force, line)
    nodes = np.concatenate([np.zeros((1, 2)), np.cumsum(steps, axis=0)])
    half = 0.5 * line.cell
    return ChainRest(
        x=frozen(nodes[:, 0].copy()),
        z=frozen(nodes[:, 1].copy()),
        force=frozen(force),
        start_force=frozen(force[0] + half * (weight + air[0])),
        end_force=frozen(force[-1] - half * (weight + air[-1])),
    )


def _passed(loads: FloatArray) -> FloatArray:
    """Return the load (n, 2) of the nodes between the first cell and each, from nodal loads (n + 1, 2)."""
    return np.concatenate([np.zeros((1, 2)), np.cumsum(loads[1:-1], axis=0)])


def _steps(force: FloatArray, line: PlanarLine) -> FloatArray:
    """Return the vectors (n, 2) along the cells that carry the forces."""
    tension = np.linalg.norm(force, axis=1)
    size = np.maximum(tension, _TINY * np.max(tension) + 1e-300)
    return np.asarray(line.cell * force * (1.0 / size + 1.0 / line.stiffness)[:, None])


def _first_force(first: FloatArray, passed: FloatArray, line: PlanarLine, chord: FloatArray) -> FloatArray:
    """Return the first cell's force for which the chain ends at the chord, by Newton on a convex energy."""
    misfit = _steps(first - passed, line).sum(axis=0) - chord
    for _ in range(200):
        step = -np.linalg.solve(_flexibility(first - passed, line), misfit)
        slope, share = abs(float(misfit @ step)), 1.0
        for _ in range(40):
            trial = first + share * step
            new = _steps(trial - passed, line).sum(axis=0) - chord
            if abs(float(new @ step)) <= (1.0 - 1e-4 * share) * slope:
                break
            share *= 0.5
        else:
            break
        first, misfit = trial, new
        if float(np.linalg.norm(step)) <= 1e-14 * float(np.linalg.norm(first)):
            break
    length = line.cell * passed.shape[0]
    if not float(np.linalg.norm(misfit)) <= 1e-10 * length:
        message = f"no rest of the chain found: its upper end misses by {float(np.linalg.norm(misfit)):.3g} m"
        raise DataError(message, "check length, stiffness and weight of the cable, or use more cells")
    return first


def _flexibility(force: FloatArray, line: PlanarLine) -> FloatArray:
    """Return the derivative (2, 2) of the upper end's position by the force [m/N]."""
    tension = np.maximum(np.linalg.norm(force, axis=1), 1e-300)
    across = np.column_stack([-force[:, 1], force[:, 0]]) / tension[:, None]
    bend = np.einsum("ij,ik,i->jk", across, across, 1.0 / tension)
    return np.asarray(line.cell * (bend + np.eye(2) * (tension.size / line.stiffness)))


def _air_at_rest(force: FloatArray, line: PlanarLine) -> FloatArray:
    """Return the wind's force (n + 1, 2) per unstretched length on the nodes of a chain at rest."""
    along = force / np.maximum(np.linalg.norm(force, axis=1), 1e-300)[:, None]
    nodes = force.shape[0] + 1
    air, still = np.zeros((2, nodes)), np.zeros(nodes)
    along_x, along_z = np.ascontiguousarray(along[:, 0]), np.ascontiguousarray(along[:, 1])
    wind, drag = (line.wind_x, line.wind_z), (line.normal_drag, line.tangential_drag)
    drag_nodes(along_x, along_z, still, still.copy(), wind, drag, air[0], air[1])
    return np.asarray(air.T)
