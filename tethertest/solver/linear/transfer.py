"""Exact axial response of a vertical or straight cable in closed form: steady, or to a smooth motion in time.

The wave equation in the material coordinate with displacement prescribed below and, above, a mass under
constant lift with a position loop (or a fixed end). Gravity adds only a static part. The two waves are each
referred to the end that they leave and only decay from there, so nothing overflows at any frequency.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from tethertest.errors import DataError
from tethertest.records.arrays import FloatArray
from tethertest.records.scene import Bottom, MeasuredMotion, Scene
from tethertest.solver.linear.axial_waves import axial_fields, axial_share, output_times
from tethertest.solver.linear.coupled_solve import continued
from tethertest.solver.linear.transform import TransformDrive, TransformLine
from tethertest.solver.solution import Solution, beside, field_of_rows
from tethertest.solver.statics.rest import rest_state
from tethertest.solver.terms import per_direction

ComplexArray = npt.NDArray[np.complex128]

#: places of the field, both ends included
_STATIONS = 41
#: so many of them are transformed at once: all would take several times the memory of what is kept
_AT_ONCE = 4


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
    waves = _EndWaves.of(scene, np.asarray(s, dtype=np.complex128))
    place = waves.length * np.asarray(gauges, dtype=np.float64)[:, None]
    rising = np.exp(-waves.number * place)
    falling = waves.reflection * np.exp(-waves.number * (2.0 * waves.length - place))
    strain = waves.number * waves.size * (falling - rising)
    return AxialTransfer((waves.stiffness * strain).T, strain.T, (waves.size * (rising + falling)).T)


@dataclass(frozen=True, slots=True, eq=False)
class _EndWaves:
    """What the ends make of a wave, whatever the place; arrays of the shape of s."""

    length: float  #: unstretched [m]
    stiffness: ComplexArray  #: [N], damping included
    number: ComplexArray  #: of the wave, decaying [1/m]
    reflection: ComplexArray  #: at the top
    size: ComplexArray  #: of the wave from the bottom per unit of displacement there

    @classmethod
    def of(cls, scene: Scene, s: ComplexArray) -> _EndWaves:
        """Return the waves of a scene at complex frequencies."""
        rest = rest_state(scene)
        stiffness = rest.axial_stiffness * (1.0 + s * (scene.cable.axial_damping_time or 0.0))
        number = s * np.sqrt(rest.mass_per_length / stiffness)
        if scene.top.kind == "fixed":
            reflection = np.full_like(s, -1.0)
        else:
            hover = float(per_direction(scene.top.hover_stiffness)[2])
            damping = float(per_direction(scene.top.hover_damping)[2])
            body = (scene.top.mass or 0.0) * s**2 + damping * s + hover
            reflection = (stiffness * number - body) / (stiffness * number + body)
        size = 1.0 / (1.0 + reflection * np.exp(-2.0 * number * rest.length))
        return cls(rest.length, stiffness, number, reflection, size)


@lru_cache(maxsize=2)  # variations of a rig are driven by one motion
def _driven(
    bottom: Bottom, measured: MeasuredMotion | None, share: float, line: TransformLine, factor: int
) -> tuple[TransformDrive, ComplexArray]:
    """Return the share of a motion that goes along the cable, from where it starts, and its transform."""
    motion = continued(bottom, measured)
    start = float(motion(np.zeros(1))[0])
    drive = TransformDrive.sampled(lambda instant: share * (motion(instant) - start), line, factor)
    return drive, drive.spectrum(line.frequencies(factor))


def _tension_along(scene: Scene, s: ComplexArray, stations: int) -> Iterator[ComplexArray]:
    """Yield the tension per unit of bottom displacement from end to end, some stations (m, n) at a time."""
    waves = _EndWaves.of(scene, s)
    decay = np.exp(-waves.number * (waves.length / (stations - 1)))
    rising = np.empty((stations, s.size), dtype=np.complex128)
    rising[0] = 1.0
    for station in range(1, stations):  # a product in place of an exponential: eight times as fast
        np.multiply(rising[station - 1], decay, out=rising[station])
    returned, size = waves.reflection * rising[-1], waves.stiffness * waves.number * waves.size
    for first in range(0, stations, _AT_ONCE):
        tension = rising[::-1][first : first + _AT_ONCE] * returned
        tension -= rising[first : first + _AT_ONCE]
        tension *= size
        yield tension


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


def run_axial_transform(
    scene: Scene, *, measured: MeasuredMotion | None = None, factor: int = 1, with_field: bool = True
) -> Solution:
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
    with_field : bool
        Follow the tension along the whole cable; without, its field is that of the gauges.

    Raises
    ------
    DataError
        The scene is not one that axial waves alone describe, or its motion starts suddenly.
    """
    from scipy.fft import irfft

    share, rest, output = axial_share(scene), rest_state(scene), scene.output
    time = output_times(scene, None)
    line = TransformLine.over(time.size, output.rate)
    drive, spectrum = _driven(scene.bottom, measured, share, line, factor)
    if drive.start_velocity:
        message = (
            f"scene {scene.name!r}: the bottom starts at {drive.start_velocity:.3g} m/s: a transform rings "
            "at the fronts of a sudden start"
        )
        remedy = 'set [bottom] start = "ramp", begin data at rest, or set axial_damping_time to 0'
        raise DataError(message, remedy)
    s = line.frequencies(factor)
    growth = np.exp(line.eta * time)

    def inverted(transfer: ComplexArray) -> FloatArray:
        """Return the time series (rows, g) of a transfer (g, n)."""
        series = irfft(transfer * spectrum, drive.weighted.size, axis=1)
        kept = series[:, : (line.rows - 1) * factor + 1 : factor]
        return np.ascontiguousarray((kept * growth).T)

    gauges = np.asarray(output.gauges, dtype=np.float64)
    stations = np.linspace(0.0, 1.0, _STATIONS)
    here = axial_transfer(scene, s, np.append(gauges, 1.0))
    displacement = here.displacement[:, :-1].T
    at_gauges = rest.bottom_tension + gauges * rest.weight + inverted(here.tension[:, :-1].T)
    if with_field:
        resting = rest.bottom_tension + stations * rest.weight
        parts = []
        for number, part in enumerate(_tension_along(scene, s, _STATIONS)):
            there = slice(number * _AT_ONCE, number * _AT_ONCE + len(part))
            parts.append(field_of_rows(time, stations[there], resting[there] + inverted(part)))
        field = beside(parts)
    else:
        field = field_of_rows(time, gauges, at_gauges)
    return Solution(
        time=time,
        tension=at_gauges,
        strain=inverted(here.strain[:, :-1].T),
        platform_position=inverted(here.displacement[:, -1:].T)[:, 0],
        field=field,
        time_step=drive.step,
        steps_done=time.size,
        steps=time.size,
        fields=axial_fields(
            scene,
            rest,
            lambda: inverted(displacement),
            lambda: inverted(displacement * s),
            time.size,
        ),
    )
