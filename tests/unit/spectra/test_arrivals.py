"""Fronts, kinks and wave speeds against exact onsets and the coupled linear cable."""

from __future__ import annotations

import numpy as np
import pytest

from tethertest import Bottom, Cable, Geometry, Output, Scene, Top, solve
from tethertest.errors import DataError
from tethertest.records.channel import Channel, Window
from tethertest.records.events import Front
from tethertest.spectra.arrivals import find_front, find_kink
from tethertest.spectra.wave_speed import wave_speed

from .conftest import Maker

LENGTH, MASS, TENSION, STIFFNESS = 250.0, 0.02, 80.0, 120.17
AXIAL, TRANSVERSE = np.sqrt((STIFFNESS + TENSION) / MASS), np.sqrt(TENSION / MASS)


def onset(power: int, since: np.ndarray) -> np.ndarray:
    """A jump, or a ramp or a parabola of 15 ms."""
    return np.where(since > 0.0, np.clip(since / 0.015, 0.0, 1.0) ** power, 0.0)


@pytest.mark.parametrize("power", [0, 1, 2])
@pytest.mark.parametrize("noise", [0.0, 0.01])
def test_the_interval_holds_the_onset(channel: Maker, power: int, noise: float) -> None:
    random = np.random.default_rng(7)
    held = 0
    for _ in range(60):
        time = np.arange(1000) / 1000.0 + random.uniform(0.0, 1e-3)
        true = 0.5 + random.uniform(0.0, 0.01)
        values = 3.6 + onset(power, time - true) + noise * random.standard_normal(time.size)
        found = find_front(channel(time, values, at=0.0, noise=noise), Window(0.1, 0.9))
        assert found is not None
        held += found.interval[0] <= true <= found.interval[1]
        # a clean jump lies between two samples
        assert found.interval[1] - found.interval[0] < (0.012 if power or noise else 1.05e-3)
    assert held >= 58


def test_noise_alone_has_no_front(channel: Maker) -> None:
    time = np.arange(5000) / 1000.0
    values = 0.01 * np.random.default_rng(8).standard_normal(time.size)
    assert find_front(channel(time, values, at=0.0, noise=0.01), Window(0.1, 4.9)) is None


@pytest.fixture(scope="module")
def article() -> list[Channel]:
    """Condition 1.1 of the source article after a jump of velocity, at three gauges."""
    scene = Scene(
        name="condition 1.1",
        cable=Cable(LENGTH, "equilibrium", MASS, axial_stiffness=STIFFNESS),
        geometry=Geometry("shallow", tension=TENSION),
        bottom=Bottom("harmonic", "tangent", amplitude=2.0, frequency=0.18),
        top=Top("fixed"),
        output=Output(8.0, 400.0, (0.25, 0.5, 1.0)),
        gravity=9.81,
    )
    response = solve(scene, fidelity="linear")
    none = np.zeros(response.time.size, dtype=np.uint16)
    return [
        Channel(f"t{at}", "tension", "N", response.time, response.tension[:, g], none, at=float(at))
        for g, at in enumerate(response.gauges)
    ]


def test_axial_fronts_give_speed_and_stiffness(article: list[Channel]) -> None:
    fronts = [find_front(item, Window(0.12, 8.0)) for item in article]
    assert all(front is not None for front in fronts)
    found = [front for front in fronts if front is not None]
    for front in found:
        assert front.interval[0] <= front.at * LENGTH / AXIAL <= front.interval[1]
    speed = wave_speed(found, "axial", LENGTH, MASS, static_tension=TENSION)
    assert speed.interval[0] <= AXIAL <= speed.interval[1]
    assert speed.value == pytest.approx(STIFFNESS, rel=0.005)
    assert speed.value_interval[0] <= STIFFNESS <= speed.value_interval[1]
    assert speed.implied == "axial_stiffness"


def test_fronts_that_may_be_of_one_instant_give_no_speed_but_a_bound() -> None:
    fronts = [Front("bottom", 0.0, 1.0, (0.99, 1.01)), Front("top", 1.0, 1.0, (0.995, 1.005))]
    speed = wave_speed(fronts, "axial", LENGTH, MASS)
    assert np.isinf(speed.speed)
    assert np.isinf(speed.interval[1])
    assert speed.interval[0] == pytest.approx(LENGTH / 0.015, rel=1e-6)


def test_the_transverse_wave_is_a_kink_that_gives_the_tension(article: list[Channel]) -> None:
    fronts = []
    for item in article:
        assert item.at is not None
        due = item.at * LENGTH / TRANSVERSE
        axial = [trip * LENGTH / AXIAL for trip in (item.at, 2.0 - item.at, 2.0 + item.at)]
        kink = find_kink(item, Window(0.7 * due, 1.5 * due), [(at, at) for at in axial])
        assert kink is not None
        assert kink.interval[0] <= due <= kink.interval[1]
        fronts.append(kink)
    speed = wave_speed(fronts, "transverse", LENGTH, MASS, at_bottom=0.0)
    assert speed.value_interval[0] <= TENSION <= speed.value_interval[1]
    assert speed.value == pytest.approx(TENSION, rel=0.005)


def test_a_smooth_record_has_no_kink(channel: Maker) -> None:
    time = np.arange(2000) / 400.0
    noise = 0.01 * np.random.default_rng(9).standard_normal(time.size)
    smooth = channel(time, np.cos(2 * np.pi * 0.3 * time) + noise, at=0.0)
    assert find_kink(smooth, Window(1.0, 4.0)) is None


def front(at: float, low: float, high: float) -> Front:
    return Front(f"at {at}", at, 0.5 * (low + high), (low, high))


def test_the_interval_of_the_speed_is_the_steepest_and_the_flattest_line() -> None:
    speed = wave_speed([front(0.0, 0.0, 0.1), front(1.0, 1.0, 1.1)], "axial", 10.0, 2.0)
    assert speed.interval == pytest.approx((10.0 / 1.1, 10.0 / 0.9))
    assert speed.speed == pytest.approx(10.0)
    assert speed.value == pytest.approx(200.0)
    at_once = wave_speed([front(0.0, 0.0, 0.1), front(1.0, 0.05, 0.15)], "axial", 10.0, 2.0)
    assert at_once.interval[1] == np.inf


def test_fronts_of_no_one_wave_are_refused() -> None:
    wrong = [front(0.0, 0.0, 0.1), front(0.5, 3.0, 3.1), front(1.0, 1.0, 1.1)]
    with pytest.raises(DataError, match="no wave of one speed"):
        wave_speed(wrong, "axial", 10.0, 2.0)
    with pytest.raises(DataError, match="one place"):
        wave_speed([front(0.5, 0.0, 0.1)], "axial", 10.0, 2.0)
