"""Both sides brought to one time, one band, one window; noise and peaks against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

from tethertest.compare.alignment import pair_with, prepare
from tethertest.records.arrays import FloatArray
from tethertest.records.channel import Channel, Flag, Window
from tethertest.signal.filters import low_passed


def sampled(rate: float, values: FloatArray | None = None, start: float = 0.0, **fields: float) -> Channel:
    count = 400 if values is None else values.size
    time = start + np.arange(count) / rate
    held = np.ones(count) if values is None else values
    return Channel("tension_top", "tension", "N", time, held, np.zeros(count, dtype=np.uint16), **fields)


def test_the_window_holds_its_start_and_not_its_stop() -> None:
    band = prepare(sampled(100.0), Window(1.0, 2.0))
    assert band is not None
    assert (band.part.start, band.part.stop) == (100, 200)
    assert band.smooth.size == 100


def test_three_samples_are_the_fewest_that_compare_anything() -> None:
    assert prepare(sampled(100.0), Window(1.0, 1.015)) is None
    assert prepare(sampled(100.0), Window(1.0, 1.025)) is not None


def test_a_window_without_a_usable_sample_compares_nothing_whatever_lies_outside_it() -> None:
    lost = sampled(100.0)
    lost = lost.with_flags((lost.time >= 1.0) & (lost.time < 2.0), Flag.SATURATED)
    assert prepare(lost, Window(1.0, 2.0)) is None
    assert prepare(lost, Window(1.0, 2.1)) is not None


@pytest.mark.parametrize(("rate", "cutoff"), [(200.0, 30.0), (100.0, 30.0), (50.0, 20.0), (10.0, 4.0)])
def test_the_low_pass_is_30_hz_or_two_fifths_of_a_slow_rate(rate: float, cutoff: float) -> None:
    band = prepare(sampled(rate), Window(0.0, 2.0))
    assert band is not None
    assert band.cutoff == pytest.approx(cutoff)


@pytest.mark.parametrize("rate", [200.0, 1000.0])
def test_noise_in_the_band_is_what_the_low_pass_leaves_of_white_noise(rate: float) -> None:
    """The energy of the filter's answer to one sample is the share of white noise it keeps."""
    channel = sampled(rate, np.ones(1200), noise=0.3)
    band = prepare(channel, Window(0.5, 1.0))
    assert band is not None
    found = pair_with(band, channel)
    assert not isinstance(found, str)
    assert found.noise == pytest.approx(0.3 * np.sqrt(1.04 * 2.0 * 30.0 / rate))
    impulse = (np.arange(4001) == 2000).astype(np.float64)
    energy = np.sum(low_passed(impulse, rate, 30.0) ** 2)
    assert found.noise == pytest.approx(0.3 * np.sqrt(energy), rel=0.01)


@pytest.mark.parametrize(("rate", "samples"), [(200.0, 4), (1000.0, 20), (120.0, 2), (10.0, 1)])
def test_the_noise_of_a_peak_is_that_of_a_mean_over_20_ms(rate: float, samples: int) -> None:
    channel = sampled(rate, np.ones(1200), noise=0.3)
    band = prepare(channel, Window(0.2, 1.0))
    assert band is not None
    found = pair_with(band, channel)
    assert not isinstance(found, str)
    assert found.peak_noise == pytest.approx(0.3 / np.sqrt(samples))


def test_a_peak_is_the_largest_mean_over_20_ms_of_the_window_and_of_what_counts() -> None:
    # four samples of 8 N at 200 Hz: the mean over four samples about one of them holds half of the first
    index = np.arange(400)
    values = np.where((index >= 200) & (index < 204), 8.0, 0.0) + np.where(index < 50, 50.0, 0.0)
    channel = sampled(200.0, values)
    band = prepare(channel, Window(0.5, 1.5))
    assert band is not None
    # a replay is judged where the measurement counts, by the same mean
    replayed = sampled(200.0, 2.0 * values)
    found = pair_with(band, replayed)
    assert not isinstance(found, str)
    assert (found.measured_peak, found.replayed_peak) == pytest.approx((7.0, 14.0))
    flagged = channel.with_flags(index == 250, Flag.SATURATED)
    spoiled = flagged.with_values(np.where(index == 250, 99.0, values))
    again = prepare(spoiled, Window(0.5, 1.5))
    assert again is not None
    unspoiled = pair_with(again, channel)
    assert not isinstance(unspoiled, str)
    assert unspoiled.measured_peak == pytest.approx(7.0)


def test_nothing_counts_that_the_low_pass_mixes_with_a_long_hole_or_an_end() -> None:
    channel = sampled(200.0, np.ones(400))
    holed = channel.with_flags((channel.time > 0.9) & (channel.time < 1.1), Flag.SATURATED)
    single = holed.with_flags(np.isclose(channel.time, 0.5), Flag.SPIKE)
    band = prepare(single, Window(0.0, 2.0))
    assert band is not None
    found = pair_with(band, channel)
    assert not isinstance(found, str)
    # a thirtieth of a second about the last and first sample beside the hole, and inside both ends
    reach, time = 1.0 / 30.0, found.time
    spoiled = (time < reach) | (time > 1.995 - reach) | ((time > 0.9 - reach) & (time < 1.1 + reach))
    assert np.array_equal(found.usable, ~(spoiled | np.isclose(time, 0.5)))


def test_nothing_counts_where_the_replay_does_not_know_the_motion() -> None:
    channel = sampled(200.0, np.linspace(1.0, 2.0, 400))
    band = prepare(channel, Window(0.5, 1.5))
    assert band is not None
    replay = channel.with_flags(channel.time > 1.2, Flag.MISSING)
    found = pair_with(band, replay)
    assert not isinstance(found, str)
    assert found.time[found.usable].max() == pytest.approx(1.2)
    assert found.measured_peak == pytest.approx(found.replayed_peak)
    nowhere = pair_with(band, channel.with_flags(channel.time > 0.1, Flag.MISSING))
    assert isinstance(nowhere, str)
    assert "nothing is known of both sides" in nowhere


def test_a_replay_must_cover_the_window_to_one_sample() -> None:
    measured = sampled(100.0)
    band = prepare(measured, Window(1.0, 2.0))
    assert band is not None

    def covers(start: float, stop: float) -> bool:
        time = np.array([start, 1.5, stop])
        replay = Channel("tension_top", "tension", "N", time, np.ones(3), np.zeros(3, dtype=np.uint16))
        return not isinstance(pair_with(band, replay), str)

    # the window's samples run from 1.00 s to 1.99 s, and one is 0.01 s
    assert covers(1.009, 1.981)
    assert not covers(1.011, 1.99)
    assert not covers(1.0, 1.979)
    empty = measured.between(9.0, 10.0)
    assert empty.time.size == 0
    assert pair_with(band, empty) == "the replay does not cover the window"


def test_both_sides_pass_the_same_low_pass_at_the_measured_times() -> None:
    time = np.arange(400) / 100.0
    ramp = 3.0 + 0.5 * time
    measured = sampled(100.0, ramp + np.cos(2.0 * np.pi * 45.0 * time))
    band = prepare(measured, Window(1.0, 3.0))
    assert band is not None
    slower = np.arange(0.0, 4.0, 0.025)
    replay = Channel(
        "tension_top", "tension", "N", slower, 3.0 + 0.5 * slower, np.zeros(slower.size, dtype=np.uint16)
    )
    found = pair_with(band, replay)
    assert not isinstance(found, str)
    assert found.time[0] == pytest.approx(1.0)
    assert found.replayed == pytest.approx(3.0 + 0.5 * found.time, abs=1e-3)
    same = pair_with(band, measured)
    assert not isinstance(same, str)
    assert np.array_equal(same.measured, same.replayed)
    # what lies above the cut-off is gone from the measurement as well
    assert np.std(found.measured - found.replayed) < 0.1 * np.sqrt(0.5)


def test_samples_that_do_not_count_stay_marked() -> None:
    measured = sampled(100.0)
    holed = measured.with_flags(np.isin(np.arange(400), (120, 125)), Flag.SPIKE)
    band = prepare(holed, Window(1.0, 2.0))
    assert band is not None
    found = pair_with(band, measured)
    assert not isinstance(found, str)
    assert np.flatnonzero(~found.usable).tolist() == [20, 25]
