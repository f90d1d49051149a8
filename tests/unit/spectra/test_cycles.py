"""Load cycles against the worked example of the standard; blind lines; notes on resonance."""

from __future__ import annotations

import numpy as np
import pytest

from tethertest.errors import DataError
from tethertest.records.channel import Flag, Window
from tethertest.records.response import NaturalFrequency
from tethertest.spectra.cycles import count_cycles, extremes, turning_points
from tethertest.spectra.resonances import resonance_notes
from tethertest.spectra.thomson import blind_search, peaks

from .conftest import Maker, cosine

#: ASTM E1049-85, figure 6: the series and its cycles
SERIES = np.array([-2.0, 1.0, -3.0, 5.0, -1.0, 3.0, -4.0, 4.0, -2.0])
CYCLES = {3.0: 0.5, 4.0: 1.5, 6.0: 0.5, 8.0: 1.0, 9.0: 0.5}


def test_the_standards_example(channel: Maker) -> None:
    counted = count_cycles(channel(np.arange(9.0), SERIES))
    sums: dict[float, float] = {}
    for cycle in counted.cycles:
        sums[cycle.range] = sums.get(cycle.range, 0.0) + cycle.count
    assert sums == CYCLES
    assert counted.number == 4.0
    damage = sum(count * size**4 for size, count in CYCLES.items())
    assert counted.equivalent_range == pytest.approx((damage / 4.0) ** 0.25)


def test_noise_makes_no_cycles_and_takes_none(channel: Maker) -> None:
    time = np.arange(10_000) / 1000.0
    noise = 0.01 * np.random.default_rng(4).standard_normal(time.size)
    counted = count_cycles(channel(time, cosine(time, 1.0, 2.0) + noise, noise=0.01))
    assert counted.number == pytest.approx(10.0, abs=0.5)
    assert counted.cycles[0].range == pytest.approx(4.0, abs=0.08)
    assert count_cycles(channel(time, noise, noise=0.01)).number <= 0.5


def test_a_gate_keeps_the_turns_that_it_does_not_forbid() -> None:
    series = np.array([0.0, 1.0, 0.9, 2.0, 1.95, 0.0, 0.05, 0.0, 1.0])
    np.testing.assert_array_equal(turning_points(series, 0.2), [0.0, 2.0, 0.0, 1.0])


def test_extremes_leave_flagged_samples_out(channel: Maker) -> None:
    time = np.arange(100) / 10.0
    record = channel(time, np.where(time == 5.0, 99.0, np.sin(time))).with_flags(time == 5.0, Flag.SPIKE)
    found = extremes(record)
    assert found.maximum == pytest.approx(1.0, abs=2e-3)
    assert found.minimum_time == pytest.approx(4.7)
    with pytest.raises(DataError, match="no usable sample"):
        extremes(record, Window(5.0, 5.0))


def test_a_blind_search_finds_lines_and_invents_few(channel: Maker) -> None:
    random = np.random.default_rng(5)
    time = np.arange(2048) / 30.0
    window = Window(0.0, float(time[-1]))
    false = sum(
        any(
            peak.significant
            for peak in peaks(blind_search(channel(time, random.standard_normal(2048)), window))
        )
        for _ in range(100)
    )
    assert false <= 5  # at a chance of 1 %, six are seen once in 1800 times
    mixed = cosine(time, 0.5) + cosine(time, 1.5, 0.3) + 0.1 * random.standard_normal(2048)
    found = [peak for peak in peaks(blind_search(channel(time, mixed), window)) if peak.significant]
    assert [peak.frequency for peak in found[:2]] == pytest.approx([0.5, 1.5], abs=0.005)
    assert [peak.amplitude for peak in found[:2]] == pytest.approx([1.0, 0.3], rel=0.05)


def test_a_drive_at_twice_a_natural_frequency_may_pump_it() -> None:
    pendulum = [NaturalFrequency("pendulum", 0.281)]
    assert "possible parametric resonance" in resonance_notes(0.57, pendulum, 0.1)[0]
    assert resonance_notes(0.57, pendulum, 0.1)[0].endswith("order 1/2")
    assert resonance_notes(0.7, pendulum, 0.1) == ()
    assert resonance_notes(0.65, pendulum, 1.0) != ()  # the tongue widens with the modulation
    assert "is near pendulum" in resonance_notes(0.29, pendulum)[0]


def test_sixteen_samples_are_the_fewest_of_a_blind_search(channel: Maker) -> None:
    time = np.arange(16.0)
    assert blind_search(channel(time, cosine(time, 0.3)), Window(0.0, 15.0)).bandwidth == 0.25
    with pytest.raises(DataError, match="15 samples in the window"):
        blind_search(channel(time, cosine(time, 0.3)), Window(0.0, 14.5))


def test_an_exponent_of_zero_is_none(channel: Maker) -> None:
    with pytest.raises(DataError, match="found 0, expected a number above zero"):
        count_cycles(channel(np.arange(9.0), SERIES), exponent=0.0)
