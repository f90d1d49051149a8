"""A scene's terms as numbers and as vectors (x, y, z)."""

from __future__ import annotations

import math

import numpy as np

from tethertest.errors import DataError
from tethertest.records.arrays import FloatArray
from tethertest.records.scene import Scene


def spatial(vector: tuple[float, ...]) -> FloatArray:
    """Return a scene's vector [x, z] or [x, y, z] as (3,) x, y, z."""
    return np.array([vector[0], vector[1] if len(vector) == 3 else 0.0, vector[-1]], dtype=np.float64)


def axial_stiffness(scene: Scene) -> float:
    """Return EA [N].

    Raises
    ------
    DataError
        It is neither given nor follows from Young's modulus and diameter.
    """
    cable = scene.cable
    if cable.axial_stiffness is not None:
        return cable.axial_stiffness
    if cable.youngs_modulus is None or cable.diameter is None:
        message = f"scene {scene.name!r}: neither axial_stiffness nor youngs_modulus with diameter is given"
        raise DataError(message, "give [cable] axial_stiffness")
    return cable.youngs_modulus * math.pi * cable.diameter**2 / 4.0


def drag_coefficients(scene: Scene) -> tuple[float, float]:
    """Return normal and tangential drag per unstretched length and velocity squared [N s^2/m^3].

    Raises
    ------
    DataError
        There is drag on a cable of unknown diameter.
    """
    air, diameter = scene.air, scene.cable.diameter
    if air is None or (air.normal_drag == 0.0 and air.tangential_drag == 0.0):
        return 0.0, 0.0
    if diameter is None:
        message = f"scene {scene.name!r}: drag needs the diameter of the cable"
        raise DataError(message, "give [cable] diameter")
    pressure = 0.5 * air.density * diameter
    return pressure * air.normal_drag, pressure * math.pi * air.tangential_drag


def steady_wind(scene: Scene) -> FloatArray:
    """Return the wind (3,) [m/s] without gusts."""
    if scene.air is None:
        return np.zeros(3)
    wind = scene.air.wind
    return spatial(wind) if isinstance(wind, tuple) else np.array([wind, 0.0, 0.0])


def per_direction(value: float | tuple[float, ...]) -> FloatArray:
    """Return a position loop's constants (3,) along x, y, z; of two the first serves x and y."""
    if not isinstance(value, tuple):
        return np.full(3, float(value))
    return np.array([value[0], value[1] if len(value) == 3 else value[0], value[-1]], dtype=np.float64)


def bottom_direction(scene: Scene, tangent: FloatArray) -> FloatArray:
    """Return the unit vector (3,) of the bottom motion.

    Parameters
    ----------
    scene : Scene
    tangent : (3,) float64
        Direction up the cable at its bottom end at rest; of any size.

    Raises
    ------
    DataError
        The direction has no size.
    """
    direction = scene.bottom.direction
    if direction == "vertical":
        vector = np.array([0.0, 0.0, 1.0])
    elif direction == "horizontal":
        vector = np.array([1.0, 0.0, 0.0])
    else:
        vector = tangent if direction == "tangent" else spatial(direction)
    size = float(np.linalg.norm(vector))
    if size == 0.0:
        message = f"scene {scene.name!r}: the bottom motion has no direction"
        raise DataError(message, "give [bottom] direction as a vector that is not zero")
    return np.asarray(vector / size)


def leaves_plane(scene: Scene) -> bool:
    """Return whether the scene has anything across the plane of x and z."""
    direction = scene.bottom.direction
    vectors = [
        direction if isinstance(direction, tuple) else (),
        scene.geometry.top or (),
        scene.top.lift if isinstance(scene.top.lift, tuple) else (),
        scene.air.wind if scene.air is not None and isinstance(scene.air.wind, tuple) else (),
    ]
    return any(len(vector) == 3 and vector[1] != 0.0 for vector in vectors)


def body_axes(scene: Scene) -> tuple[FloatArray, FloatArray]:
    """Return the axes (m, 3) along which the platform's body resists the air, and how much (m,).

    The body's x axis leans down by ``tilt``; across the plane it resists as along x. The second array is
    force per velocity squared [N s^2/m^2]; both are empty without air or area.
    """
    top, air = scene.top, scene.air
    if air is None or top.drag_area is None or not any(top.drag_area):
        return np.zeros((0, 3)), np.zeros(0)
    cosine, sine = math.cos(top.tilt), math.sin(top.tilt)
    axes = np.array([[cosine, 0.0, -sine], [0.0, 1.0, 0.0], [sine, 0.0, cosine]])
    forward, upward = top.drag_area
    return axes, 0.5 * air.density * np.array([forward, forward, upward])
