"""Time of an FBGS export: line numbers at a rate that the stamps, written to the second, bear out."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
import numpy.typing as npt

from tethertest.errors import FileFormatError
from tethertest.records.arrays import FloatArray

Integers = npt.NDArray[np.int64]

#: rates that a person sets [Hz]; a fitted rate is one of them only where the stamps leave no other
_ROUND_RATES: Final = (
    0.1, 0.2, 0.5, 1.0, 2.0, 4.0, 5.0, 8.0, 10.0, 20.0, 25.0, 40.0, 50.0, 80.0, 100.0, 125.0, 200.0, 250.0,
    400.0, 500.0, 800.0, 1000.0, 1250.0, 2000.0, 2500.0, 5000.0,
)  # fmt: skip
#: the rate is a slope between stamps this fraction of the log apart, so that one pause does not bend it
_LAG_FRACTION: Final = 0.1
#: whole numbers above this are not exact
_WHOLE: Final = 2.0**53
#: the logger may stamp a line this many lines late
_LATE_LINES: Final = 3.0
#: a pause shows when the stamps run ahead by this fraction of their resolution and by the late lines
_PAUSE_FRACTION: Final = 0.3
#: and do so for this many changes of the stamp before and after
_SIDE: Final = 4


@dataclass(frozen=True, slots=True, eq=False)
class LineClock:
    """Time of every line, and what it rests on."""

    time: FloatArray  #: (n,) [s] since the first line
    rate: float  #: lines a second [Hz]
    remarks: tuple[str, ...]


def line_clock(
    numbers: FloatArray, seconds: FloatArray, path: Path, lines: Integers, stated: float | None
) -> LineClock:
    """Rebuild the time of every line from its number.

    Parameters
    ----------
    numbers : ndarray
        (n,) `Linenumber` as written.
    seconds : ndarray
        (n,) [s] stamps since the first one, coarse.
    path, lines : Path, ndarray
        File and (n,) lines, for messages.
    stated : float or None
        Lines a second [Hz], where the run file says so.

    Returns
    -------
    LineClock
        Line numbers that are missing leave their time empty; so does a pause that only the stamps show.

    Raises
    ------
    FileFormatError
        A line number is no whole number or does not increase, the stamps go back, or they span too little
        to show the rate and the run file states none.
    """
    steps = _number_steps(numbers, path, lines)
    usual = int(np.median(steps)) if steps.size else 1
    resolution = _resolution(seconds)
    back = np.flatnonzero(np.diff(seconds) < 0)
    if back.size:
        row = int(back[0]) + 1
        message = (
            f"the stamps go back by {seconds[row - 1] - seconds[row]:g} s while the line number increases"
        )
        raise FileFormatError(
            message, "the logger's clock was set: export each part by itself", path=path, line=int(lines[row])
        )
    changes = 1 + np.flatnonzero((np.diff(seconds) > 0) & (steps == usual))
    rate = stated if stated is not None else _slope(numbers, seconds, changes, path, lines, usual)
    breaks = _pauses(numbers, seconds, changes, rate, resolution, usual)
    remarks: list[str] = []
    if stated is None:
        rate, remark = _settled(numbers, seconds, changes, breaks, rate, resolution, usual)
        remarks.append(remark)
    else:
        remarks.append(f"time is the line number at the {stated / usual:g} Hz that the run file states")
    time, residual = _anchored(numbers, seconds, changes, breaks, rate, resolution)
    _check_pauses(time, breaks, numbers, seconds, rate, path, lines)
    if residual > resolution + _LATE_LINES * usual / rate:
        message = f"the stamps stray by {residual:.3g} s from {rate / usual:.6g} Hz"
        if stated is not None:
            raise FileFormatError(
                message, "correct rate for this log in run.toml, or leave it out", path=path
            )
        remarks.append(f"{message}: the time is no better than that")
    for row in breaks:
        pause = time[row] - time[row - 1]
        remarks.append(
            f"line {lines[row]}: the stamps leave {pause:.4g} s to the line before, more "
            f"than the line numbers do; it is a gap"
        )
    holes = np.flatnonzero(steps > usual)
    if holes.size:
        lost = int(np.sum(steps[holes] // usual - 1))
        where = ", ".join(str(lines[row + 1]) for row in holes[:3]) + (", ..." if holes.size > 3 else "")
        remarks.append(f"{lost} line numbers are missing, at line {where}; their time is a gap")
    return LineClock(time, rate / usual, tuple(remarks))


def _number_steps(numbers: FloatArray, path: Path, lines: Integers) -> Integers:
    wrong = ~((np.abs(numbers) < _WHOLE) & (numbers == np.rint(numbers)))
    if np.any(wrong):
        row = int(np.argmax(wrong))
        message = "Linenumber is blank or no whole number"
        raise FileFormatError(message, "export the log again", path=path, line=int(lines[row]))
    steps = np.diff(numbers).astype(np.int64)
    if np.any(steps <= 0):
        row = int(np.argmax(steps <= 0)) + 1
        message = f"Linenumber {numbers[row]:.0f} follows {numbers[row - 1]:.0f}, expected it to increase"
        remedy = "two logs were joined, or rows were sorted: export each log by itself"
        raise FileFormatError(message, remedy, path=path, line=int(lines[row]))
    return steps


def _resolution(seconds: FloatArray) -> float:
    """Return the step of the stamps [s], at most one second."""
    ticks = np.gcd.reduce(np.rint(seconds * 1e6).astype(np.int64)) if seconds.size else 0
    return min(float(ticks) * 1e-6, 1.0) if ticks else 1.0


def _slope(
    numbers: FloatArray, seconds: FloatArray, changes: Integers, path: Path, lines: Integers, usual: int
) -> float:
    """Return line numbers a second between stamps that change, the median over the log."""
    if changes.size < 3:
        message = (
            f"the stamps of {numbers.size} lines change {changes.size} times, too little to show their rate"
        )
        remedy = "set rate for this log in run.toml to the rate of the interrogator"
        raise FileFormatError(message, remedy, path=path, line=int(lines[0]))
    lag = max(1, int(_LAG_FRACTION * changes.size))
    late, early = changes[lag:], changes[:-lag]
    return float(np.median((numbers[late] - numbers[early]) / (seconds[late] - seconds[early])))


def _pauses(
    numbers: FloatArray, seconds: FloatArray, changes: Integers, rate: float, resolution: float, usual: int
) -> Integers:
    """Return the rows before which the stamps run ahead of the line numbers, or far behind them, for good."""
    stray = seconds[changes] - numbers[changes] / rate
    shift = np.zeros(changes.size)
    for place in range(1, changes.size - 1):
        before, after = stray[max(place - _SIDE, 0) : place], stray[place + 1 : place + 1 + _SIDE]
        shift[place] = np.median(after) - np.median(before)
    least = _PAUSE_FRACTION * resolution + _LATE_LINES * usual / rate
    apart = np.flatnonzero((shift > least) | (shift < -resolution - least))
    rows: list[int] = []
    for cluster in np.split(apart, np.flatnonzero(np.diff(apart) > _SIDE) + 1):
        if cluster.size:
            first, last = changes[cluster[0] - 1] + 1, changes[cluster[-1]]
            leaps = np.diff(seconds)[first - 1 : last] + np.diff(numbers)[first - 1 : last] / rate
            rows.append(int(first + np.argmax(leaps)))
    return np.array(rows, dtype=np.int64)


def _settled(
    numbers: FloatArray,
    seconds: FloatArray,
    changes: Integers,
    breaks: Integers,
    rate: float,
    resolution: float,
    usual: int,
) -> tuple[float, str]:
    """Return the rate of the whole log, a round one where the stamps agree with it, and the evidence."""
    part = np.searchsorted(breaks, changes, side="right")
    kept = ~np.isin(changes, breaks)
    part, number, second = part[kept], numbers[changes[kept]], seconds[changes[kept]]
    mean = [np.bincount(part, of) / np.maximum(np.bincount(part), 1) for of in (number, second)]
    x, y = number - mean[0][part], second - mean[1][part]
    spread = float(np.sum(y * y))
    span = float(np.ptp(second))
    if spread > 0.0:
        rate = float(np.sum(x * y)) / spread
    stray = y - x / rate
    error = 2.0 * float(np.max(np.abs(stray), initial=usual / rate)) / max(span, resolution)
    low, high = rate / usual * (1.0 - error), rate / usual * (1.0 + error)
    rounds = [candidate for candidate in _ROUND_RATES if low <= candidate <= high]
    wholes = [float(whole) for whole in range(int(np.ceil(low)), int(high) + 1)][:3]
    evidence = (
        f"stamps to {resolution:g} s: time is the line number at {{}} Hz, by {number.size} "
        f"changes of the stamp"
        f" over {span:.4g} s (fitted {rate / usual:.6g} Hz, within {100 * error:.2g} %)"
    )
    for candidates in (rounds, wholes):
        if len(candidates) == 1:
            return candidates[0] * usual, evidence.format(f"{candidates[0]:g}")
        if candidates:
            break
    return rate, evidence.format(f"the fitted {rate / usual:.6g}")


def _anchored(
    numbers: FloatArray,
    seconds: FloatArray,
    changes: Integers,
    breaks: Integers,
    rate: float,
    resolution: float,
) -> tuple[FloatArray, float]:
    """Return times of all lines, each stretch set by its stamps, and how far these stray [s]."""
    counted = (numbers - numbers[0]) / rate
    edges = [0, *breaks.tolist(), numbers.size]
    offsets: list[float] = []
    for first, stop in itertools.pairwise(edges):
        inside = changes[(changes > first) & (changes < stop)]
        rows = inside if inside.size else np.array([first])
        offsets.append(float(np.median(seconds[rows] - counted[rows])))
    time = counted + np.repeat(np.array(offsets) - offsets[0], np.diff(edges))
    late = seconds - offsets[0] - time
    return time, max(float(np.max(late)), float(-np.min(late)) - resolution)


def _check_pauses(
    time: FloatArray,
    breaks: Integers,
    numbers: FloatArray,
    seconds: FloatArray,
    rate: float,
    path: Path,
    lines: Integers,
) -> None:
    for row in breaks:
        if time[row] - time[row - 1] < (numbers[row] - numbers[row - 1]) / rate:
            message = (
                f"Linenumber goes from {numbers[row - 1]:.0f} to {numbers[row]:.0f} while "
                f"the stamps go on by "
                f"{seconds[row] - seconds[row - 1]:g} s"
            )
            remedy = "numbers or stamps are wrong here: export the log again, or each part by itself"
            raise FileFormatError(message, remedy, path=path, line=int(lines[row]))
