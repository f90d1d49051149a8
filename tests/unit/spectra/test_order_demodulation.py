"""One order let loose: sums over segments against the full regression; courses; the second opinion."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from tethertest.records.arrays import FloatArray
from tethertest.records.channel import Channel, Window
from tethertest.signal.sinusoid import fit_sinusoids, sinusoid_pair
from tethertest.spectra.multitaper import multitaper_test
from tethertest.spectra.order_demodulation import demodulate
from tethertest.spectra.order_track import track_order
from tethertest.spectra.regression import OrderFit, channel_blocks, fit_orders

from .conftest import Maker, cosine

HALF = Fraction(1, 2)
ORDERS = (HALF, Fraction(1), Fraction(3, 2), Fraction(2))


def fitted(channel: Channel, window: Window) -> OrderFit:
    return fit_orders(channel_blocks(channel, window, 0.25, 50.0), 0.25, ORDERS, window.start)


@pytest.fixture
def values(time: FloatArray) -> FloatArray:
    noise = 0.05 * np.random.default_rng(41).standard_normal(2048)
    return np.asarray(cosine(time, 0.25) + cosine(time, 0.127, 0.2, 1.0) + noise)


@pytest.mark.parametrize("offset", [-0.004, 0.0, 0.002, 0.02])
def test_a_loose_frequency_explains_what_a_full_regression_there_does(
    offset: float, channel: Maker, time: FloatArray, window: Window, values: FloatArray
) -> None:
    fit = fitted(channel(time, values), window)
    rest = [0.25, 0.375, 0.5]
    without = fit_sinusoids(fit.blocks, rest, window.start, 3)
    full = fit_sinusoids(fit.blocks, [*rest, 0.125 + offset], window.start, 3)
    weights = fit.blocks.weights
    gained = float(weights @ without.residuals**2 - weights @ full.residuals**2)
    assert demodulate(fit, HALF).explained(np.array([offset]))[0] == pytest.approx(gained, rel=0.01)


def test_an_added_frequency_gives_the_fit_of_all_together(
    channel: Maker, time: FloatArray, window: Window, values: FloatArray
) -> None:
    blocks = channel_blocks(channel(time, values), window, 0.25, 50.0)
    first = fit_sinusoids(blocks, [0.25, 0.5], 0.0, 3)
    both = fit_sinusoids(blocks, [0.25, 0.5, 0.127], 0.0, 3)
    added = first.extended(0.127, sinusoid_pair(blocks, 0.127, 0.0))
    assert added.coefficients == pytest.approx(both.coefficients, abs=1e-10)
    assert added.residuals == pytest.approx(both.residuals, abs=1e-10)
    assert added.inverse == pytest.approx(both.inverse, abs=1e-10)


def test_the_course_of_a_decaying_line_falls_as_it_does_and_keeps_its_phase(
    channel: Maker, time: FloatArray, window: Window
) -> None:
    noise = 0.01 * np.random.default_rng(42).standard_normal(2048)
    decaying = np.exp(-time / 30.0) * cosine(time, 0.125, 0.5, 0.7)
    loose = demodulate(fitted(channel(time, cosine(time, 0.25) + decaying + noise), window), HALF)
    followed = track_order(loose, 0.01**2 / 3.0, window.start)
    rate = np.polyfit(followed.time, np.log(followed.amplitude), 1)[0]
    assert rate == pytest.approx(-1.0 / 30.0, rel=0.05)
    assert followed.phase == pytest.approx(0.7, abs=0.2)


def test_the_multitaper_test_sees_a_line_and_is_calibrated_without_one(
    channel: Maker, time: FloatArray, window: Window
) -> None:
    random = np.random.default_rng(43)
    chances = []
    for _ in range(150):
        values = cosine(time, 0.25) + 0.05 * random.standard_normal(2048)
        chances.append(multitaper_test(demodulate(fitted(channel(time, values), window), HALF)).p_value)
    assert np.mean(np.array(chances) < 0.1) == pytest.approx(0.1, abs=0.08)
    locked = cosine(time, 0.25) + cosine(time, 0.125, 0.2) + 0.05 * random.standard_normal(2048)
    assert multitaper_test(demodulate(fitted(channel(time, locked), window), HALF)).p_value < 1e-6


def test_a_track_runs_on_the_channels_clock(channel: Maker, time: FloatArray) -> None:
    late = 100.0 + time
    values = cosine(time, 0.25) + cosine(time, 0.125, 0.5)
    found = track_order(demodulate(fitted(channel(late, values), Window(100.0, 168.0)), HALF), 1e-6, 100.0)
    assert np.mean(found.time) == pytest.approx(100.0 + 0.5 * time[-1], abs=0.5)
    assert 100.0 < found.time[0] < 110.0
