"""The course of one order over the record: amplitude and phase, window by window."""

from __future__ import annotations

from typing import Final

import numpy as np

from tethertest.records.arrays import frozen
from tethertest.records.lines import OrderTrack
from tethertest.spectra.order_demodulation import DemodulatedOrder

#: windows at most, and cycles of the order that each holds at least
MOST_WINDOWS: Final = 16
CYCLES_PER_WINDOW: Final = 2.0


def track_order(
    followed: DemodulatedOrder,
    variance: float,
    start: float,
    cycles: float = CYCLES_PER_WINDOW,
    most: int = MOST_WINDOWS,
) -> OrderTrack:
    """Return one order's amplitude and phase in windows of equal length, all other orders fitted.

    Parameters
    ----------
    followed : DemodulatedOrder
        The order.
    variance : float
        Of the noise of one block next to the order, in the channel's unit squared.
    start : float
        Of the record [s]; the course's times are on the channel's clock.
    cycles : float
        Of the order, that each window holds at least.
    most : int
        Windows at most.

    Returns
    -------
    OrderTrack
        With standard errors; a single window where the record holds less than two.
    """
    count = int(np.clip(followed.length * followed.frequency / cycles, 1, most))
    number = np.clip((count * (followed.ramp + 0.5)).astype(np.intp), 0, count - 1)
    windows = (number[None, :] == np.arange(count)[:, None]).astype(np.float64)
    windows = windows[windows @ followed.single > 0.0]
    pulls, normal = followed.modulated(windows)
    inverse = np.linalg.pinv(normal, hermitian=True)
    pairs = (inverse @ pulls).reshape(-1, 2)
    amplitude = np.hypot(pairs[:, 0], pairs[:, 1])
    # the two coefficients of a window have nearly the same error
    error = np.sqrt(variance * 0.5 * np.diag(inverse).reshape(-1, 2).sum(axis=1))
    middle = windows @ followed.time / windows.sum(axis=1)
    return OrderTrack(
        frozen(start + 0.5 * followed.length + middle),
        frozen(amplitude),
        frozen(error),
        frozen(np.unwrap(np.arctan2(-pairs[:, 1], pairs[:, 0]))),
        frozen(error / np.maximum(amplitude, 1e-300)),
    )


def phase_wander(followed: OrderTrack) -> float:
    """Return the root mean square of a course's phase about a straight line [rad], noise included."""
    if followed.time.size < 4:
        return 0.0
    line = np.polynomial.Polynomial.fit(followed.time, followed.phase, 1)
    return float(np.sqrt(np.mean((followed.phase - line(followed.time)) ** 2)))
