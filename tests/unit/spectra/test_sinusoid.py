"""Least squares of sinusoids over holes and jitter: exact without noise, white covariance with it."""

from __future__ import annotations

import numpy as np
import pytest

from tethertest.signal.blocks import block_means
from tethertest.signal.sinusoid import fit_sinusoids

FREQUENCIES = (0.31, 0.62, 1.55)
AMPLITUDES = (2.0, 0.3, 0.05)
PHASES = (0.4, -2.0, 3.0)


def signal(time: np.ndarray) -> np.ndarray:
    parts = (
        a * np.cos(2 * np.pi * f * (time - 10.0) + p)
        for f, a, p in zip(FREQUENCIES, AMPLITUDES, PHASES, strict=True)
    )
    return 5.0 + 0.01 * time + sum(parts)


@pytest.mark.parametrize("rate", [1000.0, 8.0])
@pytest.mark.parametrize("jitter", [0.0, 2e-4])
def test_block_means_leave_amplitude_and_phase_exact_over_holes_and_jitter(
    rate: float, jitter: float
) -> None:
    random = np.random.default_rng(3)
    time = np.arange(30_000) / 1000.0 + jitter * random.uniform(-1, 1, 30_000)
    usable = random.random(time.size) > 0.05
    usable[5000:7000] = False
    blocks = block_means(time, np.where(usable, signal(time), 1e9), usable, rate)
    fit = fit_sinusoids(blocks, FREQUENCIES, 10.0)
    for index in range(3):
        assert fit.amplitude(index) == pytest.approx(AMPLITUDES[index], rel=1e-9)
        assert fit.phase(index) == pytest.approx(PHASES[index], abs=1e-8)
    assert np.abs(fit.residuals).max() < 1e-9


def test_a_block_shrinks_a_cosine_by_its_sinc_and_the_fit_puts_it_back() -> None:
    time = np.arange(4000) / 1000.0
    blocks = block_means(time, np.cos(2 * np.pi * 2.0 * time), np.ones(4000, dtype=bool), 8.0)
    assert blocks.width == 125
    # a quarter of a period per block: sinc(1/4) = 0.9003
    assert np.abs(blocks.values).max() < 0.91
    assert fit_sinusoids(blocks, [2.0], 0.0).amplitude(0) == pytest.approx(1.0, rel=1e-12)


def test_white_noise_scatters_the_coefficients_by_their_covariance() -> None:
    random = np.random.default_rng(4)
    time = np.arange(600) / 20.0
    usable = np.ones(600, dtype=bool)
    scores = []
    for _ in range(300):
        blocks = block_means(time, signal(time) + 0.2 * random.standard_normal(600), usable, 20.0)
        fit = fit_sinusoids(blocks, FREQUENCIES, 10.0)
        scores.append((fit.pair(0)[0] - 2.0 * np.cos(0.4)) / np.sqrt(fit.covariance()[2, 2]))
    assert np.std(scores) == pytest.approx(1.0, abs=0.12)


def test_more_unknowns_than_blocks_is_refused() -> None:
    blocks = block_means(np.arange(6.0), np.zeros(6), np.ones(6, dtype=bool), 1.0)
    with pytest.raises(ValueError, match="6 blocks for 8"):
        fit_sinusoids(blocks, FREQUENCIES, 0.0)
