"""The lines of one channel at orders of the drive, each with amplitude, interval and verdict."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Final

import numpy as np

from tethertest.errors import DataError
from tethertest.records.channel import Channel, Window
from tethertest.records.lines import ChannelLines, DriveFit, Expectation, Line, LineVerdict
from tethertest.spectra.free_lines import fit_orders_and_free_lines
from tethertest.spectra.orders import COMPANIONS, ORDERS, RESOLUTION, length_to_resolve
from tethertest.spectra.regression import (
    Amplitude,
    OrderFit,
    channel_blocks,
    fit_orders,
    local_p_value,
    order_amplitudes,
)
from tethertest.spectra.stroboscope import stroboscopic_section
from tethertest.spectra.tracking import Tracking, track, unsteadiness
from tethertest.spectra.verdicts import NATURAL_RESOLUTION, Evidence, judge

#: chance of one false line in a channel, over all orders tried (Holm)
SIGNIFICANCE: Final = 0.01
#: lines below this share of the strongest one are rounding and interpolation, however clean the record
SMALLEST_RATIO: Final = 1e-5
#: highest order of the drive that is thought of as folding back from above half the sampling rate: the kinks
#: of a tension that snaps taut carry that far
HIGHEST_FOLDED: Final = 200
#: the highest orders in the band are this many times larger than what may have folded back from beyond it
CARRIED_RATIO: Final = 3.0
FUNDAMENTAL: Final = Fraction(1)


def find_lines(
    channel: Channel,
    window: Window,
    drive: DriveFit,
    expectation: Expectation,
    orders: Sequence[Fraction] = ORDERS,
    significance: float = SIGNIFICANCE,
) -> ChannelLines:
    """Look for orders of the drive in one channel.

    Parameters
    ----------
    channel : Channel
        Measured or replayed.
    window : Window
        The steady part; phases refer to its start.
    drive : DriveFit
        Frequency of the drive with its standard error.
    expectation : Expectation
        Natural frequencies, predicted orders, lines of the bottom motion; may be empty.
    orders : sequence of Fraction
        Orders wanted. Those above what the channel's rate carries are left out.
    significance : float
        Chance of any false line among the orders tried.

    Returns
    -------
    ChannelLines
        One line per order, in rising order.

    Raises
    ------
    DataError
        The window holds too few periods or usable samples of this channel.

    References
    ----------
    S. Holm, Scand. J. Statist. 6 (1979) 65-70.
    """
    part = channel.between(window.start, window.stop)
    blocks = channel_blocks(channel, window, drive.frequency, expectation.mains)
    fit = fit_orders_and_free_lines(blocks, drive.frequency, (*orders, *COMPANIONS), window.start)
    tried = tuple(order for order in orders if order in fit.orders)
    if FUNDAMENTAL not in tried:
        message = f"channel {channel.name!r}: order 1 is not among the orders tried"
        raise DataError(message, "ask for order 1, or choose a longer window")
    amplitudes = order_amplitudes(fit, tried)
    adjusted = holm({order: amplitude.p_value for order, amplitude in amplitudes.items()})
    smallest = SMALLEST_RATIO * max(amplitude.value for amplitude in amplitudes.values())
    significant = {
        order for order in tried if adjusted[order] <= significance and amplitudes[order].value > smallest
    }
    tracked = _tracked(fit, significant, drive, expectation)
    sources = _sources(fit, amplitudes, significant, tracked, significance)
    broken = any(order.denominator != 1 for order in significant)
    changes = {order: unsteadiness(fit, order) for order in significant if broken and order.denominator == 1}
    lines = []
    for order in sorted(orders):
        frequency = float(order) * drive.frequency
        if order not in tried:
            if frequency < 0.5 * part.rate:
                lines.append(_unresolved(order, orders, fit))
            continue
        verdict, reason = judge(
            Evidence(
                order=order,
                frequency=frequency,
                amplitude=amplitudes[order],
                fundamental=amplitudes[FUNDAMENTAL].value,
                unit="" if channel.unit == "1" else channel.unit,
                adjusted=adjusted[order],
                significant=order in significant,
                is_input=channel.kind == "displacement" and channel.at == 0.0,
                leakage_floor=_leakage_floor(fit, order, amplitudes, changes),
                nearby_peak=fit.noise.nearby_peak(frequency),
                local_p_value=local_p_value(fit, order, amplitudes[order]),
                length=blocks.length,
                rate=part.rate,
                alias=_alias(fit, order, amplitudes[order], part.rate) if order in tracked else None,
                tracking=tracked.get(order),
                source=sources.get(order),
                section=stroboscopic_section(blocks, drive.frequency)
                if order == Fraction(1, 2) and order in significant
                else None,
                expectation=expectation,
            )
        )
        lines.append(_line(order, frequency, amplitudes[order], verdict, reason))
    used = int(np.count_nonzero(part.usable))
    return ChannelLines(channel.name, channel.unit, window, tuple(lines), used, part.time.size - used)


def holm(p_values: Mapping[Fraction, float]) -> dict[Fraction, float]:
    """Return p-values adjusted for the number of orders tried, by Holm's step-down rule."""
    adjusted: dict[Fraction, float] = {}
    largest = 0.0
    for rank, order in enumerate(sorted(p_values, key=lambda order: p_values[order])):
        largest = max(largest, min(1.0, (len(p_values) - rank) * p_values[order]))
        adjusted[order] = largest
    return adjusted


def _tracked(
    fit: OrderFit, significant: set[Fraction], drive: DriveFit, expectation: Expectation
) -> dict[Fraction, Tracking]:
    """Follow the significant lines that may be free: broken orders, and those at a natural frequency."""
    naturals = [natural.frequency for natural in expectation.natural_frequencies]

    def questionable(order: Fraction) -> bool:
        if order.denominator != 1:
            return True
        own = float(order) * drive.frequency
        near = any(abs(natural - own) * fit.blocks.length < NATURAL_RESOLUTION for natural in naturals)
        return order != FUNDAMENTAL and near

    return {
        order: track(fit, order, drive.standard_error) for order in sorted(significant) if questionable(order)
    }


def _sources(
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


def _leakage_floor(
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


def _alias(fit: OrderFit, order: Fraction, amplitude: Amplitude, rate: float) -> Fraction | None:
    """Return the order above half the sampling rate that folds onto this one, if the series has such orders.

    It has where the orders fitted as companions, next below what the rate carries, are clearly larger than
    the line.
    """
    own = float(order) * fit.drive
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
            folding = numerator * fit.drive / denominator
            folded = abs(folding - rate * round(folding / rate))
            if abs(folded - own) * fit.blocks.length < RESOLUTION:
                return Fraction(numerator, denominator)
    return None


def _line(order: Fraction, frequency: float, amplitude: Amplitude, verdict: LineVerdict, reason: str) -> Line:
    return Line(
        str(order),
        frequency,
        amplitude.value,
        amplitude.phase,
        amplitude.interval,
        amplitude.standard_error,
        amplitude.p_value,
        verdict,
        reason,
    )


def _unresolved(order: Fraction, orders: Sequence[Fraction], fit: OrderFit) -> Line:
    """Return the line of an order that this record cannot tell from zero or from another order."""
    needed = length_to_resolve(order, orders, fit.drive)
    largest = float(np.sqrt(2.0) * np.std(fit.blocks.values[fit.blocks.weights > 0.0]))
    return Line(
        str(order),
        float(order) * fit.drive,
        0.0,
        0.0,
        (0.0, largest),
        largest,
        1.0,
        LineVerdict.NOT_RESOLVABLE,
        f"{fit.blocks.length:.4g} s cannot tell this order from its neighbours or from drift; {needed:.1f} s "
        f"would (T |df| >= {RESOLUTION:g})",
    )
