"""Peaks find their gratings through losses, slips, ghosts and strain beyond half the spacing."""

from __future__ import annotations

import numpy as np
import pytest

from reports.lost_gratings.cases import random_case
from reports.lost_gratings.judge import judge
from tethertest.conditioning.gratings.assignment import assigned
from tethertest.records.cable import Cable, Platform
from tethertest.records.channel import Channel, Flag
from tethertest.records.rig import Instrument, Limits, Rig, Sensor

TIME = np.arange(2000) * 0.01
PLACES = np.array([1510.0, 1513.0, 1516.2, 1519.0])
SWING = np.where(TIME > 2.0, np.sin(2 * np.pi * 0.3 * (TIME - 2.0)), 0.0)


def rig(expected=PLACES, capture=1.4, fibres=(None,) * 4):
    sensors = tuple(
        Sensor(
            f"g{number + 1}", "wavelength", at=0.5, expected=1e-9 * at, capture=1e-9 * capture, fibre=fibre
        )
        for number, (at, fibre) in enumerate(zip(expected, fibres, strict=True))
    )
    return Rig("r", Cable(3.0, "unstretched", 0.05), Platform(0.4, 5.0), sensors,
               (Instrument("i", 100.0),), Limits())  # fmt: skip


def logged(columns, names=("g1", "g2", "g3", "g4")):
    return [
        Channel(name, "wavelength", "m", TIME, 1e-9 * values, np.zeros(TIME.size, np.uint16))
        for name, values in zip(names, np.asarray(columns).T, strict=True)
    ]


def truth(swing):
    noise = np.random.default_rng(4).normal(0, 1e-3, (TIME.size, 4))
    return PLACES + swing * SWING[:, None] * np.array([1.0, 0.95, 1.05, 1.0]) + noise


def slipped(true, lost):
    """Return columns as FBGS writes them: later gratings move up one place where one is lost."""
    return np.sort(np.where(lost, np.nan, true), axis=1)


def check(channels, true, lost, least=1.0):
    kept = 0
    for number, channel in enumerate(channels):
        given = np.isfinite(channel.values)
        np.testing.assert_array_equal(channel.values[given], 1e-9 * true[given, number])
        assert not given[lost[:, number]].any()
        assert (channel.flags[~given] & np.uint16(Flag.LOST)).all()
        kept += np.count_nonzero(given)
    assert kept >= least * np.count_nonzero(~lost)


def test_strain_beyond_half_the_spacing_is_tracked_through_losses():
    true = truth(2.4)  # 80 % of the spacing
    lost = np.zeros(true.shape, dtype=bool)
    lost[700:1100, 0] = lost[900:1300, 2] = lost[1500, 1:3] = True
    channels, findings = assigned(logged(slipped(true, lost)), rig(capture=2.7))
    check(channels, true, lost)
    assert not findings
    assert (channels[3].flags[1000] & np.uint16(Flag.SLIPPED)) != 0


def test_nearest_expected_wavelength_alone_would_be_wrong_there():
    true = truth(2.4)
    nearest = np.argmin(np.abs(true[:, :, None] - PLACES), axis=2)
    assert np.mean(nearest != np.arange(4)) > 0.2


def test_what_may_be_either_grating_is_left_empty_and_told():
    even = PLACES[0] + 3.0 * np.arange(4)
    true = even + 2.4 * SWING[:, None] + np.random.default_rng(5).normal(0, 1e-3, (TIME.size, 4))
    lost = np.zeros(true.shape, dtype=bool)
    lost[1000:1130] = lost[1180:1300] = True
    lost[1130:1180, 0] = True  # three of four, evenly spaced, between times when nothing was seen
    channels, findings = assigned(logged(slipped(true, lost)), rig(even, 2.7))
    check(channels, true, lost, 0.7)
    assert {item.kind for item in findings} == {"peaks_in_doubt"}
    assert np.isnan(channels[1].values[1130:1180]).all()


def test_a_ghost_beside_a_grating_does_not_take_its_place():
    true = truth(0.6)
    lost = np.zeros(true.shape, dtype=bool)
    lost[600:900, 1] = True
    ghost = np.full((TIME.size, 1), np.nan)
    ghost[500:1000] = 1513.3
    columns = np.sort(np.hstack((np.where(lost, np.nan, true), ghost)), axis=1)
    names = tuple(f"CH1 peak{number}" for number in range(1, 6))
    channels, _ = assigned(logged(columns, names), rig())
    check(channels, true, lost, 0.98)


def test_gratings_of_another_fibre_at_the_same_wavelengths_are_apart():
    true = truth(0.6)
    columns = np.column_stack((true[:, :2], true[:, :2] + 0.2))
    names = ("CH1 peak1", "CH1 peak2", "CH2 peak1", "CH2 peak2")
    both = rig(PLACES[[0, 1, 0, 1]], fibres=(1, 1, 2, 2))
    channels, _ = assigned(logged(columns, names), both)
    for number, channel in enumerate(channels):
        np.testing.assert_array_equal(channel.values, 1e-9 * columns[:, number])


@pytest.mark.parametrize("seed", [0, 7, 23, 92, 152])
def test_random_logs_give_no_grating_the_value_of_another(seed):
    outcome = judge(random_case(seed))
    assert (outcome.wrong, outcome.unflagged) == (0, 0)
    assert outcome.lost > 0


@pytest.mark.verify
def test_no_wrong_value_in_200_random_logs():
    outcomes = [judge(random_case(seed)) for seed in range(200)]
    assert sum(item.wrong + item.unflagged for item in outcomes) == 0
    plain = [item for item in outcomes if item.case.clear and not item.case.ghosts]
    assert min(item.kept / item.visible for item in plain) > 0.99
    assert sum(item.ghosts_taken for item in outcomes) < 1e-4 * sum(item.visible for item in outcomes)
