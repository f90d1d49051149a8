"""Order tracking: a wandering drive smears the orders, its own angle gathers them again."""

from __future__ import annotations

import numpy as np
import pytest

from tethertest.records.arrays import FloatArray
from tethertest.records.channel import Channel, Window
from tethertest.records.lines import Expectation, LineVerdict
from tethertest.spectra import find_lines, fit_drive
from tethertest.spectra.crank_angle import crank_angle

from .conftest import Maker, cosine

PERIOD = 30.0  #: of the wander [s]


@pytest.fixture
def turned(time: FloatArray) -> FloatArray:
    """The crank's own time: speed 3 % up and down."""
    return np.asarray(time + 0.03 * PERIOD / (2.0 * np.pi) * np.sin(2.0 * np.pi * time / PERIOD))


@pytest.fixture
def heave(channel: Maker, time: FloatArray, turned: FloatArray) -> Channel:
    noise = 1e-4 * np.random.default_rng(51).standard_normal(2048)
    return channel(
        time, cosine(turned, 0.25, 0.1, 0.4) + noise, name="heave", kind="displacement", unit="m", at=0.0
    )


@pytest.fixture
def tension(channel: Maker, time: FloatArray, turned: FloatArray) -> Channel:
    noise = 0.02 * np.random.default_rng(52).standard_normal(2048)
    parts = cosine(turned, 0.25) + cosine(turned, 0.125, 0.05, 1.0) + cosine(turned, 1.25, 0.1, 0.3)
    return channel(time, parts + noise)


def test_the_angle_follows_the_speed(heave: Channel, window: Window) -> None:
    crank = crank_angle(heave, window, fit_drive([heave], window, 0.25))
    assert crank.varies
    assert crank.speed_variation == pytest.approx(0.03 / np.sqrt(2.0), rel=0.15)


@pytest.mark.parametrize("measured", [True, False])
def test_orders_of_a_wandering_crank_are_found_on_its_angle(
    measured: bool, heave: Channel, tension: Channel, window: Window
) -> None:
    drive = fit_drive([heave if measured else tension], window, 0.25)
    crank = crank_angle(heave, window, drive) if measured else None
    lines = find_lines(tension, window, drive, Expectation(), crank=crank)
    half, fifth = lines.line("1/2"), lines.line("5")
    assert half is not None
    assert fifth is not None
    assert lines.speed_variation > 0.01
    assert half.verdict is LineVerdict.SUBHARMONIC
    assert half.amplitude == pytest.approx(0.05, abs=0.004)
    assert fifth.amplitude == pytest.approx(0.1, abs=0.01)


def test_a_steady_crank_is_left_alone(channel: Maker, time: FloatArray, window: Window) -> None:
    noise = 0.05 * np.random.default_rng(53).standard_normal(2048)
    record = channel(time, cosine(time, 0.25) + noise)
    drive = fit_drive([record], window, 0.25)
    assert not crank_angle(record, window, drive).varies
    assert find_lines(record, window, drive, Expectation()).speed_variation == 0.0


def test_a_free_line_beside_a_half_order_is_no_wander(
    channel: Maker, time: FloatArray, window: Window
) -> None:
    noise = 0.02 * np.random.default_rng(54).standard_normal(2048)
    record = channel(time, cosine(time, 0.25) + cosine(time, 0.132, 0.3, 1.0) + noise)
    drive = fit_drive([record], window, 0.25)
    assert find_lines(record, window, drive, Expectation()).speed_variation == 0.0
