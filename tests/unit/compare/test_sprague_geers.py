"""Sprague-Geers against its published check values."""

from __future__ import annotations

import numpy as np
import pytest

from tethertest.compare import sprague_geers
from tethertest.errors import DataError
from tethertest.records.arrays import FloatArray

TIME = np.linspace(0.0, 2.0, 101)


def wavelet(delay: float) -> FloatArray:
    since = TIME - delay
    return (since >= 0.0) * np.exp(-since) * np.sin(2.0 * np.pi * since)


@pytest.mark.parametrize(
    ("replayed", "magnitude", "phase", "combined"),
    [
        (1.2 * wavelet(0.14), 0.2000, 0.0, 0.2000),
        (0.8 * wavelet(0.14), -0.2000, 0.0, 0.2000),
        (wavelet(0.24), -0.0048, 0.1953, 0.1954),
        (1.2 * wavelet(0.24), 0.1943, 0.1953, 0.2755),
    ],
)
def test_check_values(replayed: FloatArray, magnitude: float, phase: float, combined: float) -> None:
    found = sprague_geers(TIME, wavelet(0.14), replayed)
    assert found.magnitude == pytest.approx(magnitude, abs=5e-5)
    assert found.phase == pytest.approx(phase, abs=5e-5)
    assert found.combined == pytest.approx(combined, abs=5e-5)


def test_the_opposite_sign_is_half_a_turn() -> None:
    found = sprague_geers(TIME, wavelet(0.14), -wavelet(0.14))
    assert (found.magnitude, found.phase) == pytest.approx((0.0, 1.0))


def test_masked_samples_do_not_count() -> None:
    measured = wavelet(0.14)
    usable = np.ones(TIME.size, dtype=bool)
    usable[40:50] = False
    spoiled = np.where(usable, measured, 99.0)
    assert sprague_geers(TIME, spoiled, measured, usable).combined == pytest.approx(0.0, abs=1e-7)


def test_noise_energy_taken_off_leaves_a_right_replay_right() -> None:
    time = np.arange(40_000) / 1000.0
    signal = np.cos(2 * np.pi * 0.5 * time)
    noisy = signal + 0.3 * np.random.default_rng(1).standard_normal(time.size)
    plain = sprague_geers(time, noisy, signal)
    corrected = sprague_geers(time, noisy, signal, noise_variance=0.09)
    assert plain.magnitude == pytest.approx(1.0 / np.sqrt(1.18) - 1.0, abs=0.01)
    assert corrected.combined < 0.03 < plain.combined


def test_nothing_to_compare_is_said() -> None:
    with pytest.raises(DataError, match="replayed signal is zero"):
        sprague_geers(TIME, wavelet(0.14), np.zeros(TIME.size))
    with pytest.raises(DataError, match="no larger than its noise"):
        sprague_geers(TIME, wavelet(0.14), wavelet(0.14), noise_variance=10.0)


def test_every_sample_weighs_half_the_steps_beside_it() -> None:
    """By hand: steps 1 and 3 weigh the samples 0.5, 2 and 1.5."""
    time, measured = np.array([0.0, 1.0, 4.0]), np.array([1.0, 2.0, 1.0])
    found = sprague_geers(time, measured, np.array([2.0, 2.0, 0.0]))
    # int m^2 = 0.5 + 8 + 1.5, int c^2 = 2 + 8, int m c = 1 + 8
    assert found.magnitude == pytest.approx(0.0, abs=1e-12)
    assert found.phase == pytest.approx(np.arccos(0.9) / np.pi)
    without_last = sprague_geers(time, measured, np.array([2.0, 2.0, 0.0]), np.array([True, True, False]))
    assert without_last.magnitude == pytest.approx(np.sqrt(4.0 / 2.5) - 1.0)
    assert without_last.combined == pytest.approx(np.hypot(without_last.magnitude, without_last.phase))


def test_noise_is_taken_off_over_the_time_that_counts() -> None:
    time, ones = np.array([0.0, 1.0, 4.0]), np.ones(3)
    # energy 4 less 0.19 x 4, and over the first second 1 less 0.19
    assert sprague_geers(time, ones, ones, noise_variance=0.19).magnitude == pytest.approx(1.0 / 0.9 - 1.0)
    first = np.array([True, True, False])
    found = sprague_geers(time, ones, ones, first, noise_variance=0.19)
    assert found.magnitude == pytest.approx(1.0 / 0.9 - 1.0)
    with pytest.raises(DataError, match="no larger than its noise"):
        sprague_geers(time, ones, ones, noise_variance=1.0)
