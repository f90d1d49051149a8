"""The linear model of vertical and straight cables, solved exactly along the characteristics.

In the material coordinate gravity adds only the tension at rest, whatever the cable weighs. Dynamic tension
and velocity at any place and time are two characteristics, each traced back to the end that it left; nothing
is interpolated along the cable or across a front. With a fixed top the result is exact at any time (over very
many round trips: to fifth order in the step, as the motion of a platform is).

References
----------
Tao & Zhang, Drones 2022, 6(11), 349, equations (27), (30)-(32) without curvature.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from tethertest.errors import DataError
from tethertest.records.arrays import FloatArray
from tethertest.records.response import Field
from tethertest.records.scene import MeasuredMotion, Scene
from tethertest.solver.linear.axial_ends import INSTANT, EndLoop, UpperEnd, WaveLine, upper_end
from tethertest.solver.linear.coupled import coupled_cable
from tethertest.solver.motion import displacement, velocity
from tethertest.solver.solution import FIELD_BINS, Solution
from tethertest.solver.statics.rest import RestState, rest_state
from tethertest.solver.terms import bottom_direction, per_direction

#: a direction's component below this is none
_NO_PART = 1e-12
_UP = np.array([0.0, 0.0, 1.0])


def run_axial_waves(
    scene: Scene, cells: int, *, measured: MeasuredMotion | None = None, native_times: bool = False
) -> Solution:
    """Solve the waves along a vertical or straight cable.

    Air drag, being quadratic, is left out. Of a straight cable's bottom motion the part across the plane is
    left to `out_of_plane_slope`.

    Parameters
    ----------
    scene : Scene
        Geometry "vertical" or "straight", motion along the cable, no axial damping.
    cells : int
        Steps per traverse of the cable, and places of the field less two.
    measured : MeasuredMotion, optional
        Bottom displacement for ``motion = "measured"``.
    native_times : bool
        Output at the steps' own ends ``k L/(n c)`` instead of at the scene's rate.

    Returns
    -------
    Solution
        At a front's own instant the values after it.

    Raises
    ------
    DataError
        The scene is not one that axial waves alone describe, or its cable is damped.
    """
    share = axial_share(scene)
    if scene.cable.axial_damping_time:
        message = (
            f"scene {scene.name!r}: waves along a cable damped by {scene.cable.axial_damping_time:.3g} s "
            "spread as they travel"
        )
        raise DataError(message, "solve a damped cable by the transform, or set axial_damping_time to 0")
    rest = rest_state(scene)
    impedance = math.sqrt(rest.axial_stiffness * rest.mass_per_length)
    line = _line(scene, cells, rest.length, rest.wave_speed, impedance, share, measured)
    duration = scene.output.duration
    waves = _Waves(line, upper_end(line, _loop(scene, 2), duration))
    time = output_times(scene, line.step if native_times else None)
    gauges = np.asarray(scene.output.gauges, dtype=np.float64)
    dynamic = waves.tension(time, gauges)
    steps = math.ceil(duration / line.step - INSTANT)
    return Solution(
        time=time,
        tension=rest.bottom_tension + gauges * rest.weight + dynamic,
        strain=dynamic / rest.axial_stiffness,
        platform_position=waves.end.position(time),
        field=_field(waves, rest, steps),
        time_step=line.step,
        steps_done=steps,
        steps=steps,
        fields=axial_fields(
            scene,
            rest,
            lambda: waves.displacement(time, gauges),
            lambda: waves.velocity(time, gauges),
            time.size,
        ),
    )


def out_of_plane_slope(
    scene: Scene, cells: int, *, measured: MeasuredMotion | None = None, native_times: bool = False
) -> FloatArray:
    """Return the slope ``u3,s`` of a shallow or straight cable across its plane, equation (27).

    To second order in it the motion adds ``u3,s^2/2`` to the dynamic strain.

    Parameters
    ----------
    scene : Scene
        Geometry "shallow" or "straight"; zeros unless the bottom's direction has a y component.
    cells : int
        Steps per traverse of a transverse wave.
    measured : MeasuredMotion, optional
        Bottom displacement for ``motion = "measured"``.
    native_times : bool
        Output at the steps' own ends ``k L/(n ct)`` instead of at the scene's rate.

    Returns
    -------
    (n, g) float64
        At output times and gauges; s is the length of the cable at rest.

    Raises
    ------
    DataError
        The geometry has no uniform tension.
    """
    cable = coupled_cable(scene)
    share = float(bottom_direction(scene, _UP)[1])
    impedance = math.sqrt(cable.tension * cable.mass_per_length)
    line = _line(scene, cells, cable.length, cable.transverse_speed, impedance, share, measured)
    waves = _Waves(line, upper_end(line, _loop(scene, 1), scene.output.duration))
    time = output_times(scene, line.step if native_times else None)
    return waves.tension(time, np.asarray(scene.output.gauges, dtype=np.float64)) / cable.tension


def axial_share(scene: Scene) -> float:
    """Return the component of the bottom motion up the cable.

    Raises
    ------
    DataError
        The geometry has a curved cable, or the motion makes more than axial waves.
    """
    kind, direction = scene.geometry.kind, scene.bottom.direction
    if kind not in {"vertical", "straight"}:
        message = f"scene {scene.name!r}: geometry {kind!r} is not one that axial waves describe"
        raise DataError(message, 'give a scene with geometry kind "vertical" or "straight"')
    vector = bottom_direction(scene, _UP)
    across = vector[:1] if kind == "straight" else vector[:2]
    unset = kind == "straight" and direction == "vertical"  # a straight cable has no set inclination
    if unset or np.max(np.abs(across)) > _NO_PART:
        message = f"scene {scene.name!r}: bottom motion {direction!r} is not along the cable"
        raise DataError(message, 'set [bottom] direction = "tangent"')
    return float(vector[2])


def output_times(scene: Scene, step: float | None) -> FloatArray:
    """Return the times of the output (n,) [s]: at the scene's rate, or multiples of a step."""
    output = scene.output
    if step is None:
        rows = math.floor(output.duration * output.rate + 1e-9) + 1
        return np.arange(rows, dtype=np.float64) / output.rate
    return np.arange(math.floor(output.duration / step + INSTANT) + 1, dtype=np.float64) * step


@dataclass(frozen=True, slots=True)
class _Waves:
    """Waves up and down a line whose upper end is solved."""

    line: WaveLine
    end: UpperEnd

    def tension(self, time: FloatArray, gauges: FloatArray) -> FloatArray:
        """Return the dynamic tension (n, g) [N]."""
        up, down = self._traced(time, gauges, self.end.returned, self.line.sent)
        return np.asarray(0.5 * (up + down))

    def velocity(self, time: FloatArray, gauges: FloatArray) -> FloatArray:
        """Return the velocity (n, g) [m/s]."""
        up, down = self._traced(time, gauges, self.end.returned, self.line.sent)
        return np.asarray((down - up) / (2.0 * self.line.impedance))

    def displacement(self, time: FloatArray, gauges: FloatArray) -> FloatArray:
        """Return the displacement from rest (n, g) [m]."""
        up, down = self._traced(time, gauges, self.end.returned_impulse, self.line.sent_impulse)
        return np.asarray((down - up) / (2.0 * self.line.impedance))

    def _traced(
        self,
        time: FloatArray,
        gauges: FloatArray,
        returned: Callable[[FloatArray], FloatArray],
        sent: Callable[[FloatArray], FloatArray],
    ) -> tuple[FloatArray, FloatArray]:
        """Return what comes up from the lower end and down from the upper one, each left there before."""
        traverse = self.line.traverse
        left_lower = time[:, None] - gauges * traverse
        left_upper = time[:, None] - (1.0 - gauges) * traverse
        return returned(left_lower - traverse) - sent(left_lower), returned(left_upper)

    def tension_at_stations(self, steps: int, *, before: bool) -> list[FloatArray]:
        """Return the dynamic tension (steps + 1,) [N] at the ends of the steps, for the ends and the cells.

        Parameters
        ----------
        steps : int
        before : bool
            Just before each instant, or after it.
        """
        cells, count = self.line.cells, 2 * steps + 1
        down = self.end.returned_at_half_steps(count, before=before)
        up = -self.line.sent(np.arange(count, dtype=np.float64) * (0.5 * self.line.step), before=before)
        up[2 * cells :] += down[: max(0, count - 2 * cells)]
        none = np.zeros(2 * cells)
        up, down = np.concatenate([none, up]), np.concatenate([none, down])
        stations = [0, *range(1, 2 * cells, 2), 2 * cells]
        return [0.5 * (up[2 * cells - place :][:count:2] + down[place:][:count:2]) for place in stations]


def _line(
    scene: Scene,
    cells: int,
    length: float,
    speed: float,
    impedance: float,
    share: float,
    measured: MeasuredMotion | None,
) -> WaveLine:
    return WaveLine(
        length,
        speed,
        impedance,
        cells,
        velocity=lambda time: share * velocity(scene.bottom, time, measured),
        displacement=lambda time: share * displacement(scene.bottom, time, measured),
    )


def _loop(scene: Scene, axis: int) -> EndLoop | None:
    """Return the platform's loop along x, y or z (0, 1, 2); None for a fixed top."""
    top = scene.top
    if top.kind == "fixed":
        return None
    stiffness, damping = per_direction(top.hover_stiffness), per_direction(top.hover_damping)
    return EndLoop(top.mass or 0.0, float(stiffness[axis]), float(damping[axis]))


def _field(waves: _Waves, rest: RestState, steps: int) -> Field:
    """Return the extremes of the tension along the cable, those on both sides of every front among them."""
    cells = waves.line.cells
    position = np.concatenate([[0.0], (np.arange(cells) + 0.5) / cells, [1.0]])
    bin_steps = max(1, math.ceil((steps + 1) / FIELD_BINS))
    starts = np.arange(0, steps + 1, bin_steps)
    highest, lowest = np.empty((2, starts.size, position.size))
    after = waves.tension_at_stations(steps, before=False)
    before = waves.tension_at_stations(steps, before=True)
    for number, sides in enumerate(zip(after, before, strict=True)):
        highest[:, number] = np.maximum.reduceat(np.maximum(*sides), starts)
        lowest[:, number] = np.minimum.reduceat(np.minimum(*sides), starts)
    still = rest.bottom_tension + position * rest.weight
    return Field(np.asarray(starts * waves.line.step), position, still + highest, still + lowest)


def axial_fields(
    scene: Scene,
    rest: RestState,
    displacement_there: Callable[[], FloatArray],
    velocity_there: Callable[[], FloatArray],
    rows: int,
) -> dict[str, FloatArray]:
    """Return what else a scene of axial waves asks for at its gauges.

    Parameters
    ----------
    scene : Scene
    rest : RestState
        Heights are counted from its lower end.
    displacement_there, velocity_there : callable
        Return (n, g) [m] and [m/s]; called only where asked for.
    rows : int
        Number of output times.
    """
    gauges = np.asarray(scene.output.gauges, dtype=np.float64)
    found: dict[str, FloatArray] = {}
    if "position" in scene.output.fields:
        mean_strain = (rest.bottom_tension + 0.5 * gauges * rest.weight) / rest.axial_stiffness
        height = gauges * rest.length * (1.0 + mean_strain) + displacement_there()
        found["position"] = height[..., None] * _UP
    if "velocity" in scene.output.fields:
        found["velocity"] = velocity_there()[..., None] * _UP
    if "curvature" in scene.output.fields:
        found["curvature"] = np.zeros((rows, gauges.size))
    return found
