"""The demands on the stated error, and the table that shows how they are met."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from reports.error_coverage.judge import Judged, Skipped
from reports.error_coverage.reference import SLACK_TOLERANCE, TAUT_TOLERANCE
from tethertest.records.response import Status


@dataclass(frozen=True, slots=True)
class Demand:
    """One demand, what was found and whether it is met."""

    name: str
    wanted: str
    found: str
    met: bool


def demands(judged: Sequence[Judged], skipped: Sequence[Skipped]) -> tuple[Demand, ...]:
    """Return the demands on a set of judged scenes."""
    covered = float(np.mean([verdict.covered for verdict in judged]))
    ratios = np.array([verdict.ratio for verdict in judged])
    taut = [verdict for verdict in judged if not verdict.slack]
    slack = [verdict for verdict in judged if verdict.slack and verdict.damped]
    losses = [verdict.wall / verdict.cheapest for verdict in judged if np.isfinite(verdict.cheapest)]
    chosen = Counter([v.fidelity for v in judged] + [v.fidelity for v in skipped])
    median, high = float(np.median(ratios)), float(np.quantile(ratios, 0.9))
    loss = float(np.median(losses))
    models = {"catenary", "linear", "nonlinear"}
    return (
        Demand("stated error covers the true one", ">= 95 %", f"{covered:.1%}", covered >= 0.95),
        Demand("stated over true, median", "< 5", f"{median:.2f}", median < 5.0),
        Demand("stated over true, 90th percentile", "< 20", f"{high:.1f}", high < 20.0),
        _kept(f"tolerance of {TAUT_TOLERANCE:.0%} met, taut", taut, 0.9),
        _kept(
            f"tolerance of {SLACK_TOLERANCE:.0%} met by the 20 ms peaks, slack with drag and damping",
            slack,
            0.7,
        ),
        Demand(
            "stated error of the 20 ms peaks covers the true one",
            ">= 95 %",
            f"{sum(verdict.true_peak <= verdict.stated_peak for verdict in slack)} of {len(slack)}",
            sum(verdict.true_peak <= verdict.stated_peak for verdict in slack) >= 0.95 * len(slack),
        ),
        Demand(
            "tolerance met or declared unmet",
            "always",
            f"{sum(verdict.honest for verdict in judged)} of {len(judged)}",
            all(verdict.honest for verdict in judged),
        ),
        Demand(
            "every fidelity chosen at least once",
            "3 of 3",
            ", ".join(f"{name} {chosen[name]}" for name in sorted(models)),
            models <= set(chosen),
        ),
        Demand("time over the cheapest adequate one's, median", "<= 3", f"{loss:.2f}", loss <= 3.0),
    )


def _kept(name: str, verdicts: Sequence[Judged], share: float) -> Demand:
    met = [verdict.kept for verdict in verdicts]
    found = float(np.mean(met)) if met else 1.0
    return Demand(name, f">= {share:.0%}", f"{found:.1%} of {len(met)}", found >= share)


def coverage_table(judged: Sequence[Judged], skipped: Sequence[Skipped]) -> str:
    """Return the table as Markdown."""
    lines = [
        "# Stated against true error",
        "",
        f"{len(judged)} random scenes judged, {len(skipped)} without a verdict. Made by "
        "`python -m reports.error_coverage`.",
        "",
        "| demand | wanted | found | met |",
        "|---|---|---|---|",
        *(
            f"| {demand.name} | {demand.wanted} | {demand.found} | {'yes' if demand.met else '**no**'} |"
            for demand in demands(judged, skipped)
        ),
        "",
        "| cable | reference | scenes | covered | stated/true: median | 90 % | true, median | OK |",
        "|---|---|---|---|---|---|---|---|",
    ]
    groups = sorted({(verdict.slack, verdict.reference) for verdict in judged})
    for slack, reference in groups:
        group = [v for v in judged if (v.slack, v.reference) == (slack, reference)]
        ratios = [verdict.ratio for verdict in group]
        lines.append(
            f"| {'slack' if slack else 'taut'} | {reference} | {len(group)} "
            f"| {np.mean([v.covered for v in group]):.0%} | {np.median(ratios):.1f} "
            f"| {np.quantile(ratios, 0.9):.1f} | {np.median([v.true for v in group]):.1e} "
            f"| {np.mean([v.status == Status.OK.name for v in group]):.0%} |"
        )
    reasons = Counter(verdict.reason.split(" (")[0] for verdict in skipped)
    lines += ["", "| no verdict because | scenes |", "|---|---|"]
    lines += [f"| {reason} | {count} |" for reason, count in reasons.most_common()]
    lines += ["", "| uncovered | stated | true | reference |", "|---|---|---|---|"]
    lines += [
        f"| {v.seed}, {v.kind} | {v.stated:.1e} | {v.true:.1e} | {v.reference} |"
        for v in judged
        if not v.covered
    ]
    return "\n".join(lines) + "\n"
