"""The judged runs as Markdown, each figure beside what is demanded of it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from tethertest.studies.clock_errors.judge import Judged
from tethertest.studies.clock_errors.motion import SHARES

#: share of the intervals of 95 % that hold the true value
COVERED = 0.95
#: median error over the bound at most
OVER_BOUND = 2.0
#: share of the runs with a start or a stop that may be refused
REFUSED = 0.05

_KINDS = {"strain": "strain against tension", "motion": "motion against tension"}
_HEAD = """# How far fitted clocks are off

{count} random runs. Made by `python -m tethertest.studies.clock_errors {count} -o reports/clock-errors.md`.
"""
_BOUND = """
The bound is the Cramer-Rao bound of offset and drift for a known waveform (ramps, phase of the drive and
knocks together) in white noise of both instruments, with gain and level free: noise alone, the rig known for
certain. "With the rig" the rig's parameters are unknowns too, known as well as the rig file states, and so is
the lag of the cable's damper between strain and tension. Offsets are at reference time zero. The signal to
noise is that of the signal's root mean square over both noises' in the band up to 0.4 of the slower rate.
"""


@dataclass(frozen=True, slots=True)
class Demand:
    """One demand and what was found."""

    text: str
    wanted: str
    found: str
    met: bool


def demands(runs: Sequence[Judged]) -> tuple[Demand, ...]:
    """Return the demands on all runs."""
    fitted = [run for run in runs if run.outcome != "refused"]
    ramped = [run for run in runs if run.ramped]
    offset = _share(fitted, lambda run: run.offset_covered)
    drift = _share(fitted, lambda run: run.drift_covered)
    alone = _median(fitted, lambda run: abs(run.offset_error) / run.bound.offset)
    alone_drift = _median(fitted, lambda run: abs(run.drift_error) / run.bound.drift)
    rig = _median(fitted, lambda run: abs(run.offset_error) / run.bound.offset_with_rig)
    wrong = sum(run.outcome == "wrong cycle" for run in runs)
    refused = sum(run.outcome == "refused" for run in ramped)
    share = refused / max(len(ramped), 1)
    covered, over = f">= {100.0 * COVERED:.0f} %", f"<= {OVER_BOUND:g}"
    return (
        Demand(
            "true offsets inside the stated interval of 95 %", covered, _percent(offset), offset >= COVERED
        ),
        Demand("true drifts inside the stated interval of 95 %", covered, _percent(drift), drift >= COVERED),
        Demand("median error of the offset over the bound", over, f"{alone:.2f}", alone <= OVER_BOUND),
        Demand("the same over the bound with the rig", over, f"{rig:.2f}", rig <= OVER_BOUND),
        Demand(
            "median error of the drift over the bound", over, f"{alone_drift:.2f}", alone_drift <= OVER_BOUND
        ),
        Demand("wrong cycles accepted", "0", str(wrong), wrong == 0),
        Demand(
            "refused although both records hold a start or a stop",
            f"<= {100.0 * REFUSED:.0f} %",
            f"{refused} of {len(ramped)}, {_percent(share)}",
            share <= REFUSED,
        ),
    )


def clock_table(runs: Sequence[Judged]) -> str:
    """Return the page."""
    lines = [_HEAD.format(count=len(runs)), "| demand | wanted | found | met |", "|---|---|---|---|"]
    lines += [
        f"| {item.text} | {item.wanted} | {item.found} | {'yes' if item.met else 'no'} |"
        for item in demands(runs)
    ]
    low, middle, high = np.quantile([run.bound.signal_to_noise for run in runs], (0.05, 0.5, 0.95))
    lengths = [run.length for run in runs]
    lines += [
        _BOUND,
        f"Records of {min(lengths):.0f} s to {max(lengths):.0f} s, median {np.median(lengths):.0f} s; signal "
        f"to noise {middle:.0f} in the median, {low:.0f} to {high:.0f} in nine of ten.",
        "",
        "| compared | record holds | runs | accepted | wrong | offset covered | drift covered | median error "
        "| median bound | error over bound | with the rig | drift over bound |",
        "|---|---|---|---|---|---|---|---|---|---|---|---|",
    ]
    for kind, name in _KINDS.items():
        for transients in SHARES:
            part = [run for run in runs if run.kind == kind and run.transients == transients]
            if part:
                lines.append(_row(name, transients, part))
    reasons = [run for run in runs if run.outcome == "refused" and run.ramped]
    if reasons:
        lines += [
            "",
            "| refused although it holds a start or a stop | signal to noise | reason |",
            "|---|---|---|",
        ]
        lines += [
            f"| {run.number}, {run.kind}, {run.transients}, {run.frequency:.2g} Hz, {run.length:.0f} s at "
            f"{run.rates[0]:.0f} and {run.rates[1]:.0f} Hz, {run.gaps} gaps "
            f"| {run.bound.signal_to_noise:.0f} | {run.reasons[0].split(';')[0]} |"
            for run in reasons
        ]
    return "\n".join((*lines, ""))


def _row(name: str, transients: str, part: Sequence[Judged]) -> str:
    fitted = [run for run in part if run.outcome != "refused"]
    wrong = sum(run.outcome == "wrong cycle" for run in part)
    held = "steady drive only" if transients == "none" else transients
    start = f"| {name} | {held} | {len(part)} | {len(fitted)} | {wrong} |"
    if not fitted:
        return f"{start} | | | | | | |"
    error = _median(fitted, lambda run: abs(run.offset_error))
    bound = _median(fitted, lambda run: run.bound.offset)
    over = _median(fitted, lambda run: abs(run.offset_error) / run.bound.offset)
    rig = _median(fitted, lambda run: abs(run.offset_error) / run.bound.offset_with_rig)
    drift = _median(fitted, lambda run: abs(run.drift_error) / run.bound.drift)
    return (
        f"{start} {_percent(_share(fitted, lambda run: run.offset_covered))} "
        f"| {_percent(_share(fitted, lambda run: run.drift_covered))} "
        f"| {1e3 * error:.3f} ms | {1e3 * bound:.3f} ms | {over:.2f} | {rig:.2f} | {drift:.2f} |"
    )


def _share(runs: Sequence[Judged], holds: Callable[[Judged], bool]) -> float:
    return float(np.mean([holds(run) for run in runs])) if runs else 0.0


def _median(runs: Sequence[Judged], value: Callable[[Judged], float]) -> float:
    return float(np.median([value(run) for run in runs])) if runs else float("inf")


def _percent(share: float) -> str:
    return f"{100.0 * share:.1f} %"
