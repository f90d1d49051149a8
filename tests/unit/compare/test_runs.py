"""What of a run is compared, against what, and what is said where something is missing."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

from tethertest.compare import compare
from tethertest.compare.metrics import slack_metrics
from tethertest.records.channel import Channel, ClockFit, ConditionedRun, Finding, Flag, Window
from tethertest.records.comparison import Comparison, Metric, Verdict
from tethertest.records.rig import Limits

from . import subjects
from .conftest import LIMITS, STATIC, WINDOW, Case, channels


def metric(comparison: Comparison, name: str, channel: str = "tension_top") -> Metric:
    return next(item for item in comparison.metrics if (item.name, item.channel) == (name, channel))


def having(case: Case, *found: Channel) -> Case:
    return replace(case, measured=replace(case.measured, channels=(*case.measured.channels, *found)))


def test_the_worst_clock_of_the_run_makes_every_phase_uncertain(case: Case) -> None:
    clocks = tuple(
        ClockFit(name, "tension", 0.0, offset_error, 0.0, 0.0, "edges")
        for name, offset_error in (("encoder", 0.03), ("gratings", 0.01))
    )
    fitted = replace(case, measured=replace(case.measured, clocks=clocks))
    plain, found = (metric(item.against(channels()), "order_phase 1") for item in (case, fitted))
    assert found.uncertainty == pytest.approx(np.hypot(plain.uncertainty, 2 * np.pi * 0.5 * 0.03), rel=1e-4)
    assert plain.uncertainty < 0.001


def test_tensions_and_strains_are_compared_and_nothing_else(case: Case) -> None:
    top, replayed = case.measured.channels[0], channels()
    others = [
        replace(top, name=name, kind=kind, unit=unit)
        for name, kind, unit in (
            ("fbg1", "strain", "1"),
            ("shake", "acceleration", "m/s^2"),
            ("t", "other", "1"),
        )
    ]
    comparison = having(case, *others).against((*replayed, replace(replayed[0], name="fbg1", kind="strain")))
    assert {item.channel for item in comparison.metrics} == {"tension_top", "tension_bottom", "fbg1"}
    names = {item.name for item in comparison.metrics if item.channel == "fbg1"}
    assert "sprague_geers" in names
    assert not names & {"peak_tension", "slack_fraction"}
    assert {"peak_tension", "slack_fraction"} <= {
        item.name for item in comparison.metrics if item.channel == "tension_top"
    }


def test_a_strain_with_many_lost_samples_decides_nothing(case: Case) -> None:
    top, replayed = case.measured.channels[0], channels()
    strain = replace(top, name="fbg1", kind="strain", unit="1")
    lost = strain.with_flags((top.time > 20.0) & (top.time < 30.0), Flag.LOST)
    comparison = having(case, lost).against((*replayed, replace(replayed[0], name="fbg1", kind="strain")))
    assert comparison.verdict is Verdict.PASS


def test_the_static_tension_is_that_of_the_channel(case: Case) -> None:
    comparison = case.against(channels())
    for name, static in STATIC.items():
        reason = metric(comparison, "sprague_geers", name).reason
        assert f"static {static:g} N removed from both" in reason


def test_variations_that_lack_a_channel_are_left_out_of_its_budget(case: Case) -> None:
    nominal, moved = channels(), channels(scale=1.05)
    comparison = case.against(channels(), [nominal, moved[:1]])
    assert "rig 5 %" in metric(comparison, "order_amplitude 1").reason
    assert "rig 0 %" in metric(comparison, "order_amplitude 1", "tension_bottom").reason


def test_a_channel_that_cannot_be_paired_says_why(case: Case) -> None:
    top, bottom = case.measured.channels
    late = tuple(item.between(20.0, 50.0) for item in channels())
    uncovered = metric(case.against(late), "peak_tension")
    assert uncovered.reason == "the replay does not cover the window from 5 s to 45 s"
    assert (uncovered.verdict, uncovered.limit, uncovered.unit) == (Verdict.UNDECIDED, 0.1, "N")
    dead = top.with_flags((top.time > 4.0) & (top.time < 46.0), Flag.STUCK)
    lines = case.against(channels()).metrics  # the case itself is sound
    assert lines
    holed = ConditionedRun((dead, bottom), (), (), None, None, WINDOW)
    comparison = compare(holed, channels(), _lines(bottom), (), LIMITS)
    assert metric(comparison, "peak_tension").reason == "no usable sample in the window from 5 s to 45 s"
    lacking = ConditionedRun((bottom,), (), (), None, None, WINDOW)
    absent = compare(lacking, channels(), _lines(bottom), (), LIMITS)
    assert metric(absent, "peak_tension").reason == "the run has no such channel"
    assert metric(absent, "peak_tension").limit == 0.1


def _lines(channel: Channel) -> tuple:
    drive = subjects.lines(subjects.line("1", 2.0, 0.4, 0.001))
    return (replace(drive, channel=channel.name, window=WINDOW),)


def test_every_metric_that_could_not_be_formed_keeps_its_own_limit_and_unit(case: Case) -> None:
    limits = replace(LIMITS, order_amplitude={"1": 0.05, "10": 0.2}, order_phase={"3/2": 0.3})
    strain = replace(case.measured.channels[0], name="fbg1", kind="strain", unit="1")
    run = replace(having(case, strain).measured, steady=None)
    comparison = compare(run, channels(), (), (), limits)
    rows = {
        item.name: (item.unit, item.limit) for item in comparison.metrics if item.channel == "tension_top"
    }
    assert rows == {
        "peak_tension": ("N", 0.1),
        "order_amplitude 1": ("N", 0.05),
        "order_amplitude 2": ("N", None),
        "order_amplitude 3": ("N", None),
        "order_amplitude 10": ("N", 0.2),
        "order_phase 1": ("rad", None),
        "order_phase 3/2": ("rad", 0.3),
        "sprague_geers": ("1", 0.15),
    }
    informing = [item for item in comparison.metrics if item.channel == "fbg1"]
    assert {item.limit for item in informing} == {None}
    assert {item.name for item in informing} == {*rows} - {"peak_tension"}
    assert {item.unit for item in informing} == {"1", "rad"}


def test_only_what_is_fatal_is_told_beside_a_run_without_a_window(case: Case) -> None:
    run = replace(
        case.measured,
        steady=None,
        findings=(Finding("a", "drift", "drifts"), Finding("b", "lost", "is lost", "fatal")),
    )
    comparison = compare(run, channels(), (), (), LIMITS)
    assert comparison.reasons == (
        "no drive: the run has no steady window; noise 0.01 N in tension_top, 0.01 N in tension_bottom",
        "b: is lost",
    )


def test_a_run_without_a_fitted_line_has_no_drive(case: Case) -> None:
    other = subjects.lines(subjects.line("2", 0.3))
    comparison = compare(case.measured, channels(), (other,), (), LIMITS)
    assert comparison.reasons[0].startswith("no drive: no line of it was fitted; noise 0.01 N")
    found = compare(case.measured, channels(), (other, *_lines(case.measured.channels[0])), (), LIMITS)
    assert "no drive" not in " ".join(found.reasons)


def test_noise_is_estimated_where_the_channel_states_none(case: Case) -> None:
    unsaid = tuple(replace(item, noise=0.0) for item in case.measured.channels)
    dead = replace(unsaid[1], flags=np.full(unsaid[1].time.size, int(Flag.STUCK), dtype=np.uint16))
    run = ConditionedRun((unsaid[0], dead), (), (), None, None, None)
    reason = compare(run, channels(), (), (), LIMITS).reasons[0]
    assert re.search(r"noise 0\.0(10|10\d*|09\d) N in tension_top$", reason)
    strain = replace(unsaid[0], name="fbg1", kind="strain", unit="1")
    only = ConditionedRun((strain,), (), (), None, None, None)
    assert compare(only, channels(), (), (), LIMITS).reasons[0].endswith("noise unknown, no tension channel")


def test_a_motion_of_one_sample_has_no_rate_and_covers_nothing(case: Case) -> None:
    top, replayed = case.measured.channels[0], channels()
    still = replace(top.between(6.0, 6.0), name="heave", kind="displacement", unit="m")
    assert still.time.size == 1
    run = having(case, still).measured
    comparison = compare(run, replayed, _lines(top), _lines(replayed[0]), LIMITS)
    assert comparison.reasons[0].startswith("heave: 100.0% of the window cannot be used")


# slack, side by side


def slackening(*spans: tuple[float, float]) -> Channel:
    time = np.arange(20_001) / 1000.0
    slack = np.zeros(time.size, dtype=bool)
    for start, stop in spans:
        slack |= (time >= start) & (time < stop)
    values = np.where(slack, 0.0, 5.0)
    return Channel("tension_top", "tension", "N", time, values, np.zeros(time.size, dtype=np.uint16))


def slack_of(measured: Channel, replayed: Channel, window: Window) -> dict[str, Metric]:
    sides = subjects.subject(measured=measured, replayed=replayed, window=window)
    return {item.name: item for item in slack_metrics(sides, 0.03)}


def test_slack_is_a_share_of_the_window_and_what_both_sides_share_of_what_either_has() -> None:
    found = slack_of(slackening((4.0, 6.0)), slackening((5.0, 8.0)), Window(0.0, 20.0))
    fraction, overlap = found["slack_fraction"], found["slack_overlap"]
    assert (fraction.measured, fraction.replayed) == pytest.approx((0.1, 0.15), abs=5e-4)
    assert fraction.error == pytest.approx(0.05, abs=5e-4)
    assert overlap.error == pytest.approx(1.0 / 4.0 - 1.0, abs=0.003)
    assert "slack measured 10.0" in fraction.reason or "slack measured 9.9" in fraction.reason
    assert {fraction.verdict, overlap.verdict} == {Verdict.INFORMATIVE}
    assert {fraction.limit, overlap.limit} == {None}
    assert (fraction.uncertainty, overlap.uncertainty) == (0.0, 0.0)


def test_slack_counts_inside_the_window_only() -> None:
    sides = slackening((1.0, 3.0), (9.0, 11.0)), slackening((1.0, 2.5), (9.5, 11.0), (15.0, 16.0))
    found = slack_of(*sides, Window(2.0, 10.0))
    fraction = found["slack_fraction"]
    assert (fraction.measured, fraction.replayed) == pytest.approx((2.0 / 8.0, 1.0 / 8.0), abs=1e-3)
    assert found["slack_overlap"].error == pytest.approx(1.0 / 2.0 - 1.0, abs=0.005)


def test_slack_on_one_side_only_overlaps_nothing() -> None:
    found = slack_of(slackening((4.0, 6.0)), slackening(), Window(0.0, 20.0))
    assert found["slack_overlap"].error == -1.0
    assert found["slack_fraction"].error == pytest.approx(-0.1, abs=5e-4)


def test_without_slack_there_is_one_row_that_says_so() -> None:
    found = slack_of(slackening(), slackening(), Window(0.0, 20.0))
    (fraction,) = found.values()
    assert (fraction.measured, fraction.replayed, fraction.error) == (0.0, 0.0, 0.0)
    assert fraction.reason == "no slack on either side"


def test_the_zero_of_the_cells_is_passed_to_the_search_for_slack(case: Case) -> None:
    low = tuple(item.with_values(np.maximum(item.values - 4.0, 0.15)) for item in channels())
    run = replace(case.measured, channels=low)
    lines = _lines(low[0])
    sure, unsure = (compare(run, low, lines, lines, Limits(), zero_uncertainty=zero) for zero in (0.01, 0.1))
    assert metric(sure, "slack_fraction").reason == "no slack on either side"
    assert metric(unsure, "slack_fraction").measured > 0.1
