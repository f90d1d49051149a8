"""The linear coupled cable by characteristics on two grids: a march that keeps its fronts.

Both waves run whole cells per step: ``dt = L/(c1 N1)``, and ``N2`` is the whole number next to ``N1 c1/ct``.
What the rounding leaves is an error in the transverse speed alone (`GridPair.speed_error`), that of a tension
twice as far off.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from tethertest.errors import DataError
from tethertest.kernels.two_grid import Body, IntArray, Overlap, Place, Record, Tension, march
from tethertest.records.arrays import FloatArray
from tethertest.records.response import Field
from tethertest.records.scene import MeasuredMotion, Scene
from tethertest.solver.linear.coupled import (
    CoupledCable,
    EndBody,
    coupled_cable,
    end_angle,
    end_body,
    local_direction,
)
from tethertest.solver.linear.coupled_fronts import start_velocity
from tethertest.solver.motion import displacement, velocity
from tethertest.solver.solution import FIELD_BINS, Solution
from tethertest.solver.terms import leaves_plane

#: fewest cells of the axial grid
LEAST_CELLS = 4
#: the axial grid may have this many times the cells asked for where the two speeds then fit better
_SPARE = 1.5


@dataclass(frozen=True, slots=True)
class GridPair:
    """Cells of the two grids."""

    axial: int
    transverse: int
    speed_error: float  #: relative error of the transverse speed


def grid_pair(ratio: float, cells: int) -> GridPair:
    """Return the pair of grids that fits the two speeds best, of `cells` to half as many more axial cells.

    The fewest cells are taken whose speed error is not beaten by more: the pairs are those of the continued
    fraction of ``c1/ct`` wherever one of them lies in the range.

    Parameters
    ----------
    ratio : float
        ``c1/ct``, at least 1.
    cells : int
        Least number of axial cells.
    """

    def pair(axial: int) -> GridPair:
        transverse = round(axial * ratio)
        return GridPair(axial, transverse, ratio * axial / transverse - 1.0)

    return min((pair(n) for n in range(cells, int(_SPARE * cells) + 1)), key=lambda one: abs(one.speed_error))


def run_two_grid(
    scene: Scene, cells: int, *, measured: MeasuredMotion | None = None, native_times: bool = False
) -> Solution:
    """March a shallow or straight scene once from rest.

    At output times between time levels, and at gauges between nodes, the fields are interpolated linearly: a
    front is spread over one cell there and nowhere else.

    Parameters
    ----------
    scene : Scene
        Geometry "shallow" or "straight", motion in the plane of the cable. Air drag is left out.
    cells : int
        Least number of axial cells, at least `LEAST_CELLS`; `grid_pair` says which number is taken.
    measured : MeasuredMotion, optional
        Bottom displacement for ``motion = "measured"``.
    native_times : bool
        Rows at the time levels ``k dt`` instead of at the output rate.

    Returns
    -------
    Solution
        The field's stations are the axial nodes.

    Raises
    ------
    DataError
        The cable has no uniform tension or is damped along its length, the motion leaves the plane or starts
        with a displacement, or there are too few cells.
    """
    cable = checked_cable(scene, cells)
    pair = grid_pair(cable.axial_speed / cable.transverse_speed, cells)
    step = cable.length / (cable.axial_speed * pair.axial)
    transverse_cell = cable.length / pair.transverse
    speed = transverse_cell / step
    bottom = bottom_velocity(scene, cable, step, measured)
    bottom[0] *= 0.5  # a front's own node carries its mean: the front then lies there, not half a cell ahead
    record = empty_record(scene, (pair.axial, pair.transverse), step, bottom.shape[0], native=native_times)
    tension = Tension(cable.tension, cable.axial_stiffness, cable.axial_speed, speed)
    half_turn = 0.5 * step * cable.curvature
    done = march(
        bottom,
        _overlap(pair.axial, pair.transverse),
        (half_turn * speed, half_turn * cable.axial_speed),
        body_step(end_body(scene, cable), cable.mass_per_length * np.array([cable.axial_speed, speed]), step),
        tension,
        (step, transverse_cell),
        record,
    )
    return solution_of(scene, cable, tension, record, (step, done, bottom.shape[0] - 1), measured)


def checked_cable(scene: Scene, cells: int) -> CoupledCable:
    """Return the linear cable of a scene that a march on so many cells can take; raises as `run_two_grid`."""
    cable = coupled_cable(scene)
    if cable.axial_damping_time > 0.0:
        message = f"scene {scene.name!r}: the linear characteristics know no axial damping"
        raise DataError(message, "leave out [cable] axial_damping_time, or use the exact transform")
    if leaves_plane(scene):
        message = f"scene {scene.name!r}: the linear characteristics follow the cable's plane alone"
        raise DataError(message, "turn the axes so that y is 0, or use the exact transform")
    if cells < LEAST_CELLS:
        message = f"scene {scene.name!r}: {cells} cells are too few for the characteristics"
        raise DataError(message, f"give at least {LEAST_CELLS}")
    return cable


def bottom_velocity(
    scene: Scene, cable: CoupledCable, step: float, measured: MeasuredMotion | None
) -> FloatArray:
    """Return the bottom's velocity (k + 1, 2) [m/s] along tangent and normal at the time levels.

    Raises
    ------
    DataError
        The motion leaves the plane of the cable or starts with a displacement.
    """
    direction = np.array(local_direction(scene, cable))
    motion = _motion(scene, measured)
    time = np.arange(math.ceil(scene.output.duration / step - 1e-9) + 1, dtype=np.float64) * step
    start_velocity(motion, motion(time), step)  # refuses a displacement at the start
    return np.asarray(velocity(scene.bottom, time, measured)[:, None] * direction)


def body_step(top: EndBody | None, impedance: FloatArray, step: float) -> Body:
    """Return the exact step of the top end under waves that grow linearly between time levels.

    ``M v,t = Z (a - v) - C v - K u`` with the arriving ``a = v - g``. Without mass the velocity follows the
    force and the displacement alone has a memory.

    Parameters
    ----------
    top : EndBody or None
        None is fixed.
    impedance : (2,) float64
        ``Z``, mass per length times wave speeds [N s/m].
    step : float
        [s].
    """
    from scipy.linalg import expm

    body = Body(np.zeros((4, 4)), np.zeros((4, 2)), np.zeros((4, 2)))
    if top is None:
        return body
    stiffness, push = np.asarray(top.stiffness), np.diag(impedance)
    resistance = np.asarray(top.damping) + push
    order = 4 if top.mass > 0.0 else 2
    rate = np.zeros((order + 4, order + 4))  # of the state, of the waves, and of the waves' slope
    if top.mass > 0.0:
        rate[:2, 2:4] = np.eye(2)
        rate[2:4, :2] = -stiffness / top.mass
        rate[2:4, 2:4] = -resistance / top.mass
        rate[2:4, 4:6] = push / top.mass
    else:
        rate[:2, :2] = -np.linalg.solve(resistance, stiffness)
        rate[:2, 2:4] = np.linalg.solve(resistance, push)
    rate[order : order + 2, order + 2 :] = np.eye(2)
    moved = expm(rate * step)
    slope = moved[:order, order + 2 :] / step
    body.carry[:order, :order] = moved[:order, :order]
    body.before[:order] = moved[:order, order : order + 2] - slope
    body.after[:order] = slope
    if top.mass == 0.0:
        follow = np.linalg.solve(resistance, stiffness)
        body.carry[2:] = -follow @ body.carry[:2]
        body.before[2:] = -follow @ body.before[:2]
        body.after[2:] = np.linalg.solve(resistance, push) - follow @ body.after[:2]
    return body


def empty_record(scene: Scene, grids: tuple[int, int], step: float, levels: int, *, native: bool) -> Record:
    """Return the record that a march over so many time levels on so many cells fills."""
    output, (axial, transverse) = scene.output, grids
    gauges = np.asarray(output.gauges, dtype=np.float64)
    if native:
        level = np.arange(levels, dtype=np.float64)
        level = level[level * step <= output.duration * (1.0 + 1e-9)]
    else:
        rows = math.floor(output.duration * output.rate + 1e-9) + 1
        level = np.minimum(np.arange(rows) / (output.rate * step), levels - 1.0)
    bin_levels = math.ceil(levels / FIELD_BINS)
    shape = (math.ceil(levels / bin_levels), axial + 1)
    return Record(
        level=level,
        axial=_place(gauges, axial),
        transverse=_place(gauges, transverse),
        station=_place(np.arange(axial + 1) / axial, transverse),
        gauges=np.zeros((level.size, gauges.size, 7)),
        top=np.zeros((level.size, 2)),
        bin_steps=bin_levels,
        field_maximum=np.zeros(shape),
        field_minimum=np.zeros(shape),
    )


def solution_of(
    scene: Scene,
    cable: CoupledCable,
    tension: Tension,
    record: Record,
    progress: tuple[float, int, int],
    measured: MeasuredMotion | None,
) -> Solution:
    """Return a filled record as a solution; `progress` is the time step [s], the steps done and all steps."""
    step, done, steps = progress
    time = record.level * step
    angle = end_angle(scene, cable, 1.0)
    bins = record.field_maximum.shape[0]
    along = record.gauges[..., 1] / tension.axial_speed
    across = record.gauges[..., 3] / tension.transverse_speed
    stretch = np.hypot(1.0 + along, across)
    quadratic = along + 0.5 * (along**2 + across**2)
    return Solution(
        time=time,
        tension=(cable.tension + cable.axial_stiffness * quadratic) * stretch,
        strain=cable.stretch * (stretch - 1.0),
        platform_position=record.top @ np.array([math.sin(angle), math.cos(angle)]),
        field=Field(
            time=np.arange(bins, dtype=np.float64) * (record.bin_steps * step),
            position=np.linspace(0.0, 1.0, record.field_maximum.shape[1]),
            maximum=record.field_maximum,
            minimum=record.field_minimum,
        ),
        time_step=step,
        steps_done=done,
        steps=steps,
        fields=_fields(scene, cable, tension, record, _motion(scene, measured)(time)),
    )


def _fields(
    scene: Scene, cable: CoupledCable, tension: Tension, record: Record, bottom: FloatArray
) -> dict[str, FloatArray]:
    """Return what the scene asks for: position and velocity (n, g, 3), total curvature (n, g)."""
    gauges = np.asarray(scene.output.gauges, dtype=np.float64)
    angle = np.array([end_angle(scene, cable, fraction) for fraction in gauges])
    tangent = np.stack([np.cos(angle), np.zeros_like(angle), np.sin(angle)], axis=-1)
    normal = np.stack([-np.sin(angle), np.zeros_like(angle), np.cos(angle)], axis=-1)

    def spatial(along: FloatArray, across: FloatArray) -> FloatArray:
        return np.asarray(along[..., None] * tangent + across[..., None] * normal)

    found: dict[str, FloatArray] = {}
    if "position" in scene.output.fields:
        distance = cable.length * gauges
        turned = 0.5 * cable.curvature * distance
        middle = end_angle(scene, cable, 0.0) + turned  # the chord of an arc points where its middle does
        chord = distance * np.sinc(turned / np.pi)
        rest = np.stack([chord * np.cos(middle), 0.0 * chord, chord * np.sin(middle)], axis=-1)
        moved = record.gauges[..., 5:7].copy()
        direction = np.array(local_direction(scene, cable))
        moved[:, gauges == 0.0] = (bottom[:, None] * direction)[:, None]  # known without summing velocities
        found["position"] = rest + spatial(moved[..., 0], moved[..., 1])
    if "velocity" in scene.output.fields:
        found["velocity"] = spatial(record.gauges[..., 0], record.gauges[..., 2])
    if "curvature" in scene.output.fields:
        bend = record.gauges[..., 4] / tension.transverse_speed  # turns of the tangent per rest length
        stretched = cable.curvature * record.gauges[..., 1] / tension.axial_speed
        found["curvature"] = cable.curvature + bend - stretched
    return found


def _motion(scene: Scene, measured: MeasuredMotion | None) -> Callable[[FloatArray], FloatArray]:
    return lambda time: displacement(scene.bottom, time, measured)


def _place(fraction: FloatArray, cells: int) -> Place:
    scaled = fraction * cells
    index = np.clip(np.floor(scaled + 1e-9), 0, cells - 1).astype(np.int64)
    return Place(index, np.asarray(np.maximum(scaled - index, 0.0)))


def _overlap(axial: int, transverse: int) -> Overlap:
    """Return the overlaps of the hat functions of two grids over one length.

    Between two neighbouring nodes of either grid the product of two hats is quadratic: Simpson's rule on the
    union of the nodes is exact.
    """
    edges = np.unique(
        np.concatenate([np.arange(axial + 1) * transverse, np.arange(transverse + 1) * axial])
    ) / (axial * transverse)
    middle, width = 0.5 * (edges[1:] + edges[:-1]), np.diff(edges)
    size = transverse + 1
    keys, shares = [], []
    low, high = (np.floor(middle * cells).astype(np.int64) for cells in (axial, transverse))
    for i in (low, low + 1):
        for j in (high, high + 1):
            products = [
                (1.0 - np.abs(axial * place - i)) * (1.0 - np.abs(transverse * place - j))
                for place in (edges[:-1], middle, edges[1:])
            ]
            keys.append(i * size + j)
            shares.append(width / 6.0 * (products[0] + 4.0 * products[1] + products[2]))
    pairs, inverse = np.unique(np.concatenate(keys), return_inverse=True)
    share = np.bincount(inverse, weights=np.concatenate(shares))
    pairs, share = pairs[share > 1e-12 * share.max()], share[share > 1e-12 * share.max()]
    rows: IntArray = (pairs // size).astype(np.int64)
    columns: IntArray = (pairs % size).astype(np.int64)
    return Overlap(
        rows,
        columns,
        share / np.bincount(rows, weights=share)[rows],
        share / np.bincount(columns, weights=share)[columns],
    )
