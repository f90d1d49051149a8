"""The drive frequency, joint over channels, and its refusal."""

from __future__ import annotations

import numpy as np
import pytest

from tethertest.errors import DataError
from tethertest.records.arrays import FloatArray
from tethertest.records.channel import Flag, Window
from tethertest.records.lines import Expectation
from tethertest.spectra import find_lines, fit_drive

from .conftest import Maker, autoregressive, cosine


def test_a_drive_seven_percent_off_nominal_is_found_within_its_standard_error(
    channel: Maker, time: FloatArray, window: Window
) -> None:
    random = np.random.default_rng(1)
    true, errors, stated = 0.2678, [], []
    for _ in range(40):
        tension = (
            cosine(time, true, 2.0, 1.0) + cosine(time, 2 * true, 0.4) + autoregressive(random, 0.9, 2048)
        )
        motion = cosine(time, true, 0.1, 0.3) + 0.2 * random.standard_normal(2048)
        fit = fit_drive([channel(time, tension), channel(time, motion, name="heave")], window, 0.25)
        errors.append(fit.frequency - true)
        stated.append(fit.standard_error)
    assert np.mean(errors) == pytest.approx(0.0, abs=4 * np.mean(stated) / np.sqrt(40))
    assert np.std(errors) == pytest.approx(np.mean(stated), rel=0.3)


def test_the_standard_error_is_the_cramer_rao_bound_in_white_noise(
    channel: Maker, time: FloatArray, window: Window
) -> None:
    noise = 0.1 * np.random.default_rng(2).standard_normal(2048)
    fit = fit_drive([channel(time, cosine(time, 0.25) + noise)], window, 0.25)
    bound = np.sqrt(24.0 * 0.1**2 / ((2 * np.pi) ** 2 * 2048 * (2048.0**2 - 1) / 30.0**2))
    assert fit.standard_error == pytest.approx(bound, rel=0.15)


def test_the_quiet_channel_carries_the_joint_fit(channel: Maker, time: FloatArray, window: Window) -> None:
    random = np.random.default_rng(5)
    quiet = channel(time, cosine(time, 0.25) + 0.001 * random.standard_normal(2048), name="heave")
    loud = channel(time, cosine(time, 0.25) + 2.0 * random.standard_normal(2048))
    alone, joint = fit_drive([quiet], window, 0.25), fit_drive([quiet, loud], window, 0.25)
    assert joint.frequency == pytest.approx(alone.frequency, abs=0.1 * alone.standard_error)
    assert joint.channels == ("heave", "tension_top")


def test_noise_alone_is_no_drive_and_the_error_says_what_was_found(
    channel: Maker, time: FloatArray, window: Window
) -> None:
    noise = autoregressive(np.random.default_rng(6), 0.9, 2048)
    with pytest.raises(DataError, match=r"no drive found within 15% of 0\.25 Hz: the strongest line is at"):
        fit_drive([channel(time, noise)], window, 0.25)


def test_a_line_far_from_the_nominal_frequency_is_no_drive(
    channel: Maker, time: FloatArray, window: Window
) -> None:
    noise = 0.1 * np.random.default_rng(7).standard_normal(2048)
    with pytest.raises(DataError, match="no drive found"):
        fit_drive([channel(time, cosine(time, 0.4) + noise)], window, 0.25)


def test_a_channel_without_usable_samples_is_passed_over_or_named(
    channel: Maker, time: FloatArray, window: Window
) -> None:
    noise = 0.1 * np.random.default_rng(8).standard_normal(2048)
    good = channel(time, cosine(time, 0.25) + noise)
    lost = channel(time, noise, name="fbg1").with_flags(np.ones(2048, dtype=bool), Flag.LOST)
    assert fit_drive([lost, good], window, 0.25).channels == ("tension_top",)
    with pytest.raises(DataError, match="'fbg1' has no usable samples"):
        fit_drive([lost], window, 0.25)


def test_a_few_samples_in_a_long_window_are_too_few(channel: Maker, time: FloatArray, window: Window) -> None:
    heave = channel(time, cosine(time, 0.3), name="heave")
    few = heave.with_flags(np.arange(time.size) % 400 > 1, Flag.OUT_OF_RANGE)
    with pytest.raises(DataError, match="too few"):
        fit_drive([few], window, 0.3)


@pytest.mark.parametrize("kept", [0.5, 0.3])
@pytest.mark.parametrize("even", [True, False])
def test_holes_cost_the_frequency_its_error_and_no_more(
    channel: Maker, time: FloatArray, window: Window, kept: float, even: bool
) -> None:
    random = np.random.default_rng(9)
    errors = []
    for _ in range(15):
        noise = 0.1 * random.standard_normal(2048)
        there = np.arange(2048) % round(1.0 / kept) == 0 if even else random.random(2048) < kept
        record = channel(time, cosine(time, 0.25) + noise).with_flags(~there, Flag.MISSING)
        fit = fit_drive([record], window, 0.25)
        bound = np.sqrt(24.0 * 0.1**2 / ((2 * np.pi) ** 2 * 2048 * (2048.0**2 - 1) / 30.0**2) / there.mean())
        assert fit.standard_error == pytest.approx(bound, rel=0.6)
        errors.append((fit.frequency - 0.25) / fit.standard_error)
    assert np.sqrt(np.mean(np.square(errors))) < 1.5


def test_holes_that_fold_orders_on_each_other_are_refused(
    channel: Maker, time: FloatArray, window: Window
) -> None:
    # a sample every second leaves half a hertz; blocks of the full rate would take orders up to four hertz
    record = channel(time, cosine(time, 0.25)).with_flags(np.arange(2048) % 30 != 0, Flag.MISSING)
    with pytest.raises(DataError, match=r"tell the frequencies apart|too few"):
        fit_drive([record], window, 0.25)


def test_a_channel_that_is_zero_throughout_is_named(channel: Maker, time: FloatArray, window: Window) -> None:
    silent = channel(time, np.zeros(time.size), name="velocity at the top")
    moving = channel(time, cosine(time, 0.25) + 0.1 * np.random.default_rng(11).standard_normal(2048))
    drive = fit_drive([silent, moving], window, 0.25)
    assert drive.channels == ("tension_top",)
    with pytest.raises(DataError, match="'velocity at the top' is zero from"):
        find_lines(silent, window, drive, Expectation())
