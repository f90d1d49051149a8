from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from tethertest.signal.settling import settled_from
from tethertest.signal.windows import Steady, find_rest, find_steady

RATE, START, STOP, END, RAMP = 200.0, 6.0, 40.0, 52.0, 4.0


@dataclass
class Record:
    time: np.ndarray
    values: np.ndarray
    usable: np.ndarray
    rate: float = RATE


def driven(frequency=0.5, noise=1e-5, taps=(2.0, 3.5, 48.0), half=0.0, seed=3):
    time = np.arange(0.0, END, 1.0 / RATE)
    area = lambda r: r**4 * (2.5 - 3.0 * r + r**2)  # noqa: E731
    up, down = np.clip((time - START) / RAMP, 0, 1), np.clip((time - STOP) / RAMP, 0, 1)
    steady = np.clip(time - START - RAMP, 0, STOP - START - RAMP)
    turned = frequency * (RAMP * area(up) + steady + RAMP * (down - area(down)))
    values = 0.1 * np.sin(2 * np.pi * turned) + half * np.sin(np.pi * turned)
    for start in taps:
        values += 1e-3 * np.sin(np.pi * np.clip((time - start) / 0.06, 0, 1)) ** 2
    values += np.random.default_rng(seed).normal(0.0, noise, time.size)
    return Record(time, values, np.ones(time.size, bool))


def test_taps_do_not_end_a_rest_window():
    rest = find_rest(driven())
    assert rest.before[0] < 0.1
    assert 5.0 < rest.before[1] < 6.8
    assert 43.5 < rest.after[0] < 45.5
    assert rest.after[1] > 51.9


def test_record_cut_in_motion_has_no_rest_there():
    whole = driven()
    part = whole.time > 20.0
    rest = find_rest(Record(whole.time[part], whole.values[part], whole.usable[part]))
    assert rest.before is None
    assert rest.after is not None


def test_record_without_motion_is_rest_at_both_ends():
    rest = find_rest(Record(np.arange(6000) / RATE, np.zeros(6000), np.ones(6000, bool)))
    assert rest.before == pytest.approx((0.0, 10.0), abs=0.1)
    assert rest.after == pytest.approx((20.0, 30.0), abs=0.1)


@pytest.mark.parametrize("frequency", [0.2, 0.5, 3.0])
@pytest.mark.parametrize("half", [0.0, 0.02])
def test_steady_window_holds_whole_cycles_between_the_ramps(frequency, half):
    steady = find_steady(driven(frequency, half=half), frequency * 1.03)
    assert steady.frequency == pytest.approx(frequency, rel=1e-3)
    assert steady.amplitude == pytest.approx(0.1, rel=0.01)
    assert (steady.span[1] - steady.span[0]) * steady.frequency == pytest.approx(steady.cycles, abs=1e-6)
    into_ramp = max(START + RAMP - steady.span[0], steady.span[1] - STOP, 0.0) / RAMP
    strayed = 2 * np.pi * frequency * RAMP * into_ramp**4 * (2.5 - 3.0 * into_ramp + into_ramp**2)
    assert strayed < 0.06  # [rad], of the drive against its steady turning
    assert steady.cycles >= 0.8 * (STOP - START - RAMP) * frequency - 2


def test_noise_alone_is_no_drive():
    random = np.random.default_rng(5)
    quiet = Record(np.arange(12_000) / RATE, random.normal(0, 1e-5, 12_000), np.ones(12_000, bool))
    assert find_steady(quiet, 0.5) is None
    assert find_steady(driven(0.5), 4.0) is None
    flat = Record(quiet.time, np.zeros(12_000), quiet.usable)
    assert find_steady(flat, 0.5) is None


def test_window_starts_when_a_subharmonic_has_grown():
    time = np.arange(0.0, 40.0, 0.002)
    grown = 1.0 / (1.0 + np.exp(-2.0 * (time - 11.0)))
    values = np.sin(2 * np.pi * 8.0 * time) + 0.8 * grown * np.sin(np.pi * 8.0 * time + 0.3)
    response = Record(time, values, np.ones(time.size, bool), 500.0)
    settled = settled_from(response, Steady((5.0, 35.0), 8.0, 0.1, 240))
    assert 12.0 < settled.span[0] < 14.5
    assert settled.span[1] == 35.0
    assert (35.0 - settled.span[0]) * 8.0 == pytest.approx(settled.cycles)
    slow = Steady((5.0, 35.0), 0.3, 0.1, 9)
    assert settled_from(response, slow) is slow


def test_three_cycles_between_long_ramps_are_found_by_their_repeating():
    time = np.arange(0.0, 18.0, 1.0 / 256.0)
    envelope = np.interp(np.floor(time / 2.0), [0, 1, 2, 4, 5, 6, 7, 8], [0.4, 0.55, 1, 1, 0.8, 0.5, 0.2, 0])
    values = envelope * np.sin(np.pi * time) + np.random.default_rng(8).normal(0.0, 1e-4, time.size)
    steady = find_steady(Record(time, values, np.ones(time.size, bool), rate=256.0), 0.5)
    assert steady.cycles == 3
    assert steady.span == pytest.approx((4.0, 10.0), abs=0.1)
    # as long a rest repeats itself too, but is no drive
    quiet = Record(time, np.where(time < 1.0, values, 0.0), np.ones(time.size, bool), rate=256.0)
    assert find_steady(quiet, 0.5) is None


@pytest.mark.parametrize("stop", [28.7, 30.0, 31.4, 33.3])
def test_a_record_that_ends_with_the_drive_running_holds_its_steady_cycles(stop: float) -> None:
    """Half of it is rest and ramp, so that the strongest line lies per cent beside the drive."""
    time = np.arange(0.0, stop, 0.005)
    speed = 0.3 * np.clip((time - 6.0) / 7.0, 0.0, 1.0)
    values = 0.15 * (1.0 - np.cos(2.0 * np.pi * np.cumsum(speed) * 0.005))
    values += 1e-5 * np.random.default_rng(1).standard_normal(time.size)
    steady = find_steady(Record(time, values, np.ones(time.size, bool), rate=200.0), 0.3)
    assert steady is not None
    assert steady.frequency == pytest.approx(0.3, rel=2e-3)
    assert steady.cycles >= int((stop - 13.0) * 0.3) - 2
    assert steady.span[0] > 11.0
