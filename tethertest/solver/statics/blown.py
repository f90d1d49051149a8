"""Rest of a chain in wind and with bending stiffness.

Newton's method on the cells' forces and the nodes' positions together: the geometry of a cell is
``X[i+1] - X[i] = h (1/T + 1/EA) F``, the balance of a node ``F[i] - F[i-1] + W/n + h air + bend = 0``, with a
banded matrix however stiff the cable is. Where the length at rest is given, the cell is one unknown more.

A hovering chain in wind without bending needs no matrix: its forces are summed from the upper end down, in
sweeps that must converge as those of a Volterra equation do.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from tethertest.errors import DataError
from tethertest.records.arrays import FloatArray
from tethertest.solver.statics.air import air_by_tangent, air_on_nodes, node_tangents
from tethertest.solver.statics.chain import ChainLoad, ChainState, cell_length, leaning_chain, still_chain

IndexArray: TypeAlias = npt.NDArray[np.intp]

#: scaled residual at which a chain counts as at rest
_SETTLED = 1e-12
#: scaled residual that still counts where rounding allows no less
_ACCEPTED = 1e-10
#: smallest step of the load by which the wind and the bending are brought on
_SMALLEST_STEP = 1.0 / 512.0


@dataclass(frozen=True, slots=True, eq=False)
class _Iterate:
    """Unknowns with their residuals."""

    state: ChainState
    nodes: FloatArray  #: (n + 1, 3)
    geometry: FloatArray  #: (n, 3) [m]
    balance: FloatArray  #: (n + 1, 3) [N], of all nodes
    length: float  #: [m]
    size: float  #: largest scaled residual


def loaded_chain(load: ChainLoad) -> ChainState:
    """Return the rest of a chain under everything that acts on it.

    Raises
    ------
    DataError
        No rest was found: the wind folds the cable over, or its bending stiffness does not fit its length.
    """
    if load.windy and load.chord is None:
        start = _summed_down(load)
        return start if load.bending == 0.0 else _brought_on(load, start)
    start = still_chain(load) if not load.windy or load.chord is None else _leaning(load, load.chord)
    if not load.windy and load.bending == 0.0:
        return start
    return _brought_on(load, start)


def node_loads(load: ChainLoad, state: ChainState) -> FloatArray:
    """Return the weight and air (n + 1, 3) [N] that a whole cell around each node would carry."""
    weight = np.broadcast_to(load.weight / load.cells, (load.cells + 1, 3))
    if not load.windy:
        return np.asarray(weight)
    tangent, _ = node_tangents(state.along())
    return np.asarray(weight + state.cell * air_on_nodes(tangent, load.wind, load.drag))


def node_bending(load: ChainLoad, cell: float, nodes: FloatArray) -> FloatArray:
    """Return the bending forces (n + 1, 3) [N] on the nodes of a chain with hinged ends."""
    bend = np.zeros_like(nodes)
    bend[1:-1] = nodes[:-2] - 2.0 * nodes[1:-1] + nodes[2:]
    push = 2.0 * bend
    push[1:] -= bend[:-1]
    push[:-1] -= bend[1:]
    return np.asarray(load.bending / cell**3 * push)


def _leaning(load: ChainLoad, chord: FloatArray) -> ChainState:
    """Return a start: the push on the chord's direction as a uniform load."""
    distance = float(np.linalg.norm(chord))
    tangent = chord / distance if distance > 0.0 else np.array([1.0, 0.0, 0.0])
    return leaning_chain(load, chord, load.length * air_on_nodes(tangent[None], load.wind, load.drag)[0])


def _summed_down(load: ChainLoad) -> ChainState:
    """Return the rest of a hovering chain in wind, without bending."""
    state = still_chain(load)
    for _ in range(200):
        loads = node_loads(load, state)
        below = np.concatenate([loads[1:-1], 0.5 * loads[-1:]])
        force = load.end_force + np.cumsum(below[::-1], axis=0)[::-1]
        change = float(np.max(np.abs(force - state.force)))
        state = ChainState(cell_length(load, force), force)
        if change <= 1e-14 * float(np.max(np.abs(force))):
            return state
    raise _folded(load)


def _folded(load: ChainLoad) -> DataError:
    if load.bending == 0.0:
        message = "no rest found in this wind: its drag folds the cable over"
        return DataError(message, "lower [air] wind, or raise the tension of the cable")
    message = "no rest found with this bending stiffness: it would push part of the cable together"
    return DataError(
        message, "lower [cable] bending_stiffness or [air] wind, or raise the tension of the cable"
    )


def _brought_on(load: ChainLoad, start: ChainState) -> ChainState:
    """Return the rest under the whole load; where that fails at once, step by step."""
    nodes = start.nodes(load.stiffness)
    found = _newton(load, start, nodes)
    if found is not None:
        return found.state
    share, step, state = 0.0, 0.25, start
    if load.windy and load.chord is not None:
        state = still_chain(load)
        nodes = state.nodes(load.stiffness)
    while share < 1.0:
        target = min(1.0, share + step)
        drag = (target * load.drag[0], target * load.drag[1])
        found = _newton(replace(load, drag=drag, bending=target * load.bending), state, nodes)
        if found is None:
            step *= 0.5
            if step < _SMALLEST_STEP:
                raise _folded(load)
            continue
        state, nodes, share, step = found.state, found.nodes, target, 2.0 * step
    return state


def _newton(load: ChainLoad, start: ChainState, nodes: FloatArray) -> _Iterate | None:
    """Return the rest from a start, or None; steps are shortened until the residual falls."""
    scale = float(np.max(np.linalg.norm(start.force, axis=1)))
    rounding = np.finfo(np.float64).eps * float(np.max(np.abs(nodes)))  #: [m], which bending magnifies
    floor = rounding * load.bending / start.cell**3 / scale
    now = _iterate(load, start.cell, start.force, nodes, scale)
    for _ in range(60):
        if now.size <= max(_SETTLED, 8.0 * floor):
            return now
        force_step, node_step, cell_step = _step(load, now, scale)
        share = 1.0
        while share > 1e-3:
            cell = now.state.cell + share * cell_step
            if cell > 0.0:
                force, moved = now.state.force + share * force_step, now.nodes + share * node_step
                trial = _iterate(load, cell, force, moved, scale)
                if trial.size < (1.0 - 1e-2 * share) * now.size:
                    break
            share *= 0.5
        else:
            break
        now = trial
    return now if now.size <= max(_ACCEPTED, 64.0 * floor) else None


def _iterate(load: ChainLoad, cell: float, force: FloatArray, nodes: FloatArray, scale: float) -> _Iterate:
    state = ChainState(cell, force)
    tension = np.linalg.norm(force, axis=1)
    steps = force * (cell * (1.0 / np.maximum(tension, 1e-300) + 1.0 / load.stiffness))[:, None]
    geometry = nodes[1:] - nodes[:-1] - steps
    loads = node_loads(load, state)
    balance = loads + node_bending(load, cell, nodes)
    balance[1:-1] += force[1:] - force[:-1]
    balance[-1] += load.end_force - force[-1] - 0.5 * loads[-1]
    balance[0] = 0.0
    if load.chord is not None:
        balance[-1] = 0.0
    length = 0.0
    if load.fixed_rest_length:
        length = cell * float(np.sum(1.0 + tension / load.stiffness)) - load.length
    size = max(
        float(np.max(np.abs(geometry))) / cell,
        float(np.max(np.abs(balance))) / scale,
        abs(length) / load.length,
    )
    return _Iterate(state, nodes, geometry, balance, length, size)


def _step(load: ChainLoad, now: _Iterate, scale: float) -> tuple[FloatArray, FloatArray, float]:
    """Return Newton's step of forces (n, 3), nodes (n + 1, 3) and cell.

    Unknowns run from the bottom, forces in units of ``scale`` and nodes in cells: F[0], X[1], F[1], X[2] ..;
    equations as well: geometry of cell 0, balance of node 1, geometry of cell 1 ..
    """
    from scipy.linalg import solve_banded

    n, cell, free = load.cells, now.state.cell, load.chord is None
    last = n if free else n - 1  #: node that moves
    width = 12 if load.bending > 0.0 else 5
    band = np.zeros((2 * width + 1, 3 * (n + last)))
    one = np.eye(3)
    tension = np.maximum(np.linalg.norm(now.state.force, axis=1), 1e-300)
    along = now.state.force / tension[:, None]
    turn = (one - along[:, :, None] * along[:, None, :]) / tension[:, None, None]
    cells, nodes = np.arange(n), np.arange(1, last + 1)
    _put(band, width, 2 * cells, 2 * cells, -scale * (turn + one / load.stiffness))
    _put(band, width, 2 * cells[:last], 2 * cells[:last] + 1, one)
    _put(band, width, 2 * cells[1:], 2 * cells[1:] - 1, -one)
    above, below = np.broadcast_to(one, (n + 1, 3, 3)).copy(), np.broadcast_to(-one, (n + 1, 3, 3)).copy()
    grown = np.zeros((n + 1, 3))  #: change of the balance with the cell
    if load.windy:
        tangent, size = node_tangents(along)
        push = air_by_tangent(tangent, load.wind, load.drag) * (cell / size)[:, None, None]
        push = push - (push @ tangent[:, :, None]) * tangent[:, None, :]
        push[-1] *= 0.5
        above[:-1] += push[:-1] @ turn
        below[1:] += push[1:] @ turn
        grown += air_on_nodes(tangent, load.wind, load.drag)
        grown[-1] *= 0.5
    _put(band, width, 2 * nodes[: n - 1] - 1, 2 * nodes[: n - 1], above[1:n])
    _put(band, width, 2 * nodes - 1, 2 * nodes - 2, below[nodes])
    if load.bending > 0.0:
        rigid = load.bending / cell**2 / scale
        inner = np.zeros(n + 3)
        inner[2:-2] = 1.0  #: nodes with a bending moment, from node -1 on
        low, mid, high = inner[nodes], inner[nodes + 1], inner[nodes + 2]
        parts = (-low, 2.0 * (low + mid), -(low + 4.0 * mid + high), 2.0 * (mid + high), -high)
        for offset, part in zip(range(-2, 3), parts, strict=True):
            there = (nodes + offset >= 1) & (nodes + offset <= last)
            rows = 2 * nodes[there] - 1
            for component in range(3):
                column = 3 * (rows + 2 * offset) + component
                band[width - 6 * offset, column] += rigid * part[there]
        grown -= 3.0 / cell * node_bending(load, cell, now.nodes)
    known = np.zeros((n + last, 3, 2))
    known[0::2, :, 0] = -now.geometry / cell
    known[1::2, :, 0] = -now.balance[nodes] / scale
    known[0::2, :, 1] = along * (1.0 + tension / load.stiffness)[:, None] / cell
    known[1::2, :, 1] = -grown[nodes] / scale
    columns = 2 if load.fixed_rest_length else 1
    flat = solve_banded((width, width), band, known.reshape(-1, 2)[:, :columns], check_finite=False)
    found: FloatArray = flat.reshape(n + last, 3, columns)
    cell_step = 0.0
    if load.fixed_rest_length:
        longer = scale * cell / load.stiffness * np.einsum("ij,ijk->k", along, found[0::2])
        per_cell = float(np.sum(1.0 + tension / load.stiffness))
        cell_step = float((-now.length - longer[0]) / (longer[1] + per_cell))
        found[:, :, 0] += cell_step * found[:, :, 1]
    node_step = np.zeros((n + 1, 3))
    node_step[nodes] = cell * found[1::2, :, 0]
    return scale * found[0::2, :, 0], node_step, cell_step


def _put(band: FloatArray, width: int, rows: IndexArray, columns: IndexArray, blocks: FloatArray) -> None:
    """Add blocks (m, 3, 3) or (3, 3) at block rows and columns (m,) of a band matrix."""
    part = np.arange(3)
    row = 3 * rows[:, None, None] + part[:, None]
    column = 3 * columns[:, None, None] + part
    band[width + row - column, column] += blocks
