"""A run held against its replay: each way to be wrong fails its own metric, each doubt is said."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tethertest.compare import compare
from tethertest.records.channel import Channel, ConditionedRun, Finding, Flag
from tethertest.records.comparison import Comparison, Metric, Verdict
from tethertest.records.rig import Limits

from .conftest import LIMITS, STATIC, WINDOW, Case, channels


def metric(comparison: Comparison, name: str, channel: str = "tension_top") -> Metric:
    return next(item for item in comparison.metrics if (item.name, item.channel) == (name, channel))


def test_the_right_replay_passes_and_names_the_nearest_limit(case: Case) -> None:
    comparison = case.against(channels())
    assert comparison.verdict is Verdict.PASS
    assert "all 10 metrics are inside their limits; nearest:" in comparison.reasons[0]
    assert abs(metric(comparison, "order_amplitude 1").error) < 0.002
    assert metric(comparison, "sprague_geers").error < 0.01
    assert "static 5 N removed from both" in metric(comparison, "sprague_geers").reason


def test_a_replay_ten_percent_large_fails_amplitude_with_a_positive_error(case: Case) -> None:
    comparison = case.against(channels(scale=1.1))
    assert comparison.verdict is Verdict.FAIL
    first = metric(comparison, "order_amplitude 1")
    assert first.verdict is Verdict.FAIL
    assert first.error == pytest.approx(0.1, abs=0.002)
    assert "limit 5 %: beyond by 5 %" in first.reason
    # the peak holds the static 5 N: 10 % of the dynamic part is 3 % of it
    assert metric(comparison, "peak_tension").error == pytest.approx(0.03, abs=0.005)
    assert metric(comparison, "sprague_geers_magnitude").error == pytest.approx(0.1, abs=0.003)


def test_a_late_replay_fails_phase_with_a_negative_error(case: Case) -> None:
    comparison = case.against(channels(lag=0.08))
    phase = metric(comparison, "order_phase 1")
    assert phase.verdict is Verdict.FAIL
    assert phase.error == pytest.approx(-2 * np.pi * 0.5 * 0.08, abs=0.005)
    assert metric(comparison, "order_amplitude 1").verdict is Verdict.PASS


def test_moved_parameters_make_the_input_uncertainty(case: Case) -> None:
    nominal = channels()
    moved = [channels(), channels(scale=1.03), channels(scale=0.96)]
    comparison = case.against(nominal, moved)
    first = metric(comparison, "order_amplitude 1")
    assert first.uncertainty == pytest.approx(0.05, rel=0.02)  # hypot(0.03, 0.04)
    assert first.verdict is Verdict.UNDECIDED
    assert comparison.verdict is Verdict.UNDECIDED
    assert metric(comparison, "peak_tension").uncertainty == pytest.approx(0.05 * 2.2 / 7.2, rel=0.1)


def test_the_mesh_makes_the_numerical_uncertainty(case: Case) -> None:
    # the nominal replay on the coarser mesh is 4 % larger, and so is the moved one: no input uncertainty
    comparison = case.against(channels(), [channels(scale=1.04), channels(scale=1.04)])
    first = metric(comparison, "order_amplitude 1")
    assert first.uncertainty == pytest.approx(0.04, rel=0.02)
    assert "rig 0 %, numerical 4 %" in first.reason


def test_a_limit_decided_simply_ignores_the_uncertainty(case: Case) -> None:
    moved = [channels(), channels(scale=1.05)]
    simple = replace(case, limits=replace(LIMITS, decision="simple"))
    assert simple.against(channels(), moved).verdict is Verdict.PASS
    assert case.against(channels(), moved).verdict is Verdict.UNDECIDED


def test_a_channel_that_is_missing_is_undecided_not_dropped(case: Case) -> None:
    comparison = case.against(channels()[:1])
    bottom = metric(comparison, "peak_tension", "tension_bottom")
    assert (bottom.verdict, bottom.limit) == (Verdict.UNDECIDED, 0.1)
    assert "not replayed" in bottom.reason
    assert comparison.verdict is Verdict.UNDECIDED
    lacking = replace(case, measured=replace(case.measured, channels=case.measured.channels[:1]))
    names = {item.name for item in lacking.against(channels()).metrics if item.channel == "tension_bottom"}
    assert {"peak_tension", "order_amplitude 1", "order_phase 1", "sprague_geers"} <= names


def test_a_fatal_finding_or_many_lost_samples_leave_the_run_undecided(case: Case) -> None:
    fatal = Finding("encoder", "ambiguous", "no tap chooses the cycle", "fatal")
    comparison = case.having(fatal).against(channels())
    assert comparison.verdict is Verdict.UNDECIDED
    assert comparison.reasons[0] == "encoder: no tap chooses the cycle"
    top, bottom = case.measured.channels
    lost = (top.time > 20.0) & (top.time < 24.0)
    spoiled = top.with_values(np.where(lost, 50.0, top.values)).with_flags(lost, Flag.SATURATED)
    holed = replace(case, measured=replace(case.measured, channels=(spoiled, bottom)))
    comparison = holed.against(channels())
    assert comparison.verdict is Verdict.UNDECIDED
    assert "tension_top: 10.0% of the window cannot be used" in comparison.reasons[0]
    # what is left is still right
    assert metric(comparison, "order_amplitude 1").verdict is Verdict.PASS
    assert metric(comparison, "peak_tension").verdict is Verdict.PASS


def test_a_run_without_drive_says_so_once_with_its_noise(case: Case) -> None:
    still = replace(channels(scale=0.0)[0], name="heave", kind="displacement", unit="m", at=0.0)
    quiet = ConditionedRun((*channels(scale=0.0, noise=0.01), still), (), (), None, None, None)
    comparison = compare(quiet, (), (), (), LIMITS)
    assert comparison.verdict is Verdict.UNDECIDED
    assert len(comparison.reasons) == 1
    assert "no drive: the run has no steady window; noise 0.01 N in tension_top" in comparison.reasons[0]
    assert metric(comparison, "sprague_geers").verdict is Verdict.UNDECIDED


def test_without_limits_nothing_can_pass(case: Case) -> None:
    comparison = replace(case, limits=Limits()).against(channels())
    assert comparison.verdict is Verdict.UNDECIDED
    assert "no metric has a limit" in comparison.reasons[0]


def test_an_order_that_is_on_neither_side_decides_nothing(case: Case) -> None:
    limits = replace(LIMITS, order_amplitude={"1": 0.05, "3": 0.1})
    comparison = replace(case, limits=limits).against(channels())
    third = metric(comparison, "order_amplitude 3")
    assert third.verdict is Verdict.INFORMATIVE
    assert "not significant in the measurement" in third.reason
    assert comparison.verdict is Verdict.PASS


def test_a_limit_on_an_order_that_the_noise_hides_is_undecided(case: Case) -> None:
    """The replay has it and the measurement cannot tell: less data must not turn a fail into a pass."""
    limits = replace(LIMITS, order_amplitude={"1": 0.05, "3": 0.1})
    hidden = tuple(
        replace(channel, values=channel.values + 2e-4 * np.cos(2.0 * np.pi * 1.5 * channel.time))
        for channel in channels()
    )
    comparison = replace(case, limits=limits).against(hidden)
    third = metric(comparison, "order_amplitude 3")
    assert third.verdict is Verdict.UNDECIDED
    assert third.limit == 0.1
    assert comparison.verdict is Verdict.UNDECIDED
    assert "its limit of 10 % cannot be judged" in comparison.reasons[0]


def test_strains_inform_and_never_fail(case: Case) -> None:
    strain, wrong = (
        replace(side, name="fbg1", kind="strain", unit="1", values=1e-4 * (side.values - 5.0), noise=1e-6)
        for side in (case.measured.channels[0], channels(scale=1.5)[0])
    )
    measured = replace(case.measured, channels=(*case.measured.channels, strain))
    comparison = replace(case, measured=measured).against((*channels(), wrong))
    first = metric(comparison, "order_amplitude 1", "fbg1")
    assert first.verdict is Verdict.INFORMATIVE
    assert first.error == pytest.approx(0.5, abs=0.01)
    assert comparison.verdict is Verdict.PASS


def test_slack_of_both_sides_is_held_side_by_side(case: Case) -> None:
    def clipped(side: tuple, below: float) -> tuple:
        return tuple(item.with_values(np.maximum(item.values - below, 0.0)) for item in side)

    measured = replace(case.measured, channels=clipped(channels(noise=0.0), 4.0))
    comparison = replace(case, measured=measured).against(clipped(channels(lag=0.05), 4.0))
    fraction, overlap = metric(comparison, "slack_fraction"), metric(comparison, "slack_overlap")
    assert fraction.measured == pytest.approx(fraction.replayed, abs=0.003)
    length = fraction.measured * 2.0  # of one interval, period 2 s
    assert overlap.error == pytest.approx((length - 0.05) / (length + 0.05) - 1.0, abs=0.02)
    assert metric(comparison, "slack_fraction").verdict is Verdict.INFORMATIVE


def test_static_tensions_of_the_case_are_those_of_the_signals(case: Case) -> None:
    for channel in case.measured.channels:
        inside = channel.between(WINDOW.start, WINDOW.stop)
        assert inside.values.mean() == pytest.approx(STATIC[channel.name], abs=0.01)


def test_rows_that_were_never_logged_leave_a_run_undecided(case: Case) -> None:
    top, bottom = case.measured.channels
    short = replace(case, measured=replace(case.measured, channels=(top.between(0.0, 30.0), bottom)))
    comparison = short.against(channels())
    assert comparison.verdict is Verdict.UNDECIDED
    assert "tension_top: 37.5% of the window cannot be used" in comparison.reasons[0]


def test_rows_that_were_never_logged_are_said_once_of_measurement_and_replay(case: Case) -> None:
    def holed(channel: Channel) -> Channel:
        kept = (channel.time < 20.0) | (channel.time > 24.0)
        return replace(
            channel, time=channel.time[kept], values=channel.values[kept], flags=channel.flags[kept]
        )

    measured = tuple(holed(channel) for channel in case.measured.channels)
    short = replace(case, measured=replace(case.measured, channels=measured))
    reasons = short.against(tuple(holed(channel) for channel in channels())).reasons
    assert "tension_top: 10.0% of the window cannot be used, at most 5% may" in reasons
    assert not any(reason.startswith("replay of") for reason in reasons)


def test_a_bottom_motion_with_too_many_holes_leaves_a_run_undecided(case: Case) -> None:
    top = case.measured.channels[0]
    heave = replace(top, name="heave", kind="displacement", unit="m", at=0.0)
    holed = heave.with_flags(np.arange(heave.time.size) % 10 == 0, Flag.MISSING)
    comparison = replace(
        case, measured=replace(case.measured, channels=(*case.measured.channels, holed))
    ).against(channels())
    assert comparison.verdict is Verdict.UNDECIDED
    assert "heave: 10.0% of the window cannot be used" in comparison.reasons[0]


def test_a_run_without_encoder_says_that_nothing_was_replayed(case: Case) -> None:
    comparison = compare(case.measured, (), (), (), LIMITS)
    assert comparison.verdict is Verdict.UNDECIDED
    assert "the bottom motion was not logged" in comparison.reasons[0]


def test_a_motion_that_is_unknown_for_too_long_leaves_a_run_undecided(case: Case) -> None:
    top, bottom = channels()
    unknown = top.with_flags((top.time > 20.0) & (top.time < 24.0), Flag.MISSING)
    comparison = case.against((unknown, bottom))
    assert comparison.verdict is Verdict.UNDECIDED
    assert comparison.reasons[0].startswith("replay of tension_top: 10.0% of the window cannot be used")
    assert not any("tension_bottom: 10.0%" in reason for reason in comparison.reasons)
    short = top.with_flags((top.time > 20.0) & (top.time < 21.0), Flag.MISSING)
    assert case.against((short, bottom)).verdict is Verdict.PASS
