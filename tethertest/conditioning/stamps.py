"""Audit of a log's time stamps: what is wrong with them, and uniform time where the evidence allows it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tethertest.errors import DataError
from tethertest.records.arrays import BoolArray, FlagArray, FloatArray
from tethertest.records.channel import Finding, Flag, RawLog

#: steps below this fraction of the median step are a stamp that repeats
DUPLICATE_FRACTION = 1e-3
#: a step back by more than this fraction of the median step is an unsorted log, by less it is jitter
BACKWARD_FRACTION = 0.5
#: a step longer than this many median steps is a gap
GAP_STEPS = 1.5
#: steps that scatter by more than this fraction of the median step (standard deviation) are rebuilt
JITTER_FRACTION = 0.02
#: repeated stamps in more than this fraction of the rows come from a coarse stamp, not from a row written
#: twice
COARSE_FRACTION = 0.02
#: rebuilt stamps may differ from written ones by this many median steps
REBUILD_STEPS = 1.5
#: and never reach across a step longer than this many median steps: rows may be missing there
REBUILD_GAP_STEPS = 1.75


@dataclass(frozen=True, slots=True, eq=False)
class Stamps:
    """Audited stamps of one log."""

    time: FloatArray  #: (n,) [s], strictly increasing
    rows: BoolArray  #: (rows of the log,) True for the n rows that are kept
    flags: FlagArray  #: (n,)
    findings: tuple[Finding, ...]  #: spans on the log's own clock
    steps: tuple[str, ...]  #: for the record


@dataclass(frozen=True, slots=True, eq=False)
class Steps:
    """What the steps between stamps are like, before anything is mended."""

    median: float  #: of the steps forward [s]; 0 where there is none
    duplicate: BoolArray  #: (n,) True where a stamp repeats the one before it, or goes back
    backward: BoolArray  #: (n,) True where time goes back
    gap: BoolArray  #: (n,) True behind a step longer than `GAP_STEPS` median steps
    jitter: float  #: standard deviation of the steps that are no gaps and no repeats [s]

    @property
    def coarse(self) -> bool:
        """Whether so many stamps repeat that the clock is coarser than the rows."""
        return int(np.count_nonzero(self.duplicate)) > COARSE_FRACTION * self.duplicate.size


def steps_of(time: FloatArray) -> Steps:
    """Sort the steps between stamps.

    Parameters
    ----------
    time : ndarray
        (n,) [s], finite, as logged.
    """
    step = np.diff(time)
    median = float(np.median(step[step > 0])) if np.any(step > 0) else 0.0
    ordinary = step[(step > (2.0 - GAP_STEPS) * median) & (step < GAP_STEPS * median)]
    return Steps(
        median,
        np.concatenate(([False], step <= DUPLICATE_FRACTION * median)),
        np.concatenate(([False], step < 0)),
        np.concatenate(([False], step > GAP_STEPS * median)),
        float(np.std(ordinary)) if ordinary.size else 0.0,
    )


def audited(time: FloatArray, raw: RawLog, clock: str) -> Stamps:
    """Audit one column of stamps.

    Parameters
    ----------
    time : ndarray
        (rows,) [s] on any origin, as logged.
    raw : RawLog
        The log, for messages.
    clock : str
        Subject of the findings.

    Returns
    -------
    Stamps
        Strictly increasing times. A row whose stamp repeats is dropped unless the stamps are coarse or a
        neighbouring step shows that only the stamp stood still; then time is rebuilt from the rows.

    Raises
    ------
    DataError
        Fewer than two rows, stamps that are missing, or time that goes backwards.
    """
    if time.size < 2:
        message = f"the log has {time.size} rows, expected a record"
        raise DataError(message, "export the log again", path=raw.path)
    missing = ~np.isfinite(time)
    findings: list[Finding] = []
    if missing.any():
        time = _interpolated(time, missing, raw)
        text = f"{raw.path.name}: {np.count_nonzero(missing)} rows have no stamp; interpolated by row"
        findings.append(Finding(clock, "missing_time", text, samples=int(np.count_nonzero(missing))))
    seen = steps_of(time)
    median, duplicate, backward, jitter = seen.median, seen.duplicate, seen.backward, seen.jitter
    _check_order(time, np.diff(time), median, raw)
    flags = np.where(missing, np.uint16(Flag.MISSING), np.uint16(0)).astype(np.uint16)
    flags[duplicate & ~backward] |= np.uint16(Flag.DUPLICATE_TIME)
    flags[backward] |= np.uint16(Flag.BACKWARD_TIME)
    rows = np.ones(time.size, dtype=bool)
    steps: list[str] = []
    coarse = seen.coarse
    if coarse or backward.any() or jitter > JITTER_FRACTION * median:
        kind = "quantised_time" if coarse else "jitter"
        words = f"steps of {1e3 * median:.4g} ms with repeats" if coarse else f"jitter {1e3 * jitter:.3g} ms"
        rebuilt = _rebuilt(time, median)
        if rebuilt is None:
            rebuilt = _spread(time)
            text = f"{words}, and rows are missing: stamps that repeat are spread evenly, true to {words}"
            severity = "warning"
        else:
            away = float(np.max(np.abs(rebuilt - time)))
            text = f"{words}: time rebuilt from row numbers, at most {1e3 * away:.3g} ms from the stamps"
            severity = "note"
        findings.append(Finding(clock, kind, f"{raw.path.name}: {text}", severity))
        steps.append(text)
        time, duplicate = rebuilt, np.zeros_like(duplicate)
    elif duplicate.any():
        time, rows, finding = _without_repeats(time, duplicate, median, raw, clock)
        findings.append(finding)
        steps.append(finding.text)
    time, flags = time[rows], flags[rows]
    step = np.diff(time)
    gap = np.concatenate(([False], step > GAP_STEPS * float(np.median(step))))
    flags[gap] |= np.uint16(Flag.GAP)
    return Stamps(time, rows, flags, tuple(findings), tuple(steps))


def _interpolated(time: FloatArray, missing: BoolArray, raw: RawLog) -> FloatArray:
    if np.count_nonzero(~missing) < 2:
        message = "the log has no time stamps"
        raise DataError(message, "export the log again with its time column", path=raw.path)
    row = np.arange(time.size, dtype=float)
    return np.asarray(np.interp(row, row[~missing], time[~missing]), dtype=np.float64)


def _check_order(time: FloatArray, step: FloatArray, median: float, raw: RawLog) -> None:
    back = np.flatnonzero(step < -BACKWARD_FRACTION * median)
    if median == 0.0:
        message = "no stamp is later than the one before it"
        raise DataError(message, "export the log again with its time column", path=raw.path)
    if back.size:
        row = int(back[0]) + 1
        line = None if raw.header_line is None else raw.header_line + 1 + row
        more = f", and {back.size - 1} more times" if back.size > 1 else ""
        message = (
            f"time goes backwards at row {row + 1} ({time[row]:.6g} s after {time[row - 1]:.6g} s, "
            f"counted from the log's start{more})"
        )
        raise DataError(message, "export the log again, sorted by time", path=raw.path, line=line)


def _rebuilt(time: FloatArray, median: float) -> FloatArray | None:
    """Return uniform time through the stamps between gaps, or None where that strays too far."""
    step = np.diff(time)
    stretch = np.concatenate(([0], np.cumsum(step > REBUILD_GAP_STEPS * median)))
    row = np.arange(time.size, dtype=float)
    count = np.bincount(stretch)
    row_mean = (np.bincount(stretch, row) / count)[stretch]
    time_mean = (np.bincount(stretch, time) / count)[stretch]
    slope = float(np.sum((row - row_mean) * (time - time_mean)) / np.sum((row - row_mean) ** 2))
    rebuilt = time_mean + slope * (row - row_mean)
    if slope <= 0 or np.max(np.abs(rebuilt - time)) > REBUILD_STEPS * median or np.any(np.diff(rebuilt) <= 0):
        return None
    return np.asarray(rebuilt, dtype=np.float64)


def _spread(time: FloatArray) -> FloatArray:
    """Return times between the first rows of different stamps, evenly by row."""
    highest = np.maximum.accumulate(time)
    first = np.flatnonzero(np.concatenate(([True], np.diff(highest) > 0)))
    row = np.arange(time.size, dtype=float)
    last_step = float(np.median(np.diff(highest[first]))) / max(float(np.median(np.diff(first))), 1.0)
    tail = time.size - 1 - int(first[-1])
    anchors = np.append(first, time.size - 1) if tail else first
    ends = np.append(highest[first], highest[-1] + tail * last_step) if tail else highest[first]
    return np.asarray(np.interp(row, anchors.astype(float), ends), dtype=np.float64)


def _without_repeats(
    time: FloatArray, duplicate: BoolArray, median: float, raw: RawLog, clock: str
) -> tuple[FloatArray, BoolArray, Finding]:
    """Give a stamp that stood still its own time; drop a row that was written twice."""
    rows = np.ones(time.size, dtype=bool)
    time = time.copy()
    spans: list[tuple[float, float]] = []
    stood = 0
    for row in np.flatnonzero(duplicate):
        following = time[row + 1] - time[row] if row + 1 < time.size else 0.0
        spans.append((float(time[row]), float(time[row])))
        if following > GAP_STEPS * median:
            time[row] = time[row - 1] + 0.5 * following
            stood += 1
        else:
            rows[row] = False
    dropped = int(np.count_nonzero(~rows))
    words = f"{stood} stamps stood still and were moved, {dropped} rows came twice and count once"
    text = f"{raw.path.name}: {words}"
    finding = Finding(clock, "duplicate_time", text, spans=tuple(spans), samples=len(spans))
    return time, rows, finding
