"""What the numbers claim: false alarms at the stated level, intervals that cover, amplitudes without bias."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

import numpy as np
import pytest

from tethertest.records.arrays import FloatArray
from tethertest.records.channel import Window
from tethertest.records.lines import DriveFit, Expectation
from tethertest.spectra import ORDERS, find_lines
from tethertest.spectra.holm import holm
from tethertest.spectra.regression import amplitude_interval

from .conftest import Maker, autoregressive, cosine

RECORDS = 250
DRIVE = DriveFit(0.25, 1e-6, ("tension_top",))


def pink(random: np.random.Generator) -> FloatArray:
    spectrum = np.fft.rfft(random.standard_normal(8192))
    spectrum[1:] /= np.sqrt(np.arange(1, spectrum.size) / spectrum.size)
    return np.fft.irfft(spectrum)[:2048]


NOISES: dict[str, Callable[[np.random.Generator], FloatArray]] = {
    "white": lambda random: random.standard_normal(2048),
    "AR(1) 0.9": lambda random: autoregressive(random, 0.9, 2048),
    "1/f": pink,
}


#: white noise in every run of the tests; other noise takes a record's time twice over, and is verified
SHORT = "white"
LONG = [pytest.param(kind, marks=pytest.mark.verify) for kind in NOISES if kind != SHORT]


@pytest.mark.parametrize("kind", [SHORT, *LONG])
def test_false_alarms_stay_at_one_percent_after_holm(
    kind: str, channel: Maker, time: FloatArray, window: Window
) -> None:
    random = np.random.default_rng(21)
    alarms = 0
    for _ in range(RECORDS):
        values = cosine(time, 0.25, 20.0, random.uniform(0, 6)) + NOISES[kind](random)
        lines = find_lines(channel(time, values), window, DRIVE, Expectation())
        alarms += any(line.verdict.value != "none" for line in lines.lines if line.order != "1")
    # 99.9 % of a binomial with p = 0.01
    assert alarms <= 9


@pytest.mark.parametrize("kind", [SHORT, LONG[0]])
def test_amplitude_intervals_cover_and_the_mean_has_no_bias(
    kind: str, channel: Maker, time: FloatArray, window: Window
) -> None:
    random = np.random.default_rng(22)
    amplitude = 0.25 if kind == "white" else 2.0
    inside, found = 0, []
    for _ in range(RECORDS):
        line = cosine(time, 0.125, amplitude, random.uniform(0, 6))
        values = cosine(time, 0.25, 20.0) + line + NOISES[kind](random)
        half = find_lines(channel(time, values), window, DRIVE, Expectation()).line("1/2")
        assert half is not None
        inside += half.interval[0] <= amplitude <= half.interval[1]
        found.append(half.amplitude / amplitude)
    assert 0.91 <= inside / RECORDS <= 0.985
    assert np.mean(found) == pytest.approx(1.0, abs=3.5 * np.std(found) / np.sqrt(RECORDS))


def test_a_locked_half_of_seven_standard_errors_is_found_nine_times_in_ten(
    channel: Maker, time: FloatArray, window: Window
) -> None:
    random = np.random.default_rng(23)
    amplitude = 7.0 * np.sqrt(2.0 / 2048)
    found = 0
    for _ in range(100):
        values = cosine(time, 0.25, 5.0) + cosine(time, 0.125, amplitude, random.uniform(0, 6))
        lines = find_lines(channel(time, values + random.standard_normal(2048)), window, DRIVE, Expectation())
        half = lines.line("1/2")
        found += half is not None and half.verdict.value == "subharmonic"
    assert found >= 90


def test_debiasing_takes_one_percent_off_at_seven_standard_errors() -> None:
    # raw amplitude of 7 standard errors is 1.04 % high on average; its square less one variance is not
    random = np.random.default_rng(24)
    raw = np.hypot(7.0 + random.standard_normal(200_000), random.standard_normal(200_000))
    assert raw.mean() / 7.0 == pytest.approx(1.0104, abs=0.0012)
    assert np.sqrt(raw**2 - 1.0).mean() / 7.0 == pytest.approx(1.0, abs=0.0012)


def test_the_interval_of_a_weak_line_starts_at_zero_and_of_a_strong_one_is_normal() -> None:
    assert amplitude_interval(1.0, 1.0)[0] == 0.0
    low, high = amplitude_interval(100.0, 1.0)
    assert high - low == pytest.approx(2 * 1.96, rel=1e-3)
    # where the two branches meet they agree
    assert amplitude_interval(19.999, 1.0) == pytest.approx(amplitude_interval(20.001, 1.0), abs=0.02)


def test_holm_multiplies_the_smallest_by_all_and_never_decreases() -> None:
    p_values = dict(zip(ORDERS[:4], (0.010, 0.04, 0.03, 0.005), strict=True))
    adjusted = holm(p_values)
    assert adjusted == pytest.approx(dict(zip(ORDERS[:4], (0.03, 0.06, 0.06, 0.02), strict=True)))
    assert holm({Fraction(1): 0.9}) == {Fraction(1): 0.9}
