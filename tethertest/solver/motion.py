"""Motion of the bottom end: displacement from rest at any times."""

from __future__ import annotations

import numpy as np

from tethertest.errors import DataError
from tethertest.records.arrays import FloatArray
from tethertest.records.scene import Bottom, MeasuredMotion


def smooth_step(ratio: FloatArray) -> FloatArray:
    """Return the quintic that goes from 0 to 1 with two vanishing derivatives at both ends."""
    r = np.clip(ratio, 0.0, 1.0)
    return np.asarray(r**3 * (10.0 - 15.0 * r + 6.0 * r**2))


def displacement(bottom: Bottom, time: FloatArray, measured: MeasuredMotion | None = None) -> FloatArray:
    """Return the bottom displacement from rest, upwards.

    Parameters
    ----------
    bottom : Bottom
        Motion of the scene.
    time : (n,) float64
        [s] from the start.
    measured : MeasuredMotion, optional
        Needed for ``motion = "measured"``; held at its end values outside its span.

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
    ramp = bottom.ramp if bottom.start == "ramp" else None
    if bottom.start == "ramp" and ramp is None:
        message = 'motion with start = "ramp" has no ramp time'
        raise DataError(message, 'add [bottom] ramp = "8 s"')
    if bottom.motion == "harmonic":
        amplitude = _need(bottom.amplitude, "amplitude", bottom)
        envelope = 1.0 if ramp is None else smooth_step(t / ramp)
        return np.where(t > 0.0, amplitude * np.sin(2.0 * np.pi * frequency * t) * envelope, 0.0)
    radius = _need(bottom.radius, "radius", bottom)
    ratio = _need(bottom.rod_ratio, "rod_ratio", bottom)
    return crank_slider(radius, ratio, _crank_angle(t, frequency, ramp))


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


def _crank_angle(time: FloatArray, frequency: float, ramp: float | None) -> FloatArray:
    t = np.maximum(time, 0.0)
    if ramp is None:
        return np.asarray(2.0 * np.pi * frequency * t)
    r = np.minimum(t / ramp, 1.0)
    turned = ramp * (2.5 * r**4 - 3.0 * r**5 + r**6) + np.maximum(t - ramp, 0.0)
    return np.asarray(2.0 * np.pi * frequency * turned)


def _measured(time: FloatArray, measured: MeasuredMotion | None) -> FloatArray:
    from scipy.interpolate import CubicSpline

    if measured is None:
        message = 'motion "measured" without data'
        raise DataError(message, "give the measured displacement with the scene")
    spline = CubicSpline(measured.time, measured.displacement)
    return np.asarray(spline(np.clip(time, measured.time[0], measured.time[-1])), dtype=np.float64)


def _need(value: float | None, key: str, bottom: Bottom) -> float:
    if value is None:
        message = f"motion {bottom.motion!r} needs {key}"
        raise DataError(message, f"add [bottom] {key}")
    return value
