"""The level that a spectrum draws is the level that the test uses."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from scipy.stats import f

from tethertest.records.arrays import FloatArray
from tethertest.records.channel import Window
from tethertest.records.lines import DriveFit, Expectation, LineVerdict
from tethertest.spectra import find_lines
from tethertest.spectra.holm import holm, holm_chances
from tethertest.spectra.orders import ORDERS
from tethertest.spectra.regression import Amplitude
from tethertest.spectra.thomson import blind_search

from .conftest import Maker, autoregressive, cosine

DRIVE = 0.25
LEVEL = 0.01


def test_an_order_is_significant_exactly_up_to_its_chance() -> None:
    random = np.random.default_rng(1)
    for _ in range(100):
        chances = {order: float(10.0 ** random.uniform(-4.5, 0.0)) for order in ORDERS}
        for order, chance in holm_chances(chances, LEVEL).items():
            for factor, significant in ((0.999, True), (1.001, False)):
                moved = holm({**chances, order: factor * chance})
                assert (moved[order] <= LEVEL) is significant


def test_the_chances_of_three_orders_by_hand() -> None:
    one, two, three = Fraction(1), Fraction(2), Fraction(3)
    found = holm_chances({one: 0.001, two: 0.002, three: 0.5}, LEVEL)
    assert found == pytest.approx({one: LEVEL / 2.0, two: LEVEL / 2.0, three: LEVEL})


#: noise by the coefficient of its memory, and amplitudes of about four standard errors in it
WEAK = {0.0: {0.5: 0.0058, 1.5: 0.0058, 4.0: 0.0058}, 0.9: {0.5: 0.07, 1.5: 0.06, 4.0: 0.032}}


@pytest.mark.parametrize("colour", WEAK)
def test_lines_are_significant_above_their_level_and_not_below(
    channel: Maker, time: FloatArray, window: Window, colour: float
) -> None:
    """Weak lines about the level: those found are above it, the others below."""
    random = np.random.default_rng(2)
    drive = DriveFit(DRIVE, 0.0, ("tension_top",))
    above = below = 0
    for _ in range(10):
        values = cosine(time, DRIVE) + 0.05 * autoregressive(random, colour, time.size)
        for order, size in WEAK[colour].items():
            values += cosine(time, order * DRIVE, size * random.uniform(0.7, 1.3), random.uniform(0.0, 6.0))
        found = find_lines(channel(time, values), window, drive, Expectation(), significance=LEVEL)
        adjusted = holm({Fraction(line.order): line.p_value for line in found.lines})
        for line in found.lines:
            assert line.significant_above is not None
            raw = float(np.hypot(line.amplitude, line.standard_error))
            significant = adjusted[Fraction(line.order)] <= LEVEL
            if line.amplitude > 0.0:
                assert (raw >= line.significant_above) is significant
            if line.verdict is not LineVerdict.NONE:
                assert significant
            above += significant
            below += not significant
    assert min(above - 10, below - 60) > 5  # the drive is always found, six orders hold noise alone


def test_the_level_of_white_noise_is_that_of_the_f_test(
    channel: Maker, time: FloatArray, window: Window
) -> None:
    random = np.random.default_rng(3)
    drive = DriveFit(DRIVE, 0.0, ("tension_top",))
    levels = []
    for _ in range(8):
        values = cosine(time, DRIVE) + 0.05 * random.standard_normal(time.size)
        found = find_lines(channel(time, values), window, drive, Expectation(), significance=LEVEL)
        levels += [line.significant_above for line in found.lines if line.order in ("3/2", "5/2", "4")]
    # nine orders are left beside the drive; (1 + 2 F / n)^(-n / 2) is exp(-F) for many degrees of freedom
    expected = 0.05 * np.sqrt(2.0 / time.size) * np.sqrt(2.0 * np.log(9.0 / LEVEL))
    assert np.mean(levels) == pytest.approx(expected, rel=0.04)


def test_a_blind_search_is_sure_exactly_above_its_level(
    channel: Maker, time: FloatArray, window: Window
) -> None:
    random = np.random.default_rng(4)
    values = cosine(time, 2.0, 0.2) + cosine(time, 5.0, 0.02) + 0.1 * autoregressive(random, 0.5, time.size)
    search = blind_search(channel(time, values), window)
    sure = search.amplitude >= search.significant_above
    assert np.array_equal(sure, search.significant)
    assert np.all(np.abs(search.frequency[sure] - 2.0) < search.bandwidth)
    assert sure.any()
    # any amplitude over its level is the root of its F over the F that is needed
    needed = f.isf(0.01 / search.frequency.size, 2, 12)
    found = f.isf(search.p_value, 2, 12)
    assert (search.amplitude / search.significant_above) ** 2 == pytest.approx(found / needed, rel=1e-3)


def test_no_amplitude_is_significant_where_the_noise_has_hardly_a_degree_of_freedom():
    amplitude = Amplitude(1.0, 0.0, 0.1, (0.8, 1.2), 4.0, 0.5, freedom=0.02, at_unit_f=0.1)
    assert amplitude.significant_at(1e-5) == np.inf
    assert replace(amplitude, freedom=20.0).significant_at(1e-5) == pytest.approx(0.1 * 4.65003, rel=1e-5)
