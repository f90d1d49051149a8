#!/usr/bin/env python3
"""Hold what `tethertest analyze` says about the synthetic campaign's lines and events against its truth.

Prints the tables and leaves with exit code 1 if a demand is not met. The truth stands in truth.json beside
each run; the package itself never opens it.
"""

from __future__ import annotations

import argparse
import json
import sys
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from scipy.stats import binom

from tethertest.pipeline.analysis_options import Options
from tethertest.pipeline.analyze import analyze
from tethertest.records.analysis import Analysis, ChannelAnalysis
from tethertest.records.channel import Window
from tethertest.records.lines import Line, LineVerdict
from tethertest.spectra.cycles import extremes
from tethertest.spectra.events import slack_intervals

HERE = Path(__file__).parent
CHANNELS = ("tension_top", "tension_bottom", "heave")
TENSIONS = CHANNELS[:2]
HALVES = {"1/2", "3/2", "5/2"}
#: the run whose tether answers every second turn, and the one whose gears bring half the speed in
PERIOD_TWO, GEAR_ERROR = "run15", "run16"
#: verdicts that make no statement about the amplitude
WITHHELD = {LineVerdict.UNDETERMINED, LineVerdict.NOT_RESOLVABLE}
#: chance that intervals which hold 95 % fail the demand all the same; and departures that are no chance
CHANCE, GROSS = 0.01, 5.0
#: slack: shared time; intervals that nobody may miss [s]; the statement's rule: joined and dropped below [s]
OVERLAP, LONG, JOINED, SHORTEST = 0.90, 0.05, 0.02, 0.01
#: largest tension: noise of the one sample, and what falls between two samples
PEAK_NOISE, PEAK_SAMPLING = 4.0, 0.02
HALF_WIDTH = 1.959964

Spans = list[tuple[float, float]]


@dataclass(frozen=True)
class Row:
    """One order of one channel of one run."""

    run: str
    channel: str
    line: Line
    true: float
    phase_error: float

    @property
    def stated(self) -> bool:
        """The analysis stands by the amplitude."""
        return self.line.verdict not in WITHHELD

    @property
    def inside(self) -> bool:
        """The interval holds the truth."""
        return self.line.interval[0] <= self.true <= self.line.interval[1]

    @property
    def departure(self) -> float:
        """Error in standard errors, of noise and calibration together."""
        scale = float(np.hypot(self.line.standard_error, self.line.calibration_error))
        return (self.line.amplitude - self.true) / max(scale, 1e-300)


@dataclass
class Found:
    """All that the runs showed."""

    rows: list[Row] = field(default_factory=list)
    verdicts: list[list[str]] = field(default_factory=list)
    events: list[list[str]] = field(default_factory=list)
    peaks: list[list[str]] = field(default_factory=list)
    complaints: list[str] = field(default_factory=list)


class Clock:
    """The data logger's clock of one run, which is the run's."""

    def __init__(self, truth: dict[str, Any]) -> None:
        each = truth["clocks"]["each"]["daq"]
        self.offset, self.pace = each["offset_s"], 1.0 + each["drift_ppm"] * 1e-6

    def shows(self, time: float) -> float:
        """Return the reading at a true time."""
        return float(time * self.pace + self.offset)

    def true(self, reading: float) -> float:
        """Return the true time of a reading."""
        return float((reading - self.offset) / self.pace)


def check_lines(found: Found, run: str, analysis: Analysis, truth: dict[str, Any]) -> None:
    """Compare amplitudes and phases with the stated orders."""
    clock, window, drive = Clock(truth), analysis.window, truth["drive"]
    for name in CHANNELS:
        item = analysis.find(name)
        stated = (truth["orders"] or {}).get(name)
        if item is None or item.lines is None or window is None or stated is None:
            continue
        start = clock.true(window.start)
        for order, true in stated.items():
            line = item.lines.line(order) if order != "mean" else None
            if line is None:
                continue
            turned = (
                2.0 * np.pi * line.frequency / analysis_frequency(analysis) * drive["frequency_Hz"] * start
            )
            error = line.phase - true["phase"] - turned
            row = Row(run, name, line, true["amplitude"], float((error + np.pi) % (2.0 * np.pi) - np.pi))
            found.rows.append(row)
            if row.stated and abs(row.departure) > GROSS:
                found.complaints.append(
                    f"{run} {name} order {order}: {row.departure:+.1f} standard errors off"
                )


def analysis_frequency(analysis: Analysis) -> float:
    """Return the fitted drive frequency [Hz]."""
    return 1.0 if analysis.drive is None else analysis.drive.frequency


def check_verdicts(found: Found, run: str, analysis: Analysis, truth: dict[str, Any]) -> None:
    """Demand that the period-two run is found and no other, and what crank and gears bring in is named so."""
    flaws = {flaw.get("channel") for flaw in truth["flaws"] if flaw["kind"] == "saturated"}
    taut = not any(truth["slack"][name] for name in TENSIONS)
    for item in analysis.channels:
        if item.lines is None:
            continue
        name = item.channel.name
        said = {line.order: line.verdict for line in item.lines.lines}
        broken = {order: verdict for order, verdict in said.items() if "/" in order}
        found.verdicts.append(
            [run, name, *(_said(said, order) for order in ("1", "2", "3")), _broken(broken)]
        )
        called = {order for order, verdict in broken.items() if verdict is LineVerdict.SUBHARMONIC}
        if run != PERIOD_TWO and called:
            found.complaints.append(f"{run} {name}: false subharmonic at {', '.join(sorted(called))}")
        if run == PERIOD_TWO and not called <= HALVES:
            found.complaints.append(
                f"{run} {name}: false subharmonic at {', '.join(sorted(called - HALVES))}"
            )
        if run == PERIOD_TWO and name in TENSIONS and not called >= HALVES:
            found.complaints.append(
                f"{run} {name}: period two not found at {', '.join(sorted(HALVES - called))}"
            )
        if run == GEAR_ERROR and name in TENSIONS and said.get("1/2") is not LineVerdict.INPUT_BORNE:
            found.complaints.append(f"{run} {name}: order 1/2 of the gears is {_said(said, '1/2')}")
        if name in flaws:
            if said.get("1") is not LineVerdict.UNDETERMINED:
                found.complaints.append(f"{run} {name}: its largest values are lost, and order 1 is stated")
        elif name in TENSIONS and said.get("1") is not LineVerdict.HARMONIC:
            found.complaints.append(f"{run} {name}: order 1 is {_said(said, '1')}")
        elif name in TENSIONS and taut and said.get("2") is not LineVerdict.CRANK_HARMONIC:
            found.complaints.append(f"{run} {name}: the crank's order 2 is {_said(said, '2')}")


def _said(said: dict[str, LineVerdict], order: str) -> str:
    return said[order].value if order in said else "-"


def _broken(broken: dict[str, LineVerdict]) -> str:
    loud = [f"{order} {v.value}" for order, v in broken.items() if v is not LineVerdict.NONE]
    return ", ".join(loud) or "none"


def check_slack(found: Found, run: str, item: ChannelAnalysis, truth: dict[str, Any]) -> None:
    """Compare slack intervals, and the snaps that end them."""
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
    found.events.append(
        [
            run, name, f"{len(seen)} / {len(true)}", f"{len(missed)} / {len(extra)}", f"{share:.3f}",
            f"{np.median(starts):+.1f} ({np.abs(starts).max():.1f})",
            f"{np.median(stops):+.1f} ({np.abs(stops).max():.1f})", str(len(item.snaps)),
        ]
    )  # fmt: skip
    if share < OVERLAP:
        found.complaints.append(f"{run} {name}: slack overlap {share:.3f}")
    if missed or extra:
        found.complaints.append(f"{run} {name}: {len(missed)} slack intervals missed, {len(extra)} not true")


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


def check_peak(found: Found, run: str, item: ChannelAnalysis, truth: dict[str, Any]) -> None:
    """Compare the largest tension of the true steady window; where it is a snap, the snap's peak too."""
    steady, name = truth["windows"]["steady"], item.channel.name
    if not steady:
        return
    clock, channel = Clock(truth), item.channel
    window = Window(clock.shows(steady[0]), clock.shows(steady[1]))
    ends = extremes(channel, window)
    true = truth["peaks"]["steady"][name]["max"]
    snaps = [snap for snap in item.snaps if window.start <= snap.peak_time <= window.stop]
    largest = max(snaps, key=lambda snap: snap.peak, default=None)
    found.peaks.append(
        [
            run, name, f"{ends.maximum:.3f} / {true:.3f}", f"{ends.maximum / true - 1.0:+.2%}",
            "-" if largest is None else
            f"{largest.peak:.3f} ({largest.peak_interval[0]:.3f} to {largest.peak_interval[1]:.3f})",
        ]
    )  # fmt: skip
    allowed = PEAK_NOISE * channel.noise + (HALF_WIDTH * channel.uncertainty + PEAK_SAMPLING) * true
    flawed = {flaw.get("channel") for flaw in truth["flaws"]}
    if name not in flawed and abs(ends.maximum - true) > allowed:
        found.complaints.append(f"{run} {name}: largest tension {ends.maximum:.3f} N, true {true:.3f} N")


def coverage(found: Found) -> list[list[str]]:
    """Return how often intervals hold the truth, and complain where that is not 95 %."""
    table = []
    stated = [row for row in found.rows if row.stated]
    for name in CHANNELS:
        for order in ("1/2", "1", "3/2", "2", "3", "all"):
            some = [row for row in stated if row.channel == name and order in {row.line.order, "all"}]
            if not some:
                continue
            inside = sum(row.inside for row in some)
            departures = np.array([row.departure for row in some])
            sizes = [row.line.amplitude / row.true - 1.0 for row in some if row.line.order == order == "1"]
            phases = np.array([row.phase_error for row in some if row.line.order == order == "1"])
            table.append(
                [
                    name, order, f"{inside} / {len(some)}", f"{np.median(np.abs(departures)):.2f}",
                    f"{np.abs(departures).max():.2f}",
                    f"{np.abs(sizes).max():.2%}" if sizes else "-",
                    f"{np.abs(phases).max() * 1e3:.2f}" if phases.size else "-",
                ]
            )  # fmt: skip
    misses = sum(not row.inside for row in stated)
    if misses > binom.ppf(1.0 - CHANCE, len(stated), 0.05):
        found.complaints.append(f"{misses} of {len(stated)} intervals do not hold the truth, 5 % may")
    inside = len(stated) - misses
    table.append(["all", "all", f"{inside} / {len(stated)} = {inside / max(1, len(stated)):.1%}", *["-"] * 4])
    return table


def amplitude_rows(found: Found) -> list[list[str]]:
    """Return one row per run, channel and order."""
    return [
        [
            row.run, row.channel, row.line.order, f"{row.line.amplitude:.6f}", f"{row.true:.6f}",
            f"{row.line.interval[0]:.6f} to {row.line.interval[1]:.6f}",
            f"{row.line.standard_error:.2g}", f"{row.line.calibration_error:.2g}",
            ("yes" if row.inside else "**no**") if row.stated else "not stated", row.line.verdict.value,
        ]
        for row in found.rows
    ]  # fmt: skip


def table(heads: str, rows: list[list[str]]) -> str:
    """Return a Markdown table."""
    columns = heads.split("|")
    lines = [columns, ["---"] * len(columns), *rows]
    return "\n".join("| " + " | ".join(cell.strip() for cell in row) + " |" for row in lines)


def check_run(found: Found, folder: Path) -> None:
    """Analyse one run and hold it against its truth."""
    truth = json.loads((folder / "truth.json").read_text(encoding="utf-8"))
    analysis = analyze(folder, Options())
    check_lines(found, folder.name, analysis, truth)
    check_verdicts(found, folder.name, analysis, truth)
    for name in TENSIONS:
        item = analysis.find(name)
        if item is not None:
            check_slack(found, folder.name, item, truth)
            check_peak(found, folder.name, item, truth)


def report(found: Found) -> str:
    """Return the tables."""
    return "\n\n".join(
        [
            "# Lines and events of the synthetic campaign against its truth\n\n"
            "Written by `python datasets/check_lines.py --output reports/rig3m-lines.md`. Amplitudes in N "
            "and m; the 95 % interval holds noise and the channel's stated scale uncertainty. Rows that the "
            "analysis itself does not stand by (undetermined, not resolvable) do not count for coverage.",
            "## Verdicts\n\n" + table("run|channel|1|2|3|orders p/q that are not none", found.verdicts),
            "## Slack and snaps\n\nCounts and times under the statement's rule (gaps below 20 ms joined). "
            "Missed and untrue: of 50 ms or more. Times in ms: median error (worst) of intervals of 50 ms or "
            "more; an interval's end is its snap's start. The statement's threshold is 0.15 N, the analysis "
            "takes the cell's own zero uncertainty, 0.06 N and up, so that a slow approach to zero starts "
            "later.\n\n"
            + table("run|channel|found / true|missed / untrue|overlap|start|end|snaps", found.events),
            "## Largest tension in the true steady window\n\nA snap's peak is looked for within 0.25 s of "
            "re-tightening; where the tension still grows after that, the largest tension is not the snap's."
            "\n\n" + table("run|channel|measured / true [N]|error|largest snap [N] (95 %)", found.peaks),
            "## Amplitudes\n\n"
            + table(
                "run|channel|order|found|true|95 %|by noise|by scale|holds|verdict", amplitude_rows(found)
            ),
            "## Coverage\n\nDepartures in standard errors of noise and scale together; the cells' scales are "
            "wrong by 0.04 %, the same in every run.\n\n"
            + table(
                "channel|order|holds|median departure|worst|worst amplitude|worst phase [mrad]",
                coverage(found),
            ),
            "## Demands\n\n" + ("\n".join(f"- {text}" for text in found.complaints) or "All met."),
        ]
    )


def main() -> int:
    """Check all runs, or those named."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("runs", nargs="*", help="run folders [all of datasets/rig3m]")
    parser.add_argument("--output", type=Path, help="write the tables to this Markdown file too")
    settings = parser.parse_args()
    found = Found()
    for folder in [Path(run) for run in settings.runs] or sorted((HERE / "rig3m").glob("run*")):
        check_run(found, folder)
    text = report(found)
    sys.stdout.write(text + "\n")
    if settings.output:
        settings.output.write_text(text + "\n", encoding="utf-8")
    return int(bool(found.complaints))


if __name__ == "__main__":
    raise SystemExit(main())
