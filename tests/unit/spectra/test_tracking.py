"""How one line is followed over the record: unequal thirds, a moving phase, and few cycles of it."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from tethertest.records.arrays import FloatArray
from tethertest.records.channel import Channel, Window
from tethertest.signal.sinusoid import fit_sinusoids
from tethertest.spectra.order_demodulation import demodulate
from tethertest.spectra.regression import OrderFit, channel_blocks, fit_orders
from tethertest.spectra.tracking import Tracking, track

from .conftest import Maker, cosine

DRIVE = 0.25
HALF = Fraction(1, 2)
ORDERS = (HALF, Fraction(1), Fraction(3, 2), Fraction(2))


def fitted(channel: Channel, window: Window) -> OrderFit:
    return fit_orders(channel_blocks(channel, window, DRIVE, 50.0), DRIVE, ORDERS, window.start)


def followed(make: Maker, time: FloatArray, window: Window, half: FloatArray, seed: int = 7) -> Tracking:
    noise = 0.05 * np.random.default_rng(seed).standard_normal(time.size)
    return track(fitted(make(time, cosine(time, DRIVE) + half + noise), window), HALF, 0.0)


def envelope(time: FloatArray, *thirds: float) -> FloatArray:
    return np.array(thirds)[np.minimum((3.0 * time / time[-1]).astype(int), 2)]


@pytest.mark.parametrize("thirds", [(1.0, 0.0, 1.0), (0.0, 1.0, 1.0), (1.0, 1.0, 0.0)])
def test_a_third_without_the_line_is_uneven(
    channel: Maker, time: FloatArray, window: Window, thirds: tuple[float, ...]
) -> None:
    seen = followed(channel, time, window, envelope(time, *thirds) * cosine(time, 0.125, 0.1, 0.6))
    assert seen.uneven
    # the third that lacks it departs by all of the whole, which is two thirds of the line
    assert seen.departure == pytest.approx(1.0, abs=0.15)


def test_equal_thirds_are_even_however_strong_or_weak(
    channel: Maker, time: FloatArray, window: Window
) -> None:
    """A strong line that settles by a third is sure to differ and small; a weak one the other way round."""
    settling = followed(channel, time, window, envelope(time, 0.7, 1.0, 1.0) * cosine(time, 0.125, 1.0, 0.6))
    assert settling.thirds > 15.0  # the gate is at 14.86
    assert settling.departure < 0.4
    assert not settling.uneven
    weak = [followed(channel, time, window, cosine(time, 0.125, 0.004, 0.6), seed) for seed in range(8)]
    assert max(item.departure for item in weak) > 1.0
    assert not any(item.uneven for item in weak)


@pytest.mark.parametrize("drift", [-0.8, -0.4, 0.4, 0.8])
def test_a_phase_that_moves_over_the_record_drifts_that_way(
    channel: Maker, time: FloatArray, window: Window, drift: float
) -> None:
    moving = 0.6 + drift * (time / time[-1] - 0.5)
    seen = followed(channel, time, window, 0.2 * np.cos(2.0 * np.pi * 0.125 * time + moving))
    assert seen.drift == pytest.approx(drift, abs=0.05)
    assert seen.drifts
    assert seen.growth == pytest.approx(0.0, abs=4.0 * seen.growth_error)


def test_a_phase_at_rest_or_not_known_to_move_does_not_drift(
    channel: Maker, time: FloatArray, window: Window
) -> None:
    """A strong line may move by a thirtieth of a cycle; a weak one by three standard errors."""
    moving = 0.6 + 0.12 * (time / time[-1] - 0.5)
    strong = followed(channel, time, window, np.cos(2.0 * np.pi * 0.125 * time + moving))
    assert strong.drift > 3.0 * strong.drift_error
    assert not strong.drifts
    weak = [followed(channel, time, window, cosine(time, 0.125, 0.01, 0.6), seed) for seed in range(6)]
    assert max(abs(item.drift) for item in weak) > 0.3
    assert not any(item.drifts for item in weak)


@pytest.mark.parametrize("offset", [-0.02, 0.0, 0.01])
@pytest.mark.parametrize("phase", [0.3, 1.1, 1.9, 2.7])
def test_few_cycles_explain_what_a_full_regression_does(channel: Maker, phase: float, offset: float) -> None:
    """With 2.3 cycles cosine, sine and the other orders are far from orthogonal."""
    time = np.arange(552) / 30.0
    window = Window(0.0, 18.4)
    fit = fitted(channel(time, cosine(time, DRIVE) + cosine(time, 0.125, 0.5, phase)), window)
    rest = [0.25, 0.375, 0.5]
    without = fit_sinusoids(fit.blocks, rest, window.start, 3)
    full = fit_sinusoids(fit.blocks, [*rest, 0.125 + offset], window.start, 3)
    weights = fit.blocks.weights
    gained = float(weights @ without.residuals**2 - weights @ full.residuals**2)
    assert demodulate(fit, HALF).explained(np.array([offset]))[0] == pytest.approx(gained, rel=2e-3)


@pytest.mark.parametrize("share", [-1.7, -0.8, 0.35, 0.8, 1.7])
def test_the_free_frequency_is_found_to_a_hundredth_of_a_resolution(
    channel: Maker, time: FloatArray, window: Window, share: float
) -> None:
    length = float(time[-1])
    free = 0.2 * np.cos(2.0 * np.pi * (0.125 + share / length) * time + 0.4)
    fit = fit_orders(
        channel_blocks(channel(time, cosine(time, DRIVE) + free), window, DRIVE, 50.0), DRIVE, ORDERS[:2], 0.0
    )
    seen = track(fit, HALF, 0.0)
    assert (seen.frequency - 0.125) * length == pytest.approx(share, abs=0.01)
    assert seen.cycles == pytest.approx((seen.frequency - 0.125) * fit.blocks.length)


def test_an_uncertain_drive_excuses_its_part_of_the_gain(
    channel: Maker, time: FloatArray, window: Window
) -> None:
    values = cosine(time, DRIVE) + cosine(time, 0.1265, 0.2, 1.0)
    values += 0.05 * np.random.default_rng(7).standard_normal(time.size)
    fit = fitted(channel(time, values), window)
    sure, unsure = (track(fit, HALF, error) for error in (0.0, 2e-3))
    bound = sure.frequency_error
    # half an order is off by half of what the drive is
    assert unsure.frequency_error == pytest.approx(np.hypot(bound, 1e-3))
    assert unsure.gain == pytest.approx(sure.gain / (1.0 + (1e-3 / bound) ** 2))
    turned = 2.0 * np.pi * 1e-3 * fit.blocks.length
    assert unsure.drift_error == pytest.approx(np.hypot(sure.drift_error, turned))


def test_the_bound_of_a_free_frequency_is_that_of_white_noise(
    channel: Maker, time: FloatArray, window: Window
) -> None:
    """sqrt(6) sigma / (pi T A sqrt(N)), and the slopes' errors follow from the same noise."""
    found = [followed(channel, time, window, cosine(time, 0.125, 0.2, 0.6), seed) for seed in range(6)]
    length = time.size / 30.0
    bound = np.sqrt(6.0) * 0.05 / (np.pi * length * 0.2 * np.sqrt(time.size))
    assert np.mean([seen.frequency_error for seen in found]) == pytest.approx(bound, rel=0.12)
    # growth and drift over the record: sqrt(24 / N) sigma / A
    slope = np.sqrt(24.0 / time.size) * 0.05 / 0.2
    assert np.mean([seen.growth_error for seen in found]) == pytest.approx(slope, rel=0.12)
    assert np.mean([seen.drift_error for seen in found]) == pytest.approx(slope, rel=0.12)
    # freeing one frequency gains one chi-squared of one degree
    assert np.mean([seen.gain for seen in found]) < 4.0


def test_an_amplitude_that_grows_over_the_record_grows_by_as_much(
    channel: Maker, time: FloatArray, window: Window
) -> None:
    for growth in (-0.6, 0.4):
        moving = 1.0 + growth * (time / time[-1] - 0.5)
        seen = followed(channel, time, window, moving * cosine(time, 0.125, 0.4, 0.6))
        assert seen.growth == pytest.approx(growth, abs=0.03)
        assert seen.decays is (growth < 0.0)
