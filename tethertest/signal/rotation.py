"""Phasors ``exp(2 pi i f t)`` at many times, quickly where the times lie on an even grid."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]
IndexArray = npt.NDArray[np.intp]
ComplexArray = npt.NDArray[np.complex128]

#: times this close to an even grid, relative to its step, are taken to lie on it: round-off of clocks
EVEN_TOLERANCE = 1e-7
#: steps per row: a phasor on an even grid is an outer product of two short ones, a tenth of the time
ROW = 128


@dataclass(frozen=True, slots=True, eq=False)
class Times:
    """Times at which phasors are wanted, with their places on an even grid if they have one."""

    time: FloatArray  #: (n,) [s]
    slots: IndexArray | None  #: (n,) places on the grid, rising; holes are allowed
    start: float  #: of the grid [s]
    step: float  #: of the grid [s]

    def rotating(self, frequency: float, origin: float) -> ComplexArray:
        """Return ``exp(2 pi i f (t - origin))`` (n,)."""
        if self.slots is None or self.slots.size == 0:
            direct: ComplexArray = np.exp(2j * np.pi * frequency * (self.time - origin))
            return direct
        rows = int(self.slots[-1]) // ROW + 1
        coarse = np.exp(2j * np.pi * frequency * (self.start - origin + np.arange(rows) * (ROW * self.step)))
        fine = np.exp(2j * np.pi * frequency * (np.arange(ROW) * self.step))
        grid: ComplexArray = np.outer(coarse, fine).ravel()
        whole = self.slots.size == int(self.slots[-1]) + 1
        return grid[: self.slots.size] if whole else grid[self.slots]


def times(time: FloatArray, interval: float) -> Times:
    """Return times with their places on the even grid of about that interval [s], if they lie on one.

    Parameters
    ----------
    time : (n,) float64
        Strictly increasing [s].
    interval : float
        Nominal distance of neighbours [s]; refined over the whole span.
    """
    if time.size < 2:
        return Times(time, None, 0.0, interval)
    last = float(np.rint((time[-1] - time[0]) / interval))
    step = float(time[-1] - time[0]) / max(last, 1.0)
    slots = np.rint((time - time[0]) / step).astype(np.intp)
    even = np.max(np.abs(time - (time[0] + step * slots))) <= EVEN_TOLERANCE * step
    return Times(time, slots if even else None, float(time[0]), step)
