"""What the upper end of a line sends back down: its fixed top, or a body with a position loop.

Waves of one kind run along a line of length ``L`` at speed ``c`` and impedance ``Z``: ``a = T - Z v`` is
carried up unchanged, ``b = T + Z v`` down. With the lower end's velocity ``v0`` given,
``a(0, t) = b(L, t - L/c) - 2 Z v0(t)`` and ``b(L, t) = a(0, t - L/c) + 2 Z v(L, t)``, so all there is to find
is the upper end's own velocity. Time goes in whole steps of ``L/(n c)``: a sudden start at 0 puts every later
front on a step's end, never inside it.

A body of mass ``M`` under lift and a position loop obeys ``M v' + (c + Z) v + k x = -a``, ``x' = v``.
Its two rates may lie far apart (a light body follows in no time at all) or meet; the functions ``phi`` of
exponential integrators serve both.

References
----------
Hochbruck & Ostermann, Acta Numerica 19 (2010), section 2.1: ``phi_k`` and its recurrence.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
import numpy.typing as npt

from tethertest.kernels.axial_waves import BodyStep, march_body
from tethertest.records.arrays import FloatArray

IndexArray = npt.NDArray[np.int64]
ComplexArray = npt.NDArray[np.complex128]

#: nodes within a step; the polynomial through them is one degree lower
_NODES = 5
#: part of a step within which two instants count as one
INSTANT = 1e-7
#: least part of a step at which the state after a front is taken: a body without mass has followed it by then
_AFTER = 1e-10
#: round trips beyond which the series of a fixed end gives way to the steps: its cost grows as their square
_SERIES_TRIPS = 50.0
#: mass that no wave moves [kg]
_IMMOVABLE = 1e30
#: decimals to which places within a step are told apart
_DECIMALS = 10
#: time constant of a body without mass, over the step
_MASSLESS = 1e-14
#: smallest distance of the two rates, over their size; nearer ones are moved apart
_APART = 1e-5
#: terms of the power series of phi where its argument is below 1
_TERMS = 16


@dataclass(frozen=True, slots=True)
class WaveLine:
    """A line that carries waves of one kind, and how its lower end moves."""

    length: float  #: [m]
    speed: float  #: [m/s]
    impedance: float  #: Z [N s/m]
    cells: int  #: steps per traverse
    velocity: Callable[[FloatArray], FloatArray]  #: of the lower end [m/s], from the right at 0
    displacement: Callable[[FloatArray], FloatArray]  #: of the lower end [m]

    @property
    def traverse(self) -> float:
        """``L/c`` [s]."""
        return self.length / self.speed

    @property
    def step(self) -> float:
        """``L/(n c)`` [s]."""
        return self.traverse / self.cells

    def sent(self, time: FloatArray, *, before: bool = False) -> FloatArray:
        """Return ``2 Z v0`` [N]; just before each instant if so asked."""
        begun = time > INSTANT * self.step if before else time >= -INSTANT * self.step
        return np.where(begun, 2.0 * self.impedance * self.velocity(np.maximum(time, 0.0)), 0.0)

    def sent_impulse(self, time: FloatArray) -> FloatArray:
        """Return the integral of `sent` from the start [N s]."""
        moved = self.displacement(np.maximum(time, 0.0)) - self.displacement(np.zeros(1))
        return np.asarray(2.0 * self.impedance * moved)


@dataclass(frozen=True, slots=True)
class EndLoop:
    """A body under constant lift and its position loop, along one direction."""

    mass: float  #: [kg], 0 or more
    stiffness: float  #: [N/m]
    damping: float  #: [N s/m]


class UpperEnd(Protocol):
    """The upper end of a line, solved."""

    def returned(self, time: FloatArray) -> FloatArray:
        """Return ``b`` [N] that leaves the end at any times up to the duration, 0 before the start."""

    def returned_impulse(self, time: FloatArray) -> FloatArray:
        """Return the integral of `returned` from the start [N s]."""

    def returned_at_half_steps(self, count: int, *, before: bool) -> FloatArray:
        """Return ``b`` [N] at the first multiples of half a step, after or just before each."""

    def position(self, time: FloatArray) -> FloatArray:
        """Return the end's displacement from rest [m]."""


def upper_end(line: WaveLine, body: EndLoop | None, duration: float) -> UpperEnd:
    """Return the solved upper end of a line.

    Over many round trips a fixed end is solved as an immovable body: its waves are polynomials in each step.

    Parameters
    ----------
    line : WaveLine
    body : EndLoop or None
        None for a fixed end.
    duration : float
        [s].
    """
    if body is None and duration <= 2.0 * _SERIES_TRIPS * line.traverse:
        return FixedEnd(line)
    return BodyEnd.marched(line, body or EndLoop(_IMMOVABLE, 0.0, 0.0), duration)


@dataclass(frozen=True, slots=True)
class FixedEnd:
    """An end that does not move: it returns the lower end's motion, again and again."""

    line: WaveLine

    def returned(self, time: FloatArray) -> FloatArray:
        """Return ``b`` [N]: d'Alembert's series, exact at any time."""
        return self._series(time, self.line.sent)

    def returned_impulse(self, time: FloatArray) -> FloatArray:
        """Return the integral of `returned` from the start [N s]."""
        return self._series(time, self.line.sent_impulse)

    def returned_at_half_steps(self, count: int, *, before: bool) -> FloatArray:
        """Return ``b`` [N] at the first multiples of half a step; a round trip is a whole number of them."""
        period = 4 * self.line.cells
        time = (np.arange(count, dtype=np.float64) - 0.5 * period) * (0.5 * self.line.step)
        padded = np.zeros(math.ceil(count / period) * period)
        padded[:count] = self.line.sent(time, before=before)
        return -np.cumsum(padded.reshape(-1, period), axis=0).ravel()[:count]

    def position(self, time: FloatArray) -> FloatArray:
        """Return zeros."""
        return np.zeros(time.shape)

    def _series(self, time: FloatArray, term: Callable[[FloatArray], FloatArray]) -> FloatArray:
        total = np.zeros(time.shape)
        delay, last = self.line.traverse, float(np.max(time, initial=0.0))
        slack = INSTANT * self.line.step
        for trip in range(math.floor(0.5 * (last + slack) / delay + 0.5)):
            since = time - (2.0 * trip + 1.0) * delay
            reached = since >= -slack
            total[reached] -= term(since[reached])
        return total


@dataclass(frozen=True, slots=True, eq=False)
class BodyEnd:
    """A body at the end: arriving waves as polynomials in each step, and its state where steps meet."""

    line: WaveLine
    answer: BodyAnswer
    powers: FloatArray  #: (k, m) [N], coefficients of the arriving wave in the part of the step gone by
    impulse: FloatArray  #: (k,) [N s], of the arriving wave up to the start of each step
    state: FloatArray  #: (k + 1, 2) position [m] and velocity [m/s]

    @classmethod
    def marched(cls, line: WaveLine, body: EndLoop, duration: float) -> BodyEnd:
        """Solve the body's motion over the duration."""
        steps = math.ceil(duration / line.step) + 1
        points, weights = np.polynomial.legendre.leggauss(_NODES)
        nodes, weights = 0.5 * (points + 1.0), 0.5 * weights
        inverse = np.linalg.inv(np.vander(nodes, increasing=True))
        answer = BodyAnswer.of(body, line.impedance, line.step, _NODES)
        end_carry, end_gain = answer.at(np.ones(1))
        node_carry, node_gain = answer.at(nodes)
        time = (np.arange(steps)[:, None] + nodes - line.cells) * line.step
        arriving, state = np.zeros((steps, _NODES)), np.zeros((steps + 1, 2))
        step = BodyStep(
            round_trip=2 * line.cells,
            impedance=line.impedance,
            carry=np.ascontiguousarray(end_carry[0]),
            gain=np.ascontiguousarray(end_gain[0] @ inverse),
            node_carry=np.ascontiguousarray(node_carry[:, 1]),
            node_gain=np.ascontiguousarray(node_gain[:, 1] @ inverse),
        )
        march_body(line.sent(time), step, arriving, state)
        impulse = np.concatenate([[0.0], np.cumsum(arriving[:-1] @ weights) * line.step])
        return cls(line, answer, arriving @ inverse.T, impulse, state)

    def returned(self, time: FloatArray, *, before: bool = False) -> FloatArray:
        """Return ``b`` [N] at any times up to the duration; just before each instant if so asked."""
        index, part = self._located(time, before=before)
        arriving = np.sum(self.powers[index] * part[..., None] ** np.arange(_NODES), axis=-1)
        sent_on = arriving + 2.0 * self.line.impedance * self._state(index, part, 1)
        return np.where(time >= -INSTANT * self.line.step, sent_on, 0.0)

    def returned_impulse(self, time: FloatArray) -> FloatArray:
        """Return the integral of `returned` from the start [N s]."""
        index, part = self._located(time)
        order = np.arange(1, _NODES + 1)
        within = np.sum(self.powers[index] * part[..., None] ** order / order, axis=-1)
        arrived = self.impulse[index] + self.line.step * within
        total = arrived + 2.0 * self.line.impedance * self._state(index, part, 0)
        return np.where(time > 0.0, total, 0.0)

    def returned_at_half_steps(self, count: int, *, before: bool) -> FloatArray:
        """Return ``b`` [N] at the first multiples of half a step."""
        return self.returned(np.arange(count, dtype=np.float64) * (0.5 * self.line.step), before=before)

    def position(self, time: FloatArray) -> FloatArray:
        """Return the body's displacement from rest [m]."""
        return self._state(*self._located(time), 0)

    def _located(self, time: FloatArray, *, before: bool = False) -> tuple[IndexArray, FloatArray]:
        """Return the step that each time belongs to, and the part of it gone by, above 0."""
        steps = np.asarray(time) / self.line.step
        index = np.ceil(steps - INSTANT) - 1.0 if before else np.floor(steps + INSTANT)
        index = np.clip(index, 0, self.powers.shape[0] - 1)
        return index.astype(np.int64), np.clip(steps - index, _AFTER, 1.0)

    def _state(self, index: IndexArray, part: FloatArray, row: int) -> FloatArray:
        """Return position (row 0) or velocity (row 1) within steps."""
        places, which = np.unique(np.round(part, _DECIMALS), return_inverse=True)
        carry, gain = self.answer.at(places)
        start = np.sum(carry[which, row] * self.state[index], axis=-1)
        return np.asarray(start + np.sum(gain[which, row] * self.powers[index], axis=-1))


def phi(argument: ComplexArray, highest: int) -> ComplexArray:
    """Return ``phi_0 = exp(z)`` and ``phi_{k+1} = (phi_k - 1/k!)/z`` up to the highest wanted.

    Parameters
    ----------
    argument : (n,) complex128
        ``z``, real part 0 or below.
    highest : int

    Returns
    -------
    (highest + 1, n) complex128
    """
    z = np.asarray(argument, dtype=np.complex128)
    small = np.abs(z) < 1.0
    near, far = np.where(small, z, 0.0), np.where(small, 1.0, z)
    down, up = np.empty((highest + 1, z.size), dtype=complex), np.empty((highest + 1, z.size), dtype=complex)
    down[highest] = 0.0
    for i in reversed(range(_TERMS)):
        down[highest] = down[highest] * near + 1.0 / math.factorial(highest + i)
    for k in range(highest, 0, -1):
        down[k - 1] = near * down[k] + 1.0 / math.factorial(k - 1)
    up[0] = np.exp(np.where(small, 0.0, far))
    for k in range(highest):
        up[k + 1] = (up[k] - 1.0 / math.factorial(k)) / far
    return np.where(small, down, up)


@dataclass(frozen=True, slots=True)
class BodyAnswer:
    """The body's state within a step, linear in its state at the start and in the wave's coefficients."""

    step: float  #: [s]
    count: int  #: coefficients of the wave
    rates: tuple[complex, complex]  #: the faster first [1/s]
    root: complex  #: ``sqrt((c + Z)^2 - 4 M k)``, mass times the distance of the rates [N s/m]
    mass: float  #: [kg]
    stiffness: float  #: [N/m]

    @classmethod
    def of(cls, body: EndLoop, impedance: float, step: float, count: int) -> BodyAnswer:
        """Return the answer of a body on a line of an impedance [N s/m]."""
        total = body.damping + impedance
        mass = max(body.mass, _MASSLESS * total * step)
        stiffness = body.stiffness
        if abs(total**2 - 4.0 * mass * stiffness) < (_APART * total) ** 2:
            stiffness = (1.0 - _APART**2) * total**2 / (4.0 * mass)
        root = complex(total**2 - 4.0 * mass * stiffness) ** 0.5
        rates = (-(total + root) / (2.0 * mass), -2.0 * stiffness / (total + root))
        return cls(step, count, rates, root, mass, stiffness)

    def at(self, part: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return what the state is made of at parts of a step.

        Parameters
        ----------
        part : (n,) float64
            Of the step, above 0.

        Returns
        -------
        carry : (n, 2, 2) float64
            (position, velocity) from the same at the start of the step.
        gain : (n, 2, m) float64
            From the coefficients [N] of the wave in powers of the part.
        """
        slow = self.rates[1]
        z = [rate * self.step * part for rate in self.rates]
        fast_phi, slow_phi = (phi(np.asarray(each), self.count + 1) for each in z)
        spread = self.mass * (z[1] * slow_phi[1] - z[0] * fast_phi[1]) / self.root
        carry = np.empty((part.size, 2, 2))
        carry[:, 0, 0] = (slow_phi[0] - slow * spread).real
        carry[:, 0, 1] = spread.real
        carry[:, 1, 0] = (-self.stiffness / self.mass * spread).real
        carry[:, 1, 1] = (fast_phi[0] + slow * spread).real
        gain = np.empty((part.size, 2, self.count))
        for p in range(self.count):
            size = math.factorial(p) * part**p / self.root
            along = self.step * part * size
            gain[:, 0, p] = (along * (z[0] * fast_phi[p + 2] - z[1] * slow_phi[p + 2])).real
            gain[:, 1, p] = (size * (z[0] * fast_phi[p + 1] - z[1] * slow_phi[p + 1])).real
        return carry, gain
