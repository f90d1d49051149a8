"""Gap or clock jump: whether rows were lost where the stamps leap, by how the signals go on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from tethertest.records.arrays import BoolArray, FloatArray
from tethertest.records.channel import Channel, Finding, Flag
from tethertest.signal.filters import filled

#: leaps shorter than this are taken as lost rows: too little happens in it to tell [s]
SHORTEST_JUMP = 0.05
#: record on either side of the leap that is compared [s], and the fewest samples of it
SIDE = 0.15
FEWEST_SAMPLES = 8
#: quadratics through both sides at once may leave this many times the residual of one on each side (F)
CONTINUOUS = 6.0
#: or as much as they do at this share of the places near by where no row is missing: the motion may be fast
USUAL = 0.9
#: places this close [s] where rows are left out for comparison, and the share that must show it for a
#: decision
NEAR = 8.0
TRIALS = 40
POWER = 0.8


def without_jumps(channels: Sequence[Channel], clock: str) -> tuple[tuple[Channel, ...], tuple[Finding, ...]]:
    """Take clock jumps out of one log's stamps and name the gaps that remain.

    Parameters
    ----------
    channels : sequence of Channel
        The channels of one column of stamps, all with the same times.
    clock : str
        Subject of the findings.

    Returns
    -------
    tuple
        Channels whose later stamps are moved back by every leap across which the signals go on as if no row
        were missing, while rows left out elsewhere in the record would show; and the findings, on the log's
        own clock.
    """
    leaps = np.flatnonzero(channels[0].flags & np.uint16(Flag.GAP))
    if not leaps.size:
        return tuple(channels), ()
    time = channels[0].time.copy()
    step = 1.0 / channels[0].rate
    jumped = np.zeros(time.size, dtype=bool)
    findings: list[Finding] = []
    lost: list[tuple[float, float]] = []
    rows = 0
    for row in leaps:
        leap = float(channels[0].time[row] - channels[0].time[row - 1]) - step
        start = float(time[row - 1])
        if leap >= SHORTEST_JUMP and _goes_on(channels, int(row), round(leap / step)):
            time[row:] -= leap
            jumped[row] = True
            text = (
                f"the clock jumps by {leap:+.4g} s at {start:.3f} s while the signals go on: "
                "later stamps moved back by it"
            )
            findings.append(Finding(clock, "clock_jump", text, spans=((start, start + step),), samples=1))
        else:
            lost.append((start, float(time[row])))
            rows += round(leap / step)
    if lost:
        text = f"{rows} rows are missing in {len(lost)} gaps, the longest {max(b - a for a, b in lost):.4g} s"
        findings.append(Finding(clock, "gap", text, spans=tuple(lost), samples=rows))
    if not jumped.any():
        return tuple(channels), tuple(findings)
    step_text = "; ".join(finding.text for finding in findings if finding.kind == "clock_jump")
    return tuple(_moved(channel, time, jumped, step_text) for channel in channels), tuple(findings)


def _moved(channel: Channel, time: FloatArray, jumped: BoolArray, text: str) -> Channel:
    cleared = np.where(jumped, channel.flags & ~np.uint16(Flag.GAP), channel.flags).astype(np.uint16)
    moved = replace(channel, time=time, flags=cleared)
    return moved.with_flags(jumped, Flag.CLOCK_JUMP).with_step(text)


def _goes_on(channels: Sequence[Channel], row: int, missing: int) -> bool:
    """Return whether the channels show that no rows are missing before a row."""
    side = max(round(SIDE * channels[0].rate), FEWEST_SAMPLES)
    telling = False
    for channel in channels:
        values = filled(channel)
        if not side <= row <= values.size - side:
            continue
        whole, torn = (_elsewhere(values, row, side, left_out, channel.rate) for left_out in (0, missing))
        if not whole.size or not torn.size:
            continue
        usual = max(CONTINUOUS, float(np.quantile(whole, USUAL)))
        if _break(values[row - side : row], values[row : row + side]) > usual:
            return False
        telling |= float(np.mean(torn > usual)) >= POWER
    return telling


def _elsewhere(values: FloatArray, row: int, side: int, left_out: int, rate: float) -> FloatArray:
    """Return the break at places near a row, each with some rows left out."""
    reach = round(NEAR * rate)
    first, last = max(side, row - reach), min(values.size - side - left_out, row + reach)
    places = np.linspace(first, last, TRIALS).astype(int) if last > first else np.zeros(0, int)
    return np.array([
        _break(values[place - side : place], values[place + left_out : place + left_out + side])
        for place in places
        if not place - side < row < place + left_out + side
    ])  # fmt: skip


def _break(before: FloatArray, after: FloatArray) -> float:
    """Return the F ratio of one quadratic through both sides against one on each."""
    side = before.size
    row = np.linspace(-1.0, 1.0, 2 * side)
    joined = _residual(row, np.concatenate((before, after)))
    apart = _residual(row[:side], before) + _residual(row[side:], after)
    freedom = 2 * side - 6
    return ((joined - apart) / 3.0) / max(apart / freedom, np.finfo(float).tiny)


def _residual(row: FloatArray, values: FloatArray) -> float:
    """Return the sum of squares that a quadratic leaves."""
    directions = np.linalg.qr(np.vander(row, 3))[0]
    centred = values - values.mean()
    return float(np.sum((centred - directions @ (directions.T @ centred)) ** 2))
