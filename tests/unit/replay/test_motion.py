"""The measured bottom motion on its way to the solver."""

from __future__ import annotations

import numpy as np
import pytest

from tethertest.errors import DataError
from tethertest.records.channel import Channel, Flag, Window
from tethertest.replay import bottom_motion

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
