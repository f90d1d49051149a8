"""Exact axial response of a vertical or straight cable in closed form: steady, or to a smooth motion in time.

The wave equation in the material coordinate with displacement prescribed below and, above, a mass under
constant lift with a position loop (or a fixed end). Gravity adds only a static part. The two waves are each
referred to the end that they leave and only decay from there, so nothing overflows at any frequency.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from tethertest.errors import DataError
from tethertest.records.arrays import FloatArray
from tethertest.records.scene import MeasuredMotion, Scene
from tethertest.solver.linear.axial_waves import axial_fields, axial_share, output_times
from tethertest.solver.linear.coupled_solve import continued
from tethertest.solver.linear.transform import TransformDrive, TransformLine
from tethertest.solver.solution import Solution, field_of_rows
from tethertest.solver.statics.rest import rest_state
from tethertest.solver.terms import per_direction

ComplexArray = npt.NDArray[np.complex128]

#: places of the field, both ends included
_STATIONS = 41


@dataclass(frozen=True, slots=True, eq=False)
class AxialTransfer:
    """Response per unit of bottom displacement; positive where it is in phase with an upward one."""

    tension: ComplexArray  #: (n, g) [N/m], damping included
    strain: ComplexArray  #: (n, g) [1/m], of the unstretched length
    displacement: ComplexArray  #: (n, g), upwards


def axial_transfer(scene: Scene, s: ComplexArray, gauges: FloatArray) -> AxialTransfer:
    """Return the response at gauges for any complex frequency.

    Parameters
    ----------
    scene : Scene
        Geometry "vertical" or "straight".
    s : (n,) complex128
        Laplace variable [1/s], not zero, its real part 0 or above.
    gauges : (g,) float64
        Fractions of the length from the bottom.
    """
    rest = rest_state(scene)
    s = np.asarray(s, dtype=np.complex128)[:, None]
    stiffness = rest.axial_stiffness * (1.0 + s * (scene.cable.axial_damping_time or 0.0))
    number = s * np.sqrt(rest.mass_per_length / stiffness)
    if scene.top.kind == "fixed":
        reflection = np.full_like(s, -1.0)
    else:
        hover = float(per_direction(scene.top.hover_stiffness)[2])
        damping = float(per_direction(scene.top.hover_damping)[2])
        body = (scene.top.mass or 0.0) * s**2 + damping * s + hover
        reflection = (stiffness * number - body) / (stiffness * number + body)
    place = rest.length * np.asarray(gauges, dtype=np.float64)[None, :]
    rising = np.exp(-number * place)
    falling = reflection * np.exp(-number * (2.0 * rest.length - place))
    size = 1.0 / (1.0 + reflection * np.exp(-2.0 * number * rest.length))
    strain = number * size * (falling - rising)
    return AxialTransfer(stiffness * strain, strain, size * (rising + falling))


def tension_transfer(scene: Scene, frequency: FloatArray, gauges: FloatArray) -> ComplexArray:
    """Return the steady tension amplitude per unit of bottom displacement.

    Parameters
    ----------
    scene : Scene
        Geometry "vertical" or "straight".
    frequency : (n,) float64
        [Hz], above zero.
    gauges : (g,) float64
        Fractions of the length from the bottom.

    Returns
    -------
    (n, g) complex128
        [N/m]; positive where tension is in phase with an upward displacement of the bottom end.
    """
    return axial_transfer(scene, np.asarray(2j * np.pi * frequency), gauges).tension


def run_axial_transform(scene: Scene, *, measured: MeasuredMotion | None = None, factor: int = 1) -> Solution:
    """Solve the waves along a vertical or straight cable, damped or not, under a smooth motion.

    Air drag, being quadratic, is left out.

    Parameters
    ----------
    scene : Scene
        Geometry "vertical" or "straight", motion along the cable.
    measured : MeasuredMotion, optional
        Bottom displacement for ``motion = "measured"``.
    factor : int
        Input samples per output time.

    Raises
    ------
    DataError
        The scene is not one that axial waves alone describe, or its motion starts suddenly.
    """
    from scipy.fft import irfft

    share, rest, output = axial_share(scene), rest_state(scene), scene.output
    time = output_times(scene, None)
    line = TransformLine.over(time.size, output.rate)
    motion = continued(scene, measured)
    start = float(motion(np.zeros(1))[0])
    drive = TransformDrive.sampled(lambda instant: share * (motion(instant) - start), line, factor)
    if drive.start_velocity:
        message = (
            f"scene {scene.name!r}: the bottom starts at {drive.start_velocity:.3g} m/s: a transform rings "
            "at the fronts of a sudden start"
        )
        remedy = 'set [bottom] start = "ramp", begin data at rest, or set axial_damping_time to 0'
        raise DataError(message, remedy)
    s = line.frequencies(factor)
    spectrum = drive.spectrum(s)[:, None]

    def inverted(transfer: ComplexArray) -> FloatArray:
        series = irfft(transfer * spectrum, drive.weighted.size, axis=0)
        kept = series[: (line.rows - 1) * factor + 1 : factor]
        return np.asarray(kept * np.exp(line.eta * time)[:, None])

    gauges = np.asarray(output.gauges, dtype=np.float64)
    stations = np.linspace(0.0, 1.0, _STATIONS)
    here, along = axial_transfer(scene, s, gauges), axial_transfer(scene, s, stations)
    tension = rest.bottom_tension + stations * rest.weight + inverted(along.tension)
    return Solution(
        time=time,
        tension=rest.bottom_tension + gauges * rest.weight + inverted(here.tension),
        strain=inverted(here.strain),
        platform_position=inverted(along.displacement[:, -1:])[:, 0],
        field=field_of_rows(time, stations, tension),
        time_step=drive.step,
        steps_done=time.size,
        steps=time.size,
        fields=axial_fields(
            scene,
            rest,
            lambda: inverted(here.displacement),
            lambda: inverted(here.displacement * s[:, None]),
            time.size,
        ),
    )
