"""Amplitudes, phases and verdicts of a run's lines against its statement."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from reports.rig3m_lines.findings import CHANNELS, TENSIONS, Clock, Complaints, allowed_misses, table
from tethertest.records.analysis import Analysis
from tethertest.records.lines import Line, LineVerdict

HALVES = {"1/2", "3/2", "5/2"}
#: the run whose tether answers every second turn, and the one whose gears bring half the speed in
PERIOD_TWO, GEAR_ERROR = "run15", "run16"
#: verdicts that make no statement about the amplitude
WITHHELD = {LineVerdict.UNDETERMINED, LineVerdict.NOT_RESOLVABLE}
#: departures in standard errors that are no chance
GROSS = 5.0


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


class LineCheck:
    """Lines of all runs."""

    def __init__(self, complaints: Complaints) -> None:
        self.complaints = complaints.texts
        self.rows: list[Row] = []
        self.verdicts: list[list[str]] = []

    def add(self, run: str, analysis: Analysis, truth: dict[str, Any]) -> None:
        """Compare one run."""
        check_lines(self, run, analysis, truth)
        check_verdicts(self, run, analysis, truth)

    def text(self) -> str:
        """Return the tables of amplitudes, and complain of intervals that do not hold."""
        return (
            "## Amplitudes\n\n"
            + table("run|channel|order|found|true|95 %|by noise|by scale|holds|verdict", amplitude_rows(self))
            + "\n\n## Coverage\n\nDepartures in standard errors of noise and scale together; the cells' "
            "scales are wrong by 0.04 %, the same in every run.\n\n"
            + table(
                "channel|order|holds|median departure|worst|worst amplitude|worst phase [mrad]",
                coverage(self),
            )
        )


def check_lines(found: LineCheck, run: str, analysis: Analysis, truth: dict[str, Any]) -> None:
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


def check_verdicts(found: LineCheck, run: str, analysis: Analysis, truth: dict[str, Any]) -> None:
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


def coverage(found: LineCheck) -> list[list[str]]:
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
    if misses > allowed_misses(len(stated)):
        found.complaints.append(f"{misses} of {len(stated)} intervals do not hold the truth, 5 % may")
    inside = len(stated) - misses
    table.append(["all", "all", f"{inside} / {len(stated)} = {inside / max(1, len(stated)):.1%}", *["-"] * 4])
    return table


def amplitude_rows(found: LineCheck) -> list[list[str]]:
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
