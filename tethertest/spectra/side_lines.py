"""Whether a line is one of the two that a wandering phase of order 1 puts beside it."""

from __future__ import annotations

from fractions import Fraction
from typing import Final

import numpy as np

from tethertest.spectra.orders import RESOLUTION
from tethertest.spectra.regression import OrderFit

#: a phase that swings makes two lines of one size, mirrored about order 1, that leave the amplitude as it is;
#: a line alone swings both alike. Below this ratio of the one to the other it is taken for a swing of phase
LARGEST_RATIO: Final = 0.25


def swings_phase(fit: OrderFit, order: Fraction) -> bool:
    """Say whether a line and its mirror image about order 1 are together a swing of order 1's phase.

    ``A cos(a + e cos(b))`` has lines of the complex amplitudes ``l`` and ``u`` at ``a - b`` and ``a + b``,
    over that of order 1; ``(l + conj u) / 2`` swings the amplitude, ``(l - conj u) / 2`` the phase.

    Parameters
    ----------
    fit : OrderFit
        All orders of a channel, order 1 among them.
    order : Fraction
        A fitted order; those from 2 on have no mirror image, and the answer is no.
    """
    mirror = 2 - order
    if mirror <= 0 or mirror == order:
        return False
    carrier = _fitted(fit, Fraction(1))
    line = _fitted(fit, order) / carrier
    image = np.conj((_fitted(fit, mirror) if mirror in fit.orders else _left(fit, mirror)) / carrier)
    return bool(abs(line + image) < LARGEST_RATIO * abs(line - image))


def _fitted(fit: OrderFit, order: Fraction) -> complex:
    cosine, sine = fit.sinusoids.pair(fit.orders.index(order))
    return complex(cosine, -sine)


def _left(fit: OrderFit, order: Fraction) -> complex:
    """Return the complex amplitude of an order that was not fitted: what is left there, or a free line."""
    frequency = float(order) * fit.drive
    rotating = fit.blocks.phasor(frequency, fit.sinusoids.origin).conj()
    weights = fit.sinusoids.weights
    values = fit.sinusoids.residuals * weights
    for index, free in enumerate(fit.sinusoids.frequencies[len(fit.orders) :], len(fit.orders)):
        if abs(free - frequency) * fit.blocks.length < RESOLUTION:
            phasor = complex(*fit.sinusoids.pair(index)).conjugate()
            line = (phasor * fit.blocks.phasor(float(free), fit.sinusoids.origin)).real
            values = values + weights * line
    norm = float(weights @ np.abs(rotating) ** 2)
    return complex(2.0 * np.sum(rotating * values) / norm)
