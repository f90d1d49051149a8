"""What a line may come from instead of the drive: a free line, unsteady whole orders, folded high ones."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Final

import numpy as np

from tethertest.spectra.holm import holm
from tethertest.spectra.orders import COMPANIONS, RESOLUTION
from tethertest.spectra.regression import Amplitude, OrderFit, fit_orders, order_amplitudes
from tethertest.spectra.tracking import Tracking

#: highest order of the drive that is thought of as folding back from above half the sampling rate: the kinks
#: of a tension that snaps taut carry that far
HIGHEST_FOLDED: Final = 200
#: whole orders up to this one any tension may have: above half the sampling rate they fold back unseen
LIKELY_ORDER: Final = 4
#: the highest orders in the band are this many times larger than what may have folded back from beyond it
CARRIED_RATIO: Final = 3.0


def free_sources(
    fit: OrderFit,
    amplitudes: Mapping[Fraction, Amplitude],
    significant: set[Fraction],
    tracked: Mapping[Fraction, Tracking],
    significance: float,
) -> dict[Fraction, float]:
    """Return the broken orders that vanish once the strongest free line is fitted at its own frequency."""
    broken = [order for order in significant if order.denominator != 1]
    if len(broken) < 2:
        return {}
    strongest = max(broken, key=lambda order: amplitudes[order].f_value)
    if tracked[strongest].locked:
        return {}
    frequency = tracked[strongest].frequency
    orders = tuple(order for order in fit.orders if order != strongest)
    free = (*fit.sinusoids.frequencies[len(fit.orders) :], frequency)
    refit = fit_orders(fit.blocks, fit.drive, orders, fit.sinusoids.origin, free)
    rest = tuple(order for order in amplitudes if order != strongest and order in refit.orders)
    adjusted = holm({order: item.p_value for order, item in order_amplitudes(refit, rest).items()})
    return {
        order: frequency for order in broken if order != strongest and adjusted.get(order, 1.0) > significance
    }


def leakage_floor(
    fit: OrderFit,
    order: Fraction,
    amplitudes: Mapping[Fraction, Amplitude],
    changes: Mapping[Fraction, float],
) -> float:
    """Return the amplitude that whole orders, not quite steady, leave at another order.

    A line of amplitude A that changes by a share c over the record leaks ``A c / (pi T |df|)`` to a frequency
    df away that the record holds a whole number of cycles of.
    """
    own = float(order) * fit.drive
    leaks = (
        amplitudes[whole].value * change / (np.pi * fit.blocks.length * abs(float(whole) * fit.drive - own))
        for whole, change in changes.items()
        if whole != order
    )
    return float(sum(leaks))


def folded_order(fit: OrderFit, order: Fraction, amplitude: Amplitude, rate: float) -> Fraction | None:
    """Return the order above half the sampling rate that folds onto this one, if the series has such orders.

    It may have the lowest whole orders always, and others where the orders fitted as companions, next below
    what the rate carries, are clearly larger than the line.
    """
    own = float(order) * fit.drive

    def folds(candidate: Fraction) -> bool:
        frequency = float(candidate) * fit.drive
        folded = abs(frequency - rate * round(frequency / rate))
        return 2.0 * frequency > rate and abs(folded - own) * fit.blocks.length < RESOLUTION

    for likely in range(2, LIKELY_ORDER + 1):
        if folds(Fraction(likely)):
            return Fraction(likely)
    for denominator in (1, 2):
        carried = [
            fit.sinusoids.amplitude(index)
            for index, companion in enumerate(fit.orders)
            if companion in COMPANIONS and companion.denominator == denominator
        ]
        if max(carried, default=0.0) < CARRIED_RATIO * amplitude.value:
            continue
        first = int(0.5 * rate / fit.drive * denominator) + 1
        for numerator in range(first, HIGHEST_FOLDED * denominator + 1):
            if folds(Fraction(numerator, denominator)):
                return Fraction(numerator, denominator)
    return None
