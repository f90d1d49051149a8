"""Slack, snaps, sections and sweeps on series small enough to be worked out by hand."""

from __future__ import annotations

import math
from fractions import Fraction
from statistics import NormalDist

import numpy as np
import pytest

from tethertest.records.across import StepVerdict
from tethertest.records.channel import Channel, Flag, Window
from tethertest.records.events import Front
from tethertest.records.lines import Event
from tethertest.signal.blocks import block_means
from tethertest.spectra.arrivals import find_front, find_kink
from tethertest.spectra.curve_steps import judge_steps
from tethertest.spectra.events import find_events
from tethertest.spectra.phase_portrait import portrait
from tethertest.spectra.regression import channel_blocks, fit_orders
from tethertest.spectra.side_lines import swings_phase
from tethertest.spectra.snaps import measured_snaps
from tethertest.spectra.stroboscopic_section import stroboscopic_section
from tethertest.spectra.wave_speed import wave_speed
from tethertest.spectra.waves import Medium

from .conftest import Maker, cosine


def snap(channel: Channel, start: float, top: float, value: float, medium: Medium | None = None):
    (found,) = measured_snaps(channel, [Event("snap", channel.name, start, top, value)], medium)
    return found


def test_a_snap_by_hand(channel: Maker) -> None:
    """Re-tightening at 1 s, peak of 10 N at 4 s; levels crossed on straight lines between samples."""
    values = np.array([0.0, 0.0, 2.0, 6.0, 10.0, 7.0, 3.0, 3.0, 3.0])
    found = snap(channel(np.arange(9.0), values), 1.0, 4.0, 10.0)
    # 1 N at 1.5 s, 9 N at 3.75 s
    assert found.rise_time == pytest.approx(2.25)
    assert found.rise_resolved
    # trapezoids 1 + 4 + 8 + 8.5, then from 7 N to 5 N in half a second
    assert found.impulse == pytest.approx(21.5 + 3.0)
    assert (found.peak, found.peak_time, found.front) == (10.0, 4.0, 10.0)
    assert found.speed is found.speed_interval is found.arrived_speed is None


def test_a_rise_within_two_samples_is_not_resolved(channel: Maker) -> None:
    values = np.array([0.0, 0.0, 10.0, 4.0, 3.0])
    found = snap(channel(np.arange(5.0), values), 1.0, 2.0, 10.0)
    assert found.rise_time == pytest.approx(0.8)
    assert not found.rise_resolved
    # 5 N, then from 10 N to 5 N in five sixths of a second
    assert found.impulse == pytest.approx(5.0 + 7.5 * 5.0 / 6.0)


def test_a_pulse_that_does_not_end_counts_to_the_end_of_what_is_looked_at(channel: Maker) -> None:
    time = np.arange(5.0) / 2.0
    found = snap(channel(time, np.array([0.0, 0.0, 10.0, 9.0, 8.0])), 0.5, 1.0, 10.0)
    assert found.impulse == pytest.approx(0.5 * (5.0 + 9.5))


def test_the_front_is_the_largest_rise_within_one_round_trip(channel: Maker) -> None:
    """Z = 2, 2 L/c = 2 s: from 2 N to 10 N in the two seconds before the peak."""
    values = np.array([0.0, 0.0, 2.0, 6.0, 10.0, 7.0, 3.0, 3.0, 3.0])
    medium = Medium(2.0, 10.0, 10.0)
    found = snap(channel(np.arange(9.0), values), 1.0, 4.0, 10.0, medium)
    assert (found.front, found.speed, found.arrived_speed) == (8.0, 4.0, 2.0)
    # second differences about the top are 0, -7 and -1: a top between samples may be 7 / 4 N higher
    assert found.speed_interval == pytest.approx((4.0, 4.0 + 1.75 / 2.0))
    assert found.peak_interval == pytest.approx((10.0, 11.75))


def test_scale_zero_and_noise_are_in_the_peaks_interval_in_square(channel: Maker) -> None:
    values = np.array([0.0, 0.0, 2.0, 6.0, 10.0, 7.0, 3.0, 3.0, 3.0])
    fields = {"uncertainty": 0.03, "offset_uncertainty": 0.4, "noise": 0.1}
    found = snap(channel(np.arange(9.0), values, **fields), 1.0, 4.0, 10.0, Medium(2.0, 10.0, 10.0))
    error, half = 0.5, 1.959964  # hypot(0.3, 0.4)
    low, high = found.peak_interval
    vying = 0.1 * half  # one sample only is about as high as the peak
    assert low == pytest.approx(10.0 - math.hypot(vying, half * error), rel=1e-6)
    assert high == pytest.approx(10.0 + math.hypot(half * math.hypot(error, 0.1), 1.75), rel=1e-6)
    assert found.speed_interval is not None
    width = half * math.hypot(0.03 * 4.0, math.sqrt(2.0) * 0.1 / 2.0)
    assert found.speed_interval[0] == pytest.approx(4.0 - width)
    assert found.speed_interval[1] == pytest.approx(4.0 + math.hypot(width, 0.875))


def test_of_several_samples_as_high_the_largest_is_too_large_by_their_noise(channel: Maker) -> None:
    values = np.array([0.0, 0.0, 9.7, 10.0, 9.65, 9.5, 3.0, 3.0])
    found = snap(channel(np.arange(8.0), values, noise=0.1), 1.0, 3.0, 10.0)
    # three within four standard deviations of the largest
    most = NormalDist().inv_cdf(NormalDist().cdf(1.959964) ** (1.0 / 3.0))
    assert found.peak_interval[0] == pytest.approx(10.0 - 0.1 * most)


def polygon(channel: Maker, *corners: float, **fields: float) -> Channel:
    """Straight lines between corners a second apart, at 1 kHz: the low-pass leaves them as they are."""
    time = np.arange(1000 * (len(corners) - 1) + 1) / 1000.0
    return channel(time, np.interp(time, np.arange(len(corners)), corners), **fields)


def test_slack_edges_are_interpolated_at_the_entering_threshold(channel: Maker) -> None:
    """Zero known to 0.5 N: slack within 1 N, taut again above 2 N."""
    record = polygon(channel, 5.0, 5.0, 3.0, 0.0, 0.5, 1.5, 0.5, 0.0, 4.0, 6.0, 5.0, 5.0)
    slack, found = find_events(record, 0.5)
    assert (slack.kind, found.kind) == ("slack", "snap")
    # from 3 N to 0 N: at 1 N two thirds of the way; from 0 N to 4 N: a quarter; 1.5 N between stays slack
    assert (slack.start, slack.stop) == pytest.approx((2.0 + 2.0 / 3.0, 7.25), abs=1e-3)
    assert slack.value == pytest.approx(0.0, abs=0.02)
    chopped = polygon(channel, 5.0, 5.0, 3.0, 0.0, 0.5, 2.5, 0.5, 0.0, 4.0, 6.0, 5.0, 5.0)
    spans = [(event.start, event.stop) for event in find_events(chopped, 0.5) if event.kind == "slack"]
    assert spans[0] == pytest.approx((2.0 + 2.0 / 3.0, 4.25), abs=1e-3)
    assert spans[1] == pytest.approx((5.75, 7.25), abs=1e-3)
    # the taut interval lasts 1.5 s: one no longer than asked for is none
    (merged,) = [event for event in find_events(chopped, 0.5, shortest=1.51) if event.kind == "slack"]
    assert (merged.start, merged.stop) == pytest.approx((2.0 + 2.0 / 3.0, 7.25), abs=1e-3)
    assert len([event for event in find_events(chopped, 0.5, shortest=1.49) if event.kind == "slack"]) == 2


def test_a_slack_interval_at_either_end_of_the_record_ends_there(channel: Maker) -> None:
    events = find_events(polygon(channel, 0.0, 0.0, 5.0, 5.0, 5.0, 0.0, 0.0, 0.0), 0.5)
    slack = [(event.start, event.stop) for event in events if event.kind == "slack"]
    assert slack[0] == pytest.approx((0.0, 1.2), abs=1e-3)
    assert slack[1] == pytest.approx((4.8, 7.0), abs=1e-3)


def test_the_zero_of_a_cell_is_its_own_and_the_usual_one_in_square(channel: Maker) -> None:
    # hypot(0.03, 0.04) = 0.05 N: slack within 0.1 N of zero; noise of 0.1 N leaves sqrt(0.3) of it
    for level, slack in ((0.099, True), (0.101, False)):
        record = polygon(channel, 3.0, level, level, level, 3.0, offset_uncertainty=0.04)
        assert bool(find_events(record)) is slack
    zero = 2.0 * math.hypot(0.03, 0.1 * math.sqrt(0.3))
    for level, slack in ((0.99 * zero, True), (1.01 * zero, False)):
        record = polygon(channel, 3.0, level, level, level, 3.0, noise=0.1)
        assert bool(find_events(record, 0.03)) is slack


def test_a_snap_is_looked_for_among_usable_samples(channel: Maker) -> None:
    time = np.arange(60) / 20.0
    values = np.where((time > 0.9) & (time < 1.5), 0.0, 4.0)
    values[31], values[32] = 40.0, 9.0
    spiked = channel(time, values).with_flags(np.arange(60) == 31, Flag.SPIKE)
    events = find_events(spiked, 0.03, shortest=0.1)
    assert [event.kind for event in events] == ["slack", "snap"]
    assert events[1].value == 9.0
    assert events[1].stop == pytest.approx(1.6)


# sections


def test_sections_one_and_two_periods_apart() -> None:
    time = np.arange(2001) / 50.0
    values = np.cos(2 * np.pi * time) + 0.3 * np.cos(np.pi * time)
    blocks = block_means(time, values, np.ones(time.size, dtype=bool), 50.0)
    section = stroboscopic_section(blocks, 1.0)
    assert section is not None
    # one period on the half order turns round: (2 x 0.3 cos)^2, on the mean over phases half of 0.36
    assert section.one == pytest.approx(0.18, rel=0.01)
    assert section.two == pytest.approx(0.0, abs=1e-3)
    short = block_means(time[:149], values[:149], np.ones(149, dtype=bool), 50.0)
    assert stroboscopic_section(short, 1.0) is None


def test_a_portrait_has_one_instant_a_period_and_240_points_a_period(channel: Maker) -> None:
    time = np.arange(1001) / 100.0
    found = portrait(channel(time, cosine(time, 1.0, 2.0)), Window(0.0, 10.0), 1.0)
    assert found.periods == 10
    assert found.values.size == 10 * 240 + 1
    assert found.section.size in {10, 11}
    assert np.diff(found.time) == pytest.approx(1.0)
    assert np.ptp(found.values) == pytest.approx(4.0, rel=0.02)
    assert np.ptp(found.rates) == pytest.approx(2.0 * 2.0 * 2.0 * np.pi, rel=0.03)
    assert found.step(1) == pytest.approx(0.0, abs=0.02)


def test_a_half_order_steps_one_period_apart_and_not_two(channel: Maker) -> None:
    time = np.arange(2001) / 100.0
    values = cosine(time, 1.0, 2.0) + cosine(time, 0.5, 0.4)
    found = portrait(channel(time, values), Window(0.0, 20.0), 1.0)
    assert found.step(1) > 0.6
    assert found.step(2) == pytest.approx(0.0, abs=0.02)


@pytest.mark.parametrize(("depth_of_phase", "swings"), [(True, True), (False, False)])
def test_a_swing_of_phase_is_told_from_a_swing_of_amplitude(
    channel: Maker, depth_of_phase: bool, swings: bool
) -> None:
    time = np.arange(4000) / 20.0
    slow = 0.1 * np.cos(2 * np.pi * 0.125 * time + 0.7)
    angle = 2 * np.pi * 0.25 * time + 0.3
    values = np.cos(angle + slow) if depth_of_phase else (1.0 + slow) * np.cos(angle)
    orders = (Fraction(1, 2), Fraction(1), Fraction(3, 2), Fraction(2))
    blocks = channel_blocks(channel(time, values), Window(0.0, 200.0), 0.25, 50.0)
    fit = fit_orders(blocks, 0.25, orders, 0.0)
    assert swings_phase(fit, Fraction(1, 2)) is swings
    assert swings_phase(fit, Fraction(3, 2)) is swings
    assert not swings_phase(fit, Fraction(1))
    assert not swings_phase(fit, Fraction(2))
    # an image that was not fitted is looked for in what is left
    without = fit_orders(blocks, 0.25, orders[:2], 0.0)
    assert swings_phase(without, Fraction(1, 2)) is swings


def test_one_line_alone_swings_both_alike_and_is_no_swing_of_phase(channel: Maker) -> None:
    time = np.arange(4000) / 20.0
    values = cosine(time, 0.25) + cosine(time, 0.125, 0.1)
    blocks = channel_blocks(channel(time, values), Window(0.0, 200.0), 0.25, 50.0)
    fit = fit_orders(blocks, 0.25, (Fraction(1, 2), Fraction(1), Fraction(3, 2)), 0.0)
    assert not swings_phase(fit, Fraction(1, 2))


# waves and sweeps


def test_a_kink_is_not_looked_for_where_other_waves_are_due(channel: Maker) -> None:
    time = np.arange(1000) / 100.0
    noise = 0.001 * np.random.default_rng(3).standard_normal(1000)
    values = np.maximum(time - 4.0, 0.0) + 0.5 * np.maximum(time - 7.0, 0.0) + noise
    record = channel(time, values, at=0.5)
    first = find_kink(record, Window(1.0, 9.0))
    assert first is not None
    assert first.time == pytest.approx(4.0, abs=0.02)
    # a span hides what is within six samples of it, and no more
    for span, seen in (((4.0, 4.0), 7.0), ((3.0, 3.93), 4.0), ((4.07, 5.0), 4.0), ((3.0, 3.96), 7.0)):
        found = find_kink(record, Window(1.0, 9.0), [span])
        assert found is not None
        assert found.time == pytest.approx(seen, abs=0.03)


def test_mass_and_tension_enter_what_a_speed_implies() -> None:
    fronts = [Front("a", 0.0, 0.0, (0.0, 0.0)), Front("b", 1.0, 0.5, (0.4, 0.6))]
    axial = wave_speed(fronts, "axial", 10.0, 2.0, mass_error=0.05, static_tension=30.0)
    assert axial.value == pytest.approx(2.0 * 20.0**2 - 30.0, rel=1e-3)
    half = 1.959964 * 0.05
    low, high = (10.0 / 0.6) ** 2, (10.0 / 0.4) ** 2
    assert axial.value_interval == pytest.approx(
        (2.0 * (1.0 - half) * low - 30.0, 2.0 * (1.0 + half) * high - 30.0), rel=1e-4
    )
    lateral = wave_speed(fronts[1:], "transverse", 10.0, 2.0, static_tension=30.0, at_bottom=0.0)
    assert (lateral.implied, axial.implied) == ("tension", "axial_stiffness")
    assert lateral.value == pytest.approx(800.0, rel=1e-3)


def test_a_lone_setting_is_told_by_the_two_settings_about_it() -> None:
    setting = np.arange(12.0)
    amplitude = 1.0 + 0.01 * setting
    for lone in (5, 2, 9):
        raised = np.where(setting == lone, 3.0, amplitude)
        (step,) = judge_steps(setting, raised, np.full(12, 1e-4), 0.01).steps
        assert step.verdict is StepVerdict.UNDECIDED
        assert step.interval == (lone - 1.0, lone + 1.0)
        assert "the setting between stands alone" in step.reason


def test_a_jump_is_between_two_settings_and_near_the_end_it_is_undecided() -> None:
    setting = np.arange(12.0)
    for gap, verdict in (
        (5, StepVerdict.JUMP),
        (2, StepVerdict.JUMP),
        (8, StepVerdict.JUMP),
        (9, None),
        (0, None),
    ):
        amplitude = np.where(setting > gap, 3.0, 1.0) + 0.01 * setting
        found = judge_steps(setting, amplitude, np.full(12, 1e-4), 0.01)
        (step,) = found.steps
        assert step.interval == (gap, gap + 1.0)
        assert step.verdict is (verdict or StepVerdict.UNDECIDED)
    falling = judge_steps(setting[::-1], amplitude[::-1], np.full(12, 1e-4), 0.01)
    assert falling.steps[0].interval == (0.0, 1.0)


def test_a_flank_twice_as_steep_as_its_neighbours_may_be_a_jump() -> None:
    setting = np.arange(12.0)
    for height, seen in ((2.0, True), (1.4, False)):
        amplitude = 1.0 + 0.1 * setting + 0.1 * (height - 1.0) * (setting > 5)
        steps = judge_steps(setting, amplitude, np.full(12, 1e-4), 0.01).steps
        assert [(step.interval, step.verdict) for step in steps] == (
            [((5.0, 6.0), StepVerdict.UNDECIDED)] if seen else []
        )


@pytest.mark.parametrize(("samples", "share"), [(5, 0.5), (10, 0.0)])
def test_a_front_of_two_early_samples_is_a_jump_between_two_and_of_more_a_ramp(
    channel: Maker, samples: int, share: float
) -> None:
    time = np.arange(400) / 100.0
    values = 3.0 + np.clip((time - 2.0) * 100.0 / samples, 0.0, 1.0)
    found = find_front(channel(time, values, at=0.0), Window(0.5, 3.5))
    assert found is not None
    assert (found.time - 2.0) * 100.0 == pytest.approx(share, abs=0.05)


def test_a_rise_is_timed_by_the_samples_own_stamps(channel: Maker) -> None:
    """As the first snap above, with the stamps of the rise uneven: 1 N at 1.5 s, 9 N at 3.875 s."""
    time = np.array([0.0, 1.0, 2.0, 3.5, 4.0, 5.5, 6.0, 7.0, 8.0])
    values = np.array([0.0, 0.0, 2.0, 6.0, 10.0, 7.0, 3.0, 3.0, 3.0])
    assert snap(channel(time, values), 1.0, 4.0, 10.0).rise_time == pytest.approx(2.375)
