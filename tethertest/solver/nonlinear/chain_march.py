"""One march of the geometrically exact cable on one mesh: along its line, in its plane or in space."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from tethertest.errors import DataError
from tethertest.kernels.march import Line, UpperEnd, march
from tethertest.kernels.record import Record
from tethertest.records.arrays import FloatArray
from tethertest.records.response import Field
from tethertest.records.scene import MeasuredMotion, Output, Scene, WindSeries
from tethertest.solver.motion import displacement, velocity
from tethertest.solver.nonlinear.limits import EXPLICIT_DAMPING, VISCOSITY, courant_limit
from tethertest.solver.solution import FIELD_BINS, Solution
from tethertest.solver.statics.equilibrium import RestChain, rest_chain
from tethertest.solver.terms import (
    body_axes,
    bottom_direction,
    drag_coefficients,
    leaves_plane,
    per_direction,
    steady_wind,
)

#: how many times faster than bottom and wind together the cable is taken to meet the air, for the step limit
_AIR_SPEED_SHARE = 2.0
#: components of a vector in space that a march of so many dimensions follows
_AXES = {1: (2,), 2: (0, 2), 3: (0, 1, 2)}


@dataclass(frozen=True, slots=True, eq=False)
class ChainCase:
    """A scene turned into a chain at rest with everything its march needs."""

    scene: Scene
    rest: RestChain
    line: Line
    top: UpperEnd
    direction: FloatArray  #: (3,) unit vector of the bottom motion
    axes: tuple[int, ...]  #: components followed
    courant: float  #: largest stable Courant number

    @property
    def time_step(self) -> float:
        """Largest stable time step [s]."""
        return self.courant * self.line.cell / math.sqrt(self.line.stiffness / self.line.mass)

    @property
    def steps(self) -> int:
        """Number of steps over the record at the largest time step."""
        return math.ceil(self.scene.output.duration / self.time_step) + 2


def chain_case(
    scene: Scene,
    cells: int,
    *,
    viscous: bool = True,
    measured: MeasuredMotion | None = None,
    wind: WindSeries | None = None,
    sideways: bool = False,
) -> ChainCase:
    """Return the chain at rest, in wind, with the upper end that holds it.

    Parameters
    ----------
    scene : Scene
    cells : int
        Number of cells, at least 2.
    viscous : bool
        With the limited viscosity that slack and fronts need.
    measured : MeasuredMotion, optional
        Bottom displacement for ``motion = "measured"``.
    wind : WindSeries, optional
        Gusts; the cable rests in the first of them.
    sideways : bool
        Follow a plane at least, even where nothing in the scene leaves the cable's line.

    Raises
    ------
    DataError
        The scene has no rest.
    """
    try:
        hash(scene)
    except TypeError:  # built with lists in the place of tuples
        return _chain_case(scene, cells, viscous, measured, wind, sideways)
    return kept_case(scene, cells, viscous, measured, wind, sideways)


def _chain_case(
    scene: Scene,
    cells: int,
    viscous: bool,
    measured: MeasuredMotion | None,
    wind: WindSeries | None,
    sideways: bool,
) -> ChainCase:
    if wind is not None and scene.air is not None:
        first = tuple(float(component) for component in wind.velocity[0])
        scene = replace(scene, air=replace(scene.air, wind=first))
    rest = rest_chain(scene, cells)
    axes = _AXES[max(2 if sideways else 1, dimensions(scene, rest, wind))]
    picked = list(axes)
    direction = bottom_direction(scene, rest.start_force)
    normal, tangential = drag_coefficients(scene)
    damping_time = scene.cable.axial_damping_time or 0.0
    wave_speed = math.sqrt(rest.stiffness / rest.mass)
    up = 0.0 if scene.geometry.kind == "straight" else scene.gravity
    line = Line(
        cell=rest.cell,
        mass=rest.mass,
        stiffness=rest.stiffness,
        damping_time=damping_time,
        implicit=_implicit(damping_time * wave_speed / rest.cell, viscous=viscous),
        viscosity=VISCOSITY if viscous else 0.0,
        bending=scene.cable.bending_stiffness,
        gravity=np.array([0.0, 0.0, -up])[picked],
        normal_drag=normal,
        tangential_drag=tangential,
    )
    top = _upper_end(scene, rest, picked)
    blown = steady_wind(scene) if wind is None else wind.velocity
    speed = float(np.max(np.abs(velocity(scene.bottom, _span(scene.output), measured))))
    speed = _AIR_SPEED_SHARE * (speed + float(np.max(np.linalg.norm(np.atleast_2d(blown), axis=1))))
    return ChainCase(scene, rest, line, top, direction, axes, courant_limit(line, top, speed))


#: a refinement asks for each mesh's rest several times
kept_case = lru_cache(maxsize=16)(_chain_case)


def dimensions(scene: Scene, rest: RestChain, wind: WindSeries | None = None) -> int:
    """Return how many dimensions the scene needs: 1 along the cable, 2 in its plane, 3 in space."""
    gusts = wind is not None and any(drag_coefficients(scene))
    if leaves_plane(scene) or (gusts and wind is not None and bool(np.any(wind.velocity[:, 1]))):
        return 3
    direction = bottom_direction(scene, rest.start_force)
    upright = not np.any(rest.nodes[:, :2]) and not np.any(rest.lift[:2])
    return 1 if upright and not gusts and not np.any(direction[:2]) else 2


def run_chain(
    scene: Scene,
    cells: int,
    *,
    viscous: bool = True,
    courant: float | None = None,
    measured: MeasuredMotion | None = None,
    wind: WindSeries | None = None,
    native_times: bool = False,
    imperfection: float = 0.0,
) -> Solution:
    """March a scene once.

    Parameters
    ----------
    scene : Scene
    cells : int
        Number of cells, at least 2.
    viscous : bool
        True for the default with limited viscosity; False only for taut, smooth scenes.
    courant : float, optional
        Courant number of the axial wave; the largest stable one if absent.
    measured : MeasuredMotion, optional
        Bottom displacement for ``motion = "measured"``.
    wind : WindSeries, optional
        Gusts.
    native_times : bool
        Rows at the scheme's own time levels instead of k/rate.
    imperfection : float
        Sideways bow of the rest position over the length; the march then follows a plane at least.

    Raises
    ------
    DataError
        The scene has no rest, or the Courant number is above the stability limit.
    """
    case = chain_case(
        scene, cells, viscous=viscous, measured=measured, wind=wind, sideways=imperfection != 0.0
    )
    if courant is not None and not 0.0 < courant <= case.courant:
        message = f"Courant number {courant:g} lies outside 0 to the stability limit {case.courant:.4g}"
        raise DataError(message, "give a smaller one, or none for the largest stable one")
    time_step = case.time_step * (1.0 if courant is None else courant / case.courant)
    steps = math.ceil(scene.output.duration / time_step) + 2
    levels = np.arange(steps + 2, dtype=np.float64) * time_step
    bottom = displacement(scene.bottom, levels, measured)
    bottom = bottom - bottom[0]  # at rest where the record begins
    picked = list(case.axes)
    position = np.ascontiguousarray(case.rest.nodes.T[picked])
    if imperfection != 0.0:
        bow = np.sin(np.pi * np.arange(cells + 1) / cells)
        position[0] += imperfection * cells * case.line.cell * bow
    record = empty_record(scene.output, cells, steps, len(picked), time_step, native_times=native_times)
    direction = np.ascontiguousarray(case.direction[picked])
    done = march(bottom, direction, position, case.line, case.top, _gusts(scene, wind, levels, picked),
                 time_step, record)  # fmt: skip
    return _solution(case, record, time_step, done, steps, native_times=native_times)


def empty_record(
    output: Output, cells: int, steps: int, dimension: int, time_step: float, *, native_times: bool
) -> Record:
    """Return the record that a march of so many steps on so many cells fills."""
    rows = math.floor(output.duration * output.rate + 1e-9) + 1
    if native_times:
        rows = min(steps, math.floor(output.duration / time_step * (1.0 + 1e-12)) + 3)  # two beyond the end
    gauges = np.asarray(output.gauges, dtype=np.float64)
    stations = np.concatenate([[0.0], (np.arange(cells) + 0.5) / cells, [1.0]])
    index = np.clip(np.searchsorted(stations, gauges, "right") - 1, 0, cells)
    node = np.clip(np.floor(gauges * cells).astype(np.int64), 0, cells - 1)
    bin_steps = max(1, math.ceil(steps / FIELD_BINS))
    bins = math.ceil(steps / bin_steps)
    return Record(
        interval=0.0 if native_times else 1.0 / output.rate,
        bin_steps=bin_steps,
        gauge_index=index.astype(np.int64),
        gauge_weight=(gauges - stations[index]) / (stations[index + 1] - stations[index]),
        node_index=node,
        node_weight=gauges * cells - node,
        rows=np.zeros((rows, gauges.size, 3 + 2 * dimension if output.fields else 2)),
        top=np.zeros(rows),
        field_maximum=np.full((bins, cells + 2), -np.inf),
        field_minimum=np.full((bins, cells + 2), np.inf),
    )


def _solution(
    case: ChainCase, record: Record, time_step: float, done: int, steps: int, *, native_times: bool
) -> Solution:
    output, rest, d = case.scene.output, case.rest, len(case.axes)
    ends = [float(np.linalg.norm(force)) for force in (rest.start_force, rest.end_force)]
    inner = np.linalg.norm(rest.force, axis=1)
    strain = np.concatenate([ends[:1], inner, ends[1:]]) / rest.stiffness
    weight, index = record.gauge_weight, record.gauge_index
    rest_strain = (1.0 - weight) * strain[index] + weight * strain[index + 1]
    rows, bins, cells = record.rows, record.field_maximum.shape[0], rest.force.shape[0]
    fields: dict[str, FloatArray] = {}
    picked = list(case.axes)
    for name, first in (("position", 2), ("velocity", 2 + d)):
        if name in output.fields:
            fields[name] = np.zeros((*rows.shape[:2], 3))
            fields[name][..., picked] = rows[..., first : first + d]
    if "curvature" in output.fields:
        fields["curvature"] = rows[..., 2 + 2 * d].copy()
    return Solution(
        time=np.arange(rows.shape[0], dtype=np.float64) * (time_step if native_times else 1.0 / output.rate),
        tension=np.ascontiguousarray(rows[..., 0]),
        strain=rows[..., 1] - rest_strain,
        platform_position=record.top - rest.nodes[-1, 2],
        field=Field(
            time=np.arange(bins, dtype=np.float64) * (record.bin_steps * time_step),
            position=np.concatenate([[0.0], (np.arange(cells) + 0.5) / cells, [1.0]]),
            maximum=record.field_maximum,
            minimum=record.field_minimum,
        ),
        time_step=time_step,
        steps_done=done,
        steps=steps,
        fields=fields,
    )


def _implicit(damping: float, *, viscous: bool) -> float:
    """Return the weight of the new rate of stretch, for damping ``t_d c / h``."""
    if damping == 0.0:
        return 0.0
    if not viscous:
        return 0.5
    return 1.0 if damping > EXPLICIT_DAMPING else 0.0


def _upper_end(scene: Scene, rest: RestChain, picked: list[int]) -> UpperEnd:
    top = scene.top
    axes, drag = body_axes(scene)
    return UpperEnd(
        fixed=top.kind == "fixed",
        mass=top.mass or 0.0,
        lift=np.ascontiguousarray(rest.lift[picked]),
        stiffness=per_direction(top.hover_stiffness)[picked],
        damping=per_direction(top.hover_damping)[picked],
        body_axes=np.ascontiguousarray(axes[:, picked]),
        body_drag=drag,
    )


def _gusts(scene: Scene, wind: WindSeries | None, levels: FloatArray, picked: list[int]) -> FloatArray:
    """Return the wind (d, 1) or (d, levels) [m/s]; a series is held at its ends."""
    if wind is None:
        return np.ascontiguousarray(steady_wind(scene)[picked][:, None])
    return np.array([np.interp(levels, wind.time, wind.velocity[:, axis]) for axis in picked])


def _span(output: Output) -> FloatArray:
    return np.linspace(0.0, output.duration, 513)
