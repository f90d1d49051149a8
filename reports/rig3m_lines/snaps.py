"""Snaps of a run, one by one, against its statement."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from reports.rig3m_lines.findings import Clock, Complaints, allowed_misses, median_and_worst, table
from tethertest.records.analysis import ChannelAnalysis
from tethertest.records.events import Snap
from tethertest.spectra.events import find_events, slack_intervals
from tethertest.spectra.snaps import with_snaps

#: a snap counts from this peak on [N]: a tenth of it, where its rise begins, is the statement's threshold
FLOOR = 1.5
#: start of a found snap from that of a true one [s]: the slow stretch from 0.06 N to 0.15 N
START = 0.04
#: slack shorter than this [s] either side may miss: with two dips joined, twice the shortest interval
CERTAIN = 0.02
#: the same top of the tension, in sampling intervals; share of all snaps whose top is the true one
SAME_TOP, TOPS = 1.5, 0.95
#: median and worst error of the same top, relative: a top of 1 ms is seen at 1 kHz by a sample or two
MEDIAN_PEAK, WORST_PEAK = 0.01, 0.05
#: share of the rise times right within a sampling interval and this share of the rise
RISES, RISE_SHARE = 0.95, 0.05
#: the ends part at a speed worth naming after slack of this long [s]; the front that they send, over it
LONG = 0.05
FRONTS = (0.5, 2.0)
#: every so many samples are kept for the intervals of a slower logger; down to this rate they must hold [Hz]
THINNED, SLOWEST = (2, 4), 490.0
#: the speed of a front that is doubled at the sensor is no larger than the ends', within this
DOUBLED = 1.05


@dataclass(frozen=True)
class Stated:
    """A stated snap, on the data logger's clock."""

    start: float
    slack: float
    peak_time: float
    peak: float
    rise: float
    parting: float


@dataclass
class End:
    """The snaps of one end of one run."""

    run: str
    name: str
    step: float
    pairs: list[tuple[Stated, Snap]] = field(default_factory=list)
    missed: list[Stated] = field(default_factory=list)
    false: list[tuple[float, Snap]] = field(default_factory=list)  #: each after its slack [s]

    @property
    def tops(self) -> list[tuple[Stated, Snap]]:
        """Pairs that mean the same top of the tension."""
        return [(t, s) for t, s in self.pairs if abs(s.peak_time - t.peak_time) <= SAME_TOP * self.step]

    @property
    def inside(self) -> int:
        """Number of pairs whose interval holds the true peak, of the same top or not."""
        return sum(s.peak_interval[0] <= t.peak <= s.peak_interval[1] for t, s in self.pairs)


def stated(truth: dict[str, Any], name: str) -> list[Stated]:
    """Return the true snaps of one end."""
    clock, columns = Clock(truth), truth["snaps"][name]
    keys = ("start_s", "slack_s", "peak_s", "peak_N", "rise_s", "parting_m_per_s")
    return [
        Stated(clock.shows(start), slack, clock.shows(peak_time), peak, rise, parting)
        for start, slack, peak_time, peak, rise, parting in zip(*(columns[key] for key in keys), strict=True)
    ]


def paired(run: str, item: ChannelAnalysis, truth: dict[str, Any]) -> End:
    """Return true snaps and found ones in pairs, the nearest starts first."""
    name = item.channel.name
    true, found = stated(truth, name), list(item.snaps)
    lengths = {stop: stop - start for start, stop in slack_intervals(item.events, name)}
    apart = sorted(
        (abs(snap.start - one.start), i, j) for i, one in enumerate(true) for j, snap in enumerate(found)
    )
    end = End(run, name, 1.0 / item.channel.rate)
    partner: dict[int, int] = {}
    for distance, i, j in apart:
        if distance <= START and i not in partner and j not in partner.values():
            partner[i] = j
    counted = [(i, one) for i, one in enumerate(true) if one.peak >= FLOOR]
    end.pairs = [(one, found[partner[i]]) for i, one in counted if i in partner]
    end.missed = [one for i, one in counted if i not in partner]
    end.false = [
        (lengths[snap.start], snap)
        for j, snap in enumerate(found)
        if snap.peak >= FLOOR and j not in partner.values()
    ]
    return end


def thinned(item: ChannelAnalysis, count: int) -> ChannelAnalysis:
    """Return the snaps that a logger finds that takes every so many samples, without a filter."""
    whole = item.channel
    part = replace(whole, time=whole.time[::count], values=whole.values[::count], flags=whole.flags[::count])
    return replace(item, channel=part, events=with_snaps(part, find_events(part)))


class SnapCheck:
    """Snaps of all runs."""

    def __init__(self, complaints: Complaints) -> None:
        self.complaints = complaints
        self.ends: list[End] = []
        self.without = 0
        self.slower: dict[int, list[End]] = {count: [] for count in THINNED}

    def add(self, run: str, item: ChannelAnalysis, truth: dict[str, Any]) -> None:
        """Compare one end of one run."""
        end = paired(run, item, truth)
        if end.pairs or end.missed or end.false:
            self.ends.append(end)
            for count, ends in self.slower.items():
                ends.append(paired(run, thinned(item, count), truth))
        else:
            self.without += 1

    def text(self) -> str:
        """Return the tables, and complain of what is wrong."""
        counts = [self._count(end) for end in self.ends]
        errors = [self._errors(end) for end in self.ends if end.tops]
        speeds = [row for end in self.ends if (row := self._speeds(end))]
        pairs = sum(len(end.pairs) for end in self.ends)
        tops = sum(len(end.tops) for end in self.ends)
        self.complaints.demand(
            tops >= TOPS * max(1, pairs), f"{tops} of {pairs} snaps peak where they truly do"
        )
        return (
            f"## Snaps one by one\n\nTrue snaps of {FLOOR:g} N and more. A found snap is the true one whose "
            f"start is nearest, within {START * 1e3:.0f} ms; missed and false ones after slack below "
            f"{CERTAIN * 1e3:.0f} ms in brackets, which may be (statement and analysis both ask for 10 ms, "
            "at different thresholds). False: a peak of that size where no true snap is. Same top: the peaks "
            f"lie within {SAME_TOP:g} sampling intervals; else another top of the same bouncing is the "
            "largest within 0.25 s, seen through noise or through a start that differs. At the other "
            f"{self.without} ends there is no true snap, and none is found.\n\n"
            + table("run|channel|true|found|missed|false|start [ms] median (worst)|same top", counts)
            + "\n\nPeak, its time and rise of the same tops: median error (worst). The 95 % interval counts "
            "for all pairs. It is wider upwards by what may stand between two samples, a bound, so that it "
            "holds more than 95 % where the sampling is fine. Rise right: within a sampling interval and "
            f"{RISE_SHARE:.0%} of the rise.\n\n"
            + table("run|channel|peak|holds|width|time [ms]|rise [ms]|rise right", errors)
            + "\n\nThe same records with every second and every fourth sample: a top of a millisecond falls "
            "between samples, and the interval must say so. Below 500 Hz nothing is demanded: what the rate "
            "does not carry cannot be bounded from the samples. The largest error is one snap of run 12: "
            "its 0.25 s end after the largest top by the statement's start, before it by the analysis's.\n\n"
            + table("rate [Hz]|true|found|peak|holds|width", self._rates())
            + "\n\nFront over impedance, as `speed`, against the largest speed at which the ends part, "
            f"after slack of {LONG * 1e3:.0f} ms and more: 1 where the front starts at the sensor, 2 where "
            "it is doubled there, less by the slack that is left. Largest doubled: largest `arrived_speed` "
            "over it.\n\n"
            + table("run|channel|snaps|ends part [m/s]|speed / that, median (range)|largest doubled", speeds)
        )

    def _count(self, end: End) -> list[str]:
        surely = [one for one in end.missed if one.slack >= CERTAIN]
        falsely = [snap for slack, snap in end.false if slack >= CERTAIN]
        where = f"{end.run} {end.name}"
        self.complaints.demand(not surely, f"{where}: {len(surely)} snaps missed")
        self.complaints.demand(not falsely, f"{where}: {len(falsely)} snaps that are none")
        starts = np.array([snap.start - one.start for one, snap in end.pairs]) * 1e3
        return [
            end.run, end.name, str(len(end.pairs) + len(end.missed)), str(len(end.pairs)),
            f"{len(surely)} ({len(end.missed) - len(surely)})",
            f"{len(falsely)} ({len(end.false) - len(falsely)})",
            median_and_worst(starts), f"{len(end.tops)} / {len(end.pairs)}",
        ]  # fmt: skip

    def _errors(self, end: End) -> list[str]:
        true = np.array([one.peak for one, _ in end.tops])
        peaks = np.array([snap.peak for _, snap in end.tops]) / true - 1.0
        times = np.array([snap.peak_time - one.peak_time for one, snap in end.tops]) * 1e3
        rises = np.array([snap.rise_time - one.rise for one, snap in end.tops])
        allowed = end.step + RISE_SHARE * np.array([one.rise for one, _ in end.tops])
        right = float(np.mean(np.abs(rises) <= allowed))
        width = np.array([snap.peak_interval[1] - snap.peak_interval[0] for _, snap in end.tops]) / true
        middle, worst = float(np.median(peaks)), float(np.abs(peaks).max())
        where = f"{end.run} {end.name}"
        self.complaints.demand(
            abs(middle) <= MEDIAN_PEAK and worst <= WORST_PEAK,
            f"{where}: peaks off by {middle:+.2%} (median), {worst:.2%} (worst)",
        )
        self.complaints.demand(right >= RISES, f"{where}: {right:.1%} of the rise times are right")
        return [
            end.run, end.name, f"{middle:+.2%} ({worst:.2%})", f"{end.inside} / {len(end.pairs)}",
            f"{np.median(width):.1%}", median_and_worst(times, 2), median_and_worst(rises * 1e3, 2),
            f"{right:.1%}",
        ]  # fmt: skip

    def _rates(self) -> list[list[str]]:
        rows = []
        for ends in (self.ends, *self.slower.values()):
            pairs, inside = [pair for end in ends for pair in end.pairs], sum(end.inside for end in ends)
            if not pairs:
                continue
            rate = 1.0 / ends[0].step
            true = np.array([one.peak for one, _ in pairs])
            errors = np.array([snap.peak for _, snap in pairs]) / true - 1.0
            width = np.array([snap.peak_interval[1] - snap.peak_interval[0] for _, snap in pairs]) / true
            self.complaints.demand(
                rate < SLOWEST or len(pairs) - inside <= allowed_misses(len(pairs)),
                f"at {rate:.0f} Hz {inside} of {len(pairs)} intervals hold the snap's peak, 95 % must",
            )
            rows.append(
                [
                    f"{rate:.0f}", str(len(pairs) + sum(len(end.missed) for end in ends)), str(len(pairs)),
                    f"{np.median(errors):+.2%} ({np.abs(errors).max():.2%})",
                    f"{inside} / {len(pairs)} = {inside / len(pairs):.1%}", f"{np.median(width):.1%}",
                ]
            )  # fmt: skip
        return rows

    def _speeds(self, end: End) -> list[str]:
        known = [
            (one.parting, snap.speed, snap.arrived_speed)
            for one, snap in end.pairs
            if one.slack >= LONG and snap.speed is not None and snap.arrived_speed is not None
        ]
        if not known:
            return []
        parting, front, arrived = np.array(known).T
        share, largest = front / parting, float(np.max(arrived / parting))
        middle, where = float(np.median(share)), f"{end.run} {end.name}"
        self.complaints.demand(
            FRONTS[0] <= middle <= FRONTS[1], f"{where}: fronts of {middle:.2f} of the speed of the ends"
        )
        self.complaints.demand(
            largest <= DOUBLED, f"{where}: a doubled front of {largest:.2f} of the speed of the ends"
        )
        return [
            end.run, end.name, str(len(known)), f"{parting.min():.3f} to {parting.max():.3f}",
            f"{middle:.2f} ({share.min():.2f} to {share.max():.2f})", f"{largest:.2f}",
        ]  # fmt: skip
