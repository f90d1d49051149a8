"""Every clock on the reference: offset and drift, or why none can be believed."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from tethertest.conditioning.clocks.alignment import ClockAlignment
from tethertest.conditioning.clocks.alignment_tasks import AlignmentTask, alignment_tasks
from tethertest.conditioning.clocks.band import best_cutoff
from tethertest.conditioning.clocks.clock_linearity import Delay, delays, worst
from tethertest.conditioning.clocks.correlation import SEARCH, scanned
from tethertest.conditioning.clocks.cycle_ambiguity import OffsetCandidate, chosen
from tethertest.conditioning.rig_priors import RigPriors
from tethertest.records.channel import Channel, ClockFit, Finding, Severity
from tethertest.records.run import Run

#: offsets that are fitted beside the best one
MOST = 8
#: an offset that is told no better than this is not told [s]
USELESS = 0.03
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


def fitted_clock(
    clock: str, channels: Sequence[Channel], reference: Sequence[Channel], run: Run, priors: RigPriors
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
    priors : RigPriors
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
            clock, priors.reference_clock, by_hand.value, error, 0.0, believable / np.sqrt(3.0), text
        )
        return fit, (Finding(clock, "clock_override", text, Severity.NOTE),)
    refused: list[tuple[ClockFit, tuple[Finding, ...]]] = []
    for task in alignment_tasks(channels, reference, run, priors):
        fit, findings = _compared(clock, task, priors, believable)
        if not any(item.severity == Severity.FATAL for item in findings):
            return fit, findings
        refused.append((fit, findings))
    return refused[0]


def identity(clock: str) -> ClockFit:
    """Return the fit of the reference clock against itself."""
    return ClockFit(clock, clock, 0.0, 0.0, 0.0, 0.0, "reference")


def _compared(
    clock: str, task: AlignmentTask | str, priors: RigPriors, believable: float
) -> tuple[ClockFit, tuple[Finding, ...]]:
    """Return the fit of one comparison and what is to be said of it."""
    if isinstance(task, str):
        return _unplaced(clock, priors, believable, task, 0.0)
    cutoff = best_cutoff(task.pair, task.drive)
    pair = task.pair.low_passed(cutoff)
    comparison = ClockAlignment(pair, task.spans, task.slowest, cutoff, task.systematic)
    if not pair.clock.usable.any() or not pair.reference.usable.any():
        text = f"no samples are left to compare: {task.method}"
        return _unplaced(clock, priors, believable, text, 0.0)
    scan = scanned(comparison, pair, believable, task.slowest, cutoff)
    prior = believable / np.sqrt(3.0)
    found = chosen(comparison, scan.candidates(MOST), prior, cutoff)
    if found is None or found[0].explained < EXPLAINED:
        share = "nothing" if found is None else f"{100.0 * found[0].explained:.0f} %"
        text = f"the best offset explains {share} of the signal: {task.method}"
        return _unplaced(clock, priors, believable, text, 0.0)
    line, rivals = found
    left = delays(comparison, line)
    error = np.sqrt(np.diag(line.covariance))
    if error[0] > USELESS:
        text = f"the record tells the offset to no better than {1e3 * error[0]:.0f} ms: {task.method}"
        return _unplaced(clock, priors, believable, text, line.offset)
    fit = ClockFit(
        clock,
        priors.reference_clock,
        float(line.offset - task.lag),
        float(np.hypot(error[0], task.lag_error)),
        float(line.drift),
        float(error[1]),
        task.method,
        (
            *task.remarks,
            f"{len(left)} spans, {100.0 * line.explained:.1f} % explained below {cutoff:.3g} Hz",
        ),
    )
    return fit, _judged(clock, fit, rivals, worst(left), believable)


def _unplaced(
    clock: str, priors: RigPriors, believable: float, text: str, offset: float
) -> tuple[ClockFit, tuple[Finding, ...]]:
    fit = ClockFit(
        clock,
        priors.reference_clock,
        offset,
        SEARCH / np.sqrt(3.0),
        0.0,
        believable / np.sqrt(3.0),
        "not aligned: taken by its own stamps",
        (text,),
    )
    return fit, (Finding(clock, "clock_not_aligned", f"{text}; {_remedy(clock)}", Severity.FATAL),)


def _remedy(clock: str) -> str:
    return (
        f"look for a wrong unit, sign, sensor or platform mode; else set [override.clock_offset] {clock}, "
        "or knock on the base at rest before and after the next run"
    )


def _judged(
    clock: str, fit: ClockFit, rivals: Sequence[OffsetCandidate], left: Delay | None, believable: float
) -> tuple[Finding, ...]:
    found: list[Finding] = []
    if abs(fit.offset) > SEARCH:
        text = f"offset {fit.offset:+.3f} s: clocks of one run are believed to differ by {SEARCH:g} s at most"
        found.append(Finding(clock, "clock_ambiguous", f"{text}; {_remedy(clock)}", Severity.FATAL))
    if rivals:
        others = ", ".join(f"{item.offset:+.3f} s" for item in rivals[:3])
        fits = f"offset {fit.offset:+.3f} s fits no better than {others}"
        text = f"{fits}: no tap or transient chooses the cycle; {_remedy(clock)}"
        found.append(Finding(clock, "clock_ambiguous", text, Severity.FATAL))
    if left is not None and abs(left.delay) > BREAK:
        text = f"the clock does not run straight: {1e3 * left.delay:+.3g} ms off near {left.time:.1f} s"
        found.append(Finding(clock, "clock_inconsistent", text, Severity.FATAL))
    if abs(fit.drift) > believable + DRIFT_SIGMAS * fit.drift_error:
        limit = f"{1e6 * believable:.0f} ppm"
        text = f"drift {1e6 * fit.drift:+.0f} ppm, more than the {limit} that its instrument may have"
        found.append(Finding(clock, "clock_drift", text, Severity.FATAL))
    return tuple(found)
