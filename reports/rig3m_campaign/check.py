"""One run's report against the truth it was made from, which the package itself never opens."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from tethertest.errors import TethertestError
from tethertest.jobs.report import make_report
from tethertest.records.channel import Channel
from tethertest.records.report import Report

#: clean runs: amplitude at f within 3 % or 2 standard errors, slack overlap 90 %, peak within the
#: truth's own N to 2N spread and 5 %
AMPLITUDE, STANDARD_ERRORS, OVERLAP, PEAK = 0.03, 2.0, 0.90, 0.05
#: load cells average over this long before a peak is taken, so that noise does not count [s]
PEAK_MEAN = 0.02
ORDERS = ("1/2", "1", "2", "3")
#: injected flaw -> findings that name it
FINDING_OF_FLAW = {
    "saturated": {"saturated"},
    "lost-grating": {"lost"},
    "stuck": {"stuck"},
    "clock-jump": {"clock_jump"},
    "spikes": {"spike"},
    "dropped": {"gap"},
    "hum": {"hum"},
    "swapped-date": {"day_month_swapped"},
}


@dataclass
class Check:
    """What one run showed."""

    name: str
    title: str
    flaws: list[str]
    verdict: str = ""
    exit_code: int = 0
    row: dict[str, str] = field(default_factory=dict)
    complaints: list[str] = field(default_factory=list)


def reference_time(truth: dict[str, Any], time: float) -> float:
    """Return the reading of the data logger's clock at a true time."""
    clock = truth["clocks"]["each"]["daq"]
    return float(time * (1.0 + clock["drift_ppm"] * 1e-6) + clock["offset_s"])


def peak(channel: Channel, start: float, stop: float) -> float:
    """Return the largest mean over `PEAK_MEAN` of the usable samples between two times."""
    part = channel.between(start, stop)
    count = max(1, round(PEAK_MEAN * channel.rate))
    means = np.convolve(part.values[part.usable], np.full(count, 1.0 / count), "valid")
    return float(means.max()) if means.size else float("nan")


def overlap(found: list[tuple[float, float]], true: list[tuple[float, float]]) -> float:
    """Return the time in both over the time in either."""
    if not found and not true:
        return 1.0
    axis = np.arange(0.0, 120.0, 1e-3)

    def inside(spans: list[tuple[float, float]]) -> np.ndarray:
        mask = np.zeros(axis.size, dtype=bool)
        for a, b in spans:
            mask |= (axis >= a) & (axis <= b)
        return mask

    either = inside(found) | inside(true)
    return float(np.sum(inside(found) & inside(true)) / np.sum(either)) if either.any() else 1.0


def check_orders(check: Check, report: Report, truth: dict[str, Any]) -> None:
    """Compare the top tension's orders."""
    lines = next((found for found in report.measured_lines if found.channel == "tension_top"), None)
    true = (truth.get("orders") or {}).get("tension_top", {})
    for order in ORDERS:
        line = lines.line(order) if lines else None
        if line is None or order not in true:
            check.row[order] = "-"
            continue
        wanted = true[order]["amplitude"]
        check.row[order] = f"{line.amplitude:.4f} / {wanted:.4f} {line.verdict.value}"
        if order == "1" and not check.flaws:
            allowed = max(AMPLITUDE * wanted, STANDARD_ERRORS * line.standard_error)
            if abs(line.amplitude - wanted) > allowed:
                check.complaints.append(f"order 1: {line.amplitude:.4f} N, true {wanted:.4f} N")


def check_clocks(check: Check, report: Report, truth: dict[str, Any]) -> None:
    """Compare clock offsets and drifts."""
    for fit in report.measured.clocks:
        true = truth["clocks"]["relative_to_daq"].get(fit.clock)
        if true is None:
            continue
        offset = fit.offset - true["offset_s"]
        drift = fit.drift * 1e6 - true["drift_ppm"]
        check.row[fit.clock] = (
            f"{offset * 1e3:+.2f} ± {1.96 * fit.offset_error * 1e3:.2f} ms, "
            f"{drift:+.1f} ± {1.96e6 * fit.drift_error:.1f} ppm"
        )
        if not check.flaws and abs(offset) > 1.96 * fit.offset_error:
            check.complaints.append(f"{fit.clock}: offset {offset * 1e3:+.2f} ms outside its interval")


def check_slack_and_peaks(check: Check, report: Report, truth: dict[str, Any]) -> None:
    """Compare slack intervals at the bottom cell and the peaks in the true steady window."""
    steady = truth["windows"].get("steady")
    if not steady:
        return
    start, stop = (reference_time(truth, time) for time in steady)
    true = [(reference_time(truth, a), reference_time(truth, b)) for a, b in truth["slack"]["tension_bottom"]]
    found = [(e.start, e.stop) for e in report.events if e.kind == "slack" and e.channel == "tension_bottom"]
    share = overlap(found, true)
    check.row["slack"] = f"{share:.3f} ({len(found)} / {len(true)})"
    if not check.flaws and share < OVERLAP:
        check.complaints.append(f"slack overlap {share:.3f}")
    for name in ("tension_top", "tension_bottom"):
        channel = report.measured.channel(name)
        if channel is None:
            continue
        wanted = truth["peaks"]["steady"][name]["max_of_mean"]
        got = peak(channel, start, stop)
        check.row[f"peak {name}"] = f"{got:.3f} / {wanted:.3f}"
        spread = truth["convergence"][f"peak_of_mean_{name}"]["relative"] or 0.0
        if not check.flaws and abs(got - wanted) > (spread + PEAK) * wanted:
            check.complaints.append(f"peak of {name}: {got:.3f} N, true {wanted:.3f} N")


def check_findings(check: Check, report: Report, truth: dict[str, Any]) -> None:
    """Every injected flaw is found, and nothing is found on clean runs."""
    loud = [finding for finding in report.measured.findings if finding.severity != "note"]
    check.row["findings"] = "; ".join(f"{f.subject} {f.kind}" for f in loud) or "none"
    if not check.flaws:
        check.complaints += [f"flagged although clean: {f.subject} {f.kind}" for f in loud]
    for flaw in truth["flaws"]:
        subject = flaw.get("channel") or flaw.get("clock") or flaw.get("log")
        kinds = {finding.kind for finding in loud if subject in {None, finding.subject}}
        if not kinds & FINDING_OF_FLAW[flaw["kind"]]:
            check.complaints.append(f"not found: {flaw['kind']} in {subject}")


def check_run(folder: Path) -> Check:
    """Run the chain on one folder and hold it against its truth."""
    truth = json.loads((folder / "truth.json").read_text(encoding="utf-8"))
    check = Check(folder.name, "", [flaw["kind"] for flaw in truth["flaws"]])
    try:
        report = make_report(folder)
    except TethertestError as error:
        check.verdict, check.exit_code = f"refused: {error.problem}", 2
        if not check.flaws:
            check.complaints.append(str(error))
        return check
    check.title = report.run.file.title
    check.verdict = report.comparison.verdict.value
    check.exit_code = {"pass": 0, "fail": 1, "undecided": 4}[check.verdict]
    check.row["reason"] = report.comparison.reasons[0] if report.comparison.reasons else ""
    for part in (check_orders, check_clocks, check_slack_and_peaks, check_findings):
        part(check, report, truth)
    if check.flaws and check.verdict == "pass":
        loud = [finding for finding in report.measured.findings if finding.severity != "note"]
        if not loud:
            check.complaints.append("a flawed run passed without a word")
    return check
