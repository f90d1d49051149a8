"""What the first lines say: which run, the verdict, and why."""

from __future__ import annotations

from dataclasses import dataclass

from tethertest.records.comparison import Verdict
from tethertest.records.report import Report
from tethertest.render.text import ABSENT, COVERAGE_95, plus_minus, words

REASONS_SHOWN = 4  #: on the first screen; the rest stand in the section of metrics

VERDICT_WORDS = {
    Verdict.PASS: "PASS",
    Verdict.FAIL: "FAIL",
    Verdict.UNDECIDED: "UNDECIDED",
    Verdict.INFORMATIVE: "NO LIMITS",
}


@dataclass(frozen=True, slots=True)
class Head:
    """The head of the page."""

    identity: str
    title: str
    facts: tuple[tuple[str, str], ...]
    verdict: str
    tone: str
    reasons: tuple[str, ...]
    more_reasons: int


def head(report: Report) -> Head:
    """Return the head of the page."""
    reasons = report.comparison.reasons
    return Head(
        identity=report.run.file.id,
        title=report.run.file.title,
        facts=(
            ("Date", report.run.file.date.isoformat(sep=" ", timespec="minutes")),
            ("Operator", report.run.file.operator or ABSENT),
            ("Rig", report.run.rig.name),
            ("UAV mode", report.run.file.platform.mode),
            ("Drive set", drive_text(report)),
            ("Drive fitted", fitted_text(report)),
            ("Purpose", report.run.file.purpose),
        ),
        verdict=VERDICT_WORDS[report.comparison.verdict],
        tone=report.comparison.verdict.value,
        reasons=reasons[:REASONS_SHOWN] or ("no reason was given",),
        more_reasons=max(len(reasons) - REASONS_SHOWN, 0),
    )


def drive_text(report: Report) -> str:
    """Return the drive as it was set; its frequency stays in Hz, as on the rig's dial."""
    drive = report.run.file.drive
    parts = [words(drive.kind)]
    if drive.frequency is not None:
        parts.append(f"{drive.frequency:g} Hz")
    if drive.radius is not None:
        parts.append(f"radius {1e3 * drive.radius:g} mm")
    if drive.amplitude is not None:
        parts.append(f"amplitude {1e3 * drive.amplitude:g} mm")
    return ", ".join(parts)


def fitted_text(report: Report) -> str:
    """Return the drive frequency as fitted, with its 95 % interval."""
    if report.drive is None:
        return "no drive was found"
    return f"{plus_minus(report.drive.frequency, COVERAGE_95 * report.drive.standard_error)} Hz"
