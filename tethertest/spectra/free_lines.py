"""Strong lines between the orders, fitted along so that they do not leak into them."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Final

import numpy as np

from tethertest.signal.blocks import Blocks
from tethertest.signal.sinusoid import sinusoid_pair
from tethertest.spectra.orders import RESOLUTION
from tethertest.spectra.regression import OrderFit, fit_orders, with_noise

#: an ordinate this many times the smooth density is a line (chance 1e-13)
STRONG: Final = 30.0
#: at most so many are fitted along; a response with more has no period worth speaking of
MOST: Final = 4
#: points per 1/T of the transform in which a line's frequency is read
ZERO_PADDING: Final = 8


def fit_orders_and_free_lines(
    blocks: Blocks, drive: float, orders: Sequence[Fraction], origin: float, white: float = 0.0
) -> OrderFit:
    """Fit the orders, then again with the strongest lines that are left at least 1/T away from all of them.

    Parameters
    ----------
    blocks : Blocks
        The channel's window.
    drive : float
        Frequency of the drive [Hz].
    orders : sequence of Fraction
        Those wanted.
    origin : float
        Time to which phases refer [s].
    white : float
        Density of the sensor's own white noise [unit^2/Hz].

    Returns
    -------
    OrderFit
        Of the orders; the free lines are among its sinusoids.
    """
    fit = fit_orders(blocks, drive, orders, origin, white=white)
    for _ in range(MOST):
        frequency = _strongest_left(fit)
        if frequency is None:
            break
        sinusoids = fit.sinusoids.extended(frequency, sinusoid_pair(blocks, frequency, origin))
        fit = with_noise(blocks, drive, fit.orders, sinusoids, white)
    return fit


def _strongest_left(fit: OrderFit) -> float | None:
    """Return the frequency [Hz] of the strongest line left between the fitted ones, if beyond chance."""
    noise, fitted, length = fit.noise, fit.sinusoids.frequencies, fit.blocks.length
    highest = float(fitted.max())
    ratio = noise.plain / noise.density(noise.frequency)
    ratio[noise.frequency > highest] = 0.0
    best = int(np.argmax(ratio))
    if ratio[best] < STRONG:
        return None
    near = float(noise.frequency[best])
    trial = near + np.arange(-ZERO_PADDING, ZERO_PADDING + 1) / (ZERO_PADDING * length)
    residuals = fit.sinusoids.residuals * fit.blocks.weights
    grid, origin = fit.blocks.grid, fit.sinusoids.origin
    power = np.array([abs(np.vdot(grid.rotating(float(at), origin), residuals)) ** 2 for at in trial])
    peak = int(np.clip(np.argmax(power), 1, trial.size - 2))
    left, middle, right = power[peak - 1 : peak + 2]
    bend = float(left - 2.0 * middle + right)
    shift = 0.5 * float(left - right) / bend if bend < 0.0 else 0.0
    frequency = float(trial[peak] + np.clip(shift, -1.0, 1.0) / (ZERO_PADDING * length))
    apart = float(np.min(np.abs(fitted - frequency)))
    return frequency if apart * length >= RESOLUTION and frequency * length >= RESOLUTION else None
