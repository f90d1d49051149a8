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
