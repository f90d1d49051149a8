"""What a line is, and why: the rules, from what is known about it to a verdict with a reason."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Final

from tethertest.records.lines import Expectation, LineVerdict
from tethertest.records.response import NaturalFrequency
from tethertest.spectra.inputs import explain_by_input
from tethertest.spectra.leaks import LIKELY_ORDER
from tethertest.spectra.regression import Amplitude, stands_out
from tethertest.spectra.stroboscopic_section import Section
from tethertest.spectra.tracking import GATE, LOOSE_CYCLES, Tracking

#: a line and a natural frequency are told apart from T |df| = 2 on
NATURAL_RESOLUTION: Final = 2.0
#: a line must stand out of the residual next to it at this chance: about Holm's level for the weakest of ten
LEAKAGE_CHANCE: Final = 0.002
#: no record of any length tells frequencies apart that differ by less than this share
SAME: Final = 1e-6
#: a drive this near, relative, to twice a natural frequency can excite it parametrically: tongues of the
#: Mathieu equation are about as wide as the relative change of stiffness, and a taut cable's tension changes
#: by a tenth
PARAMETRIC_REACH: Final = 0.1
#: multiples of the mains frequency that a logger picks up
MAINS_MULTIPLES: Final = (1, 2, 3)
#: amplitude at which a record that long sees a locked line nine times in ten, in standard errors
DETECTABLE: Final = 5.5

Judged = tuple[LineVerdict, str]


@dataclass(frozen=True, slots=True)
class Evidence:
    """All that is known about one order of one channel."""

    order: Fraction
    frequency: float  #: [Hz]
    amplitude: Amplitude
    fundamental: float  #: amplitude of order 1
    unit: str
    adjusted: float  #: p-value after Holm's correction
    significant: bool
    alias: Fraction | None  #: order above half the sampling rate that folds onto this one
    is_input: bool  #: the channel is the bottom motion itself
    leakage_floor: float  #: amplitude that unsteady whole orders leave here
    nearby_peak: float  #: amplitude of the strongest left-over ordinate next to the line
    local_p_value: float  #: against the residual next to the line
    length: float  #: of the record [s]
    rate: float  #: of the channel's samples [Hz]
    tracking: Tracking | None  #: for significant lines that could be something else than the drive's
    source: float | None  #: frequency [Hz] of a free line that explains this one away
    section: Section | None  #: for order 1/2
    saturated: int  #: samples at the amplifier's limit, left out
    wander: float  #: [rad] of the drive's phase that may not have been followed
    side_line: bool  #: a swing of order 1's phase, and no motion says that the drive is steady
    expectation: Expectation


def judge(evidence: Evidence) -> Judged:
    """Return the verdict on one order, with its reason.

    Parameters
    ----------
    evidence : Evidence
        What is known about it.

    Returns
    -------
    LineVerdict, str
        Rules in this order: not significant; largest values lost; the drive itself; mains; brought in by the
        bottom motion;
        harmonics; then for orders that are no whole number the conditions of a subharmonic, the first that
        fails giving the verdict.
    """
    size = _size(evidence)
    if not evidence.significant and not (evidence.order == 1 and evidence.saturated):
        return LineVerdict.NONE, (
            f"not significant (p = {evidence.adjusted:.2g} after Holm); amplitudes from "
            f"{DETECTABLE * evidence.amplitude.standard_error:.2g} {evidence.unit} would show".replace(
                "  ", " "
            )
        )
    if evidence.saturated:
        return LineVerdict.UNDETERMINED, (
            f"{size}, but {evidence.saturated} samples at the amplifier's limit are left out: the largest "
            "values are lost, and neither amplitude nor interval holds; choose a window without them"
        )
    if evidence.order == 1:
        return LineVerdict.HARMONIC, f"the drive itself, {size}"
    if (mains := _mains(evidence)) is not None:
        return LineVerdict.MAINS, mains
    whole = evidence.order.denominator == 1
    if whole and evidence.local_p_value > LEAKAGE_CHANCE:
        return LineVerdict.LEAKAGE, f"{size}: {_local(evidence)}"
    explanation = explain_by_input(
        evidence.order,
        evidence.amplitude.value,
        evidence.amplitude.standard_error,
        evidence.fundamental,
        evidence.expectation,
    )
    if explanation.explained:
        kind = LineVerdict.CRANK_HARMONIC if whole else LineVerdict.INPUT_BORNE
        return kind, f"{size}: {explanation.text}"
    verdict, reason = _whole_order(evidence) if whole else _broken_order(evidence)
    more = f"; {explanation.text}" if explanation.text else ""
    return verdict, f"{size}: {reason}{more}"


def _size(evidence: Evidence) -> str:
    low, high = evidence.amplitude.interval
    text = f"{evidence.amplitude.value:.3g} {evidence.unit} ({low:.3g} to {high:.3g})".replace("  ", " ")
    if evidence.order == 1:
        return text
    return f"{text}, {evidence.amplitude.value / max(evidence.fundamental, 1e-300):.3g} of order 1"


def _mains(evidence: Evidence) -> str | None:
    """Say whether the line stands where the mains or its folded multiples do."""
    for multiple in MAINS_MULTIPLES:
        hum = multiple * evidence.expectation.mains
        folded = abs(hum - evidence.rate * round(hum / evidence.rate))
        if folded > 0.0 and abs(folded - evidence.frequency) * evidence.length < 1.0:
            where = (
                f" folded to {folded:.4g} Hz by sampling at {evidence.rate:.4g} Hz" if folded != hum else ""
            )
            return f"{evidence.frequency:.4g} Hz cannot be told from {hum:g} Hz of the mains{where}"
    return None


def _whole_order(evidence: Evidence) -> Judged:
    near, tracking = _nearest(evidence), evidence.tracking
    if near is not None and tracking is not None:
        beside = f"the natural frequency {near.name!r} ({near.frequency:.4g} Hz) is next to it"
        if tracking.decays:
            return LineVerdict.NATURAL_TRANSIENT, f"decays: {_lost(tracking)}; {beside}"
        return LineVerdict.HARMONIC, f"steady multiple of the drive, {_made(evidence)}; {beside}"
    return LineVerdict.HARMONIC, f"multiple of the drive, {_made(evidence)}"


def _made(evidence: Evidence) -> str:
    """Say whether the crank makes a whole order, as far as that is known."""
    told = evidence.expectation
    if evidence.is_input:
        return "in the bottom motion itself"
    if told.input_lines is not None or str(evidence.order) in told.crank_orders:
        return "not made by the crank"
    return "made by the cable or by the drive: no bottom motion was measured, and no crank is known"


def _broken_order(evidence: Evidence) -> Judged:
    """Go through the conditions of a subharmonic."""
    tracking = evidence.tracking
    if evidence.alias is not None:
        return LineVerdict.ALIAS, (
            f"order {evidence.alias} folds here at {evidence.rate:.4g} Hz sampling, and "
            + (
                "any tension may have it"
                if evidence.alias <= LIKELY_ORDER
                else "the orders below it are strong"
            )
            + "; log faster or filter before logging"
        )
    if evidence.source is not None:
        return LineVerdict.LEAKAGE, f"explained by a line at {evidence.source:.4g} Hz that is not locked"
    if tracking is None:
        return LineVerdict.UNDETERMINED, "its course over the record could not be followed"
    if tracking.decays:
        return LineVerdict.NATURAL_TRANSIENT, f"decays: {_lost(tracking)}"
    near = _nearest(evidence)
    if near is not None:
        return LineVerdict.NOT_RESOLVABLE, _too_short(evidence, near)
    if not tracking.locked:
        return _free(evidence, tracking)
    return _locked_order(evidence, tracking)


def _locked_order(evidence: Evidence, tracking: Tracking) -> Judged:
    """Go through what else than a subharmonic may be locked to the drive."""
    if evidence.local_p_value > LEAKAGE_CHANCE:
        return LineVerdict.LEAKAGE, _local(evidence)
    if not stands_out(evidence.amplitude.value, evidence.nearby_peak):
        return LineVerdict.LEAKAGE, (
            f"one of several of its kind: the residual next to it holds a line of {evidence.nearby_peak:.2g}"
        )
    if tracking.uneven:
        return LineVerdict.UNDETERMINED, (
            "not there all along: the thirds of the record differ (chi-squared "
            f"{tracking.thirds:.2g}); the window may hold a start-up"
        )
    if evidence.amplitude.value < evidence.leakage_floor:
        return LineVerdict.LEAKAGE, (
            f"below the leakage floor {evidence.leakage_floor:.2g} of the whole orders, which are not "
            "quite steady"
        )
    if tracking.drifts:
        return LineVerdict.UNDETERMINED, (
            f"its phase drifts by {tracking.drift:.2g} rad over the record (+/- {tracking.drift_error:.2g})"
        )
    if evidence.amplitude.value < evidence.wander * evidence.fundamental:
        return LineVerdict.UNDETERMINED, (
            "the drive's speed wanders, and what is too quick to be followed may leave side lines of up to "
            f"{evidence.wander:.2g} of order 1"
        )
    if evidence.side_line:
        return LineVerdict.UNDETERMINED, (
            "with its mirror image about order 1 it makes a swing of order 1's phase, as a drive whose speed "
            "swings does; log the crank's motion"
        )
    reason = (
        f"locked to the drive (free frequency {tracking.frequency:.5g} Hz, {abs(tracking.cycles):.2g} cycles "
        f"off over the record, chi-squared gain {max(0.0, tracking.gain):.2g} of {tracking.penalty:.2g}), "
        f"steady, p = {evidence.adjusted:.2g} after Holm"
    )
    if evidence.is_input:
        return LineVerdict.INPUT_BORNE, f"the bottom motion itself has it, {reason}"
    if (natural := _parametric(evidence)) is not None:
        reason += (
            f"; parametric resonance: the drive is near twice the natural frequency {natural.name!r} "
            f"({natural.frequency:.4g} Hz)"
        )
    elif not evidence.expectation.natural_frequencies:
        reach = max(GATE * tracking.frequency_error, LOOSE_CYCLES / evidence.length)
        reason += (
            f"; no natural frequency was stated: one within {reach:.2g} Hz of the line, undamped, would look "
            "the same"
        )
    second = tracking.second_opinion
    reason += f"; multitaper F = {second.f_value:.3g} (p = {second.p_value:.2g})"
    if evidence.section is not None:
        reason += f"; stroboscopic section D1/D2 = {evidence.section.ratio:.3g}"
    if evidence.expectation.input_lines is None:
        reason += (
            "; no bottom motion was measured: a drive that itself moves at this order, as a worn gear or "
            "belt does, would look the same"
        )
        return LineVerdict.SUBHARMONIC, reason
    return LineVerdict.SUBHARMONIC, f"not in the input, {reason}"


def _local(evidence: Evidence) -> str:
    return f"does not stand out of the residual next to it (p = {evidence.local_p_value:.2g})"


def _lost(tracking: Tracking) -> str:
    """Say how much of a decaying line goes; a straight line through a fast decay may lose more than all."""
    if tracking.growth <= -1.0:
        return "all of its amplitude is lost within the record"
    change = f"{-tracking.growth:.0%} +/- {tracking.growth_error:.0%}"
    return f"{change} of its amplitude is lost over the record"


def _nearest(evidence: Evidence) -> NaturalFrequency | None:
    """Return the natural frequency that the record cannot tell from the line, if there is one."""
    naturals = evidence.expectation.natural_frequencies
    if not naturals:
        return None
    nearest = min(naturals, key=lambda natural: abs(natural.frequency - evidence.frequency))
    apart = abs(nearest.frequency - evidence.frequency) * evidence.length
    return nearest if apart < NATURAL_RESOLUTION else None


def length_needed(evidence: Evidence) -> float | None:
    """Return the record length [s] that tells the line from the nearest natural frequency, if any would."""
    near = _nearest(evidence)
    if near is None:
        return None
    apart = abs(near.frequency - evidence.frequency)
    return None if apart < SAME * evidence.frequency else NATURAL_RESOLUTION / apart


def _too_short(evidence: Evidence, near: NaturalFrequency) -> str:
    apart = abs(near.frequency - evidence.frequency)
    where = f"{apart:.3g} Hz from the natural frequency {near.name!r} ({near.frequency:.4g} Hz)"
    needed = length_needed(evidence)
    if needed is None:
        short = f"{where}: no record length tells them apart, change the drive frequency"
    else:
        short = f"{where}: {evidence.length:.3g} s cannot tell them apart, {needed:.0f} s would (T |df| >= 2)"
    if _parametric(evidence) is None:
        return short
    return (
        f"{short}; the drive is near twice this frequency, so that a parametric resonance would look the same"
    )


def _parametric(evidence: Evidence) -> NaturalFrequency | None:
    """Return the natural frequency that the drive is near twice of, for the order 1/2."""
    if evidence.order != Fraction(1, 2):
        return None
    near = [
        natural
        for natural in evidence.expectation.natural_frequencies
        if abs(natural.frequency - evidence.frequency) <= PARAMETRIC_REACH * evidence.frequency
    ]
    return min(near, key=lambda natural: abs(natural.frequency - evidence.frequency), default=None)


def _free(evidence: Evidence, tracking: Tracking) -> Judged:
    """Name a line that does not keep the pace of the drive."""
    reach = max(GATE * tracking.frequency_error, 0.5 / evidence.length)
    found = f"sits at {tracking.frequency:.5g} Hz, not at {evidence.frequency:.5g} Hz"
    for natural in evidence.expectation.natural_frequencies:
        if abs(natural.frequency - tracking.frequency) <= reach:
            where = f"the natural frequency {natural.name!r} ({natural.frequency:.4g} Hz)"
            return LineVerdict.NATURAL_TRANSIENT, f"{found}: {where}"
    return LineVerdict.UNDETERMINED, (
        f"{found} (chi-squared gain {tracking.gain:.2g}), and no natural frequency is known there"
    )
