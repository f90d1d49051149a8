"""Strains at stations per bottom displacement of the linear cable, for any complex frequency.

The cable carries two waves up and two down. A wave's exponential is referred to the end where it is 1 and
only decays from there, so nothing overflows at any frequency or length; the ends are 2 x 2 reflections.
"""

from __future__ import annotations

import numpy as np

from tethertest.records.arrays import FloatArray
from tethertest.solver.linear.coupled import (
    ComplexArray,
    CoupledCable,
    EndBody,
    coefficients,
    wave_number_squares,
)


def strain_transfer(
    cable: CoupledCable,
    s: ComplexArray,
    direction: tuple[float, float],
    stations: FloatArray,
    top: EndBody | None = None,
) -> tuple[ComplexArray, ComplexArray]:
    """Return strains and top displacement per unit of bottom displacement.

    Parameters
    ----------
    cable : CoupledCable
    s : (n,) complex128
        Laplace variable [1/s] with a real part above zero.
    direction : (float, float)
        Components of the bottom motion along the tangent and the normal there.
    stations : (g,) float64
        Fractions of the length from the bottom.
    top : EndBody, optional
        Body at the top; fixed if absent.

    Returns
    -------
    strains : (g, 2, n) complex128
        eps1 and eps2 [1/m].
    displacement : (2, n) complex128
        Of the upper end along (tangent, normal) there.
    """
    axial, transverse, _, _ = coefficients(cable, s)
    squares = wave_number_squares(cable, s)
    numbers = np.sqrt(squares)  # real part above zero: these decay
    shape, force = _waves(cable, s, squares, numbers)
    mirror_shape, mirror_force = shape.copy(), force.copy()  # x -> -x turns the sign of u1 and q2
    mirror_shape[0] *= -1.0
    mirror_force[1] *= -1.0
    decay = np.exp(-numbers * cable.length)
    if top is None:
        arriving, leaving = shape, mirror_shape
    else:
        body = _body(top, s)
        arriving = _product(body, shape) + cable.mass_per_length * force
        leaving = _product(body, mirror_shape) + cable.mass_per_length * mirror_force
    reflection = -_product(_inverse(leaving), arriving * decay[None])
    round_trip = _product(mirror_shape * decay[None], reflection)
    up = np.einsum("ijn,j->in", _inverse(shape + round_trip), np.asarray(direction, dtype=np.float64))
    down = np.einsum("ijn,jn->in", reflection, up)
    rows = np.stack([force[0] / axial, force[1] / transverse])
    mirror_rows = np.stack([mirror_force[0] / axial, mirror_force[1] / transverse])
    rows, mirror_rows = rows * up[None], mirror_rows * down[None]
    strains = np.empty((stations.size, 2, s.size), dtype=np.complex128)
    for g, station in enumerate(stations):
        rising = np.exp(-numbers * (station * cable.length))
        falling = np.exp(-numbers * ((1.0 - station) * cable.length))
        strains[g] = rows[:, 0] * rising[0] + rows[:, 1] * rising[1]
        strains[g] += mirror_rows[:, 0] * falling[0] + mirror_rows[:, 1] * falling[1]
    end = np.einsum("ijn,jn->in", shape, decay * up) + np.einsum("ijn,jn->in", mirror_shape, down)
    return strains, np.asarray(end)


def _waves(
    cable: CoupledCable, s: ComplexArray, squares: ComplexArray, numbers: ComplexArray
) -> tuple[ComplexArray, ComplexArray]:
    """Return (u1, u2) and (q1, q2) of the two waves ``exp(-mu x)``; (component, wave, n)."""
    axial, transverse, along, across = coefficients(cable, s)
    bend = cable.curvature
    first = axial * squares - along - bend**2 * transverse
    second = transverse * squares - across - bend**2 * axial
    cross = bend * (axial + transverse) * numbers
    swap = np.abs(first) > np.abs(second)  # either row of the singular pair serves; take the larger one
    tangential, normal = np.where(swap, -cross, second), np.where(swap, first, cross)
    size = np.maximum(np.abs(tangential), np.abs(normal))
    tangential, normal = tangential / size, normal / size
    shape: ComplexArray = np.stack([tangential, normal])
    force = np.stack(
        [
            -axial * (numbers * tangential + bend * normal),
            transverse * (bend * tangential - numbers * normal),
        ]
    )
    return shape, force


def _body(top: EndBody, s: ComplexArray) -> ComplexArray:
    stiffness, damping = np.asarray(top.stiffness), np.asarray(top.damping)
    inertia = top.mass * np.eye(2)
    return np.asarray(inertia[..., None] * s**2 + damping[..., None] * s + stiffness[..., None])


def _product(left: ComplexArray, right: ComplexArray) -> ComplexArray:
    return np.stack(
        [np.stack([left[i, 0] * right[0, j] + left[i, 1] * right[1, j] for j in (0, 1)]) for i in (0, 1)]
    )


def _inverse(matrix: ComplexArray) -> ComplexArray:
    determinant = matrix[0, 0] * matrix[1, 1] - matrix[0, 1] * matrix[1, 0]
    adjugate = np.stack([np.stack([matrix[1, 1], -matrix[0, 1]]), np.stack([-matrix[1, 0], matrix[0, 0]])])
    return np.asarray(adjugate / determinant)
