"""What the quasi-static cable leaves out, and the motion that this would have made.

The quasi-static motion is known, so the forces it neglects are: the inertia of the cable, the drag of its own
motion, and what the platform's balance still lacks. They drive a linear chain about a state of the cable;
its response, dynamic amplification included, is the first-order error of the model.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from tethertest.records.arrays import FloatArray
from tethertest.solver.quasi_static.moved_ends import MovedEnds, rates
from tethertest.solver.quasi_static.rest_case import RestCase, air_push

ComplexArray: TypeAlias = npt.NDArray[np.complex128]

#: cells of the chain
CELLS = 16
#: passes of the drag's damping, which depends on the motion it damps
_PASSES = 4
#: equivalent linear damping of quadratic drag: sqrt(8 / pi) times the standard deviation of the velocity
_EQUIVALENT = np.sqrt(8.0 / np.pi)
#: what the window that keeps the transform causal leaves of the record's end
_WINDOW = 1e-7


@dataclass(frozen=True, slots=True, eq=False)
class NeglectedLoad:
    """Forces that the quasi-static motion neglects, at the free nodes of a chain."""

    force: FloatArray  #: (n, k, 3) [N]; k free nodes
    velocity: FloatArray  #: (n, k, 3) of the quasi-static motion [m/s]
    interval: float  #: [s]


def neglected_load(case: RestCase, ends: MovedEnds) -> NeglectedLoad:
    """Return the neglected inertia and drag of the rows of a quasi-static solution."""
    cable, nodes = case.cable, np.arange(CELLS + 1) / CELLS
    position = ends.bottom[:, None] + cable.position(ends.force, nodes)
    velocity, acceleration = rates(position, ends.interval)
    cell = cable.length / CELLS
    force = -case.mass * cell * acceleration
    if any(case.drag):
        tangent = case.tangents(ends.force, nodes)
        air = air_push(tangent, case.wind - velocity, case.drag)
        force += cell * (air - air_push(tangent[:1], case.wind, case.drag))
    if not case.platform:
        return NeglectedLoad(force[:, 1:-1], velocity[:, 1:-1], ends.interval)
    top_velocity, top_acceleration = rates(ends.top, ends.interval)
    pulled = ends.force - case.force
    force[:, -1] = 0.5 * force[:, -1] - (
        pulled
        + case.hover_stiffness * ends.top
        + case.hover_damping * top_velocity
        + case.body_mass * top_acceleration
    )
    force[-1] = force[-2]  # the last row has no central difference
    return NeglectedLoad(force[:, 1:], velocity[:, 1:], ends.interval)


def tension_response(
    case: RestCase, load: NeglectedLoad, state: FloatArray, fraction: FloatArray
) -> FloatArray:
    """Return the tension (n, g) [N] that the neglected load makes at fractions (g,) of the length.

    Parameters
    ----------
    case : RestCase
    load : NeglectedLoad
    state : (3,) float64
        Bottom force [N] of the catenary about which the chain is linear.
    fraction : (g,) float64
    """
    from scipy.linalg import eigh

    axial, along, stiffness = _stiffness(case, state)
    mass = np.full(stiffness.shape[0], case.mass * case.cable.length / CELLS)
    hover = np.zeros(stiffness.shape[0])
    if case.platform:
        mass[-3:] = 0.5 * mass[-3:] + case.body_mass
        stiffness[-3:, -3:] += np.diag(case.hover_stiffness)
        hover[-3:] = case.hover_damping
    squared, shape = eigh(stiffness, np.diag(mass))
    rows, count = load.force.shape[:2]
    driven = load.force.reshape(rows, 3 * count) @ shape
    gauges = _gauge_rows(axial, along, count, fraction)
    transform = _Transform.of(driven, load.interval)
    velocity = load.velocity
    for later in range(_PASSES if any(case.drag) else 1, 0, -1):
        damping = hover + _drag_damping(case, along, velocity)
        modal = np.einsum("ij,i,ij->j", shape, damping, shape)
        answer = transform.spectrum / (transform.rate**2 + modal * transform.rate + squared)
        if later > 1:
            own = transform.back(transform.rate * answer) @ shape.T
            velocity = load.velocity + own.reshape(rows, count, 3)
    return np.asarray(transform.back(answer) @ (gauges @ shape).T)


def _stiffness(case: RestCase, state: FloatArray) -> tuple[float, FloatArray, FloatArray]:
    """Return EA/h [N/m], the cells' unit vectors and the stiffness of the chain's free nodes [N/m]."""
    cell = case.cable.length / CELLS
    centres = (np.arange(CELLS) + 0.5) / CELLS
    along = case.tangents(state[None], centres)[0]
    tension = case.cable.tension(state[None], centres)[0]
    axial = case.cable.stiffness / cell
    lateral = tension / (cell * (1.0 + tension / case.cable.stiffness))
    outer = np.einsum("ij,ik->ijk", along, along)
    blocks = axial * outer + lateral[:, None, None] * (np.eye(3) - outer)
    whole = np.zeros((CELLS + 1, 3, CELLS + 1, 3))
    for i in range(CELLS):
        whole[i, :, i] += blocks[i]
        whole[i + 1, :, i + 1] += blocks[i]
        whole[i, :, i + 1] -= blocks[i]
        whole[i + 1, :, i] -= blocks[i]
    last = CELLS + 1 if case.platform else CELLS
    free = whole[1:last, :, 1:last].reshape(3 * (last - 1), 3 * (last - 1))
    return axial, along, free


def _gauge_rows(axial: float, along: FloatArray, count: int, fraction: FloatArray) -> FloatArray:
    """Return the gauges' tension (g, 3 k) [N/m] per displacement of the free nodes, linear between cells."""
    cells = np.zeros((CELLS, CELLS + 1, 3))
    index = np.arange(CELLS)
    cells[index, index + 1] = axial * along
    cells[index, index] = -axial * along
    centres = (index + 0.5) / CELLS
    low = np.clip(np.searchsorted(centres, fraction) - 1, 0, CELLS - 2)
    share = ((fraction - centres[low]) * CELLS)[:, None, None]
    between = (1.0 - share) * cells[low] + share * cells[low + 1]
    return np.asarray(between[:, 1 : count + 1].reshape(fraction.size, 3 * count))


def _drag_damping(case: RestCase, along: FloatArray, velocity: FloatArray) -> FloatArray:
    """Return the equivalent damping (3 k,) [N s/m] of the drag on the free nodes."""
    count = velocity.shape[1]
    relative = velocity - case.wind
    tangent = along[np.minimum(np.arange(1, count + 1), CELLS - 1)]
    slip = np.einsum("nkj,kj->nk", relative, tangent)
    across = relative - slip[..., None] * tangent
    speed = np.sqrt(np.mean(np.sum(across**2, axis=2), axis=0))
    per_node = case.drag[0] * case.cable.length / CELLS * _EQUIVALENT * speed
    return np.repeat(per_node, 3)


@dataclass(frozen=True, slots=True, eq=False)
class _Transform:
    """Fourier transform of rows from rest, on a line that makes it causal.

    The window decays over twice the record, so that what has not died out by its end does not return at its
    start.
    """

    spectrum: ComplexArray  #: (f, m)
    rate: ComplexArray  #: (f, 1), what differentiation multiplies with [1/s]
    window: FloatArray  #: (n, 1)
    padded: int

    @classmethod
    def of(cls, driven: FloatArray, interval: float) -> _Transform:
        """Return the transform of rows (n, m)."""
        from scipy.fft import next_fast_len, rfft

        rows = driven.shape[0]
        padded = int(next_fast_len(2 * rows, real=True))
        decay = -np.log(_WINDOW) / (padded * interval)
        window = np.exp(-decay * interval * np.arange(rows))[:, None]
        spectrum = np.asarray(rfft(driven * window, padded, axis=0))
        omega = (2.0 * np.pi / (padded * interval)) * np.arange(spectrum.shape[0])
        return cls(spectrum, 1j * omega[:, None] + decay, window, padded)

    def back(self, spectrum: ComplexArray) -> FloatArray:
        """Return the rows (n, m) of a spectrum (f, m)."""
        from scipy.fft import irfft

        return np.asarray(irfft(spectrum, self.padded, axis=0)[: self.window.size] / self.window)
