"""The measured bottom motion on its way to the solver."""

from __future__ import annotations

import numpy as np
import pytest

from tethertest.errors import DataError
from tethertest.records.channel import Channel, Flag, Window
from tethertest.replay import BottomMotion, bottom_motion

RATE = 200.0


def heave(noise: float = 1e-5, frequency: float = 0.3) -> Channel:
    time = 2.0 + np.arange(0.0, 60.0, 1.0 / RATE)
    values = 0.1 * np.sin(2 * np.pi * frequency * (time - 10.0)) * np.clip((time - 10.0) / 8.0, 0.0, 1.0)
    values += 0.0006 * np.sin(np.pi * np.clip((time - 5.0) / 0.06, 0.0, 1.0)) ** 2  # a marker tap
    values += 0.037 + noise * np.random.default_rng(1).standard_normal(time.size)
    return Channel("heave", "displacement", "m", time, values, np.zeros(time.size, dtype=np.uint16), at=0.0)


def smoothed(channel: Channel) -> tuple[np.ndarray, np.ndarray]:
    motion = bottom_motion(channel, frequency=0.3, rest_before=Window(2.0, 9.9), steady=Window(20.0, 60.0))
    return motion.motion.time + motion.start, motion.motion.displacement


def test_displacement_counts_from_rest_and_keeps_the_drive() -> None:
    time, values = smoothed(heave())
    steady = (time > 20.0) & (time < 60.0)
    wanted = 0.1 * np.sin(2 * np.pi * 0.3 * (time - 10.0))
    assert np.abs(values[steady] - wanted[steady]).max() < 1e-4
    assert abs(np.median(values[time < 9.0])) < 2e-6


def test_a_tap_at_rest_survives_while_noise_under_the_drive_does_not() -> None:
    time, values = smoothed(heave())
    assert values[np.abs(time - 5.03) < 0.01].max() == pytest.approx(6e-4, rel=0.1)
    steady = (time > 20.0) & (time < 60.0)
    rough = np.std(np.diff(values[steady], 3))
    assert rough < 0.05 * np.std(np.diff(1e-5 * np.random.default_rng(2).standard_normal(4000), 3))


def test_a_hole_is_bridged_and_not_replayed_as_a_jump() -> None:
    channel = heave()
    broken = channel.values.copy()
    broken[5000:5010] = np.nan
    spoiled = channel.with_values(broken).with_flags(np.isnan(broken), Flag.MISSING)
    assert np.abs(smoothed(spoiled)[1] - smoothed(channel)[1]).max() < 2e-4


def test_a_channel_without_data_is_refused() -> None:
    channel = heave()
    empty = channel.with_flags(np.ones(channel.time.size, dtype=bool), Flag.MISSING)
    with pytest.raises(DataError, match="0 usable samples"):
        smoothed(empty)


#: a drive with a second order and a gear error, as a crank-slider makes them
def driven(time: np.ndarray) -> np.ndarray:
    angle = 2 * np.pi * 0.31 * time
    return 0.1 * np.sin(angle) - 0.006 * np.cos(2 * angle) + 0.002 * np.sin(0.5 * angle + 1.0) + 0.02


def running(start: float, stop: float, *, from_rest: bool = True) -> Channel:
    """A log from `start` to `stop`; the drive ramps up from 10 s on unless it runs for ever."""
    time = np.arange(start, stop, 1.0 / RATE)
    share = np.clip((time - 10.0) / 8.0, 0.0, 1.0) if from_rest else np.ones(time.size)
    values = share**2 * (3.0 - 2.0 * share) * driven(time)
    values = values + 1e-5 * np.random.default_rng(3).standard_normal(time.size)
    return Channel("hub", "displacement", "m", time, values, np.zeros(time.size, np.uint16), at=0.0)


def acceleration(motion: BottomMotion) -> tuple[np.ndarray, np.ndarray]:
    time = motion.motion.time + motion.start
    return time[2:-2], np.gradient(np.gradient(motion.motion.displacement, 1 / RATE), 1 / RATE)[2:-2]


@pytest.mark.parametrize("stop", [43.1, 43.9, 44.77, 45.5])
def test_a_log_that_ends_with_the_drive_running_invents_no_stop(stop: float) -> None:
    motion = bottom_motion(
        running(0.0, stop), frequency=0.312, rest_before=Window(0.0, 9.0), steady=Window(20.0, stop)
    )
    time, found = acceleration(motion)
    wanted = np.gradient(np.gradient(driven(time), 1 / RATE), 1 / RATE)
    late = (time > 25.0) & (time < stop - 0.05)
    # 0.45 m/s^2 is the drive; the last 0.4 s made twice as much of a reflection
    assert np.abs(found - wanted)[late].max() < 0.02
    assert motion.unknown == (
        (pytest.approx(stop - 3.0 / motion.cutoff, abs=0.01), pytest.approx(stop, abs=0.01)),
    )


def test_a_log_that_starts_with_the_drive_running_is_led_in_from_rest() -> None:
    heave = running(30.0, 70.0, from_rest=False)
    motion = bottom_motion(heave, frequency=0.309, rest_after=None, steady=Window(30.0, 70.0))
    time, values = motion.motion.time + motion.start, motion.motion.displacement
    assert motion.start < 30.0 - 3 / 0.31
    assert values[0] == 0.0
    within = (time > 30.0) & (time < 68.5)
    offset = np.mean(values[within] - driven(time[within]))
    assert np.abs(values[within] - driven(time[within]) - offset).max() < 2e-4
    # no jolt at the joint: the lead-in accelerates no more than the drive itself
    moments, found = acceleration(motion)
    assert np.abs(found[moments < 32.0]).max() < 1.2 * np.abs(found[moments > 32.0]).max()
    assert motion.unknown[0] == (motion.start, pytest.approx(30.0 + 3.0 / motion.cutoff))


def test_where_only_the_end_rests_displacement_counts_from_there() -> None:
    heave = running(30.0, 70.0, from_rest=False)
    stopped = heave.time > 60.0
    heave = heave.with_values(np.where(stopped, 0.055, heave.values))
    motion = bottom_motion(heave, frequency=0.31, rest_after=Window(62.0, 70.0), steady=Window(31.0, 59.0))
    late = motion.motion.time + motion.start > 64.0
    assert np.abs(motion.motion.displacement[late]).max() < 1e-4


@pytest.mark.parametrize("flag", [Flag.MISSING, Flag.STUCK])
def test_a_record_ends_where_its_usable_samples_do(flag: Flag) -> None:
    """An encoder that dies under the drive has not stopped the drive."""
    heave = running(0.0, 60.0)
    dead = heave.time > 43.9
    value = np.nan if flag is Flag.MISSING else heave.values[np.argmax(dead)]
    lost = heave.with_values(np.where(dead, value, heave.values)).with_flags(dead, flag)
    windows = {"rest_before": Window(0.0, 9.0), "steady": Window(20.0, 43.0)}
    found = bottom_motion(lost, frequency=0.31, **windows)
    wanted = bottom_motion(heave.between(0.0, 43.9), frequency=0.31, **windows)
    assert np.array_equal(found.motion.displacement, wanted.motion.displacement)
    assert found.unknown == wanted.unknown
    blind = heave.time < 30.0
    late = heave.with_flags(blind, flag)
    assert bottom_motion(late, frequency=0.31, steady=Window(32.0, 58.0)).unknown[0][1] > 30.0


def test_a_ramp_at_the_end_is_not_continued_and_half_the_filter_is_not_known() -> None:
    motion = bottom_motion(
        running(0.0, 16.0), frequency=0.31, rest_before=Window(0.0, 9.0), steady=Window(12.0, 16.0)
    )
    assert motion.unknown == (
        (pytest.approx(16.0 - 5.1 / motion.cutoff, abs=0.01), pytest.approx(16.0, abs=0.01)),
    )


@pytest.mark.parametrize("length", [0.1, 0.4, 1.0])
def test_a_hole_in_the_drive_is_filled_by_what_repeats_and_not_known_itself(length: float) -> None:
    heave = running(0.0, 60.0)
    lost = (heave.time > 40.0) & (heave.time < 40.0 + length)
    holed = heave.with_values(np.where(lost, np.nan, heave.values)).with_flags(lost, Flag.MISSING)
    motion = bottom_motion(holed, frequency=0.31, rest_before=Window(0.0, 9.0), steady=Window(20.0, 58.0))
    time = motion.motion.time + motion.start
    near = (time > 35.0) & (time < 45.0)
    assert np.abs(motion.motion.displacement - driven(time))[near].max() < 2e-4
    spans, beside = [span for span in motion.unknown if span[0] < 50.0], 0.5 / motion.cutoff
    assert spans == [
        (pytest.approx(40.0 - beside, abs=0.02), pytest.approx(40.0 + length + beside, abs=0.02))
    ]


def test_a_hole_in_a_ramp_spoils_half_the_filter_beside_it() -> None:
    heave = running(0.0, 60.0)
    lost = (heave.time > 13.0) & (heave.time < 13.5)
    holed = heave.with_flags(lost, Flag.MISSING)
    motion = bottom_motion(holed, frequency=0.31, rest_before=Window(0.0, 9.0), steady=Window(20.0, 58.0))
    beside = 5.1 / motion.cutoff
    assert motion.unknown[0] == (
        pytest.approx(13.0 - beside, abs=0.02),
        pytest.approx(13.5 + beside, abs=0.02),
    )


def test_a_run_at_rest_at_both_ends_is_known_throughout() -> None:
    heave = running(0.0, 60.0)
    stopped = heave.with_values(np.where(heave.time > 50.0, 0.0, heave.values))
    motion = bottom_motion(stopped, frequency=0.31, rest_before=Window(0.0, 9.0), steady=Window(20.0, 49.0))
    assert motion.unknown == ()
    assert motion.start == 0.0
