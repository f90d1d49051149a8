"""Taut smooth scenes by spectral elements: the reference that the leapfrog march is measured with."""

from __future__ import annotations

import math

import numpy as np

from tethertest.bench.finite_volumes.march import FIELD_BINS
from tethertest.bench.spectral_elements.kernel import SpectralRecord, SpectralTop, march_spectral
from tethertest.bench.spectral_elements.rest import SpectralRest, spectral_rest
from tethertest.errors import DataError
from tethertest.records.arrays import FloatArray
from tethertest.records.response import Field
from tethertest.records.scene import MeasuredMotion, Scene
from tethertest.solver.motion import displacement
from tethertest.solver.solution import Solution
from tethertest.solver.terms import bottom_direction, per_direction

#: highest natural frequency times step at which classical Runge-Kutta steps are still stable
STABLE = 2.8
#: the same for real decay
_STABLE_DECAY = 2.7
#: shortest spacing of the differences that make the bottom's velocity and acceleration [s]
_SPACING = 5e-4
#: steps marched at once
_BLOCK = 50_000


def step_count(scene: Scene, elements: int, *, courant: float = 2.0) -> int:
    """Return the number of steps that `run_spectral` would take.

    Explicit damping of a short, stiff cable asks for very many: look before you run.

    Raises
    ------
    DataError
        As `run_spectral`.
    """
    _check(scene, elements, courant)
    rows, row_steps = _rows(scene, spectral_rest(scene, elements), courant)
    return (rows - 1) * row_steps


def run_spectral(
    scene: Scene, elements: int, *, courant: float = 2.0, measured: MeasuredMotion | None = None
) -> Solution:
    """March a taut scene with a smooth start once.

    Parameters
    ----------
    scene : Scene
        Geometry "vertical", "straight", "shallow" or "ends"; motion without a jump of velocity.
    elements : int
        Number of elements of degree 8.
    courant : float
        Time step times the bound of the highest axial frequency, up to `STABLE`; the step is a whole part of
        an output interval.
    measured : MeasuredMotion, optional
        Bottom displacement for ``motion = "measured"``.

    Returns
    -------
    Solution
        Ends early, with ``steps_done < steps`` and the rows up to there, where the cable goes slack.

    Raises
    ------
    DataError
        As `spectral_rest`; or the scene has what this reference does not know.
    """
    _check(scene, elements, courant)
    rest = spectral_rest(scene, elements)
    picked = list(rest.axes)
    rows, row_steps = _rows(scene, rest, courant)
    time_step, steps = 1.0 / (scene.output.rate * row_steps), (rows - 1) * row_steps
    record = _empty_record(scene, rest, rows, row_steps)
    top, direction = _top_end(scene, rest), bottom_direction(scene, rest.start_force)[picked]
    position, velocity = rest.position.copy(), np.zeros_like(rest.position)
    done = 0
    while True:
        block = min(_BLOCK, steps - done)
        place, speed, jolt = _bottom(scene, done, block, time_step, measured)
        marched = march_spectral(
            position,
            velocity,
            direction[:, None] * place,
            direction[:, None] * speed,
            direction[:, None] * jolt,
            rest.cable,
            top,
            time_step,
            done,
            done + block == steps,
            record,
        )
        done += marched
        if marched < block or done == steps:
            break
    kept = rows if done == steps else (done - 1) // row_steps + 1
    return Solution(
        time=np.arange(kept, dtype=np.float64) / scene.output.rate,
        tension=record.tension[:kept],
        strain=record.strain[:kept] - record.strain[0],
        platform_position=record.top[:kept] - rest.position[-1, -1],
        field=Field(
            time=np.arange(record.field_maximum.shape[0], dtype=np.float64) * (record.bin_steps * time_step),
            position=rest.mesh.arc / rest.mesh.length,
            maximum=record.field_maximum,
            minimum=record.field_minimum,
        ),
        time_step=time_step,
        steps_done=done,
        steps=steps,
    )


def _check(scene: Scene, elements: int, courant: float) -> None:
    bottom, air = scene.bottom, scene.air
    if bottom.motion == "step" or (bottom.motion == "harmonic" and bottom.start == "jump"):
        message = f"scene {scene.name!r}: the bottom velocity jumps, which rings in spectral elements"
        raise DataError(message, 'give [bottom] start = "ramp", or take another reference')
    if air is not None and air.wind_file is not None:
        message = f"scene {scene.name!r}: wind from a file is unknown to this reference"
        raise DataError(message, "give [air] wind")
    if scene.top.drag_area is not None and any(scene.top.drag_area):
        message = f"scene {scene.name!r}: drag of the body is unknown to this reference"
        raise DataError(message, "leave out [top] drag_area")
    if scene.cable.bending_stiffness > 0.0:
        message = f"scene {scene.name!r}: bending stiffness is unknown to this reference"
        raise DataError(message, "leave out [cable] bending_stiffness")
    if elements < 1 or not 0.0 < courant <= STABLE:
        message = f"{elements} elements at Courant number {courant:g}"
        raise DataError(message, f"give at least 1 element and a Courant number above 0, at most {STABLE}")


def _rows(scene: Scene, rest: SpectralRest, courant: float) -> tuple[int, int]:
    """Return the number of output rows and the steps from one to the next."""
    rows = math.floor(scene.output.duration * scene.output.rate + 1e-9) + 1
    return rows, max(1, math.ceil(1.0 / (scene.output.rate * _largest_step(rest, courant)) - 1e-9))


def _largest_step(rest: SpectralRest, courant: float) -> float:
    """Return the largest step [s]; damping turns the highest frequencies into real decay."""
    cable = rest.cable
    highest = math.sqrt(cable.stiffness / cable.mass) * rest.mesh.highest_wavenumber
    damping = 0.5 * cable.damping_time * highest
    decay = highest * (damping + math.sqrt(max(0.0, damping**2 - 1.0)))
    return min(courant / highest, _STABLE_DECAY / decay if decay > 0.0 else math.inf)


def _top_end(scene: Scene, rest: SpectralRest) -> SpectralTop:
    """Return the upper end; a platform's lift is what holds the elements at rest."""
    picked, top = list(rest.axes), scene.top
    mass = top.mass or 0.0
    return SpectralTop(
        fixed=top.kind == "fixed",
        mass=mass,
        lift=-rest.force[:, -1] - mass * rest.cable.gravity,
        stiffness=per_direction(top.hover_stiffness)[picked],
        damping=per_direction(top.hover_damping)[picked],
        rest=rest.position[:, -1].copy(),
    )


def _bottom(
    scene: Scene, first: int, steps: int, time_step: float, measured: MeasuredMotion | None
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the bottom's displacement and velocity at a block's levels, and its acceleration at half levels.

    Velocity and acceleration are fourth-order differences of the displacement, so that they belong to it.
    """
    half = 0.5 * time_step
    stride = max(1, math.ceil(_SPACING / half))
    spacing = stride * half
    levels = np.arange(2 * first - 2 * stride, 2 * (first + steps) + 2 * stride + 1, dtype=np.float64)
    moved = displacement(scene.bottom, levels * half, measured)
    moved = moved - displacement(scene.bottom, np.zeros(1), measured)  # at rest where the record begins
    count = 2 * steps + 1
    far, near, here, near_after, far_after = (moved[i * stride : i * stride + count] for i in range(5))
    speed = (far - far_after + 8.0 * (near_after - near)) / (12.0 * spacing)
    jolt = (16.0 * (near + near_after) - far - far_after - 30.0 * here) / (12.0 * spacing**2)
    return here[::2], speed[::2], jolt


def _empty_record(scene: Scene, rest: SpectralRest, rows: int, row_steps: int) -> SpectralRecord:
    element, basis = rest.mesh.basis(np.asarray(scene.output.gauges, dtype=np.float64))
    levels = (rows - 1) * row_steps + 1
    bin_steps = math.ceil(levels / FIELD_BINS)
    bins, nodes = math.ceil(levels / bin_steps), rest.position.shape[1]
    return SpectralRecord(
        row_steps=row_steps,
        bin_steps=bin_steps,
        gauge_element=element,
        gauge_basis=basis,
        tension=np.zeros((rows, element.size)),
        strain=np.zeros((rows, element.size)),
        top=np.zeros(rows),
        field_maximum=np.full((bins, nodes), -np.inf),
        field_minimum=np.full((bins, nodes), np.inf),
    )
