"""The metrics of one channel, each a function from a `Subject` to `Metric`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from operator import attrgetter
from typing import Final

import numpy as np

from tethertest.compare.alignment import Pair
from tethertest.compare.orders import order_error, phasors, wrapped
from tethertest.compare.sprague_geers import SpragueGeers, sprague_geers
from tethertest.compare.subject import Subject, undecided
from tethertest.errors import DataError
from tethertest.records.comparison import Metric, Verdict
from tethertest.records.lines import Line, LineVerdict
from tethertest.spectra import find_events, slack_intervals

#: orders compared even where no limit asks for them
ORDERS: Final = ("1", "2", "3")
PHASE_ORDERS: Final = ("1",)
#: relative uncertainty of the noise variance that is taken off the measured energy: noise is not quite white
NOISE_UNCERTAINTY: Final = 0.2
#: an order of the replay below this many standard errors of the measured one is absent on both sides
ABSENT: Final = 0.1


def peak_metric(subject: Subject) -> Metric:
    """Compare the largest tension in the window, as means over 20 ms."""
    pair = subject.pair
    ratio = pair.replayed_peak / pair.measured_peak
    data = ratio * float(np.hypot(subject.measured.uncertainty, pair.peak_noise / pair.measured_peak))
    uncertainty = subject.over_pairs(data, lambda moved: moved.replayed_peak / pair.measured_peak)
    return subject.metric(
        "peak_tension",
        subject.measured.unit,
        pair.measured_peak,
        pair.replayed_peak,
        ratio - 1.0,
        uncertainty,
        subject.limits.peak_tension,
        "largest mean over 20 ms",
    )


def sprague_geers_metrics(subject: Subject) -> list[Metric]:
    """Compare the whole course of the signal: combined error with a limit, its two parts for information."""
    note = _treatment(subject)
    limit = subject.limits.sprague_geers
    try:
        found = _sprague_geers(subject, subject.pair)
        plain = _sprague_geers(subject, subject.pair, 1.0 + NOISE_UNCERTAINTY)
        moved = [_sprague_geers(subject, pair) for pair in subject.moved_pairs]
        members = [_sprague_geers(subject, pair) for pair in subject.member_pairs]
    except DataError as error:
        reason = f"{error.problem}; {note}"
        name = subject.measured.name
        return [undecided("sprague_geers", name, "1", limit if subject.limited else None, reason)]
    data = float(
        np.linalg.norm(
            [
                plain.combined - found.combined,
                subject.measured.uncertainty
                * (1.0 + found.magnitude)
                * _share(found.magnitude, found.combined),
                # a time shift moves the phase of order 1 by 2 pi f dt, and P by that over pi
                2.0 * subject.drive * subject.clock_error * _share(found.phase, found.combined),
            ]
        )
    )
    combined = subject.budget(
        data, found.combined, [item.combined for item in moved], [item.combined for item in members]
    )
    metrics = [
        subject.metric("sprague_geers", "1", None, None, found.combined, combined, limit, note),
    ]
    for name, part_of in (
        ("sprague_geers_magnitude", attrgetter("magnitude")),
        ("sprague_geers_phase", attrgetter("phase")),
    ):
        value = part_of(found)
        part = subject.budget(
            data, value, [part_of(item) for item in moved], [part_of(item) for item in members]
        )
        metrics.append(subject.metric(name, "1", None, None, value, part, None))
    return metrics


def order_metrics(subject: Subject) -> list[Metric]:
    """Compare amplitude and phase of the orders of the drive."""
    amplitudes = sorted({*ORDERS, *subject.limits.order_amplitude}, key=Fraction)
    phases = sorted({*PHASE_ORDERS, *subject.limits.order_phase}, key=Fraction)
    wanted = sorted({*amplitudes, *phases}, key=Fraction)
    frequencies = [float(Fraction(order)) * subject.drive for order in wanted]
    sides = ((subject.replayed, *subject.moved), subject.members)
    fits = [[phasors(channel, subject.window, frequencies) for channel in side] for side in sides]
    metrics = []
    for order, frequency in zip(wanted, frequencies, strict=True):
        measured, replayed = _lines_of(subject, order)
        if measured is None or replayed is None:
            metrics += _missing_order(subject, order, order in amplitudes, order in phases)
            continue
        found = _Order(order, measured, replayed, *([fit[frequency] for fit in side] for side in fits))
        if order in amplitudes:
            metrics.append(_amplitude_metric(subject, found))
        if order in phases:
            metrics.append(_phase_metric(subject, found))
    return metrics


def slack_metrics(subject: Subject, zero_uncertainty: float) -> list[Metric]:
    """Compare how much of the window is slack, and how far the slack intervals coincide; for information."""
    window, name = subject.window, subject.measured.name
    sides = []
    for channel in (subject.measured, subject.replayed):
        intervals = slack_intervals(find_events(channel, zero_uncertainty), name)
        clipped = [(max(start, window.start), min(stop, window.stop)) for start, stop in intervals]
        sides.append([(start, stop) for start, stop in clipped if stop > start])
    measured, replayed = (sum(stop - start for start, stop in side) for side in sides)
    common = sum(max(0.0, min(a[1], b[1]) - max(a[0], b[0])) for a in sides[0] for b in sides[1])
    union = measured + replayed - common
    shares = measured / window.length, replayed / window.length
    if union <= 0.0:
        reason = "no slack on either side"
        return [
            Metric("slack_fraction", name, "1", *shares, 0.0, 0.0, None, Verdict.INFORMATIVE, reason),
        ]
    note = f"slack measured {shares[0]:.2%}, replayed {shares[1]:.2%} of the window"
    overlap = common / union
    missed = f"{overlap:.1%} of the time slack on either side is slack on both"
    return [
        Metric(
            "slack_fraction", name, "1", *shares, shares[1] - shares[0], 0.0, None, Verdict.INFORMATIVE, note
        ),
        Metric("slack_overlap", name, "1", None, None, overlap - 1.0, 0.0, None, Verdict.INFORMATIVE, missed),
    ]


def _share(part: float, whole: float) -> float:
    return abs(part) / whole if whole > 0.0 else 1.0


def _sprague_geers(subject: Subject, pair: Pair, noise_factor: float = 1.0) -> SpragueGeers:
    if subject.static is None:
        shift = float(pair.measured[pair.usable].mean()), float(pair.replayed[pair.usable].mean())
    else:
        shift = subject.static, subject.static
    return sprague_geers(
        pair.time,
        pair.measured - shift[0],
        pair.replayed - shift[1],
        pair.usable,
        noise_factor * pair.noise**2,
    )


def _treatment(subject: Subject) -> str:
    if subject.static is None:
        removed = "mean of each side removed"
    else:
        removed = f"static {subject.static:.4g} {subject.measured.unit} removed from both"
    return f"{removed}, both low-passed at {subject.pair.cutoff:g} Hz, noise energy taken off the measured"


def _lines_of(subject: Subject, order: str) -> tuple[Line | None, Line | None]:
    measured = None if subject.measured_lines is None else subject.measured_lines.line(order)
    replayed = None if subject.replayed_lines is None else subject.replayed_lines.line(order)
    unresolved = LineVerdict.NOT_RESOLVABLE
    if measured is not None and measured.verdict is unresolved and measured.amplitude == 0.0:
        measured = None
    return measured, replayed


def _missing_order(subject: Subject, order: str, amplitude: bool, phase: bool) -> list[Metric]:
    reason = f"order {order} was not fitted on both sides"
    name, limits = subject.measured.name, subject.limits
    missing = []
    if amplitude:
        limit = limits.order_amplitude.get(order) if subject.limited else None
        missing.append(undecided(f"order_amplitude {order}", name, subject.measured.unit, limit, reason))
    if phase:
        limit = limits.order_phase.get(order) if subject.limited else None
        missing.append(undecided(f"order_phase {order}", name, "rad", limit, reason))
    return missing


@dataclass(frozen=True, slots=True)
class _Order:
    """One order of the drive on both sides, and ``A exp(i phase)`` of all replays."""

    order: str
    measured: Line
    replayed: Line
    replays: Sequence[complex]  #: the run's own, then `Subject.moved`
    members: Sequence[complex]  #: `Subject.members`


def _amplitude_metric(subject: Subject, found: _Order) -> Metric:
    order, measured, replayed = found.order, found.measured, found.replayed
    name, unit = f"order_amplitude {order}", subject.measured.unit
    limit = subject.limits.order_amplitude.get(order)
    if measured.verdict is LineVerdict.NONE and replayed.amplitude <= measured.interval[1]:
        reason = (
            f"order {order} is not significant in the measurement (below {measured.interval[1]:.2g}), and "
            f"the replay's {replayed.amplitude:.2g} agrees with that; a relative error has no meaning"
        )
        if limit is not None and replayed.amplitude < ABSENT * measured.standard_error:
            limit = None
            reason += ": on neither side is there anything to limit"
        elif limit is not None:
            reason += f": its limit of {100.0 * limit:.2g} % cannot be judged, take a longer record"
        return Metric(
            name,
            subject.measured.name,
            unit,
            measured.amplitude,
            replayed.amplitude,
            0.0,
            0.0,
            limit,
            Verdict.INFORMATIVE if limit is None else Verdict.UNDECIDED,
            reason,
        )
    # an amplitude de-biased to nothing is held against its standard error
    base = max(measured.amplitude, measured.standard_error)
    ratio = replayed.amplitude / base
    data = ratio * float(np.hypot(measured.standard_error / base, subject.measured.uncertainty))
    own, *moved = (abs(value) / base for value in found.replays)
    data = float(np.hypot(data, replayed.standard_error / base))
    uncertainty = subject.budget(data, own, moved, [abs(value) / base for value in found.members])
    return subject.metric(name, unit, measured.amplitude, replayed.amplitude, ratio - 1.0, uncertainty, limit)


def _phase_metric(subject: Subject, found: _Order) -> Metric:
    order, measured, replayed = found.order, found.measured, found.replayed
    error = order_error(measured, replayed)
    clock = 2.0 * np.pi * measured.frequency * subject.clock_error
    zero = float(np.angle(found.replays[0]))
    (own, *moved), members = (
        [wrapped(float(np.angle(value)) - zero) for value in side] for side in (found.replays, found.members)
    )
    data = float(np.hypot(min(error.phase_uncertainty, np.pi), clock))
    uncertainty = subject.budget(data, own, moved, members)
    limit = subject.limits.order_phase.get(order)
    return subject.metric(
        f"order_phase {order}", "rad", measured.phase, replayed.phase, error.phase, uncertainty, limit
    )
