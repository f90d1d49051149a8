"""Runs in the order of time as sweeps up and down, and how far the two lie apart."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

import numpy as np
from scipy.special import ndtri

from tethertest.records.across import Branch, Direction, Hysteresis, Step
from tethertest.records.arrays import FloatArray

#: runs with different settings in a row that make a sweep: three come in order one time in three by chance
FEWEST_OF_A_SWEEP: Final = 4
#: settings this close, relative, are one and the same
SAME_SETTING: Final = 0.005
#: share of the gap beside them by which two branches' settings may differ to be compared
_SHARED: Final = 0.1
#: on each side of a 95 % interval
_TAIL: Final = 0.025


def branches(setting: FloatArray) -> tuple[Branch, ...]:
    """Split runs into sweeps.

    Parameters
    ----------
    setting : (n,) float64
        Drive frequency or amplitude of every run, in the order of time.

    Returns
    -------
    tuple of Branch
        Sweeps up and down in the order of time; the run at a turn belongs to both. Runs outside of any sweep
        come last, as one branch that has no order.
    """
    found: list[Branch] = []
    start = 0
    while start < setting.size - 1:
        members, direction = _run_on(setting, start)
        if direction is not Direction.UNORDERED and _distinct(setting[members]) >= FEWEST_OF_A_SWEEP:
            found.append(Branch(direction, tuple(members)))
        start = max(members[-1], start + 1)
    swept = {member for branch in found for member in branch.members}
    rest = tuple(member for member in range(setting.size) if member not in swept)
    return (*found, Branch(Direction.UNORDERED, rest)) if rest else tuple(found)


def _run_on(setting: FloatArray, start: int) -> tuple[list[int], Direction]:
    """Return the runs from one on, until the setting turns."""
    members, direction = [start], Direction.UNORDERED
    for place in range(start + 1, setting.size):
        change = setting[place] - setting[members[-1]]
        if abs(change) > SAME_SETTING * abs(setting[place]):
            way = Direction.UP if change > 0.0 else Direction.DOWN
            if direction not in {Direction.UNORDERED, way}:
                break
            direction = way
        members.append(place)
    return members, direction


def _distinct(setting: FloatArray) -> int:
    return len(merged(setting, setting, np.ones_like(setting))[0])


def merged(
    setting: FloatArray, amplitude: FloatArray, error: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return one amplitude per setting, by rising setting.

    Parameters
    ----------
    setting, amplitude, error : (n,) float64
        In any order; settings closer than `SAME_SETTING` are repeats.

    Returns
    -------
    setting, amplitude, error : (m,) float64
        Plain means of repeats; their error is the larger of what the lines' errors and what the spread of the
        repeats make it.
    """
    order = np.argsort(setting, kind="stable")
    setting, amplitude, error = setting[order], amplitude[order], error[order]
    apart = np.diff(setting) > SAME_SETTING * np.abs(setting[1:])
    rows = []
    for part in np.split(np.arange(setting.size), np.flatnonzero(apart) + 1):
        if part.size == 0:
            continue
        known = float(np.sqrt(np.sum(error[part] ** 2))) / part.size
        seen = float(np.std(amplitude[part], ddof=1)) / math.sqrt(part.size) if part.size > 1 else 0.0
        rows.append((float(setting[part].mean()), float(amplitude[part].mean()), max(known, seen)))
    columns = np.array(rows, dtype=np.float64).reshape(-1, 3)
    return columns[:, 0], columns[:, 1], columns[:, 2]


def judge_loop(
    up: tuple[FloatArray, FloatArray, FloatArray],
    down: tuple[FloatArray, FloatArray, FloatArray],
    significance: float,
    jumps: Sequence[Step] = (),
) -> Hysteresis | None:
    """Compare a sweep up with a sweep down.

    Parameters
    ----------
    up, down : three (n,) float64 each
        Settings, strictly increasing, amplitudes and their standard errors, scatter from run to run included.
    significance : float
        Chance to call equal branches different, over all settings.
    jumps : sequence of Step
        Of both branches; they bound how well the area is known.

    Returns
    -------
    Hysteresis or None
        None where the branches have no span or no setting in common.

    Notes
    -----
    Amplitudes are compared at settings that both branches have; nothing is interpolated across a gap that may
    hold a jump. The area is by the trapezoid rule over the settings of both.
    """
    if not up[0].size or not down[0].size:
        return None
    low, high = max(up[0][0], down[0][0]), min(up[0][-1], down[0][-1])
    pairs = _shared(up[0], down[0])
    if high <= low or not pairs:
        return None
    at = np.array([0.5 * (up[0][i] + down[0][j]) for i, j in pairs])
    apart = np.array([up[1][i] - down[1][j] for i, j in pairs])
    spread = np.array([math.hypot(up[2][i], down[2][j]) for i, j in pairs])
    limit = float(-ndtri(significance / (2.0 * len(pairs))))
    different = np.flatnonzero(np.abs(apart) > limit * spread)
    grid = np.unique(np.clip(np.concatenate((up[0], down[0])), low, high))
    width = np.diff(grid)
    weight = 0.5 * (np.append(width, 0.0) + np.insert(width, 0, 0.0))
    area, variance = 0.0, 0.0
    for sign, (setting, amplitude, error) in ((1.0, up), (-1.0, down)):
        shares = weight @ np.array([np.interp(grid, setting, unit) for unit in np.eye(setting.size)]).T
        area += sign * float(shares @ amplitude)
        variance += float(np.sum((shares * error) ** 2))
    jumped = sum(
        0.5 * (jump.interval[1] - jump.interval[0]) * abs(jump.amplitudes[1] - jump.amplitudes[0])
        for jump in jumps
    )
    half = float(-ndtri(_TAIL)) * math.sqrt(variance) + jumped
    largest = int(np.argmax(np.abs(apart)))
    return Hysteresis(
        area=area,
        interval=(area - half, area + half),
        differs=None if different.size == 0 else (float(at[different[0]]), float(at[different[-1]])),
        largest=float(apart[largest]),
        largest_at=float(at[largest]),
        significance=significance,
    )


def _shared(up: FloatArray, down: FloatArray) -> list[tuple[int, int]]:
    """Return the places of settings that both branches have."""
    pairs = []
    for place, setting in enumerate(up):
        other = int(np.argmin(np.abs(down - setting)))
        gaps = [float(np.min(np.diff(branch))) for branch in (up, down) if branch.size > 1]
        near = max(_SHARED * min(gaps, default=0.0), SAME_SETTING * abs(float(setting)))
        if abs(float(down[other] - setting)) <= near:
            pairs.append((place, other))
    return pairs
