"""The judged runs as Markdown, each figure beside what is demanded of it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from reports.clock_errors.judge import COVERAGE_95, Judged
from reports.clock_errors.motion import SHARES

#: share of the intervals of 95 % that hold the true value
COVERED = 0.95
#: median error over the bound at most
OVER_BOUND = 2.0
#: share of the runs with a start or a stop that may be refused
REFUSED = 0.05

_KINDS = {"strain": "strain against tension", "motion": "motion against tension"}
_HEAD = """# How far fitted clocks are off

Made by `{command}`: random drives (0.1 Hz to 2 Hz), offsets (to 5 s), drifts (to 100 ppm), rates, noises,
gaps and stamps.

The bound is the Cramer-Rao bound of offset and drift for a known waveform (ramps, phase of the drive and
knocks together) in white noise of both instruments, with gain and level free. Where the rig is off, its
parameters are unknowns too, known as well as the rig file states, and so is the lag of the cable's damper
between strain and tension; the bound of noise alone stands beside it. Offsets are at reference time zero. The
signal to noise is that of the signal's root mean square over both noises' in the band up to 0.4 of the slower
rate. The median error of an efficient estimate is 0.67 of its bound.
"""


@dataclass(frozen=True, slots=True)
class Demand:
    """One demand and what was found."""

    text: str
    wanted: str
    found: str
    met: bool


def demands(runs: Sequence[Judged]) -> tuple[Demand, ...]:
    """Return the demands on all runs of one rig."""
    fitted = [run for run in runs if run.outcome != "refused"]
    ramped = [run for run in runs if run.ramped]
    wrong = sum(run.outcome == "wrong cycle" for run in runs)
    refused = sum(run.outcome == "refused" for run in ramped)
    share = refused / max(len(ramped), 1)
    return (
        _covered("offsets", fitted, lambda run: run.offset_covered),
        _covered("drifts", fitted, lambda run: run.drift_covered),
        _over_bound("offset", _median(fitted, _offset_over_bound)),
        _over_bound("drift", _median(fitted, _drift_over_bound)),
        Demand("wrong cycles accepted", "0", str(wrong), wrong == 0),
        Demand(
            "refused although both records hold a start or a stop",
            f"<= {100.0 * REFUSED:.0f} %",
            f"{refused} of {len(ramped)}, {_percent(share)}",
            share <= REFUSED,
        ),
    )


def _covered(name: str, fitted: Sequence[Judged], holds: Callable[[Judged], bool]) -> Demand:
    """Return the demand on intervals: their share is 95 %, or below it by no more than its own 95 %."""
    share = _share(fitted, holds)
    chance = COVERAGE_95 * np.sqrt(COVERED * (1.0 - COVERED) / max(len(fitted), 1))
    return Demand(
        f"true {name} inside the stated interval of 95 %",
        f">= {100.0 * COVERED:.0f} %, by chance {_percent(COVERED - chance)}",
        f"{_percent(share)} of {len(fitted)}",
        share >= COVERED - chance,
    )


def _over_bound(name: str, found: float) -> Demand:
    return Demand(
        f"median error of the {name} over the bound",
        f"<= {OVER_BOUND:g}",
        f"{found:.2f}",
        found <= OVER_BOUND,
    )


def clock_table(judged: Mapping[str, Sequence[Judged]], command: str) -> str:
    """Return the page.

    Parameters
    ----------
    judged : mapping
        What is known of the rig -> the judged runs.
    command : str
        What makes the page again.
    """
    lines = [_HEAD.format(command=command)]
    for heading, runs in judged.items():
        lines += _section(heading, runs)
    return "\n".join(lines)


def _section(heading: str, runs: Sequence[Judged]) -> list[str]:
    low, middle, high = np.quantile([run.bound.signal_to_noise for run in runs], (0.05, 0.5, 0.95))
    lengths = [run.length for run in runs]
    lines = [
        f"## {heading}",
        "",
        f"{len(runs)} runs of {min(lengths):.0f} s to {max(lengths):.0f} s, median "
        f"{np.median(lengths):.0f} s; signal to noise {middle:.0f} in the median, "
        f"{low:.0f} to {high:.0f} in nine of ten.",
        "",
        "| demand | wanted | found | met |",
        "|---|---|---|---|",
    ]
    lines += [
        f"| {item.text} | {item.wanted} | {item.found} | {'yes' if item.met else 'no'} |"
        for item in demands(runs)
    ]
    lines += [
        "",
        "| compared | record holds | runs | accepted | wrong | offset covered | drift covered | median error "
        "| median bound | error over bound | of noise alone | drift over bound |",
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
    return [*lines, ""]


def _row(name: str, transients: str, part: Sequence[Judged]) -> str:
    fitted = [run for run in part if run.outcome != "refused"]
    wrong = sum(run.outcome == "wrong cycle" for run in part)
    held = "steady drive only" if transients == "none" else transients
    start = f"| {name} | {held} | {len(part)} | {len(fitted)} | {wrong} |"
    if not fitted:
        return f"{start} | | | | | | |"
    error = _median(fitted, lambda run: abs(run.offset_error))
    bound = _median(fitted, lambda run: run.bound.offset_with_rig)
    alone = _median(fitted, lambda run: abs(run.offset_error) / run.bound.offset)
    return (
        f"{start} {_percent(_share(fitted, lambda run: run.offset_covered))} "
        f"| {_percent(_share(fitted, lambda run: run.drift_covered))} "
        f"| {1e3 * error:.3f} ms | {1e3 * bound:.3f} ms | {_median(fitted, _offset_over_bound):.2f} "
        f"| {alone:.2f} | {_median(fitted, _drift_over_bound):.2f} |"
    )


def _offset_over_bound(run: Judged) -> float:
    return abs(run.offset_error) / run.bound.offset_with_rig


def _drift_over_bound(run: Judged) -> float:
    return abs(run.drift_error) / run.bound.drift_with_rig


def _share(runs: Sequence[Judged], holds: Callable[[Judged], bool]) -> float:
    return float(np.mean([holds(run) for run in runs])) if runs else 0.0


def _median(runs: Sequence[Judged], value: Callable[[Judged], float]) -> float:
    return float(np.median([value(run) for run in runs])) if runs else float("inf")


def _percent(share: float) -> str:
    return f"{100.0 * share:.1f} %"
