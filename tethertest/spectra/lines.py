"""The lines of one channel at orders of the drive, each with amplitude, interval and verdict."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Final

import numpy as np

from tethertest.errors import DataError
from tethertest.records.channel import Channel, Flag, Window
from tethertest.records.lines import ChannelLines, DriveFit, Expectation, Line, LineVerdict, OrderTrack
from tethertest.spectra.crank_angle import SMALLEST_WANDER, CrankAngle, crank_angle
from tethertest.spectra.free_lines import fit_orders_and_free_lines
from tethertest.spectra.holm import holm, holm_chances
from tethertest.spectra.leaks import folded_order, free_sources, leakage_floor
from tethertest.spectra.order_demodulation import SEGMENTS, demodulate
from tethertest.spectra.order_track import phase_wander, track_order
from tethertest.spectra.orders import COMPANIONS, ORDERS, RESOLUTION, length_to_resolve
from tethertest.spectra.regression import (
    Amplitude,
    OrderFit,
    channel_blocks,
    local_p_value,
    order_amplitudes,
)
from tethertest.spectra.side_lines import swings_phase
from tethertest.spectra.stroboscopic_section import stroboscopic_section
from tethertest.spectra.tracking import Tracking, track, unsteadiness
from tethertest.spectra.verdicts import NATURAL_RESOLUTION, Evidence, judge, length_needed

#: chance of one false line in a channel, over all orders tried (Holm)
SIGNIFICANCE: Final = 0.01
#: lines below this share of the strongest one are rounding and interpolation, however clean the record
SMALLEST_RATIO: Final = 1e-5
#: a channel's own wander is followed if that leaves less than this share of what was left
OWN_GAIN: Final = 0.9
#: share of a wander, followed by means over one or two cycles, that may be faster than these and stay
UNFOLLOWED: Final = 0.3
FUNDAMENTAL: Final = Fraction(1)


def find_lines(
    channel: Channel,
    window: Window,
    drive: DriveFit,
    expectation: Expectation,
    orders: Sequence[Fraction] = ORDERS,
    significance: float = SIGNIFICANCE,
    crank: CrankAngle | None = None,
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
    crank : CrankAngle, optional
        The drive's angle from a measured motion. Where its speed varies, orders are those of the crank's
        angle; without it a channel whose own order 1 wanders is put on the clock of that.

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

    def search_on(pace: CrankAngle | None) -> _Search:
        if pace is None:
            return _search(channel, window, drive, expectation, orders, significance)
        turned = Window(min(window.start, pace.turned[0]), max(window.stop, pace.turned[-1]), window.reason)
        steadied = pace.steadied(channel)
        return _search(steadied, turned, drive, expectation, orders, significance, origin=window.start)

    search = search_on(crank if crank is not None and crank.varies else None)
    measured = crank is not None
    if crank is None and FUNDAMENTAL in search.significant:
        wanders = phase_wander(_phases(search, window)) >= SMALLEST_WANDER
        own = crank_angle(channel, window, drive) if wanders else None
        if own is not None and own.varies:
            followed = search_on(own)
            # a free line beats with order 1 and feigns wander, but following it explains nothing
            if followed.left < OWN_GAIN * search.left:
                crank, search = own, followed
    varies = crank is not None and crank.varies
    wander = UNFOLLOWED * crank.wander if crank is not None and varies else 0.0
    part = channel.between(window.start, window.stop)
    lines = _lines(
        search,
        part,
        drive,
        orders,
        expectation,
        wander,
        followed=measured and not varies,
        local_always=varies,
    )
    used = int(np.count_nonzero(part.usable))
    variation = crank.speed_variation if crank is not None and varies else 0.0
    return ChannelLines(channel.name, channel.unit, window, lines, used, part.time.size - used, variation)


@dataclass(frozen=True, slots=True, eq=False)
class _Search:
    """The orders of one channel, fitted and tested."""

    fit: OrderFit
    amplitudes: dict[Fraction, Amplitude]
    adjusted: dict[Fraction, float]  #: p-values after Holm's correction
    significant: set[Fraction]
    level: float  #: chance of any false line
    thresholds: dict[Fraction, float]  #: raw amplitude from which an order is significant

    @property
    def left(self) -> float:
        """Mean square of what the fit leaves."""
        weights, residuals = self.fit.sinusoids.weights, self.fit.sinusoids.residuals
        return float(weights @ residuals**2 / weights.sum())


def _search(
    channel: Channel,
    window: Window,
    drive: DriveFit,
    expectation: Expectation,
    orders: Sequence[Fraction],
    significance: float,
    origin: float | None = None,
) -> _Search:
    blocks = channel_blocks(channel, window, drive.frequency, expectation.mains)
    start = window.start if origin is None else origin
    white = 2.0 * channel.noise**2 / channel.rate
    fit = fit_orders_and_free_lines(blocks, drive.frequency, (*orders, *COMPANIONS), start, white)
    tried = tuple(order for order in orders if order in fit.orders)
    if FUNDAMENTAL not in tried:
        message = f"channel {channel.name!r}: order 1 is not among the orders tried"
        raise DataError(message, "ask for order 1, or choose a longer window")
    amplitudes = {
        order: amplitude.calibrated(channel.uncertainty)
        for order, amplitude in order_amplitudes(fit, tried).items()
    }
    chances = {order: amplitude.p_value for order, amplitude in amplitudes.items()}
    adjusted = holm(chances)
    smallest = SMALLEST_RATIO * max(amplitude.value for amplitude in amplitudes.values())
    significant = {
        order for order in tried if adjusted[order] <= significance and amplitudes[order].value > smallest
    }
    thresholds = {
        order: max(smallest, amplitudes[order].significant_at(chance))
        for order, chance in holm_chances(chances, significance).items()
    }
    return _Search(fit, amplitudes, adjusted, significant, significance, thresholds)


def _phases(search: _Search, window: Window) -> OrderTrack:
    """Return the course of order 1, cycle by cycle."""
    fit = search.fit
    variance = float(fit.noise.density(fit.drive)[0]) * fit.blocks.rate / 2.0
    return track_order(demodulate(fit, FUNDAMENTAL), variance, window.start, cycles=1.0, most=SEGMENTS // 2)


def _lines(
    search: _Search,
    part: Channel,
    drive: DriveFit,
    orders: Sequence[Fraction],
    expectation: Expectation,
    wander: float,
    *,
    followed: bool,
    local_always: bool,
) -> tuple[Line, ...]:
    fit, amplitudes, significant = search.fit, search.amplitudes, search.significant
    tracked = _tracked(fit, significant, drive, expectation)
    sources = free_sources(fit, amplitudes, significant, tracked, search.level)
    broken = any(order.denominator != 1 for order in significant)
    changes = {order: unsteadiness(fit, order) for order in significant if broken and order.denominator == 1}
    saturated = int(np.count_nonzero(part.flags & np.uint16(Flag.SATURATED)))
    lines = []
    for order in sorted(orders):
        frequency = float(order) * drive.frequency
        if order not in amplitudes:
            if frequency < 0.5 * part.rate:
                lines.append(_unresolved(order, orders, fit))
            continue
        half = order == Fraction(1, 2) and order in significant
        evidence = Evidence(
            order=order,
            frequency=frequency,
            amplitude=amplitudes[order],
            fundamental=amplitudes[FUNDAMENTAL].value,
            unit="" if part.unit == "1" else part.unit,
            adjusted=search.adjusted[order],
            significant=order in significant,
            is_input=part.kind == "displacement" and part.at == 0.0,
            leakage_floor=leakage_floor(fit, order, amplitudes, changes),
            nearby_peak=fit.noise.nearby_peak(frequency),
            local_p_value=local_p_value(fit, order, amplitudes[order], always=local_always),
            length=fit.blocks.length,
            rate=part.rate,
            alias=folded_order(fit, order, amplitudes[order], part.rate) if order in tracked else None,
            tracking=tracked.get(order),
            source=sources.get(order),
            section=stroboscopic_section(fit.blocks, drive.frequency) if half else None,
            saturated=saturated,
            wander=wander,
            side_line=not followed and order in tracked and swings_phase(fit, order),
            expectation=expectation,
        )
        verdict, reason = judge(evidence)
        needed = length_needed(evidence) if verdict is LineVerdict.NOT_RESOLVABLE else None
        lines.append(_line(evidence, verdict, reason, needed, search.thresholds[order]))
    return tuple(lines)


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


def _line(
    evidence: Evidence, verdict: LineVerdict, reason: str, needed: float | None, threshold: float
) -> Line:
    amplitude = evidence.amplitude
    return Line(
        str(evidence.order),
        evidence.frequency,
        amplitude.value,
        amplitude.phase,
        amplitude.interval,
        amplitude.standard_error,
        amplitude.p_value,
        verdict,
        reason,
        None if evidence.tracking is None else evidence.tracking.track,
        needed,
        threshold if np.isfinite(threshold) else None,
        amplitude.calibration_error,
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
        length_needed=needed,
    )
