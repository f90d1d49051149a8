"""Exact steady axial response of a vertical cable with a platform end, in closed form."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from tethertest.records.arrays import FloatArray
from tethertest.records.scene import Scene
from tethertest.solver.statics.rest import rest_state


def tension_transfer(scene: Scene, frequency: FloatArray, gauges: FloatArray) -> npt.NDArray[np.complex128]:
    """Return the tension amplitude per unit of bottom displacement.

    The wave equation in the material coordinate with displacement prescribed below and, above, a mass under
    constant lift with a position loop (or a fixed end). Gravity adds only a static part.

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
    rest = rest_state(scene)
    omega = 2.0 * np.pi * np.asarray(frequency, dtype=np.float64)[:, None]
    stiffness = rest.axial_stiffness * (1.0 + 1j * omega * (scene.cable.axial_damping_time or 0.0))
    wave = omega * np.sqrt(rest.mass_per_length / stiffness)
    phase = wave * rest.length
    if scene.top.kind == "fixed":
        sine = -np.cos(phase) / np.sin(phase)
    else:
        hover, damping = (
            value if isinstance(value, float) else float(value[-1])
            for value in (scene.top.hover_stiffness, scene.top.hover_damping)
        )
        end = hover - (scene.top.mass or 0.0) * omega**2 + 1j * omega * damping
        line = stiffness * wave
        sine = (line * np.sin(phase) - end * np.cos(phase)) / (line * np.cos(phase) + end * np.sin(phase))
    station = wave * rest.length * np.asarray(gauges, dtype=np.float64)[None, :]
    return np.asarray(stiffness * wave * (sine * np.cos(station) - np.sin(station)))
