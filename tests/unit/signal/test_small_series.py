"""Blocks, phasors, noise and sampling intervals on series small enough to check by hand."""

from __future__ import annotations

import numpy as np
import pytest

from tethertest.signal.blocked_matmul import blocked_cross, blocked_times
from tethertest.signal.blocks import block_means
from tethertest.signal.filters import moving_mean, without_line
from tethertest.signal.noise import quantum, white_noise
from tethertest.signal.rotation import times
from tethertest.signal.series import sampling_interval
from tethertest.signal.sinusoid import fit_sinusoids, sinusoid_pair, trend_columns


def whole(count: int) -> np.ndarray:
    return np.ones(count, dtype=bool)


def test_blocks_hold_means_of_usable_samples_with_their_share_as_weight() -> None:
    time, values = np.arange(12) / 10.0, np.arange(12.0)
    usable = whole(12)
    usable[[4, 8, 9, 10, 11]] = False
    usable[11] = True
    blocks = block_means(time, values, usable, 2.5)
    assert (blocks.width, blocks.interval) == (4, pytest.approx(0.1))
    assert blocks.values == pytest.approx([1.5, 6.0, 11.0])
    assert blocks.weights == pytest.approx([1.0, 0.75, 0.25])
    assert blocks.time == pytest.approx([0.15, 0.6, 1.1])
    assert (blocks.step, blocks.rate, blocks.length) == pytest.approx((0.4, 2.5, 1.2))


def test_a_block_without_samples_has_no_weight_and_its_own_middle() -> None:
    usable = whole(12)
    usable[4:8] = False
    blocks = block_means(np.arange(12) / 10.0, np.arange(12.0), usable, 2.5)
    assert blocks.weights.tolist() == [1.0, 0.0, 1.0]
    assert blocks.values.tolist() == [1.5, 0.0, 9.5]
    assert blocks.time == pytest.approx([0.15, 0.55, 0.95])
    assert blocks.phasor(1.0, 0.0)[1] == 0.0


def test_a_series_slower_than_asked_is_kept_sample_by_sample() -> None:
    blocks = block_means(np.arange(5) / 10.0, np.arange(5.0), whole(5), 50.0)
    assert blocks.width == 1
    assert blocks.values.tolist() == [0.0, 1.0, 2.0, 3.0, 4.0]
    with pytest.raises(ValueError, match="1 usable samples"):
        block_means(np.arange(5) / 10.0, np.arange(5.0), np.arange(5) == 2, 50.0)


@pytest.mark.parametrize("damage", ["none", "holes", "jitter"])
def test_a_blocks_phasor_is_the_mean_of_its_samples_own(damage: str) -> None:
    random = np.random.default_rng(2)
    time, usable = 5.0 + np.arange(400) / 50.0, whole(400)
    if damage == "holes":
        usable[random.choice(np.arange(5, 395), 60, replace=False)] = False
    if damage == "jitter":
        time = time + 1e-3 * random.uniform(-1.0, 1.0, 400)
    blocks = block_means(time, np.cos(time), usable, 10.0)
    number = np.floor((time[usable] - time[usable][0] + 0.5 * blocks.interval) / blocks.step).astype(int)
    direct = np.exp(2j * np.pi * 1.7 * (time[usable] - 4.0))
    expected = [direct[number == index].mean() for index in range(number[-1] + 1)]
    assert blocks.phasor(1.7, 4.0) == pytest.approx(
        np.array(expected), abs=2e-4 if damage == "jitter" else 1e-9
    )
    pair = sinusoid_pair(blocks, 1.7, 4.0)
    assert pair[:, 0] + 1j * pair[:, 1] == pytest.approx(np.array(expected), abs=1e-3)


def test_a_fit_of_two_sinusoids_on_a_drift_is_exact_with_holes() -> None:
    time = 2.0 + np.arange(600) / 30.0
    usable = np.arange(600) % 7 != 3
    drift = 1.5 + 0.3 * (time - time.mean())
    values = (
        drift
        + 2.0 * np.cos(2 * np.pi * 0.5 * (time - 2.0) + 0.4)
        + 0.3 * np.sin(2 * np.pi * 1.1 * (time - 2.0))
    )
    fit = fit_sinusoids(block_means(time, np.where(usable, values, 99.0), usable, 10.0), [0.5, 1.1], 2.0)
    assert (fit.amplitude(0), fit.phase(0)) == pytest.approx((2.0, 0.4))
    assert (fit.amplitude(1), fit.phase(1)) == pytest.approx((0.3, -np.pi / 2.0))
    assert fit.pair(1) == pytest.approx([0.0, 0.3], abs=1e-9)
    assert fit.coefficients[0] == pytest.approx(1.5, abs=0.02)
    assert np.max(np.abs(fit.residuals)) < 1e-9


def test_the_covariance_of_a_fit_is_that_of_least_squares() -> None:
    random = np.random.default_rng(3)
    time = np.arange(3000) / 30.0
    found = []
    for _ in range(8):
        noisy = np.cos(np.pi * time) + 0.2 * random.standard_normal(3000)
        fit = fit_sinusoids(block_means(time, noisy, whole(3000), 10.0), [0.5], 0.0)
        found.append(np.diag(fit.covariance())[2:])
    # sigma^2 2 / N for each coefficient
    assert np.mean(found, axis=0) == pytest.approx(0.04 * 2.0 / 3000.0 * np.ones(2), rel=0.05)
    assert np.diag(fit.covariance(9.0))[2:] == pytest.approx(9.0 * 2.0 / 1000.0, rel=0.02)


def test_a_fit_takes_its_coefficients_off_the_degrees_of_freedom() -> None:
    time = np.arange(21) / 10.0
    noisy = np.cos(2 * np.pi * time) + np.random.default_rng(7).standard_normal(21)
    fit = fit_sinusoids(block_means(time, noisy, np.arange(21) != 9, 10.0), [1.0], 0.0)
    # twenty samples, and four numbers: offset, drift, cosine and sine
    assert fit.covariance() == pytest.approx(float(fit.residuals @ fit.residuals) / 16.0 * fit.inverse)


def test_trends_are_legendres_polynomials_from_minus_one_to_one() -> None:
    blocks = block_means(np.arange(11) / 10.0, np.ones(11), whole(11), 10.0)
    columns = trend_columns(blocks, 2)
    share = np.linspace(-1.0, 1.0, 11)
    assert columns == pytest.approx(np.column_stack((np.ones(11), share, 1.5 * share**2 - 0.5)))


def test_frequencies_that_the_samples_do_not_tell_apart_are_refused() -> None:
    time = np.arange(200) / 10.0
    with pytest.raises(ValueError, match="do not tell the frequencies apart"):
        fit_sinusoids(block_means(time, np.cos(time), whole(200), 10.0), [1.0, 1.0 + 1e-9], 0.0)
    with pytest.raises(ValueError, match="6 blocks for 6 coefficients"):
        fit_sinusoids(block_means(time[:6], np.cos(time[:6]), whole(6), 10.0), [1.0, 2.0], 0.0)


def test_noise_of_a_sample_whatever_else_moves_slowly() -> None:
    random = np.random.default_rng(4)
    time = np.arange(20_000) / 1000.0
    found = white_noise(3.0 * np.sin(2 * np.pi * time) + 0.05 * random.standard_normal(20_000))
    # the quieter quarter of the pieces decides
    assert found == pytest.approx(0.05, rel=0.06)
    rounded = np.round(0.1 * np.sin(2 * np.pi * 0.01 * time), 2)
    assert white_noise(rounded) == pytest.approx(0.01 / np.sqrt(12.0))
    assert white_noise(np.arange(9.0)) == 0.0
    assert white_noise(np.append(random.standard_normal(1000), np.nan)) == pytest.approx(1.0, rel=0.2)


def test_the_step_of_rounding_is_seen_where_values_repeat() -> None:
    assert quantum(np.array([1.0, 1.25, 1.25, 2.0])) == 0.25
    assert quantum(np.array([1.0, 1.25, 2.0])) == 0.0
    assert quantum(np.array([1.0, 1.0])) == 0.0
    # sums of tenths differ in the last digit only
    assert quantum(np.array([0.3, 0.1 + 0.2, 0.3, 0.5])) == pytest.approx(0.2)


def test_the_usual_interval_leaves_gaps_out_and_is_free_of_rounding() -> None:
    stamps = np.round(np.arange(300) / 30.0, 3)
    assert sampling_interval(stamps) == pytest.approx(1.0 / 30.0, rel=1e-4)
    assert sampling_interval(np.append(stamps, stamps + 100.0)) == pytest.approx(1.0 / 30.0, rel=1e-4)
    lost = np.delete(stamps, [50, 51, 120, 200, 201, 202])
    assert sampling_interval(lost) == pytest.approx(1.0 / 30.0, rel=1e-4)
    assert sampling_interval(np.array([0.0, 1.0, 2.26])) == pytest.approx(1.13)


def test_moving_means_by_hand() -> None:
    values = np.array([0.0, 4.0, 8.0, 0.0, 4.0])
    assert moving_mean(values, 1.0) == pytest.approx(values)
    assert moving_mean(values, 3.0) == pytest.approx([2.0, 4.0, 4.0, 4.0, 2.0])
    # two samples: the middle one whole, half of either neighbour; at the ends over what there is
    assert moving_mean(values, 2.0) == pytest.approx([4.0 / 3.0, 4.0, 5.0, 3.0, 8.0 / 3.0])
    assert moving_mean(values, 0.2) == pytest.approx(values)


def test_a_line_is_taken_out_and_what_lies_beside_it_stays() -> None:
    time = np.arange(4000) / 1000.0
    slow = np.sin(2 * np.pi * 2.0 * time)
    left = without_line(time, slow + 0.4 * np.cos(2 * np.pi * 50.0 * time + 0.3), 50.0, 0.5)
    assert left[500:-500] == pytest.approx(slow[500:-500], abs=0.01)


@pytest.mark.parametrize("count", [5, 128, 300])
@pytest.mark.parametrize("holes", [False, True])
def test_phasors_on_a_grid_are_those_computed_one_by_one(count: int, holes: bool) -> None:
    at = 3.0 + 0.01 * np.arange(count)
    at = np.delete(at, [2]) if holes else at
    grid = times(at, 0.01)
    assert grid.slots is not None
    assert grid.rotating(1.3, 2.0) == pytest.approx(np.exp(2j * np.pi * 1.3 * (at - 2.0)))
    uneven = at + 1e-4 * np.arange(at.size) ** 2
    off = times(uneven, 0.01)
    assert off.rotating(1.3, 2.0) == pytest.approx(np.exp(2j * np.pi * 1.3 * (uneven - 2.0)))


def test_products_slab_by_slab_are_the_products() -> None:
    random = np.random.default_rng(5)
    for rows in (5, 128, 300):
        left, right = random.standard_normal((rows, 3)), random.standard_normal((rows, 2))
        assert blocked_cross(left, right) == pytest.approx(left.T @ right)
        assert blocked_cross(left, right[:, 0]) == pytest.approx(left.T @ right[:, 0])
        small = random.standard_normal((3, 2))
        assert blocked_times(left, small) == pytest.approx(left @ small)
        assert blocked_times(left, small[:, 0]) == pytest.approx(left @ small[:, 0])
