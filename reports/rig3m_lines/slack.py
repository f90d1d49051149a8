"""Slack intervals and the largest tension of a run against its statement."""

from __future__ import annotations

from typing import Any

import numpy as np

from reports.rig3m_lines.findings import HALF_WIDTH, Clock, Complaints, Spans, median_and_worst, table
from tethertest.records.analysis import ChannelAnalysis
from tethertest.records.channel import Window
from tethertest.spectra.cycles import extremes
from tethertest.spectra.events import slack_intervals

#: shared time; intervals that nobody may miss [s]; the statement's rule: joined and dropped below [s]
OVERLAP, LONG, JOINED, SHORTEST = 0.90, 0.05, 0.02, 0.01
#: largest tension: noise of the one sample, and what falls between two samples
PEAK_NOISE, PEAK_SAMPLING = 4.0, 0.02


class SlackCheck:
    """Slack and largest tension of all runs."""

    def __init__(self, complaints: Complaints) -> None:
        self.complaints = complaints
        self.slack: list[list[str]] = []
        self.largest: list[list[str]] = []

    def add(self, run: str, item: ChannelAnalysis, truth: dict[str, Any]) -> None:
        """Compare one end of one run."""
        self._slack(run, item, truth)
        self._largest(run, item, truth)

    def _slack(self, run: str, item: ChannelAnalysis, truth: dict[str, Any]) -> None:
        clock, name = Clock(truth), item.channel.name
        true = [(clock.shows(a), clock.shows(b)) for a, b in truth["slack"][name]]
        seen = joined(list(slack_intervals(item.events, name)))
        if not true and not seen:
            return
        share = overlap(seen, true)
        missed, extra = unmatched(true, seen), unmatched(seen, true)
        pairs = matched(true, seen)
        starts = np.array([s[0] - t[0] for t, s in pairs]) * 1e3
        stops = np.array([s[1] - t[1] for t, s in pairs]) * 1e3
        self.slack.append(
            [
                run, name, f"{len(seen)} / {len(true)}", f"{len(missed)} / {len(extra)}", f"{share:.3f}",
                median_and_worst(starts), median_and_worst(stops),
            ]
        )  # fmt: skip
        where = f"{run} {name}"
        self.complaints.demand(share >= OVERLAP, f"{where}: slack overlap {share:.3f}")
        self.complaints.demand(
            not missed and not extra, f"{where}: {len(missed)} slack intervals missed, {len(extra)} not true"
        )

    def _largest(self, run: str, item: ChannelAnalysis, truth: dict[str, Any]) -> None:
        steady, name = truth["windows"]["steady"], item.channel.name
        if not steady:
            return
        clock, channel = Clock(truth), item.channel
        ends = extremes(channel, Window(clock.shows(steady[0]), clock.shows(steady[1])))
        true = truth["peaks"]["steady"][name]["max"]
        self.largest.append(
            [run, name, f"{ends.maximum:.3f} / {true:.3f}", f"{ends.maximum / true - 1.0:+.2%}"]
        )
        allowed = PEAK_NOISE * channel.noise + (HALF_WIDTH * channel.uncertainty + PEAK_SAMPLING) * true
        flawed = {flaw.get("channel") for flaw in truth["flaws"]}
        self.complaints.demand(
            name in flawed or abs(ends.maximum - true) <= allowed,
            f"{run} {name}: largest tension {ends.maximum:.3f} N, true {true:.3f} N",
        )

    def text(self) -> str:
        """Return the tables."""
        return (
            "## Slack\n\nCounts and times under the statement's rule (gaps below 20 ms joined). Missed and "
            "untrue: of 50 ms or more. Times in ms: median error (worst) of intervals of 50 ms or more. The "
            "statement's threshold is 0.15 N, the analysis takes the cell's own zero uncertainty, 0.06 N and "
            "up, so that a slow approach to zero starts later and ends earlier.\n\n"
            + table("run|channel|found / true|missed / untrue|overlap|start|end", self.slack)
            + "\n\n## Largest tension in the true steady window\n\n"
            + table("run|channel|measured / true [N]|error", self.largest)
        )


def joined(spans: Spans) -> Spans:
    """Return intervals under the statement's own rule."""
    result: Spans = []
    for start, stop in spans:
        if result and start - result[-1][1] < JOINED:
            result[-1] = (result[-1][0], stop)
        else:
            result.append((start, stop))
    return [span for span in result if span[1] - span[0] >= SHORTEST]


def unmatched(spans: Spans, others: Spans) -> Spans:
    """Return the long intervals that touch none of the others."""
    return [s for s in spans if s[1] - s[0] >= LONG and not any(o[0] < s[1] and o[1] > s[0] for o in others)]


def matched(true: Spans, seen: Spans) -> list[tuple[tuple[float, float], tuple[float, float]]]:
    """Return pairs of long true intervals and those seen that share most time with them."""
    pairs = []
    for span in true:
        near = [s for s in seen if s[0] < span[1] and s[1] > span[0]]
        if near and span[1] - span[0] >= LONG:
            pairs.append((span, max(near, key=lambda s: min(s[1], span[1]) - max(s[0], span[0]))))
    return pairs


def overlap(seen: Spans, true: Spans) -> float:
    """Return the time in both over the time in either."""
    axis = np.arange(0.0, 120.0, 1e-3)

    def inside(spans: Spans) -> np.ndarray:
        mask = np.zeros(axis.size, dtype=bool)
        for a, b in spans:
            mask |= (axis >= a) & (axis <= b)
        return mask

    either = inside(seen) | inside(true)
    return float(np.sum(inside(seen) & inside(true)) / np.sum(either)) if either.any() else 1.0
