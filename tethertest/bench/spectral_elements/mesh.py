"""Gauss-Lobatto-Legendre elements along a cable."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.polynomial import legendre

from tethertest.records.arrays import FloatArray

#: polynomial degree of an element
DEGREE = 8


@dataclass(frozen=True, slots=True, eq=False)
class SpectralMesh:
    """Equal elements on a cable of given unstretched length."""

    length: float  #: unstretched [m]
    elements: int

    @property
    def size(self) -> float:
        """Unstretched length of an element [m]."""
        return self.length / self.elements

    @property
    def points(self) -> FloatArray:
        """Quadrature weights (q,) of an element [m]."""
        return np.asarray(0.5 * self.size * _weights())

    @property
    def derivative(self) -> FloatArray:
        """Derivative (q, q) by the unstretched arc at the points of an element, from its values [1/m]."""
        return np.asarray(2.0 / self.size * _derivative())

    @property
    def integral(self) -> FloatArray:
        """Integral (q, q) from the start of an element to its points, of its values [m]."""
        return np.asarray(0.5 * self.size * _integral())

    @property
    def arc(self) -> FloatArray:
        """Unstretched arc (m,) of the nodes from the bottom end [m]."""
        inner = 0.5 * self.size * (1.0 + _points()[1:])
        starts = self.size * np.arange(self.elements)
        return np.concatenate([[0.0], (starts[:, None] + inner).ravel()])

    @property
    def nodes(self) -> FloatArray:
        """Quadrature weights (m,) of the nodes [m]."""
        weights = np.zeros(self.elements * DEGREE + 1)
        for element in range(self.elements):
            weights[element * DEGREE : (element + 1) * DEGREE + 1] += self.points
        return weights

    @property
    def highest_wavenumber(self) -> float:
        """Bound of the highest natural frequency over the wave speed [1/m]: that of a free element."""
        stiffness = self.derivative.T @ (self.points[:, None] * self.derivative)
        scale = 1.0 / np.sqrt(self.points)
        return float(np.sqrt(np.max(np.linalg.eigvalsh(scale[:, None] * stiffness * scale))))

    def stretched_length(self, position: FloatArray) -> float:
        """Return the length [m] of a cable whose nodes lie at positions (d, m)."""
        starts = range(0, position.shape[1] - 1, DEGREE)
        slopes = [position[:, start : start + DEGREE + 1] @ self.derivative.T for start in starts]
        return float(sum(self.points @ np.linalg.norm(slope, axis=0) for slope in slopes))

    def basis(self, fraction: FloatArray) -> tuple[np.ndarray, FloatArray]:
        """Return elements (g,) and their Lagrange polynomials (g, q) at fractions (g,) of the length."""
        element = np.clip((fraction * self.elements).astype(np.int64), 0, self.elements - 1)
        local = 2.0 * (fraction * self.elements - element) - 1.0
        modes = legendre.legvander(_points(), DEGREE)
        return element, np.ascontiguousarray(np.linalg.solve(modes.T, legendre.legvander(local, DEGREE).T).T)


@cache
def _points() -> FloatArray:
    """Return the points (q,) on [-1, 1]: the ends, and where the derivative of the last mode vanishes."""
    inner = legendre.Legendre.basis(DEGREE).deriv().roots()
    return np.concatenate([[-1.0], np.sort(np.real(inner)), [1.0]])


@cache
def _weights() -> FloatArray:
    last = legendre.Legendre.basis(DEGREE)(_points())
    return np.asarray(2.0 / (DEGREE * (DEGREE + 1) * last**2))


@cache
def _derivative() -> FloatArray:
    points = _points()
    last = legendre.Legendre.basis(DEGREE)(points)
    apart = points[:, None] - points[None, :] + np.eye(points.size)
    matrix = last[:, None] / (last[None, :] * apart)
    np.fill_diagonal(matrix, 0.0)
    np.fill_diagonal(matrix, -matrix.sum(axis=1))  # a constant has no slope, to rounding
    return np.asarray(matrix)


@cache
def _integral() -> FloatArray:
    points = _points()
    grown = [legendre.legval(points, legendre.legint(mode, lbnd=-1)) for mode in np.eye(DEGREE + 1)]
    return np.asarray(np.linalg.solve(legendre.legvander(points, DEGREE).T, np.array(grown)).T)
