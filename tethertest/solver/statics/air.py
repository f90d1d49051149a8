"""The steady wind's push on a cable and on the body at its top, at rest."""

from __future__ import annotations

import numpy as np

from tethertest.records.arrays import FloatArray
from tethertest.records.scene import Scene
from tethertest.solver.terms import body_axes, steady_wind


def node_tangents(along: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the nodes' tangents (n + 1, 3) and the sizes (n + 1,) of the sums they come from.

    A node's tangent is the mean of its cells' unit vectors (n, 3), an end's that of its cell.
    """
    total = np.concatenate([along[:1], along[:-1] + along[1:], along[-1:]])
    size = np.maximum(np.sqrt(np.einsum("ij,ij->i", total, total)), 1e-12)
    return total / size[:, None], size


def air_on_nodes(tangent: FloatArray, wind: FloatArray, drag: tuple[float, float]) -> FloatArray:
    """Return the air's force (m, 3) [N/m] per unstretched length, normal and tangential apart (Morison type).

    Parameters
    ----------
    tangent : (m, 3) float64
        Unit vectors.
    wind : (3,) float64
        [m/s].
    drag : (float, float)
        Normal and tangential, per length and velocity squared [N s^2/m^3].
    """
    slip = tangent @ wind
    across = wind - slip[:, None] * tangent
    speed = np.sqrt(np.einsum("ij,ij->i", across, across))
    return np.asarray(
        (drag[0] * speed)[:, None] * across + (drag[1] * np.abs(slip) * slip)[:, None] * tangent
    )


def air_by_tangent(tangent: FloatArray, wind: FloatArray, drag: tuple[float, float]) -> FloatArray:
    """Return the derivative (m, 3, 3) [N/m] of `air_on_nodes` by the tangents."""
    slip = tangent @ wind
    across = wind - slip[:, None] * tangent
    speed = np.sqrt(np.einsum("ij,ij->i", across, across))
    direction = across / np.maximum(speed, 1e-300)[:, None]
    one = np.eye(3)
    turned = tangent[:, :, None] * wind  # t W', the derivative of slip t besides slip itself
    sideways = -(turned + slip[:, None, None] * one)
    normal = speed[:, None, None] * (sideways + direction[:, :, None] * (direction[:, None, :] @ sideways))
    size = np.abs(slip)[:, None, None]
    return np.asarray(drag[0] * normal + drag[1] * size * (2.0 * turned + slip[:, None, None] * one))


def body_drag(scene: Scene) -> FloatArray:
    """Return the steady wind's force (3,) [N] on the platform at rest: quadratic along each of its axes."""
    axes, drag = body_axes(scene)
    slip = axes @ steady_wind(scene)
    if slip.size == 0:
        return np.zeros(3)
    across = float(np.hypot(slip[0], slip[1]))  # the body is round about its z axis
    speed = np.array([across, across, abs(float(slip[2]))])
    return np.asarray((drag * speed * slip) @ axes)
