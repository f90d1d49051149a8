"""The verdict of a run from its metrics, its findings and the samples it lost."""

from __future__ import annotations

from dataclasses import replace

import pytest

from tethertest.compare.verdict import overall, without_drive
from tethertest.records.channel import Finding
from tethertest.records.comparison import Metric, Verdict

GOOD = Metric("peak_tension", "top", "N", 1.0, 1.02, 0.02, 0.0, 0.1, Verdict.PASS, "good")
CLOSE = replace(GOOD, name="order_phase 1", error=-0.04, limit=0.05, reason="close")
BAD = replace(GOOD, name="sprague_geers", verdict=Verdict.FAIL, reason="bad")
OPEN = replace(GOOD, name="order_amplitude 1", verdict=Verdict.UNDECIDED, reason="open")
FREE = replace(GOOD, limit=None, verdict=Verdict.INFORMATIVE, reason="free")
FATAL = Finding("encoder", "ambiguous", "no cycle", "fatal")
WARNING = Finding("cell", "drift", "it drifts", "warning")
NOTE = Finding("cell", "hum", "it hums", "note")


def test_all_inside_passes_and_names_the_one_nearest_to_its_limit() -> None:
    found = overall([GOOD, CLOSE, FREE], [WARNING, NOTE], {"top": 0.05})
    assert found.verdict is Verdict.PASS
    assert found.metrics == (GOOD, CLOSE, FREE)
    assert found.reasons == (
        "all 2 metrics are inside their limits; nearest: top, order phase 1: close",
        "cell: it drifts",
    )


def test_one_failure_fails_and_what_is_open_is_told_after_it() -> None:
    found = overall([OPEN, GOOD, BAD], [WARNING], {})
    assert found.verdict is Verdict.FAIL
    assert found.reasons == ("top, sprague geers: bad", "top, order amplitude 1: open", "cell: it drifts")


def test_one_open_metric_leaves_the_run_undecided() -> None:
    found = overall([GOOD, OPEN], [WARNING], {})
    assert found.verdict is Verdict.UNDECIDED
    assert found.reasons == ("top, order amplitude 1: open", "cell: it drifts")


def test_without_any_limit_nothing_is_decided() -> None:
    found = overall([FREE], [WARNING, NOTE], {})
    assert found.verdict is Verdict.UNDECIDED
    assert found.reasons == ("no metric has a limit; set [limits] in the rig file", "cell: it drifts")


@pytest.mark.parametrize("metrics", [[GOOD], [GOOD, BAD], [GOOD, OPEN]])
def test_a_fatal_finding_decides_over_every_metric(metrics: list[Metric]) -> None:
    found = overall(metrics, [NOTE, WARNING, FATAL], {})
    assert found.verdict is Verdict.UNDECIDED
    assert found.reasons[0] == "encoder: no cycle"
    assert found.reasons[-1] == "cell: it drifts"
    assert len(found.reasons) == 1 + len(metrics)  # the warning, and every metric that does not pass


def test_a_twentieth_of_a_window_may_be_lost_and_not_more() -> None:
    assert overall([GOOD], [], {"top": 0.05, "bottom": 0.0}).verdict is Verdict.PASS
    found = overall([GOOD], [], {"top": 0.051})
    assert found.verdict is Verdict.UNDECIDED
    assert found.reasons == ("top: 5.1% of the window cannot be used, at most 5% may",)


def test_a_run_in_which_nothing_was_compared_says_the_reason_and_what_is_fatal() -> None:
    found = without_drive([FREE], [NOTE, WARNING, FATAL], "no drive")
    assert (found.metrics, found.verdict) == ((FREE,), Verdict.UNDECIDED)
    assert found.reasons == ("no drive", "encoder: no cycle")
