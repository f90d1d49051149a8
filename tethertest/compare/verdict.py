"""The verdict of a run, from its metrics and what the audit found."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final

from tethertest.records.channel import Finding, Severity
from tethertest.records.comparison import Comparison, Metric, Verdict

#: a limited channel with more of its window unusable than this decides nothing
UNUSABLE_LIMIT: Final = 0.05


def overall(
    metrics: Sequence[Metric], findings: Sequence[Finding], unusable: Mapping[str, float]
) -> Comparison:
    """Draw the verdict of a run.

    Parameters
    ----------
    metrics : sequence of Metric
        All of them.
    findings : sequence of Finding
        Of the audit; a fatal one leaves the run undecided.
    unusable : mapping
        Limited channel -> share of its window that cannot be used.

    Returns
    -------
    Comparison
        Undecided where the data cannot carry a verdict (fatal finding, too many unusable samples); else fail
        if a limited metric fails, undecided if one is undecided or none has a limit, else pass.
    """
    doubts = [f"{item.subject}: {item.text}" for item in findings if item.severity == Severity.FATAL]
    doubts += [
        f"{channel}: {share:.1%} of the window cannot be used, at most {UNUSABLE_LIMIT:.0%} may"
        for channel, share in unusable.items()
        if share > UNUSABLE_LIMIT
    ]
    told = tuple(f"{item.subject}: {item.text}" for item in findings if item.severity == Severity.WARNING)
    failed = [item for item in metrics if item.verdict is Verdict.FAIL]
    open_ones = [item for item in metrics if item.verdict is Verdict.UNDECIDED]
    passed = [item for item in metrics if item.verdict is Verdict.PASS]
    if doubts:
        return Comparison(tuple(metrics), Verdict.UNDECIDED, (*doubts, *_words([*failed, *open_ones]), *told))
    if failed:
        return Comparison(tuple(metrics), Verdict.FAIL, (*_words([*failed, *open_ones]), *told))
    if open_ones:
        return Comparison(tuple(metrics), Verdict.UNDECIDED, (*_words(open_ones), *told))
    if not passed:
        reason = "no metric has a limit; set [limits] in the rig file"
        return Comparison(tuple(metrics), Verdict.UNDECIDED, (reason, *told))
    nearest = max(passed, key=lambda item: abs(item.error) / item.limit if item.limit else 0.0)
    summary = f"all {len(passed)} metrics are inside their limits; nearest: {_word(nearest)}"
    return Comparison(tuple(metrics), Verdict.PASS, (summary, *told))


def without_drive(metrics: Sequence[Metric], findings: Sequence[Finding], reason: str) -> Comparison:
    """Return the undecided verdict of a run in which nothing could be compared, the reason said once."""
    fatal = (f"{item.subject}: {item.text}" for item in findings if item.severity == Severity.FATAL)
    return Comparison(tuple(metrics), Verdict.UNDECIDED, (reason, *fatal))


def _words(metrics: Sequence[Metric]) -> tuple[str, ...]:
    return tuple(_word(metric) for metric in metrics)


def _word(metric: Metric) -> str:
    return f"{metric.channel}, {metric.name.replace('_', ' ')}: {metric.reason}"
