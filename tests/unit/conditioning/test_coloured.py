"""Sums over coloured noise scatter as their covariance says."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import butter, sosfiltfilt

from tethertest.conditioning.clocks.coloured import noise_of

STEP, COUNT = 0.02, 4000


def coloured(random: np.random.Generator) -> np.ndarray:
    sections = butter(2, 3.0, fs=1.0 / STEP, output="sos")
    return sosfiltfilt(sections, random.standard_normal(COUNT + 400))[200:-200]


def test_covariance_of_sums_is_that_of_many_draws():
    random = np.random.default_rng(2)
    time = STEP * np.arange(COUNT)
    columns = np.column_stack((np.sin(2.0 * np.pi * 0.5 * time), time * np.cos(2.0 * np.pi * 6.0 * time)))
    sums = np.array([columns.T @ coloured(random) for _ in range(400)])
    stated = noise_of(coloured(random), COUNT, 0, STEP, np.inf).covariance(columns)
    np.testing.assert_allclose(np.std(sums, axis=0), np.sqrt(np.diag(stated)), rtol=0.25)


def test_white_noise_is_as_many_independent_samples_as_it_has():
    white = np.random.default_rng(4).standard_normal(COUNT)
    noise = noise_of(white, COUNT, 0, STEP, np.inf)
    assert noise.independent == pytest.approx(COUNT, rel=0.05)
    assert noise.variance == pytest.approx(1.0, rel=0.06)


def test_slow_noise_is_fewer():
    """A band of 3 Hz on each side holds a few samples per second and no more."""
    noise = noise_of(coloured(np.random.default_rng(4)), COUNT, 0, STEP, np.inf)
    assert noise.independent == pytest.approx(2.0 * 3.0 * COUNT * STEP, rel=0.4)
