"""Every clock on the reference: which signals are compared, and what that says."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from tethertest.conditioning.alignment import Line, Pair, fitted_line
from tethertest.conditioning.correlation import SEARCH, Coarse, IntegerArray, best_offset
from tethertest.conditioning.guide import Guide
from tethertest.conditioning.signals import (
    expected_pair,
    strain_pair,
)
from tethertest.conditioning.taps import tap_spans
from tethertest.records.arrays import FloatArray
from tethertest.records.channel import Channel, ClockFit, Finding
from tethertest.records.run import Run
from tethertest.signal.windows import Span, find_rest

#: the record is cut into spans of this length, each of which gives its own delay [s]
SPAN = 8.0
#: timing error that strain and tension may share: the wave needs 7 ms along the cable, and interpolation
#: between its ends leaves a hundredth of that [s]
STRAIN_SYSTEMATIC = 1e-4
#: timing error of the expected tension in one tap: the rig's natural frequency is known to half a per cent
#: [s]
EXPECTED_SYSTEMATIC = 3e-4
#: timing error of all taps alike where the rig does not say how well it knows the cable's damping time: the
#: damper's part leads the tension by just that time [s]
UNKNOWN_DAMPING = 5e-4
#: a span that disagrees with the straight line by more than this shows a clock that jumped [s]
BREAK = 5e-3
#: below this explained fraction of the signal the two instruments did not see the same thing
EXPLAINED = 0.3
#: drift above the believable one by this many standard errors is a finding
DRIFT_SIGMAS = 3.0
#: standard error of an offset set by hand without one: what an eye reads off two records [s]
HAND_ERROR = 0.01
#: believable drift of a clock that the rig does not list [1]
DEFAULT_DRIFT = 1e-4


@dataclass(frozen=True, slots=True, eq=False)
class Comparable:
    """A clock's signal beside the reference's, and where to compare."""

    pair: Pair
    spans: tuple[Span, ...]
    systematic: float  #: timing error that a span has by itself [s]
    common: float  #: timing error that all spans share [s]
    method: str
    remarks: tuple[str, ...] = ()


def fitted_clock(
    clock: str, channels: Sequence[Channel], reference: Sequence[Channel], run: Run, guide: Guide
) -> tuple[ClockFit, tuple[Finding, ...]]:
    """Fit one clock against the reference.

    Parameters
    ----------
    clock : str
        Name of the clock.
    channels, reference : sequence of Channel
        Channels on that clock and on the reference clock; wavelengths and tensions not tared yet.
    run : Run
        For the cable, believable drifts and offsets set by hand.
    guide : Guide
        For the expected tension.

    Returns
    -------
    tuple
        The fit and its findings: "fatal" where the clock cannot be placed.
    """
    believable = next((item.clock_drift for item in run.rig.instrument if item.name == clock), DEFAULT_DRIFT)
    by_hand = run.file.override.clock_offset.get(clock)
    if by_hand is not None:
        error = HAND_ERROR if by_hand.error is None else by_hand.error
        doubt = f"+/- {1e3 * error:.3g} ms{', assumed' if by_hand.error is None else ''}"
        text = f"offset {by_hand.value:+.4f} s ({doubt}) set by hand: {by_hand.reason}"
        fit = ClockFit(
            clock, guide.reference_clock, by_hand.value, error, 0.0, believable / np.sqrt(3.0), text
        )
        return fit, (Finding(clock, "clock_override", text, "note"),)
    comparable = _comparable(channels, reference, run, guide)
    if isinstance(comparable, str):
        return _unplaced(clock, guide, believable, comparable, 0.0)
    pair, spans = comparable.pair, comparable.spans
    group = _span_numbers(pair.time, spans)
    use = pair.usable & (group >= 0)
    coarse = best_offset(pair.reference_time, pair.reference, pair.time, pair.values, use, group)
    if coarse is None or coarse.explained < EXPLAINED:
        share = "nothing" if coarse is None else f"{100.0 * coarse.explained:.0f} %"
        text = f"the best offset explains {share} of the signal: {comparable.method}"
        return _unplaced(clock, guide, believable, text, 0.0)
    line = fitted_line(pair, spans, coarse.offset, believable, comparable.systematic)
    if line is None:
        text = f"no span of the record carries a delay: {comparable.method}"
        return _unplaced(clock, guide, believable, text, coarse.offset)
    fit = ClockFit(
        clock,
        guide.reference_clock,
        line.offset,
        float(np.hypot(line.offset_error, comparable.common)),
        line.drift,
        line.drift_error,
        comparable.method,
        (*comparable.remarks, f"{len(line.delays)} spans, {100.0 * coarse.explained:.1f} % explained"),
    )
    return fit, _judged(clock, coarse, line, believable)


def identity(clock: str) -> ClockFit:
    """Return the fit of the reference clock against itself."""
    return ClockFit(clock, clock, 0.0, 0.0, 0.0, 0.0, "reference")


def _comparable(
    channels: Sequence[Channel], reference: Sequence[Channel], run: Run, guide: Guide
) -> Comparable | str:
    """Return what can be compared, or why nothing can."""
    heave = next((channel for channel in channels if channel.kind == "displacement"), None)
    gratings = [channel for channel in channels if channel.kind == "wavelength" and channel.at is not None]
    tensions = [channel for channel in reference if channel.kind == "tension"]
    if not tensions:
        return f"the reference clock {guide.reference_clock!r} has no tension to compare with"
    if gratings:
        pair = strain_pair(gratings, tensions, run.rig, guide.mains)
        if isinstance(pair, str):
            return pair
        return Comparable(
            pair, _cut(pair.time), STRAIN_SYSTEMATIC, 0.0, "strain of the gratings against tension"
        )
    if heave is None:
        return "the clock has neither gratings nor a bottom displacement"
    bottom = next((channel for channel in tensions if channel.at == 0.0), None)
    if guide.expected_tension is None or bottom is None:
        return "the bottom displacement needs a bottom tension and the tension the cable would answer with"
    damping = run.rig.uncertainty.get("cable.axial_damping_time", UNKNOWN_DAMPING)
    rest = find_rest(heave)
    taps = tap_spans(heave, rest)
    start = heave if rest.before is None else heave.between(*rest.before)
    expected = guide.expected_tension(heave.with_values(heave.values - np.nanmedian(start.values)))
    if taps:
        pair = expected_pair(expected, heave, bottom, guide.mains, transients=True)
        method = f"tension expected from the bottom's motion against bottom tension, {len(taps)} taps at rest"
        return Comparable(pair, taps, EXPECTED_SYSTEMATIC, damping, method)
    pair = expected_pair(expected, heave, bottom, guide.mains, transients=False)
    method = "tension expected from the bottom's motion against bottom tension, start to stop"
    remark = "no marker tap: the drive's own phase enters, so the phases compared are not independent"
    return Comparable(pair, _cut(pair.time), EXPECTED_SYSTEMATIC, damping, method, (remark,))


def _cut(time: FloatArray) -> tuple[Span, ...]:
    count = max(round((time[-1] - time[0]) / SPAN), 2)
    edges = np.linspace(time[0], time[-1], count + 1)
    return tuple((float(start), float(stop)) for start, stop in pairwise(edges))


def _span_numbers(time: FloatArray, spans: tuple[Span, ...]) -> IntegerArray:
    """Return the number of the span that each time lies in, -1 for none."""
    number = np.full(time.size, -1, dtype=np.int64)
    for index, (start, stop) in enumerate(spans):
        number[(time >= start) & (time <= stop)] = index
    return number


def _unplaced(
    clock: str, guide: Guide, believable: float, text: str, offset: float
) -> tuple[ClockFit, tuple[Finding, ...]]:
    fit = ClockFit(
        clock,
        guide.reference_clock,
        offset,
        SEARCH / np.sqrt(3.0),
        0.0,
        believable / np.sqrt(3.0),
        "not aligned: taken by its own stamps",
        (text,),
    )
    return fit, (Finding(clock, "clock_not_aligned", f"{text}; {_remedy(clock)}", "fatal"),)


def _remedy(clock: str) -> str:
    return (
        f"look for a wrong unit, sign, sensor or platform mode; else set [override.clock_offset] {clock}, "
        "or knock on the base at rest before and after the next run"
    )


def _judged(clock: str, coarse: Coarse, line: Line, believable: float) -> tuple[Finding, ...]:
    found: list[Finding] = []
    if coarse.rivals:
        others = ", ".join(f"{item:+.3f} s" for item in coarse.rivals[:3])
        fits = f"offset {line.offset:+.3f} s fits no better than {others}"
        text = f"{fits}: no tap or transient chooses the cycle; {_remedy(clock)}"
        found.append(Finding(clock, "clock_ambiguous", text, "fatal"))
    if line.worst > BREAK:
        where = max(line.delays, key=lambda item: abs(item.delay))
        text = f"the clock does not run straight: {1e3 * where.delay:+.3g} ms off near {where.time:.1f} s"
        found.append(Finding(clock, "clock_inconsistent", text, "fatal"))
    if abs(line.drift) > believable + DRIFT_SIGMAS * line.drift_error:
        limit = f"{1e6 * believable:.0f} ppm"
        text = f"drift {1e6 * line.drift:+.0f} ppm, more than the {limit} that its instrument may have"
        found.append(Finding(clock, "clock_drift", text, "fatal"))
    return tuple(found)
