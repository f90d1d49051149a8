"""Axial waves on a vertical or straight cable: one march on one mesh."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from tethertest.errors import DataError
from tethertest.kernels.axial import Line, Record, TopEnd, march
from tethertest.records.arrays import FloatArray
from tethertest.records.response import Field
from tethertest.records.scene import MeasuredMotion, Scene
from tethertest.solver.motion import displacement
from tethertest.solver.statics.rest import RestState, rest_state

#: limited linear viscosity of the nonlinear scheme; the slack law needs a scheme that loses energy at fronts
VISCOSITY = 0.1
#: distance kept from the stability limit where damping or viscosity act
_MARGIN = 0.995
#: rows of the tension field kept over the record
_FIELD_BINS = 480


@dataclass(frozen=True, slots=True, eq=False)
class AxialSolution:
    """One march, before its error is known."""

    time: FloatArray  #: (n,) [s]
    tension: FloatArray  #: (n, g) [N]
    strain: FloatArray  #: (n, g), change from rest
    platform_position: FloatArray  #: (n,) [m] from rest
    field: Field
    time_step: float
    steps_done: int
    steps: int


def courant_limit(viscosity: float, damping_time: float, wave_speed: float, cell: float) -> float:
    """Return the largest stable Courant number: ``s^2 + 2 a s <= 1`` with ``a = C1 + t_d c / h``."""
    a = viscosity + damping_time * wave_speed / cell
    limit = -a + math.sqrt(a * a + 1.0)
    return limit if a == 0.0 else _MARGIN * limit


def step_count(scene: Scene, cells: int, *, unilateral: bool) -> int:
    """Return the number of steps that a march on ``cells`` cells takes."""
    rest = rest_state(scene)
    return math.ceil(scene.output.duration / _time_step(scene, rest, cells, unilateral=unilateral)) + 2


def run_axial(
    scene: Scene, cells: int, *, unilateral: bool, measured: MeasuredMotion | None = None
) -> AxialSolution:
    """March a vertical or straight scene once.

    Parameters
    ----------
    scene : Scene
        Geometry "vertical" or "straight", motion along the cable.
    cells : int
        Number of cells.
    unilateral : bool
        True for the nonlinear law without compression, with viscosity; False for the linear law.
    measured : MeasuredMotion, optional
        Bottom displacement for ``motion = "measured"``.

    Raises
    ------
    DataError
        The scene is not one that axial waves alone describe.
    """
    _check(scene)
    rest = rest_state(scene)
    cell = rest.length / cells
    time_step = _time_step(scene, rest, cells, unilateral=unilateral)
    steps = step_count(scene, cells, unilateral=unilateral)
    bottom = displacement(scene.bottom, np.arange(steps + 2, dtype=np.float64) * time_step, measured)
    centres = (np.arange(cells) + 0.5) / cells
    rest_tension = rest.bottom_tension + centres * rest.weight
    position = np.concatenate([[0.0], np.cumsum(cell * (1.0 + rest_tension / rest.axial_stiffness))])
    position[1:] += bottom[0]
    position[0] = bottom[0]
    line = Line(
        cell=cell,
        mass=rest.mass_per_length,
        stiffness=rest.axial_stiffness,
        damping_time=scene.cable.axial_damping_time or 0.0,
        viscosity=VISCOSITY if unilateral else 0.0,
        gravity=rest.gravity,
        drag=_drag(scene),
        unilateral=unilateral,
    )
    record = empty_record(scene, cells, steps)
    rest_top = float(position[-1])
    done = march(bottom, position, line, _top_end(scene, rest, rest_top), time_step, record)
    gauges = np.asarray(scene.output.gauges)
    rest_strain = (rest.bottom_tension + gauges * rest.weight) / rest.axial_stiffness
    bins = record.field_maximum.shape[0]
    return AxialSolution(
        time=np.arange(record.top.size, dtype=np.float64) / scene.output.rate,
        tension=record.tension,
        strain=record.strain - rest_strain,
        platform_position=record.top - rest_top,
        field=Field(
            time=np.arange(bins, dtype=np.float64) * (record.bin_steps * time_step),
            position=np.concatenate([[0.0], centres, [1.0]]),
            maximum=record.field_maximum,
            minimum=record.field_minimum,
        ),
        time_step=time_step,
        steps_done=done,
        steps=steps,
    )


def _check(scene: Scene) -> None:
    if scene.geometry.kind not in {"vertical", "straight"}:
        message = (
            f"scene {scene.name!r}: geometry {scene.geometry.kind!r} is not one that axial waves describe"
        )
        raise DataError(message, 'give a scene with geometry kind "vertical" or "straight"')
    along = {"vertical": {"tangent", "vertical"}, "straight": {"tangent"}}[scene.geometry.kind]
    if scene.bottom.direction not in along:
        message = f"scene {scene.name!r}: bottom motion {scene.bottom.direction!r} is not along the cable"
        raise DataError(message, 'set [bottom] direction = "tangent"')


def _time_step(scene: Scene, rest: RestState, cells: int, *, unilateral: bool) -> float:
    cell = rest.length / cells
    viscosity = VISCOSITY if unilateral else 0.0
    damping_time = scene.cable.axial_damping_time or 0.0
    return courant_limit(viscosity, damping_time, rest.wave_speed, cell) * cell / rest.wave_speed


def _drag(scene: Scene) -> float:
    if scene.air is None or scene.cable.diameter is None:
        return 0.0
    return 0.5 * scene.air.density * scene.air.tangential_drag * math.pi * scene.cable.diameter


def _top_end(scene: Scene, rest: RestState, position: float) -> TopEnd:
    top = scene.top
    if top.kind == "fixed":
        return TopEnd(True, 0.0, 0.0, 0.0, 0.0, position)
    mass = top.mass or 0.0
    stiffness, damping = (
        value if isinstance(value, float) else float(value[-1])  # a vector's last component is vertical
        for value in (top.hover_stiffness, top.hover_damping)
    )
    return TopEnd(False, mass, rest.top_tension + mass * rest.gravity, stiffness, damping, position)


def empty_record(scene: Scene, cells: int, steps: int) -> Record:
    """Return the record that a march of so many steps on so many cells fills."""
    output = scene.output
    rows = math.floor(output.duration * output.rate + 1e-9) + 1
    stations = np.concatenate([[0.0], (np.arange(cells) + 0.5) / cells, [1.0]])
    gauges = np.asarray(output.gauges, dtype=np.float64)
    index = np.clip(np.searchsorted(stations, gauges, "right") - 1, 0, cells)
    weight = (gauges - stations[index]) / (stations[index + 1] - stations[index])
    bin_steps = max(1, math.ceil(steps / _FIELD_BINS))
    bins = math.ceil(steps / bin_steps)
    return Record(
        interval=1.0 / output.rate,
        bin_steps=bin_steps,
        gauge_index=index.astype(np.int64),
        gauge_weight=weight,
        tension=np.zeros((rows, gauges.size)),
        strain=np.zeros((rows, gauges.size)),
        top=np.zeros(rows),
        field_maximum=np.full((bins, cells + 2), -np.inf),
        field_minimum=np.full((bins, cells + 2), np.inf),
    )
