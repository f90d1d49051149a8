"""Vertical and straight scenes by second-order finite volumes with the exact taut-slack Riemann solver."""

from __future__ import annotations

import math

import numpy as np

from tethertest.bench.finite_volumes.kernel import MusclCable, MusclRecord, MusclTop, march_muscl
from tethertest.errors import DataError
from tethertest.records.response import Field
from tethertest.records.scene import MeasuredMotion, Scene
from tethertest.solver.motion import displacement
from tethertest.solver.solution import Solution
from tethertest.solver.statics.rest import RestState, rest_state
from tethertest.solver.terms import drag_coefficients, per_direction, steady_wind

#: rows of the tension field kept over the record
FIELD_BINS = 480
#: lightest platform whose explicit march is stable, in masses of a cell
_LIGHTEST = 0.5


def run_axial_muscl(
    scene: Scene, cells: int, *, courant: float = 0.4, measured: MeasuredMotion | None = None
) -> Solution:
    """March a vertical or straight scene once, taut or slack.

    Parameters
    ----------
    scene : Scene
        Geometry "vertical" or "straight", motion along the cable, no wind.
    cells : int
        Number of cells, at least 2.
    courant : float
        Largest Courant number of the axial wave, 0 to 1; the step is a whole part of an output interval.
    measured : MeasuredMotion, optional
        Bottom displacement for ``motion = "measured"``.

    Returns
    -------
    Solution
        The strain of a slack place counts as zero.

    Raises
    ------
    DataError
        The scene is not one that axial waves alone describe, or the mesh or step is out of range.
    """
    _check(scene, cells, courant)
    rest = rest_state(scene)
    cell = rest.length / cells
    interval = 1.0 / scene.output.rate
    rows = math.floor(scene.output.duration * scene.output.rate + 1e-9) + 1
    row_steps = max(1, math.ceil(interval * rest.wave_speed / (courant * cell) - 1e-9))
    time_step, steps = interval / row_steps, (rows - 1) * row_steps
    bottom = displacement(scene.bottom, np.arange(-1.0, steps + 3.0, dtype=np.float64) * time_step, measured)
    centres = (np.arange(cells) + 0.5) / cells
    stretch = 1.0 + (rest.bottom_tension + centres * rest.weight) / rest.axial_stiffness
    cable = MusclCable(
        cell=cell,
        mass=rest.mass_per_length,
        stiffness=rest.axial_stiffness,
        damping_time=scene.cable.axial_damping_time or 0.0,
        gravity=rest.gravity,
        drag=drag_coefficients(scene)[1],
    )
    record = _empty_record(scene, cells, rows, row_steps)
    done = march_muscl(bottom, stretch, cable, _top_end(scene, rest, cell), time_step, record)
    kept = done // row_steps + 1
    gauges = np.asarray(scene.output.gauges)
    return Solution(
        time=np.arange(kept, dtype=np.float64) / scene.output.rate,
        tension=record.tension[:kept],
        strain=record.strain[:kept] - (rest.bottom_tension + gauges * rest.weight) / rest.axial_stiffness,
        platform_position=record.top[:kept],
        field=Field(
            time=np.arange(record.field_maximum.shape[0], dtype=np.float64) * (record.bin_steps * time_step),
            position=np.concatenate([[0.0], centres, [1.0]]),
            maximum=record.field_maximum,
            minimum=record.field_minimum,
        ),
        time_step=time_step,
        steps_done=done,
        steps=steps,
    )


def _check(scene: Scene, cells: int, courant: float) -> None:
    along = {"vertical": {"tangent", "vertical"}, "straight": {"tangent"}}.get(scene.geometry.kind, set())
    if scene.bottom.direction not in along:
        message = (
            f"scene {scene.name!r}: geometry {scene.geometry.kind!r} moved {scene.bottom.direction!r} is not "
            "one that axial waves describe"
        )
        raise DataError(message, 'give geometry kind "vertical" or "straight", moved along the "tangent"')
    if np.any(steady_wind(scene)) or (scene.air is not None and scene.air.wind_file is not None):
        message = f"scene {scene.name!r}: wind bends the cable, axial waves do not describe it"
        raise DataError(message, "leave out [air] wind")
    if cells < 2 or not 0.0 < courant <= 1.0:
        message = f"{cells} cells at Courant number {courant:g}"
        raise DataError(message, "give at least 2 cells and a Courant number above 0, at most 1")


def _top_end(scene: Scene, rest: RestState, cell: float) -> MusclTop:
    top = scene.top
    if top.kind == "fixed":
        return MusclTop(True, 0.0, 0.0, 0.0, 0.0)
    mass = top.mass or 0.0
    if mass < _LIGHTEST * rest.mass_per_length * cell:
        message = f"scene {scene.name!r}: a platform of {mass:g} kg is lighter than half a cell of the cable"
        raise DataError(message, "use more cells; a platform without mass is not one that this march handles")
    stiffness, damping = (float(per_direction(v)[-1]) for v in (top.hover_stiffness, top.hover_damping))
    return MusclTop(False, mass, rest.top_tension + mass * rest.gravity, stiffness, damping)


def _empty_record(scene: Scene, cells: int, rows: int, row_steps: int) -> MusclRecord:
    stations = np.concatenate([[0.0], (np.arange(cells) + 0.5) / cells, [1.0]])
    gauges = np.asarray(scene.output.gauges, dtype=np.float64)
    index = np.clip(np.searchsorted(stations, gauges, "right") - 1, 0, cells)
    levels = (rows - 1) * row_steps + 1
    bin_steps = math.ceil(levels / FIELD_BINS)
    bins = math.ceil(levels / bin_steps)
    return MusclRecord(
        row_steps=row_steps,
        bin_steps=bin_steps,
        gauge_index=index.astype(np.int64),
        gauge_weight=(gauges - stations[index]) / (stations[index + 1] - stations[index]),
        tension=np.zeros((rows, gauges.size)),
        strain=np.zeros((rows, gauges.size)),
        top=np.zeros(rows),
        field_maximum=np.full((bins, cells + 2), -np.inf),
        field_minimum=np.full((bins, cells + 2), np.inf),
    )
