"""The steady window of a run stays inside what is compared in it."""

from __future__ import annotations

import numpy as np
import pytest

from tethertest.conditioning.rest import windows_of
from tethertest.records.channel import Channel, Flag, Window

from .conftest import make_bench

RATE, FREQUENCY, REACH = 100.0, 0.5, 1.5
RUN = make_bench().run


def driven(name: str, kind: str, stop: float) -> Channel:
    """Rest until 6 s, then a drive that runs on to the last sample."""
    time = np.arange(0.0, stop, 1.0 / RATE)
    share = np.clip((time - 6.0) / 4.0, 0.0, 1.0)
    values = 0.1 * share**2 * (3.0 - 2.0 * share) * np.sin(2.0 * np.pi * FREQUENCY * time)
    values += 1e-5 * np.random.default_rng(4).standard_normal(time.size)
    return Channel(name, kind, "m", time, values, np.zeros(time.size, np.uint16), at=0.0)


def steady_of(*channels: Channel) -> Window:
    steady = windows_of(RUN, channels, FREQUENCY, REACH).steady
    assert steady is not None
    cycles = steady.length * FREQUENCY
    assert cycles == pytest.approx(round(cycles), abs=0.01)  # of the frequency as found
    return steady


def test_it_ends_the_reach_of_the_motion_before_the_motion_does() -> None:
    hub = driven("hub", "displacement", 40.0)
    steady = steady_of(hub, driven("Kraft_oben", "tension", 60.0))
    assert steady.stop == pytest.approx(40.0 - REACH, abs=0.02)
    assert steady.start > 9.0


def test_it_ends_before_the_first_tension_does() -> None:
    hub = driven("hub", "displacement", 60.0)
    forces = driven("Kraft_oben", "tension", 50.0), driven("Kraft_unten", "tension", 35.0)
    assert steady_of(hub, *forces).stop == pytest.approx(35.0 - 0.1, abs=0.02)


def test_a_record_ends_with_its_last_usable_sample() -> None:
    hub = driven("hub", "displacement", 40.0)
    dead = hub.with_flags(hub.time > 30.0, Flag.STUCK)
    dead = dead.with_values(np.where(hub.time > 30.0, hub.values[3000], hub.values))
    assert steady_of(dead, driven("Kraft_oben", "tension", 60.0)).stop <= 30.0 - REACH + 0.02


def test_a_window_too_short_to_lose_its_ends_is_kept_whole() -> None:
    hub = driven("hub", "displacement", 18.0)
    steady = steady_of(hub, driven("Kraft_oben", "tension", 12.5))
    assert steady.length * FREQUENCY >= 3.0
