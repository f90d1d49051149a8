"""Zeros, hum, spikes and negative tensions at their thresholds, against values worked out by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tethertest.conditioning.clocks.coloured import noise_of
from tethertest.conditioning.flags.hum import hum_amplitude, with_hum_flagged
from tethertest.conditioning.flags.spikes import SpikeRule, with_spikes_flagged
from tethertest.conditioning.load_cells.tare import Level, rest_level, zeroed
from tethertest.conditioning.timestamps.jumps import without_jumps
from tethertest.records.arrays import FloatArray
from tethertest.records.channel import Channel, Flag, Window


def cell(values: FloatArray, rate: float = 100.0, **fields: object) -> Channel:
    values = np.asarray(values, dtype=np.float64)
    plain: dict[str, object] = {"name": "tension_top", "kind": "tension", "unit": "N"}
    flags = np.zeros(values.size, dtype=np.uint16)
    time = np.arange(values.size) / rate
    return Channel(**{**plain, **fields}, time=time, values=values, flags=flags)  # type: ignore[arg-type]


# zeros


def test_the_level_at_rest_is_the_median_of_means_over_a_quarter_second() -> None:
    # five means of 25 samples: 1, 2, 9, 3, 5; deviations from their median 3: 2, 1, 6, 0, 2
    values = np.repeat([1.0, 2.0, 9.0, 3.0, 5.0], 25)
    found = rest_level(cell(values), Window(0.0, 1.245))
    assert found is not None
    assert found.value == 3.0
    assert found.time == pytest.approx(0.62)
    assert found.error == pytest.approx(1.2533 * 1.4826 * 2.0 / np.sqrt(5.0), rel=1e-4)


def test_a_level_rests_on_usable_samples_of_the_window() -> None:
    values = np.concatenate((np.full(100, 7.0), np.full(100, 2.0)))
    flagged = cell(values).with_flags(np.arange(200) % 2 == 0, Flag.SPIKE)
    spoiled = flagged.with_values(np.where(np.arange(200) % 2 == 0, 50.0, values))
    found = rest_level(spoiled, Window(1.0, 1.995))
    assert found is not None
    assert found.value == 2.0
    assert rest_level(spoiled, None) is None
    assert rest_level(spoiled, Window(5.0, 6.0)) is None
    dead = cell(values).with_flags(np.ones(200, dtype=bool), Flag.STUCK)
    assert rest_level(dead, Window(0.0, 1.0)) is None
    few = rest_level(cell(values), Window(0.0, 0.025))
    assert few is not None
    assert (few.value, few.error) == (7.0, 0.0)


def test_two_levels_take_out_a_straight_line() -> None:
    before, after = Level(10.0, 5.4, 0.01), Level(30.0, 5.6, 0.03)
    channel = replace(cell(np.full(401, 6.0), rate=10.0), offset_uncertainty=0.04)
    found, findings = zeroed(channel, before, after, 5.0, 0.25)
    # 0.4 N at 10 s and 0.6 N at 30 s
    at = {seconds: float(found.values[seconds * 10]) for seconds in (0, 10, 20, 30, 40)}
    assert at == pytest.approx({0: 5.7, 10: 5.6, 20: 5.5, 30: 5.4, 40: 5.3})
    assert not findings
    # a drift of 0.2 N, of which half either way is not known: a rectangle
    expected = np.linalg.norm([0.04, 0.01, 0.2 / np.sqrt(12.0)])
    assert found.offset_uncertainty == pytest.approx(float(expected))


@pytest.mark.parametrize(
    ("before", "after"), [(Level(10.0, 5.4, 0.01), None), (None, Level(30.0, 5.4, 0.01))]
)
def test_one_level_takes_out_a_constant(before: Level | None, after: Level | None) -> None:
    found, findings = zeroed(cell(np.full(401, 6.0), rate=10.0), before, after, 5.0, 0.25)
    assert found.values == pytest.approx(5.6)
    assert found.offset_uncertainty == pytest.approx(0.01)
    assert not findings


def test_a_drift_up_to_what_is_allowed_is_not_flagged() -> None:
    channel = cell(np.full(401, 6.0), rate=10.0)
    for drift, flagged in ((0.25, False), (-0.25, False), (0.2501, True), (-0.2501, True)):
        found, findings = zeroed(channel, Level(0.0, 5.0, 0.0), Level(40.0, 5.0 + drift, 0.0), 5.0, 0.25)
        assert bool(findings) is flagged
        assert bool(np.all(found.flags == Flag.DRIFT)) is flagged
        if flagged:
            assert (findings[0].kind, findings[0].samples, findings[0].spans) == (
                "drift",
                401,
                ((0.0, 40.0),),
            )
            assert findings[0].severity == "warning"


def test_without_rest_the_records_median_is_set_and_a_cell_decides_nothing() -> None:
    values = np.array([1.0, 2.0, 9.0, 4.0, 100.0])
    channel = cell(values).with_flags(np.arange(5) == 4, Flag.SPIKE)
    found, (finding,) = zeroed(channel, None, None, 5.0, 0.1)
    assert found.values[:4] == pytest.approx(values[:4] - 3.0 + 5.0)
    assert (finding.kind, finding.severity) == ("no_tare", "fatal")
    grating = replace(channel, kind="strain")
    assert zeroed(grating, None, None, 0.0, 0.1)[1][0].severity == "warning"


# hum


def test_hum_is_the_amplitude_of_its_line_and_its_surroundings_are_beside_it() -> None:
    time = np.arange(4000) / 1000.0
    hummed = cell(5.0 + 0.02 * np.cos(2 * np.pi * 50.0 * time + 0.3), rate=1000.0)
    line, around = hum_amplitude(hummed, 50.0, [Window(0.0, 3.9995)])
    assert line == pytest.approx(0.02, rel=0.01)
    assert around == pytest.approx(0.0, abs=2e-4)
    # 5 Hz away it is no hum, but the surroundings
    beside = cell(0.02 * np.cos(2 * np.pi * 55.0 * time), rate=1000.0)
    assert hum_amplitude(beside, 50.0, [Window(0.0, 3.9995)])[0] < 1e-3
    assert hum_amplitude(hummed, 50.0, []) == (0.0, 0.0)
    assert hum_amplitude(hummed, 50.0, [Window(0.0, 0.5)]) == (0.0, 0.0)


def test_a_log_too_slow_for_the_mains_and_their_surroundings_shows_no_hum() -> None:
    for rate, seen in ((116.0, True), (115.0, False)):  # 50 Hz and 8 Hz beside it
        time = np.arange(int(4 * rate)) / rate
        hummed = cell(0.02 * np.cos(2 * np.pi * 50.0 * time), rate=rate)
        assert (hum_amplitude(hummed, 50.0, [Window(0.0, 4.0)])[0] > 0.0) is seen


def test_hum_is_flagged_above_its_surroundings_and_above_what_does_harm() -> None:
    time = np.arange(4000) / 1000.0
    hummed = cell(5.0 + 0.02 * np.cos(2 * np.pi * 50.0 * time), rate=1000.0)
    windows = [Window(0.0, 3.9995)]
    # 0.65 of the sensor's noise: 0.02 N are harmless beside 0.0312 N
    flagged, (finding,) = with_hum_flagged(hummed, 50.0, 0.0300, windows)
    assert np.all(flagged.flags == Flag.HUM)
    assert (finding.kind, finding.samples) == ("hum", 4000)
    assert with_hum_flagged(hummed, 50.0, 0.0315, windows)[1] == ()
    noise = 0.15 * np.random.default_rng(3).standard_normal(4000)
    assert with_hum_flagged(cell(hummed.values + noise, rate=1000.0), 50.0, 0.0, windows)[1] == ()


# spikes


def quiet(size: int = 2000, seed: int = 5) -> FloatArray:
    return 5.0 + 0.01 * np.random.default_rng(seed).standard_normal(size)


@pytest.mark.parametrize("width", [1, 2, 3])
def test_one_to_three_samples_far_from_their_neighbours_are_a_spike(width: int) -> None:
    values = quiet()
    values[700 : 700 + width] += 1.0
    (found,) = with_spikes_flagged([cell(values, rate=1000.0)])
    assert np.flatnonzero(found.flags & Flag.SPIKE).tolist() == list(range(700, 700 + width))


def test_four_samples_a_step_or_a_slow_top_are_no_spike() -> None:
    four, step, slow = quiet(), quiet(), quiet()
    four[700:704] += 1.0
    step[700:] += 1.0
    slow[690:711] += 1.0 - np.abs(np.arange(-10, 11)) / 10.0
    for values in (four, step, slow):
        (found,) = with_spikes_flagged([cell(values, rate=1000.0)])
        assert not np.any(found.flags & Flag.SPIKE)


def test_a_spike_lasts_three_milliseconds_at_most_but_always_one_sample() -> None:
    values = quiet()
    values[700:702] += 1.0
    for rate, found_there in ((1000.0, True), (700.0, True), (600.0, False), (100.0, False)):
        (found,) = with_spikes_flagged([cell(values, rate=rate)])
        assert bool(np.any(found.flags & Flag.SPIKE)) is found_there
    values[701] = 5.0
    (found,) = with_spikes_flagged([cell(values, rate=100.0)])
    assert np.flatnonzero(found.flags).tolist() == [700]


def test_a_spike_is_twelve_standard_deviations_high() -> None:
    for height, seen in ((0.115, False), (0.125, True)):
        values = np.full(2000, 5.0)
        values[700] += height
        spikes = SpikeRule(0.01, np.zeros(0)).spikes(cell(values, rate=1000.0), ())
        assert bool(np.any(spikes)) is seen


def test_what_two_channels_show_within_a_waves_delay_is_no_spike() -> None:
    for apart, kept in ((7, True), (-7, True), (10, False), (-10, False)):
        first, second = quiet(seed=1), quiet(seed=2)
        first[700] += 1.0
        second[700 + apart] += 0.3
        channels = [cell(first, rate=1000.0), cell(second, rate=1000.0, name="tension_bottom")]
        found = with_spikes_flagged(channels)[0]
        assert bool(np.any(found.flags & Flag.SPIKE)) is not kept
        # another kind of channel says nothing about it
        other = [channels[0], replace(channels[1], kind="strain")]
        assert np.any(with_spikes_flagged(other)[0].flags & Flag.SPIKE)


def test_the_same_far_value_three_times_alone_is_a_lost_sample_each_time() -> None:
    values = quiet()
    values[[300, 900, 1500]] = 0.0
    # of a run of many each hides the others from a look around; only the repeated value gives them away
    values[300:1900:40] = 0.0
    (found,) = with_spikes_flagged([cell(values, rate=1000.0)])
    assert np.count_nonzero(found.flags & Flag.SPIKE) == np.count_nonzero(values == 0.0)


def test_samples_beside_a_hole_are_no_spike() -> None:
    values = quiet()
    values[700] += 1.0
    channel = cell(values, rate=1000.0).with_flags(np.arange(2000) == 702, Flag.MISSING)
    (found,) = with_spikes_flagged([channel])
    assert not np.any(found.flags & Flag.SPIKE)
    far = cell(values, rate=1000.0).with_flags(np.arange(2000) == 704, Flag.MISSING)
    assert np.any(with_spikes_flagged([far])[0].flags & Flag.SPIKE)


# noise of sums


def test_sums_over_white_noise_have_its_variance() -> None:
    random = np.random.default_rng(6)
    columns = np.column_stack((np.ones(4000), np.cos(np.arange(4000) / 7.0)))
    found = [noise_of(0.3 * random.standard_normal(4000), 4000, 0, 0.01, np.inf) for _ in range(10)]
    assert np.mean([noise.variance for noise in found]) == pytest.approx(0.09, rel=0.03)
    assert np.mean([noise.independent for noise in found]) == pytest.approx(4000, rel=0.1)
    covariance = np.mean([noise.covariance(columns) for noise in found], axis=0)
    assert covariance == pytest.approx(0.09 * columns.T @ columns, rel=0.15, abs=10.0)


def test_fitted_parameters_took_their_share_of_the_variance() -> None:
    residual = 0.3 * np.random.default_rng(7).standard_normal(400)
    plain, fitted = (noise_of(residual, 400, count, 0.01, np.inf) for count in (0, 40))
    ratio = plain.independent / (plain.independent - 40.0)
    assert fitted.variance / plain.variance == pytest.approx(ratio)


def test_noise_that_lasts_has_fewer_independent_samples() -> None:
    random = np.random.default_rng(8)
    held = np.repeat(random.standard_normal(1000), 4)
    found = noise_of(held, 4000, 0, 0.01, np.inf)
    # a value held for four samples: the sum of squared correlations is 1 + 2 (9 + 4 + 1) / 16
    assert found.independent == pytest.approx(4000 / 2.75, rel=0.15)


def test_samples_that_are_not_known_do_not_dilute_the_variance() -> None:
    residual = 0.3 * np.random.default_rng(9).standard_normal(4000)
    residual[2000:] = 0.0
    assert noise_of(residual, 2000, 0, 0.01, np.inf).variance == pytest.approx(0.09, rel=0.1)


def test_an_answer_is_six_standard_deviations_high() -> None:
    for height, kept in ((0.055, False), (0.065, True)):
        first, second = np.full(2000, 5.0), np.full(2000, 5.0)
        first[700] += 1.0
        second[703] += height
        other = cell(second, rate=1000.0, name="tension_bottom")
        spikes = SpikeRule(0.01, np.zeros(0)).spikes(cell(first, rate=1000.0), [(other, 0.01)])
        assert bool(np.any(spikes)) is not kept


@pytest.mark.parametrize("place", [2, 3, 1996, 1997])
def test_a_spike_near_an_end_of_the_record_is_one(place: int) -> None:
    values = quiet()
    values[place] += 1.0
    (found,) = with_spikes_flagged([cell(values, rate=1000.0)])
    assert np.flatnonzero(found.flags).tolist() == [place]


# leaps of the stamps


def leapt(values: FloatArray, lost: int, leap: float) -> Channel:
    """Return a record whose stamps leap at its middle, with so many rows left out there."""
    half = values.size // 2
    kept = np.delete(values, slice(half, half + lost))
    time = np.arange(kept.size) / 500.0 + np.where(np.arange(kept.size) >= half, leap, 0.0)
    channel = Channel("tension_top", "tension", "N", time, kept, np.zeros(kept.size, dtype=np.uint16))
    return channel.with_flags(np.arange(kept.size) == half, Flag.GAP)


def test_signals_that_go_on_across_a_leap_show_a_jump_and_lost_rows_a_gap() -> None:
    time = np.arange(10_000) / 500.0
    moving = np.sin(2 * np.pi * 0.2 * time) + 0.01 * np.random.default_rng(3).standard_normal(time.size)
    (jumped,), (finding,) = without_jumps([leapt(moving, 0, 0.4)], "daq")
    assert finding.kind == "clock_jump"
    assert finding.text.startswith("the clock jumps by +0.4 s at 9.998 s")
    assert np.diff(jumped.time) == pytest.approx(0.002)
    assert np.flatnonzero(jumped.flags & Flag.CLOCK_JUMP).tolist() == [5000]
    assert not np.any(jumped.flags & Flag.GAP)
    (kept,), (finding,) = without_jumps([leapt(moving, 200, 0.4)], "daq")
    assert (finding.kind, finding.samples) == ("gap", 200)
    assert finding.text == "200 rows are missing in 1 gaps, the longest 0.402 s"
    assert np.max(np.diff(kept.time)) == pytest.approx(0.402)


def test_a_signal_at_rest_does_not_tell_and_a_short_leap_is_lost_rows() -> None:
    still = 0.01 * np.random.default_rng(4).standard_normal(10_000)
    assert without_jumps([leapt(still, 0, 0.4)], "daq")[1][0].kind == "gap"
    time = np.arange(10_000) / 500.0
    moving = np.sin(2 * np.pi * 0.25 * time) + 3e-3 * np.random.default_rng(3).standard_normal(time.size)
    for leap, kind in ((0.051, "clock_jump"), (0.049, "gap")):
        assert without_jumps([leapt(moving, 0, leap)], "daq")[1][0].kind == kind
