"""Amplitudes, intervals, chances and small statistics against closed forms."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.stats import f, ncx2, t

from tethertest.errors import DataError
from tethertest.records.arrays import FloatArray
from tethertest.records.channel import Flag, Window
from tethertest.records.lines import DriveFit, Expectation
from tethertest.spectra import find_lines, fit_drive, regression
from tethertest.spectra.leaks import leakage_floor
from tethertest.spectra.multitaper import TAPERS, f_value_at, harmonic_test, tapers
from tethertest.spectra.regression import (
    Amplitude,
    amplitude_interval,
    believed_excess,
    channel_blocks,
    fit_orders,
    local_p_value,
    order_amplitudes,
)

from .conftest import Maker, cosine

ONE, TWO, HALF = Fraction(1), Fraction(2), Fraction(1, 2)


@pytest.mark.parametrize("raw", [0.5, 1.5, 2.5, 3.0, 8.0])
def test_the_interval_holds_amplitudes_under_which_the_one_found_is_not_in_the_outer_tails(
    raw: float,
) -> None:
    low, high = amplitude_interval(3.0 * raw, 9.0)
    square = max(raw**2, 2.0 * np.log(2.0))  # no better than a record that shows the median of noise
    assert ncx2.cdf(square, 2, (high / 3.0) ** 2) == pytest.approx(0.025, rel=1e-6)
    if 1.0 - np.exp(-0.5 * raw**2) < 0.975:
        assert low == 0.0
    else:
        assert ncx2.cdf(raw**2, 2, (low / 3.0) ** 2) == pytest.approx(0.975, rel=1e-6)


def test_an_interval_without_variance_is_a_point_and_one_of_few_degrees_is_wider() -> None:
    assert amplitude_interval(2.0, 0.0) == (2.0, 2.0)
    low, high = amplitude_interval(100.0, 1.0, freedom=6.0)
    assert high - low == pytest.approx(2.0 * t.ppf(0.975, 6), rel=1e-5)
    one = amplitude_interval(1e4, 1.0, freedom=0.3)  # as one degree, the least that is known
    assert one[1] - one[0] == pytest.approx(2.0 * t.ppf(0.975, 1), rel=1e-5)
    assert low + high == pytest.approx(2.0 * np.sqrt(100.0**2 - (t.ppf(0.975, 6) / 1.959964) ** 2), rel=1e-6)


def test_the_scale_widens_both_arms_of_an_interval_in_square() -> None:
    plain = Amplitude(2.0, 0.0, 0.1, (1.7, 2.4), 9.0, 0.1)
    found = plain.calibrated(0.05)
    assert found.calibration_error == pytest.approx(0.1)
    scale = 1.959964 * 0.1
    assert found.interval == pytest.approx((2.0 - np.hypot(0.3, scale), 2.0 + np.hypot(0.4, scale)))
    assert found.standard_error == 0.1
    assert plain.calibrated(9.0).interval[0] == 0.0


def test_the_amplitude_of_a_chance_is_that_of_the_f_test() -> None:
    amplitude = Amplitude(1.0, 0.0, 0.1, (0.8, 1.2), 4.0, 0.5, freedom=12.0, at_unit_f=0.3)
    assert amplitude.significant_at(0.01) == pytest.approx(0.3 * np.sqrt(f.isf(0.01, 2, 12)))


@dataclass
class Background:
    """Stands for a density: only what lies next to the line is asked."""

    ratio: float
    degrees: float = 8.0

    def excess(self, frequency: float) -> tuple[float, float]:
        return self.ratio, self.degrees

    def freedom(self, frequency: float) -> float:
        return 40.0


@dataclass
class Fit:
    noise: Background
    drive: float = 0.25


def test_a_local_background_is_believed_where_it_is_clearly_above_the_smooth_one() -> None:
    # 2.8 standard deviations of a mean of eight degrees: 1 + 2.8 sqrt(2 / 8) = 2.4
    assert believed_excess(Background(2.41), 0.25) == 2.41
    assert believed_excess(Background(2.39), 0.25) == 1.0
    assert believed_excess(Background(0.2), 0.25) == 1.0


def test_the_local_chance_refers_to_what_is_believed() -> None:
    amplitude = Amplitude(1.0, 0.0, 0.1, (0.8, 1.2), 9.0, 0.5)
    believed = local_p_value(Fit(Background(3.0)), ONE, amplitude)  # type: ignore[arg-type]
    assert believed == pytest.approx(f.sf(9.0 / 3.0, 2, 8))
    smooth = local_p_value(Fit(Background(2.0)), ONE, amplitude)  # type: ignore[arg-type]
    assert smooth == pytest.approx(f.sf(9.0, 2, 40))
    always = local_p_value(Fit(Background(2.0)), ONE, amplitude, always=True)  # type: ignore[arg-type]
    assert always == pytest.approx(f.sf(9.0 / 2.0, 2, 8))


def test_unsteady_whole_orders_leak_by_their_change_over_the_distance() -> None:
    def of(value: float) -> Amplitude:
        return Amplitude(value, 0.0, 0.0, (0.0, 0.0), 0.0, 0.0)

    fit = SimpleNamespace(drive=0.25, blocks=SimpleNamespace(length=100.0))
    amplitudes = {ONE: of(2.0), TWO: of(0.5)}
    changes = {ONE: 0.1, TWO: 0.4}
    # A c / (pi T |df|), of order 1 0.125 Hz away and of order 2 0.375 Hz away
    expected = 0.2 / (np.pi * 100.0 * 0.125) + 0.2 / (np.pi * 100.0 * 0.375)
    assert leakage_floor(fit, HALF, amplitudes, changes) == pytest.approx(expected)  # type: ignore[arg-type]
    # no order leaks into itself
    itself = leakage_floor(fit, ONE, amplitudes, changes)  # type: ignore[arg-type]
    assert itself == pytest.approx(0.2 / (np.pi * 100.0 * 0.25))


def test_white_noise_gives_the_error_of_least_squares(
    channel: Maker, window: Window, time: FloatArray
) -> None:
    """sigma sqrt(2 / N) for an amplitude, and p of a line of F = A^2 / (2 error^2)."""
    random = np.random.default_rng(31)
    errors, values = [], []
    for _ in range(6):
        series = cosine(time, 0.25) + cosine(time, 0.5, 0.01) + 0.1 * random.standard_normal(time.size)
        blocks = channel_blocks(channel(time, series), window, 0.25, 50.0)
        found = order_amplitudes(fit_orders(blocks, 0.25, (ONE, TWO), 0.0), (ONE, TWO))
        errors.append(found[TWO].standard_error)
        values.append(found[TWO])
        raw = np.hypot(found[TWO].value, found[TWO].standard_error)
        if found[TWO].value > 0.0:  # the two coefficients have nearly one variance
            assert found[TWO].f_value == pytest.approx(raw**2 / (2.0 * errors[-1] ** 2), rel=0.05)
            assert raw == pytest.approx(found[TWO].at_unit_f * np.sqrt(found[TWO].f_value), rel=1e-6)
        assert found[TWO].p_value == pytest.approx(f.sf(found[TWO].f_value, 2, found[TWO].freedom), rel=1e-6)
        # order 1 in front of no noise to speak of: its own amplitude less one variance in square
        pair = fit_orders(blocks, 0.25, (ONE, TWO), 0.0).sinusoids.pair(0)
        assert found[ONE].value ** 2 + found[ONE].standard_error ** 2 == pytest.approx(float(pair @ pair))
    assert np.mean(errors) == pytest.approx(0.1 * np.sqrt(2.0 / time.size), rel=0.08)


def test_the_interval_knows_how_few_degrees_the_noise_has_and_what_stands_next_to_the_line(
    channel: Maker, window: Window, time: FloatArray, monkeypatch: pytest.MonkeyPatch
) -> None:
    noise = 0.1 * np.random.default_rng(35).standard_normal(time.size)
    blocks = channel_blocks(channel(time, cosine(time, 0.25) + noise), window, 0.25, 50.0)
    fit = fit_orders(blocks, 0.25, (ONE, TWO), 0.0)
    plain = order_amplitudes(fit, (ONE,))[ONE]
    raw = float(np.hypot(*fit.sinusoids.pair(0)))
    expected = amplitude_interval(raw, plain.standard_error**2, plain.freedom)
    assert plain.interval == pytest.approx(expected, rel=1e-9)
    assert expected[1] - expected[0] > 1.001 * 2.0 * 1.959964 * plain.standard_error
    monkeypatch.setattr(regression, "believed_excess", lambda noise, frequency: 4.0)
    beside = order_amplitudes(fit, (ONE,))[ONE]
    assert beside.standard_error == pytest.approx(2.0 * plain.standard_error)
    assert beside.p_value == plain.p_value


def test_flagged_stretches_cost_what_they_take_of_the_record(
    channel: Maker, window: Window, time: FloatArray
) -> None:
    """Weights: three quarters of the samples make errors larger by sqrt(4 / 3), and no amplitude smaller."""
    random = np.random.default_rng(32)
    lost = (np.arange(time.size) // 8) % 4 == 0
    drive = DriveFit(0.25, 0.0, ("tension_top",))
    found = []
    for _ in range(12):
        whole = channel(time, cosine(time, 0.25) + 0.1 * random.standard_normal(time.size))
        line = find_lines(whole.with_flags(lost, Flag.SPIKE), window, drive, Expectation()).line("1")
        assert line is not None
        found.append((line.amplitude, line.standard_error))
    amplitude, error = np.mean(found, axis=0)
    assert amplitude == pytest.approx(1.0, abs=0.004)
    # blocks with fewer samples scatter more, which the one density of all blocks leaves a little too large
    assert error == pytest.approx(1.05 * 0.1 * np.sqrt(2.0 / (0.75 * time.size)), rel=0.08)


def test_the_drives_error_is_the_bound_of_a_frequency_in_white_noise(channel: Maker) -> None:
    """sqrt(6) sigma / (pi T A sqrt(N))."""
    time = np.arange(3000) / 30.0
    random = np.random.default_rng(33)
    found = [
        fit_drive(
            [channel(time, cosine(time, 0.25, 2.0) + 0.2 * random.standard_normal(3000))],
            Window(0.0, 100.0),
            0.25,
        )
        for _ in range(8)
    ]
    bound = np.sqrt(6.0) * 0.2 / (np.pi * 100.0 * 2.0 * np.sqrt(3000))
    assert np.mean([fit.standard_error for fit in found]) == pytest.approx(bound, rel=0.2)
    assert all(abs(fit.frequency - 0.25) < 4.0 * bound for fit in found)
    # two channels alike know it better by the root of two
    pair = [
        channel(time, cosine(time, 0.25, 2.0) + 0.2 * random.standard_normal(3000), name=name)
        for name in ("a", "b")
    ]
    both = fit_drive(pair, Window(0.0, 100.0), 0.25)
    assert both.standard_error == pytest.approx(bound / np.sqrt(2.0), rel=0.2)
    assert both.channels == ("a", "b")


def test_a_quiet_channel_carries_the_drive_and_a_noisy_one_hardly_counts(channel: Maker) -> None:
    time = np.arange(3000) / 30.0
    random = np.random.default_rng(34)
    quiet = channel(time, cosine(time, 0.25, 2.0) + 0.02 * random.standard_normal(3000), name="quiet")
    noisy = channel(time, cosine(time, 0.2503, 2.0) + 2.0 * random.standard_normal(3000), name="noisy")
    found = fit_drive([noisy, quiet], Window(0.0, 100.0), 0.25)
    bound = np.sqrt(6.0) * 0.02 / (np.pi * 100.0 * 2.0 * np.sqrt(3000))
    assert found.standard_error == pytest.approx(bound, rel=0.2)
    assert found.frequency == pytest.approx(0.25, abs=5.0 * bound)


def test_a_window_of_too_few_periods_or_of_zeros_is_refused(channel: Maker) -> None:
    time = np.arange(600) / 30.0
    with pytest.raises(DataError, match=r"2\.4 periods of 0.12 Hz"):
        channel_blocks(channel(time, cosine(time, 0.12)), Window(0.0, 20.0), 0.12, 50.0)
    assert channel_blocks(channel(time, cosine(time, 0.12)), Window(0.0, 20.0), 0.126, 50.0).length > 19.0
    with pytest.raises(DataError, match="is zero from 0 s to 20 s"):
        channel_blocks(channel(time, np.zeros(600)), Window(0.0, 20.0), 0.25, 50.0)
    with pytest.raises(DataError, match="no usable samples from 30 s to 40 s"):
        channel_blocks(channel(time, cosine(time, 0.12)), Window(30.0, 40.0), 0.25, 50.0)


def test_blocks_hold_whole_periods_of_the_mains(channel: Maker) -> None:
    time = np.arange(20_000) / 1000.0
    blocks = channel_blocks(channel(time, cosine(time, 0.5)), Window(0.0, 20.0), 0.5, 50.0)
    # forty blocks a period are 20 Hz; 50 Hz over two is the nearest above that holds whole periods
    assert blocks.rate == pytest.approx(25.0)
    fast = channel_blocks(channel(time, cosine(time, 2.0)), Window(0.0, 20.0), 2.0, 50.0)
    assert fast.rate == pytest.approx(1000.0 / 12.0)


# Thomson's test


def test_the_harmonic_test_by_hand() -> None:
    sums = np.array([2.0, 0.0, 1.0, 0.0, 0.5, 0.0, 0.0])
    transforms = np.array([4.1, 0.3, 1.8, 0.2j, 1.0, -0.1, 0.1j])[:, None]
    found = harmonic_test(transforms, sums)
    power = 5.25
    mean = (8.2 + 1.8 + 0.5) / power
    left = np.abs(transforms[:, 0] - mean * sums) ** 2
    expected = 6.0 * mean**2 * power / left.sum()
    assert found.mean[0] == pytest.approx(mean)
    assert found.f_value[0] == pytest.approx(expected)
    assert found.p_value[0] == pytest.approx(f.sf(expected, 2, 12))
    assert f_value_at(found.p_value[0]) == pytest.approx(expected)
    # an amplitude 2 mean has F = expected, and F grows as its square
    assert found.at_unit_f[0] == pytest.approx(2.0 * mean / np.sqrt(expected))


def test_tapers_are_seven_orthonormal_ones_of_four_resolutions() -> None:
    shapes = tapers(256)
    assert shapes.shape == (TAPERS, 256) == (7, 256)
    assert shapes @ shapes.T == pytest.approx(np.eye(7), abs=1e-8)
    inside = np.abs(np.fft.fftfreq(4096, 1.0 / 256)) <= 4.0
    energy = np.abs(np.fft.fft(shapes, 4096)) ** 2
    assert np.all(energy[:6, inside].sum(axis=1) / energy[:6].sum(axis=1) > 0.99)
