"""Random interrogator logs with lost, slipped, crossed and false peaks."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tethertest.records.arrays import BoolArray, FloatArray
from tethertest.records.cable import Cable, Platform
from tethertest.records.rig import Instrument, Limits, Rig, Sensor

RATE, LENGTH = 100.0, 30.0
#: ways in which a logger orders the peaks that it still sees
LAYOUTS = ("own column", "slipping columns", "numbered peaks", "crossed columns")
#: a run is clear when no grating moves farther than this share of the distance to its neighbour, from where
#: the rig file expects it
CLEAR_SHARE = 0.45


@dataclass(frozen=True, slots=True, eq=False)
class Case:
    """One log with what is in it."""

    seed: int
    layout: str
    true: FloatArray  #: (n, g) [m], NaN where a grating was lost
    columns: FloatArray  #: (n, p) as logged [m]
    rig: Rig
    clear: bool  #: gratings stay nearer to their own place than to a neighbour's
    ghosts: bool
    dead: bool


def random_case(seed: int) -> Case:
    """Return a random log: 3 to 10 gratings, strain, warming, snaps, losses and ghosts."""
    random = np.random.default_rng(seed)
    count = int(random.integers(3, 11))
    time = np.arange(round(RATE * LENGTH)) / RATE
    spacing = float(random.uniform(1.5, 6.0))
    places = 1510.0 + spacing * (np.arange(count) + random.uniform(-0.15, 0.15, count))
    shift = _motion(random, time, spacing)
    true = places + shift[:, None] * random.uniform(0.88, 1.12, count)
    true += random.uniform(-5.0, 5.0) * 0.01 * (time / LENGTH)[:, None]
    true += random.normal(0.0, random.uniform(0.5e-3, 3e-3), true.shape)
    true = np.round(true, 4)
    expected = np.round(places + random.uniform(-0.08, 0.08, count) * spacing, 2)
    gap = float(np.min(np.diff(np.sort(expected))))
    reach = float(np.max(np.abs(true - expected)))
    clear = reach < CLEAR_SHARE * gap
    capture = 0.5 * gap if clear else 1.15 * reach
    dead = bool(random.random() < 0.1)
    seen = _seen(random, time.size, count, dead)
    ghosts = bool(random.random() < 0.3)
    extra = _ghosts(random, time.size, expected, capture) if ghosts else np.full((time.size, 0), np.nan)
    layout = LAYOUTS[int(random.integers(len(LAYOUTS)))]
    if extra.size and layout != "numbered peaks":
        layout = "slipping columns"
    visible = np.where(seen, true, np.nan)
    rig = _rig(expected, capture)
    columns = _laid_out(random, layout, visible, extra)
    return Case(seed, layout, 1e-9 * visible, 1e-9 * columns, rig, clear, ghosts, dead)


def _motion(random: np.random.Generator, time: FloatArray, spacing: float) -> FloatArray:
    """Return the common shift [nm]: slow oscillation that ramps up, and snaps in a third of the runs."""
    swing = float(np.exp(random.uniform(np.log(0.03), np.log(min(3.0, 0.9 * spacing)))))
    frequency = float(random.uniform(0.1, 1.5))
    ramp = np.clip((time - 3.0) / 3.0, 0.0, 1.0)
    shift = swing * ramp * np.sin(2.0 * np.pi * frequency * time)
    if random.random() < 0.35:
        for start in np.arange(6.0, LENGTH - 1.0, 1.0 / frequency):
            width, height = random.uniform(0.01, 0.05), swing * random.uniform(0.3, 1.2)
            shift += height * np.sin(np.pi * np.clip((time - start) / width, 0.0, 1.0))
    return shift


def _seen(random: np.random.Generator, rows: int, count: int, dead: bool) -> BoolArray:
    seen = random.random((rows, count)) > float(random.choice((0.0, 0.002, 0.01)))
    for grating in range(count):
        for _ in range(int(random.integers(0, 3))):
            start = int(random.integers(0, rows))
            seen[start : start + int(random.uniform(5, 1000)), grating] = False
    for _ in range(int(random.integers(0, 3))):
        start, several = int(random.integers(0, rows)), random.random(count) < 0.6
        seen[start : start + int(random.uniform(5, 300)), several] = False
    if random.random() < 0.3:
        start = int(random.integers(0, rows))
        seen[start : start + int(random.uniform(10, 100))] = False
    if dead:
        seen[:, int(random.integers(count))] = False
    return seen


def _ghosts(random: np.random.Generator, rows: int, expected: FloatArray, capture: float) -> FloatArray:
    extra = np.full((rows, 1), np.nan)
    for _ in range(int(random.integers(1, 6))):
        start = int(random.integers(0, rows))
        stop = min(start + int(random.choice((1, 1, 20, 300))), rows)
        near = float(random.choice(expected)) + random.uniform(-0.9, 0.9) * capture
        extra[start:stop, 0] = np.round(near + random.normal(0.0, 2e-3, stop - start), 4)
    return extra


def _laid_out(random: np.random.Generator, layout: str, visible: FloatArray, extra: FloatArray) -> FloatArray:
    """Return the columns that a logger writes."""
    if layout == "own column":
        return visible
    if layout == "crossed columns":
        crossed = visible.copy()
        one, other = random.choice(visible.shape[1], 2, replace=False)
        start = int(random.integers(0, visible.shape[0]))
        crossed[start:, [one, other]] = crossed[start:, [other, one]]
        return crossed
    return np.sort(np.hstack((visible, extra)), axis=1)


def _rig(expected: FloatArray, capture: float) -> Rig:
    gratings = tuple(
        Sensor(
            f"g{number + 1}", "wavelength", at=0.5, expected=1e-9 * float(at), capture=1e-9 * capture
        )
        for number, at in enumerate(expected)
    )  # fmt: skip
    return Rig(
        "random",
        Cable(3.0, "unstretched", 0.05, 10_000.0),
        Platform(0.4, 5.0),
        gratings,
        (Instrument("interrogator", RATE),),
        Limits(),
    )
