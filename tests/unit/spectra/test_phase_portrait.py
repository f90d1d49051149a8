"""One point for period one, two for period two, exact counts of periods; spectrograms show what is there."""

from __future__ import annotations

import numpy as np
import pytest

from tethertest.errors import DataError
from tethertest.records.channel import Window
from tethertest.spectra.order_spectrogram import MOST_COLUMNS, order_spectrogram
from tethertest.spectra.phase_portrait import portrait

from .conftest import Maker, cosine

DRIVE = 0.25
NOISE = 0.01


@pytest.mark.parametrize("rate", [2.0, 10.0, 100.0])
@pytest.mark.parametrize("extra", [0, 1])
@pytest.mark.parametrize("start", [0.0, 1234.5])
def test_ten_periods_are_ten_points(channel: Maker, rate: float, extra: int, start: float) -> None:
    """With and without the sample that closes the last period: a sample lasts up to the next."""
    time = start + np.arange(round(10.0 / DRIVE * rate) + extra) / rate
    seen = portrait(channel(time, cosine(time, DRIVE)), Window(start, start + 10.0 / DRIVE), DRIVE)
    assert seen.section.size == seen.time.size == 10
    assert np.diff(seen.time) == pytest.approx(1.0 / DRIVE)


@pytest.mark.parametrize(("samples", "points"), [(398, 9), (399, 10), (439, 11), (438, 10)])
def test_a_window_that_cuts_a_part_of_a_sample_loses_no_period(
    channel: Maker, samples: int, points: int
) -> None:
    time = np.arange(samples) / 10.0
    seen = portrait(channel(time, cosine(time, DRIVE)), Window(0.0, 50.0), DRIVE)
    assert seen.section.size == points
    assert seen.time[-1] <= time[-1]


def test_ten_cycles_found_between_samples_are_ten_points(channel: Maker) -> None:
    time = np.arange(30000) / 500.0
    seen = portrait(channel(time, cosine(time, 0.3)), Window(13.3377, 13.3377 + 10.0 / 0.3), 0.2999993)
    assert seen.section.size == 10


@pytest.mark.parametrize("rate", [2.5, 30.0])
def test_period_one_is_one_point_within_the_noise(channel: Maker, rate: float) -> None:
    random = np.random.default_rng(5)
    time = np.arange(round(80.0 * rate)) / rate
    noise = NOISE * random.standard_normal(time.size)
    seen = portrait(channel(time, cosine(time, DRIVE, phase=0.4) + noise), Window(0.0, 80.0), DRIVE)
    # ten samples per period are too few for straight lines: those would scatter by 0.05
    assert seen.section.std() < 2.0 * NOISE
    assert np.ptp(seen.section) < 8.0 * NOISE
    assert seen.step(1) == pytest.approx(seen.step(2), rel=0.6)


def test_period_two_is_two_points_apart_by_twice_the_half_order(channel: Maker) -> None:
    random = np.random.default_rng(6)
    time = np.arange(2400) / 30.0
    values = cosine(time, DRIVE) + cosine(time, 0.5 * DRIVE, 0.3, 1.1) + NOISE * random.standard_normal(2400)
    seen = portrait(channel(time, values), Window(0.0, 80.0), DRIVE)
    odd, even = seen.section[0::2], seen.section[1::2]
    assert max(odd.std(), even.std()) < 2.0 * NOISE
    # at the phase where it spreads most: cos(pi / 32) of the full 0.6 at least
    assert abs(odd.mean() - even.mean()) == pytest.approx(0.6, rel=0.03)
    assert seen.step(1) == pytest.approx(0.6, rel=0.03)
    assert seen.step(2) < 4.0 * NOISE


def test_the_rate_of_change_leads_by_a_quarter_period(channel: Maker) -> None:
    time = np.arange(2000) / 25.0
    seen = portrait(channel(time, cosine(time, DRIVE, 2.0)), Window(0.0, 80.0), DRIVE)
    swing = 2.0 * np.pi * DRIVE
    inner = slice(500, -500)  # the low-pass bends the last half period
    radius = np.hypot(seen.values, seen.rates / swing)
    assert radius[inner] == pytest.approx(2.0, rel=2e-3)
    # against time the point turns clockwise: the rate is positive where the value rises
    assert np.all(np.diff(seen.values)[inner] * seen.rates[1:][inner] > -1e-3)
    expected = -2.0 * swing * np.sin(2.0 * np.pi * DRIVE * seen.time[3:-3])
    assert seen.section_rate[3:-3] == pytest.approx(expected, abs=0.01 * 2.0 * swing)


def test_a_long_window_shows_all_points_and_its_last_periods(channel: Maker) -> None:
    time = np.arange(12000) / 5.0
    seen = portrait(channel(time, cosine(time, DRIVE) + 1e-3 * time), Window(0.0, 2400.0), DRIVE)
    assert seen.section.size == 600
    assert seen.periods == 200
    assert seen.values.mean() == pytest.approx(2.0, abs=0.02)  # the drift's mean from 1600 to 2400 s


@pytest.mark.parametrize(("frequency", "stop"), [(1.0, 2.9), (16.0, 60.0)])
def test_too_few_periods_or_samples_are_refused(channel: Maker, frequency: float, stop: float) -> None:
    time = np.arange(round(stop * 30.0)) / 30.0
    with pytest.raises(DataError, match="periods of"):
        portrait(channel(time, cosine(time, 0.5)), Window(0.0, stop), frequency)


def test_a_spectrogram_shows_amplitudes_at_their_orders_and_times(channel: Maker) -> None:
    time = np.arange(6000) / 30.0
    late = np.where(time > 120.0, cosine(time, 0.5 * DRIVE, 0.2), 0.0)
    seen = order_spectrogram(
        channel(time, 5.0 + cosine(time, DRIVE) + cosine(time, 3.0 * DRIVE, 0.1) + late), DRIVE
    )
    at = {order: seen.amplitude[np.argmin(np.abs(seen.order - order))] for order in (0.5, 1.0, 2.0, 3.0)}
    # a column is 24 s wide, with its middle at the time that is drawn
    assert seen.time[[0, -1]] == pytest.approx([12.0, 188.0], abs=1.6)
    assert at[1.0] == pytest.approx(1.0, rel=0.02)
    assert at[3.0] == pytest.approx(0.1, rel=0.02)
    assert at[2.0][np.abs(seen.time - 120.0) > 12.0].max() < 0.005
    assert at[0.5][seen.time < 107.0].max() < 0.01
    assert at[0.5][seen.time > 133.0] == pytest.approx(0.2, rel=0.05)
    assert np.interp(120.0, seen.time, at[0.5]) == pytest.approx(0.1, rel=0.15)


def test_a_long_spectrogram_hides_nothing(channel: Maker) -> None:
    """Five thousand columns become twelve hundred at most, and a burst of one column stays in sight."""
    time = np.arange(60000) / 8.0
    burst = cosine(time, 2.0) * ((time > 3000.0) & (time < 3006.0))
    seen = order_spectrogram(channel(time, cosine(time, 1.0) + burst), 1.0)
    assert seen.time.size <= MOST_COLUMNS
    second = seen.amplitude[np.argmin(np.abs(seen.order - 2.0))]
    assert second.max() > 0.8
    assert seen.time[np.argmax(second)] == pytest.approx(3003.0, abs=6.0)
    assert np.median(second) < 0.01


def test_a_record_shorter_than_a_column_has_no_spectrogram(channel: Maker) -> None:
    time = np.arange(239) / 10.0
    with pytest.raises(DataError, match="shorter than 6 periods"):
        order_spectrogram(channel(time, cosine(time, DRIVE)), DRIVE)
