"""Elastic catenaries by the thousand: one cable, many positions of its ends, all solved at once.

The formulas are those of `tethertest.solver.statics.catenary_shape`, in space and for rows: a force (n, 3)
with which the cable pulls its bottom end gives the upper end's place, and its derivative is the flexibility.
Every row hangs in the plane of its chord and the load.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tethertest.errors import DataError
from tethertest.records.arrays import BoolArray, FloatArray

#: a chord whose part across the load is below this share of the length stands upright
_UPRIGHT = 1e-13
#: relative size of the last Newton step
_SETTLED = 1e-12
#: largest misfit of the upper end, relative to the length
_CLOSED = 1e-9
_ITERATIONS = 100
_HALVINGS = 40


@dataclass(frozen=True, slots=True, eq=False)
class HangingCable:
    """A uniform elastic cable under a uniform load; its ends are still free."""

    length: float  #: unstretched [m]
    stiffness: float  #: EA [N]
    load: FloatArray  #: (3,) per unstretched length, x, y, z [N/m]

    @property
    def weight(self) -> float:
        """Size of the load per length [N/m]."""
        return float(np.linalg.norm(self.load))

    @property
    def up(self) -> FloatArray:
        """Unit vector (3,) against the load; z without load."""
        return -self.load / self.weight if self.weight > 0.0 else np.array([0.0, 0.0, 1.0])

    def tension(self, force: FloatArray, fraction: FloatArray) -> FloatArray:
        """Return the tension (n, m) [N] at fractions (m,) of the length, for bottom forces (n, 3) [N]."""
        low = force @ self.up
        side_squared = np.maximum(np.einsum("ij,ij->i", force, force) - low**2, 0.0)
        along = low[:, None] + (self.weight * self.length) * fraction
        return np.asarray(np.sqrt(side_squared[:, None] + along**2))

    def lowest_tension(self, force: FloatArray) -> FloatArray:
        """Return the lowest tension (n,) [N] anywhere along the cable, for bottom forces (n, 3) [N]."""
        low = force @ self.up
        nearest = np.clip(0.0, low, low + self.weight * self.length)
        return np.asarray(np.hypot(np.linalg.norm(force - low[:, None] * self.up, axis=1), nearest))

    def position(self, force: FloatArray, fraction: FloatArray) -> FloatArray:
        """Return the positions (n, m, 3) [m] from the bottom end, at fractions (m,) of the length."""
        low = (force @ self.up)[:, None]
        level = force - low * self.up
        side = np.linalg.norm(level, axis=1)[:, None]
        arc = self.length * np.asarray(fraction)
        reach, climb = self._offset(side, low, arc)
        per_force = reach / np.where(side > 0.0, side, 1.0)
        return np.asarray(per_force[..., None] * level[:, None, :] + climb[..., None] * self.up)

    def flexibility(self, force: FloatArray) -> FloatArray:
        """Return the derivative (n, 3, 3) [m/N] of the upper end's place by the bottom force (n, 3) [N]."""
        up = self.up
        low = force @ up
        level = force - low[:, None] * up
        side = np.linalg.norm(level, axis=1)
        across = level / np.where(side > 0.0, side, 1.0)[:, None]
        swing, turn, cross = self._compliances(side, low)
        stretch = self.length / self.stiffness
        mixed = np.einsum("i,ij,k->ijk", cross, across, up)
        upright = np.outer(up, up)
        return np.asarray(
            (stretch + swing)[:, None, None] * (np.eye(3) - upright)
            - np.einsum("i,ij,ik->ijk", turn, across, across)
            + mixed
            + mixed.transpose(0, 2, 1)
            + (stretch + turn)[:, None, None] * upright
        )

    def between(self, chord: FloatArray) -> FloatArray:
        """Return the bottom forces (n, 3) [N] of cables whose chords (n, 3) [m] are known, taut or hanging.

        A cable without load whose chord is shorter than itself pulls with nothing.

        Raises
        ------
        DataError
            Newton's method did not close a chord.
        """
        distance = np.linalg.norm(chord, axis=1)
        if self.weight == 0.0:
            pull = self.stiffness * np.maximum(distance / self.length - 1.0, 0.0)
            return np.asarray((pull / np.where(distance > 0.0, distance, 1.0))[:, None] * chord)
        up = self.up
        rise = chord @ up
        level = chord - rise[:, None] * up
        side = np.linalg.norm(level, axis=1)
        total = self.weight * self.length
        upright = side <= _UPRIGHT * self.length
        pull, low = np.zeros_like(rise), np.zeros_like(rise)
        low[upright] = self._upright(rise[upright]) - 0.5 * total
        if not np.all(upright):
            pull[~upright], low[~upright] = self._newton(side[~upright], rise[~upright])
        across = level / np.where(side > 0.0, side, 1.0)[:, None]
        return np.asarray(pull[:, None] * across + low[:, None] * up)

    def _offset(self, side: FloatArray, low: FloatArray, arc: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return reach across the load and climb against it [m] of the point at unstretched arc [m]."""
        high = low + self.weight * arc
        low_tension, high_tension = np.hypot(side, low), np.hypot(side, high)
        both = low_tension + high_tension
        climb = arc * ((low + high) / np.where(both > 0.0, both, 1.0) + 0.5 * (low + high) / self.stiffness)
        swing = self._swing(side, low, high, low_tension, high_tension, arc)
        return np.asarray(side * (swing + arc / self.stiffness)), np.asarray(climb)

    def _swing(
        self,
        side: FloatArray,
        low: FloatArray,
        high: FloatArray,
        low_tension: FloatArray,
        high_tension: FloatArray,
        arc: FloatArray,
    ) -> FloatArray:
        """Return the integral of ds/T [m/N], without cancellation."""
        if self.weight == 0.0:
            return np.asarray(arc / np.maximum(low_tension, 1e-300))
        same = low * high > 0.0
        products = np.where(same, high * low_tension + low * high_tension, 1.0)
        near = self.weight * arc * (high + low) / products
        apart = (high * low_tension - low * high_tension) / np.maximum(side * side, 1e-300)
        return np.asarray(np.arcsinh(np.where(same, near, apart)) / self.weight)

    def _compliances(self, side: FloatArray, low: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return swing, turn and cross [m/N]: what bending adds to the flexibility of the whole cable."""
        high = low + self.weight * self.length
        low_tension, high_tension = np.hypot(side, low), np.hypot(side, high)
        arc = np.full_like(low, self.length)
        swing = self._swing(side, low, high, low_tension, high_tension, arc)
        product = np.maximum(low_tension * high_tension, 1e-300)
        cross = -side * self.length * (high + low) / (product * (low_tension + high_tension))
        if self.weight == 0.0:
            turn = self.length * side**2 / (product * low_tension)
        else:
            same = low * high > 0.0
            products = np.where(same, high * low_tension + low * high_tension, 1.0)
            near = side**2 * self.length * (high + low) / (product * products)
            unit = np.maximum(low_tension, 1e-300), np.maximum(high_tension, 1e-300)
            turn = np.where(same, near, (high / unit[1] - low / unit[0]) / self.weight)
        return swing, np.clip(turn, 0.0, swing), cross

    def _upright(self, rise: FloatArray) -> FloatArray:
        """Return the mean force along the load where the ends lie one above the other."""
        half = 0.5 * self.weight * self.length
        folded = rise / (2.0 / self.weight + self.length / self.stiffness)
        taut = self.stiffness * (rise - np.copysign(self.length, rise)) / self.length
        return np.where(np.abs(folded) <= half, folded, taut)

    def _guess(self, side: FloatArray, rise: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return a first force across and along the load: of the taut line, or the inextensible catenary."""
        distance, half = np.hypot(side, rise), 0.5 * self.weight * self.length
        pull = self.stiffness * np.maximum(distance / self.length - 1.0, 0.0) + 0.1 * half
        slenderness = np.sqrt(np.maximum(self.length**2 - rise**2, side**2)) / side
        shallow = np.maximum(1e-3, np.sqrt(6.0 * (np.minimum(slenderness, 3.0) - 1.0)))
        logarithm = np.log(2.0 * np.maximum(slenderness, 3.0))
        ratio = np.where(slenderness < 3.0, shallow, logarithm + np.log(logarithm))
        taut = distance >= self.length
        return (
            np.where(taut, pull * side / distance, 0.5 * self.weight * side / ratio),
            np.where(taut, pull * rise / distance, 0.5 * self.weight * rise / np.tanh(ratio)) - half,
        )

    def _newton(self, side: FloatArray, rise: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the forces (n,) across and along the load, by Newton's method on the convex energy.

        A row's step is halved until the energy's slope along it has fallen in size; settled rows drop out.
        """
        level, low = self._guess(side, rise)
        reach, climb = self._offset(side=level, low=low, arc=np.full_like(low, self.length))
        miss_side, miss_rise = reach - side, climb - rise
        stretch = self.length / self.stiffness
        open_rows = np.arange(side.size)
        for _ in range(_ITERATIONS):
            now, below = level[open_rows], low[open_rows]
            swing, turn, cross = self._compliances(now, below)
            first, second = stretch + swing - turn, stretch + turn
            determinant = first * second - cross * cross
            off_side, off_rise = miss_side[open_rows], miss_rise[open_rows]
            step_side = (cross * off_rise - second * off_side) / determinant
            step_low = (cross * off_side - first * off_rise) / determinant
            slope = np.abs(off_side * step_side + off_rise * step_low)
            share = np.ones_like(now)
            for _ in range(_HALVINGS):
                new, new_low = now + share * step_side, below + share * step_low
                reach, climb = self._offset(new, new_low, np.full_like(new, self.length))
                off_side, off_rise = reach - side[open_rows], climb - rise[open_rows]
                left = np.abs(off_side * step_side + off_rise * step_low)
                fine = (new > 0.0) & (left <= (1.0 - 1e-4 * share) * slope + 1e-300)
                if np.all(fine):
                    break
                share = np.where(fine, share, 0.5 * share)
            level[open_rows] = np.where(fine, new, now)
            low[open_rows] = np.where(fine, new_low, below)
            miss_side[open_rows] = np.where(fine, off_side, miss_side[open_rows])
            miss_rise[open_rows] = np.where(fine, off_rise, miss_rise[open_rows])
            small = np.hypot(step_side, step_low) <= _SETTLED * np.hypot(now, below)
            open_rows = open_rows[fine & ~small]
            if open_rows.size == 0:
                break
        self._check(np.hypot(miss_side, miss_rise) <= _CLOSED * (self.length + np.hypot(side, rise)))
        return level, low

    def _check(self, closed: BoolArray) -> None:
        if not np.all(closed):
            failed = np.count_nonzero(~closed)
            message = f"no equilibrium found for {failed} of {closed.size} positions of the ends"
            raise DataError(message, "check length, stiffness and motion of the cable")
