"""Motion of the bottom end: displacement from rest, and its exact velocity, at any times."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from tethertest.errors import DataError
from tethertest.records.arrays import FloatArray
from tethertest.records.scene import Bottom, MeasuredMotion
from tethertest.signal.spline import Piecewise, spline


def smooth_step(ratio: FloatArray) -> FloatArray:
    """Return the quintic that goes from 0 to 1 with two vanishing derivatives at both ends."""
    r = np.clip(ratio, 0.0, 1.0)
    return np.asarray(r**3 * (10.0 - 15.0 * r + 6.0 * r**2))


def smooth_step_slope(ratio: FloatArray) -> FloatArray:
    """Return the derivative of `smooth_step`."""
    r = np.clip(ratio, 0.0, 1.0)
    return np.asarray(30.0 * r**2 * (1.0 - r) ** 2)


def displacement(bottom: Bottom, time: FloatArray, measured: MeasuredMotion | None = None) -> FloatArray:
    """Return the bottom displacement from rest, upwards.

    Parameters
    ----------
    bottom : Bottom
        Motion of the scene.
    time : (n,) float64
        [s] from the start.
    measured : MeasuredMotion, optional
        Needed for ``motion = "measured"``; continued with uniform acceleration outside its span.

    Returns
    -------
    (n,) float64
        [m].

    Raises
    ------
    DataError
        A key that the motion needs is missing.
    """
    t = np.asarray(time, dtype=np.float64)
    if bottom.motion == "fixed":
        return np.zeros_like(t)
    if bottom.motion == "step":
        return _need(bottom.velocity, "velocity", bottom) * np.maximum(t, 0.0)
    if bottom.motion == "measured":
        return _measured(t, measured)
    frequency = _need(bottom.frequency, "frequency", bottom)
    ramp = _ramp(bottom)
    if bottom.motion == "harmonic":
        amplitude = _need(bottom.amplitude, "amplitude", bottom)
        envelope = 1.0 if ramp is None else smooth_step(t / ramp)
        return np.where(t > 0.0, amplitude * np.sin(2.0 * np.pi * frequency * t) * envelope, 0.0)
    radius = _need(bottom.radius, "radius", bottom)
    ratio = _need(bottom.rod_ratio, "rod_ratio", bottom)
    return crank_slider(radius, ratio, _crank_angle(t, frequency, ramp))


def velocity(bottom: Bottom, time: FloatArray, measured: MeasuredMotion | None = None) -> FloatArray:
    """Return the bottom velocity, upwards: the derivative of `displacement` in closed form.

    Parameters
    ----------
    bottom : Bottom
        Motion of the scene.
    time : (n,) float64
        [s] from the start; the velocity is 0 before it and, at 0 itself, that just after it.
    measured : MeasuredMotion, optional
        Needed for ``motion = "measured"``; at rest outside its span.

    Returns
    -------
    (n,) float64
        [m/s].

    Raises
    ------
    DataError
        A key that the motion needs is missing.
    """
    t = np.asarray(time, dtype=np.float64)
    begun = t >= 0.0
    if bottom.motion == "fixed":
        return np.zeros_like(t)
    if bottom.motion == "step":
        return np.where(begun, _need(bottom.velocity, "velocity", bottom), 0.0)
    if bottom.motion == "measured":
        return np.where(begun, _measured_velocity(t, measured), 0.0)
    frequency = _need(bottom.frequency, "frequency", bottom)
    angular = 2.0 * np.pi * frequency
    ramp = _ramp(bottom)
    share = np.ones_like(t) if ramp is None else smooth_step(t / ramp)
    if bottom.motion == "harmonic":
        rate = angular * np.cos(angular * t) * share
        if ramp is not None:
            rate += np.sin(angular * t) * smooth_step_slope(t / ramp) / ramp
        return np.where(begun, _need(bottom.amplitude, "amplitude", bottom) * rate, 0.0)
    radius = _need(bottom.radius, "radius", bottom)
    ratio = _need(bottom.rod_ratio, "rod_ratio", bottom)
    turning = angular * share
    return np.where(begun, turning * crank_slope(radius, ratio, _crank_angle(t, frequency, ramp)), 0.0)


def crank_slider(radius: float, rod_ratio: float, angle: FloatArray) -> FloatArray:
    """Return the slider's displacement from mid-stroke at -90 degrees, for crank angles turned since then.

    Parameters
    ----------
    radius : float
        Crank radius [m].
    rod_ratio : float
        Radius over rod length; 0 is a pure sine.
    angle : (n,) float64
        Angle turned since rest [rad].
    """
    theta = np.asarray(angle) - 0.5 * np.pi
    if rod_ratio == 0.0:
        return np.asarray(radius * np.cos(theta))
    rod = np.sqrt(1.0 - rod_ratio**2 * np.sin(theta) ** 2) / rod_ratio
    rest = np.sqrt(1.0 - rod_ratio**2) / rod_ratio
    return np.asarray(radius * (np.cos(theta) + rod - rest))


def crank_slope(radius: float, rod_ratio: float, angle: FloatArray) -> FloatArray:
    """Return the derivative of `crank_slider` to the angle [m/rad]; parameters as there."""
    theta = np.asarray(angle) - 0.5 * np.pi
    sine = np.sin(theta)
    lean = rod_ratio * np.cos(theta) / np.sqrt(1.0 - (rod_ratio * sine) ** 2)
    return np.asarray(-radius * sine * (1.0 + lean))


def _ramp(bottom: Bottom) -> float | None:
    if bottom.start != "ramp":
        return None
    if bottom.ramp is None:
        message = 'motion with start = "ramp" has no ramp time'
        raise DataError(message, 'add [bottom] ramp = "8 s"')
    return bottom.ramp


def _crank_angle(time: FloatArray, frequency: float, ramp: float | None) -> FloatArray:
    t = np.maximum(time, 0.0)
    if ramp is None:
        return np.asarray(2.0 * np.pi * frequency * t)
    r = np.minimum(t / ramp, 1.0)
    turned = ramp * (2.5 * r**4 - 3.0 * r**5 + r**6) + np.maximum(t - ramp, 0.0)
    return np.asarray(2.0 * np.pi * frequency * turned)


def _measured(time: FloatArray, measured: MeasuredMotion | None) -> FloatArray:
    data = _given(measured)
    through = _splined(data)
    inside = np.clip(time, data.time[0], data.time[-1])
    found = through(inside)
    beyond = time != inside  # a step or two of the solver's: uniform acceleration goes on
    if beyond.any():
        end, after = inside[beyond], time[beyond] - inside[beyond]
        found[beyond] += after * (through(end, 1) + 0.5 * after * through(end, 2))
    return found


def _measured_velocity(time: FloatArray, measured: MeasuredMotion | None) -> FloatArray:
    data = _given(measured)
    through = _splined(data)
    inside = np.clip(time, data.time[0], data.time[-1])
    found = through(inside, 1)
    beyond = time != inside
    if beyond.any():
        found[beyond] += (time[beyond] - inside[beyond]) * through(inside[beyond], 2)
    return found


@lru_cache(maxsize=2)  # one solve asks for it dozens of times, and so do the variations of a rig
def _splined(data: MeasuredMotion) -> Piecewise:
    return spline(data.time, data.displacement)


def _given(measured: MeasuredMotion | None) -> MeasuredMotion:
    if measured is None:
        message = 'motion "measured" without data'
        raise DataError(message, "give the measured displacement with the scene")
    return measured


def _need(value: float | None, key: str, bottom: Bottom) -> float:
    if value is None:
        message = f"motion {bottom.motion!r} needs {key}"
        raise DataError(message, f"add [bottom] {key}")
    return value
