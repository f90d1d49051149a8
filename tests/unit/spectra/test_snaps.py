"""Snaps in numbers, against pulses of known shape and a cable pulled taut at a known speed."""

from __future__ import annotations

import math

import numpy as np
import pytest

from tethertest.kernels.march import Line, UpperEnd, march
from tethertest.kernels.record import Record
from tethertest.solver.nonlinear.limits import VISCOSITY, courant_limit
from tethertest.spectra import find_events
from tethertest.spectra.snaps import measured_snaps
from tethertest.spectra.waves import Medium

from .conftest import Maker

STIFFNESS, MASS, LENGTH = 10020.0, 0.0484, 3.0
SPEED, IMPEDANCE = math.sqrt(STIFFNESS / MASS), math.sqrt(STIFFNESS * MASS)
MEDIUM = Medium(IMPEDANCE, SPEED, LENGTH)


def test_a_half_sine_pulse_has_its_own_rise_and_impulse(channel: Maker) -> None:
    time = np.arange(40_000) / 10_000.0
    peak, width = 20.0, 0.08
    pulse = peak * np.sin(np.pi * (time - 2.0) / width)
    tension = np.where((time >= 2.0) & (time <= 2.0 + width), pulse, np.where(time < 1.0, 5.0, 0.0))
    record = channel(time, tension)
    (snap, *_) = measured_snaps(record, find_events(record, 0.02))
    assert snap.peak == pytest.approx(peak, rel=1e-6)
    rise = width / np.pi * (np.arcsin(0.9) - np.arcsin(0.1))
    assert snap.rise_time == pytest.approx(rise, rel=1e-3)
    assert snap.rise_resolved
    # from zero to where the sine has fallen to one half, at 5/6 of the pulse; the start is found within 1 ms
    impulse = peak * width / np.pi * (1.0 - np.cos(5.0 * np.pi / 6.0))
    assert snap.impulse == pytest.approx(impulse, rel=5e-3)
    assert snap.speed is None
    assert snap.front == snap.peak


@pytest.mark.parametrize("samples", [4, 6, 12])
def test_intervals_hold_a_peak_between_two_samples(channel: Maker, samples: int) -> None:
    random = np.random.default_rng(11)
    peak, rate, noise = 20.0, 1000.0, 0.015
    width, held, fast, short = samples / rate, 0, 0, 0
    for _ in range(60):
        time = np.arange(2000) / rate
        begin = 1.2 + random.uniform(0.0, 1.0 / rate)
        pulse = (peak - 2.0) * np.sin(np.pi * np.clip((time - begin) / width, 0.0, 1.0))
        tension = np.where(time < 1.0, 5.0, np.where(time < begin, 0.0, 2.0 + pulse))
        tension += noise * random.standard_normal(time.size)
        record = channel(time, tension, noise=noise, uncertainty=1e-3)
        (snap,) = measured_snaps(record, find_events(record, 0.02), MEDIUM)
        held += snap.peak_interval[0] <= peak <= snap.peak_interval[1]
        short += snap.peak + 1.96 * math.hypot(noise, 1e-3 * peak) < peak
        assert snap.speed_interval is not None
        # the whole rise is within one round trip
        fast += snap.speed_interval[0] <= peak / IMPEDANCE <= snap.speed_interval[1]
    assert held >= 57
    assert fast >= 57
    # noise and scale alone would not do, and the more samples there are the less is added
    assert short > 3
    assert snap.peak_interval[1] - snap.peak < 0.8 * peak / samples


def test_the_interval_allows_for_the_luck_of_the_largest_of_many(channel: Maker) -> None:
    random = np.random.default_rng(12)
    level, noise, held = 10.0, 0.05, 0
    for _ in range(60):
        time = np.arange(2000) / 1000.0
        tension = np.where(time < 0.5, 5.0, np.where(time < 1.0, 0.0, level))
        tension = tension + noise * random.standard_normal(time.size)
        record = channel(time, tension, noise=noise)
        (snap,) = measured_snaps(record, find_events(record, 0.02))
        held += snap.peak_interval[0] <= level <= snap.peak_interval[1]
    assert held >= 55


def test_the_zero_of_the_cell_is_in_the_interval_of_a_peak(channel: Maker) -> None:
    time = np.arange(2000) / 1000.0
    tension = np.where(time < 0.5, 5.0, np.where(time < 1.0, 0.0, 5.0))
    record = channel(time, tension, offset_uncertainty=0.1)
    (snap,) = measured_snaps(record, find_events(record, 0.02))
    assert snap.peak - snap.peak_interval[0] == pytest.approx(0.196, rel=1e-3)


@pytest.mark.parametrize(("slack", "speed"), [(1e-4, 1.0), (1e-3, 2.0), (3e-3, 2.0)])
def test_a_cable_pulled_taut_tells_the_speed_of_the_pull(channel: Maker, slack: float, speed: float) -> None:
    strain = 0.5 * (-slack + math.sqrt(slack**2 + 4.0 * speed**2 / SPEED**2))
    time, bottom, top = pulled(slack, speed)
    # a logger at 2 kHz averages over its interval, which takes the mesh's own ringing off the front
    width = round(5e-4 / (time[1] - time[0]))
    still = np.zeros(200)
    for series, factor in ((bottom, 1.0), (top, None)):
        means = series[: series.size // width * width].reshape(-1, width).mean(axis=1)
        whole = np.concatenate([still, means])
        record = channel(np.arange(whole.size) * width * (time[1] - time[0]), whole)
        (snap, *_) = measured_snaps(record, find_events(record, 0.02), MEDIUM)
        assert snap.speed is not None
        assert snap.arrived_speed is not None
        if factor is not None:
            # T = EA e exactly, and e = V/c less d/2 for small slack
            assert snap.speed == pytest.approx(SPEED * strain, rel=0.06)
            assert snap.speed < speed
        else:
            # a fixed end sees T + Z V
            assert snap.arrived_speed == pytest.approx(0.5 * (SPEED * strain + speed), rel=0.06)


def pulled(slack: float, speed: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Pull the bottom end of a slack straight cable at rest downwards; stop after the first reflection."""
    cells = 200
    cell = LENGTH / cells
    none, nothing = np.zeros(1), np.zeros((0, 1))
    line = Line(cell, MASS, STIFFNESS, 0.0, 0.0, VISCOSITY, 0.0, none, 0.0, 0.0)
    upper = UpperEnd(True, 0.0, none, none, none, nothing, np.zeros(0))
    step = courant_limit(line, upper) * cell / SPEED
    strain = 0.5 * (-slack + math.sqrt(slack**2 + 4.0 * speed**2 / SPEED**2))
    steps = int(1.45 * LENGTH * (strain + slack) / speed / step)
    bottom = -speed * step * np.arange(steps + 2)
    position = (1.0 - slack) * cell * np.arange(cells + 1)[None]
    rows = steps - 2
    record = Record(
        step,
        steps,
        np.array([0, cells], dtype=np.int64),
        np.array([0.0, 1.0]),
        np.array([0, cells - 1], dtype=np.int64),
        np.ones(2),
        np.zeros((rows, 2, 2)),
        np.zeros(rows),
        np.full((1, cells + 2), -np.inf),
        np.full((1, cells + 2), np.inf),
    )
    assert march(bottom, np.ones(1), position, line, upper, np.zeros((1, 1)), step, record) == steps
    return step * np.arange(rows), record.rows[:, 0, 0], record.rows[:, 1, 0]
