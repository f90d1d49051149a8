from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from tethertest.errors import DataError
from tethertest.signal.filters import filled, low_passed, moving_mean, resampled, without_line
from tethertest.signal.noise import quantum, white_noise


@dataclass
class Record:
    time: np.ndarray
    values: np.ndarray
    usable: np.ndarray
    rate: float


def record(values, rate=100.0, bad=()):
    usable = np.ones(len(values), bool)
    usable[list(bad)] = False
    return Record(np.arange(len(values)) / rate, np.asarray(values, float), usable, rate)


def test_low_pass_has_half_power_at_its_cutoff_and_no_delay():
    time = np.arange(20_000) / 1000.0
    wave = np.sin(2 * np.pi * 20.0 * time)
    passed = low_passed(wave, 1000.0, 20.0)[5000:15_000]
    inner = wave[5000:15_000]
    assert np.dot(passed, inner) / np.dot(inner, inner) == pytest.approx(np.sqrt(0.5), abs=0.005)
    quadrature = np.cos(2 * np.pi * 20.0 * time)[5000:15_000]
    assert np.dot(passed, quadrature) / np.dot(inner, inner) == pytest.approx(0.0, abs=1e-3)


def test_low_pass_refuses_a_cutoff_of_zero_and_passes_all_near_nyquist():
    with pytest.raises(DataError, match="above zero"):
        low_passed(np.ones(10), 100.0, 0.0)
    values = np.arange(10.0)
    assert low_passed(values, 100.0, 49.0) is values


def test_filled_draws_straight_lines_and_needs_a_sample():
    np.testing.assert_allclose(filled(record([0, 9, 9, 3, 4], bad=(1, 2))), [0, 1, 2, 3, 4])
    with pytest.raises(DataError, match="no usable sample"):
        filled(record([1, 2], bad=(0, 1)))


def test_resampled_leaves_holes_holes():
    series = record(np.arange(10.0), rate=1.0, bad=(4, 5, 6))
    values = resampled(series, np.array([-1.0, 2.5, 3.0, 4.0, 6.5, 7.0, 9.5]))
    np.testing.assert_array_equal(values, [np.nan, 2.5, 3.0, np.nan, np.nan, 7.0, np.nan])


def test_moving_mean_over_a_part_of_a_sample_is_blind_to_a_whole_cycle():
    wave = np.sin(2 * np.pi * np.arange(2000) / 37.4)
    assert np.max(np.abs(moving_mean(wave, 37.4)[50:-50])) < 2e-3
    np.testing.assert_allclose(moving_mean(np.arange(50.0), 5)[5:-5], np.arange(50.0)[5:-5])


def test_without_line_takes_hum_and_leaves_its_neighbours():
    time = np.arange(10_000) / 1000.0
    signal = np.sin(2 * np.pi * 12.0 * time)
    cleaned = without_line(time, signal + 0.3 * np.sin(2 * np.pi * 50.0 * time + 1.0), 50.0, 1.0)
    assert np.max(np.abs(cleaned - signal)[1000:-1000]) < 2e-3


def test_white_noise_sees_through_motion_and_snaps():
    random = np.random.default_rng(7)
    time = np.arange(60_000) / 1000.0
    values = 5.0 * np.sin(2 * np.pi * 3.0 * time) + random.normal(0.0, 0.015, time.size)
    values[30_000:30_040] += 20.0 * np.sin(np.pi * np.arange(40) / 40.0)
    assert white_noise(values) == pytest.approx(0.015, rel=0.05)


def test_noise_is_not_below_the_rounding():
    rounded = np.round(np.linspace(0.0, 1.0, 5000), 2)
    assert quantum(rounded) == pytest.approx(0.01)
    assert white_noise(rounded) == pytest.approx(0.01 / np.sqrt(12.0), rel=0.01)
