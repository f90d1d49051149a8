"""Order tracking: a wandering drive smears the orders, its own angle gathers them again."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tethertest.records.arrays import FloatArray
from tethertest.records.channel import Channel, Flag, Window
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


def crank(turned: FloatArray, half: float = 0.0) -> FloatArray:
    """Height of a crank-slider's slider; a gear error brings half the speed in."""
    angle = 2.0 * np.pi * 0.3 * turned - 1.3
    rod = np.sqrt(16.0 - np.sin(angle) ** 2) - 4.0
    return np.asarray(0.1 * (np.cos(angle) + rod) + half * np.sin(0.5 * angle))


def encoder(channel: Maker, time: FloatArray, values: FloatArray) -> Channel:
    """Return a motion logged without its level taken out."""
    motion: Channel = channel(time, values + 0.02, name="heave", kind="displacement", unit="m", at=0.0)
    return motion


@pytest.mark.parametrize("half", [0.0, 0.003])
@pytest.mark.parametrize("cycles", [7, 10])
def test_a_steady_crank_with_its_harmonics_does_not_wander(channel: Maker, half: float, cycles: int) -> None:
    time = np.arange(0.0, cycles / 0.3, 0.005)
    heave = encoder(channel, time, crank(time, half))
    window = Window(0.0, float(time[-1]))
    found = crank_angle(heave, window, fit_drive([heave], window, 0.3))
    assert not found.varies
    assert found.wander < 1e-3


def test_lost_rows_of_the_encoder_are_no_wander(channel: Maker) -> None:
    time = np.arange(0.0, 33.0, 0.005)
    kept = np.ones(time.size, dtype=bool)
    for start in (900, 2600, 4100):
        kept[start : start + 150] = False
    heave = encoder(channel, time[kept], crank(time[kept]))
    window = Window(0.0, 33.0)
    found = crank_angle(heave, window, fit_drive([heave], window, 0.3))
    assert found.clear
    assert found.wander < 1e-3


def test_a_motion_that_is_missing_for_a_turn_tells_nothing(channel: Maker) -> None:
    time = np.arange(0.0, 33.0, 0.005)
    kept = (time < 12.0) | (time > 15.5)
    heave = encoder(channel, time[kept], crank(time[kept]))
    window = Window(0.0, 33.0)
    assert not crank_angle(heave, window, fit_drive([heave], window, 0.3)).clear


def test_a_channel_that_begins_before_the_motion_keeps_its_pace(
    heave: Channel, tension: Channel, window: Window
) -> None:
    angle = crank_angle(heave.between(0.35, 67.0), window, fit_drive([heave], window, 0.25))
    steadied = angle.steadied(tension)
    assert angle.time[0] > steadied.time[0]
    assert np.diff(steadied.time)[:5] == pytest.approx(np.diff(tension.time)[:5], rel=1e-6)


def test_a_swing_of_the_speed_is_no_subharmonic_with_the_motion_or_without(
    channel: Maker, time: FloatArray, window: Window
) -> None:
    """A swing every third turn puts lines at 2/3 and 4/3: less on the crank's angle, and never called."""
    swing = np.sin(2.0 * np.pi * time / 12.0)
    turned = time + 0.025 * 12.0 / (2.0 * np.pi) * swing
    noise = np.random.default_rng(55).standard_normal(time.size)
    record = channel(time, cosine(turned, 0.25) + 0.05 * noise)
    motion = encoder(channel, time, cosine(turned, 0.25, 0.1, 0.4))
    drive = fit_drive([motion], window, 0.25)
    blind = find_lines(record, window, drive, Expectation()).line("2/3")
    told = find_lines(record, window, drive, Expectation(), crank=crank_angle(motion, window, drive)).line(
        "2/3"
    )
    assert blind is not None
    assert told is not None
    assert blind.amplitude == pytest.approx(0.0375, abs=0.006)
    assert blind.verdict is LineVerdict.UNDETERMINED
    assert told.amplitude < 0.5 * blind.amplitude
    assert told.verdict is not LineVerdict.SUBHARMONIC


def test_the_scale_of_a_cell_is_a_part_of_the_interval_of_its_own(
    channel: Maker, time: FloatArray, window: Window
) -> None:
    record = channel(
        time, cosine(time, 0.25, 2.0) + 0.02 * np.random.default_rng(56).standard_normal(time.size)
    )
    drive = fit_drive([record], window, 0.25)
    bare = find_lines(record, window, drive, Expectation()).line("1")
    cell = find_lines(replace(record, uncertainty=0.01), window, drive, Expectation()).line("1")
    assert bare is not None
    assert cell is not None
    assert bare.calibration_error == 0.0
    assert cell.calibration_error == pytest.approx(0.02, rel=1e-3)
    assert (cell.standard_error, cell.phase) == (bare.standard_error, bare.phase)
    assert cell.interval[1] - cell.amplitude == pytest.approx(
        1.96 * np.hypot(0.02, cell.standard_error), rel=1e-3
    )


def test_lost_peaks_leave_no_amplitude_standing(channel: Maker, time: FloatArray, window: Window) -> None:
    values = cosine(time, 0.25, 2.0) + 0.02 * np.random.default_rng(57).standard_normal(time.size)
    record = channel(time, values).with_flags(values > 1.5, Flag.SATURATED)
    line = find_lines(record, window, fit_drive([record], window, 0.25), Expectation()).line("1")
    assert line is not None
    assert line.verdict is LineVerdict.UNDETERMINED


def test_a_wander_that_noise_may_feign_casts_no_doubt_on_a_line(
    channel: Maker, time: FloatArray, window: Window
) -> None:
    random = np.random.default_rng(53)
    steady = channel(time, cosine(time, 0.25, 0.1) + 1e-4 * random.standard_normal(2048), name="heave")
    locked = cosine(time, 0.25) + cosine(time, 0.125, 0.1, 1.0) + 0.02 * random.standard_normal(2048)
    drive = fit_drive([steady], window, 0.25)
    crank = crank_angle(steady, window, drive)
    assert crank is not None
    # a third of it would be three times the line; but twice as much is still noise
    feigned = replace(crank, wander=1.0, noise=0.5)
    assert not feigned.varies
    half = find_lines(channel(time, locked), window, drive, Expectation(), crank=feigned).line("1/2")
    assert half is not None
    assert half.verdict is LineVerdict.SUBHARMONIC
