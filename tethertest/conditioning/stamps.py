"""Audit of a log's time stamps: what is wrong with them, and uniform time where the evidence allows it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tethertest.conditioning.stamp_steps import GAP_STEPS, Quantised, Steps, even_rows, steps_of
from tethertest.errors import DataError
from tethertest.records.arrays import BoolArray, FlagArray, FloatArray
from tethertest.records.channel import Finding, Flag, RawLog, Severity

#: a step back by more than this fraction of the median step is an unsorted log, by less it is jitter
BACKWARD_FRACTION = 0.5
#: steps that scatter by more than this fraction of the median step (standard deviation) are rebuilt
JITTER_FRACTION = 0.02
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
    median, duplicate, backward = seen.median, seen.duplicate, seen.backward
    _check_order(time, np.diff(time), median, raw)
    flags = np.where(missing, np.uint16(Flag.MISSING), np.uint16(0)).astype(np.uint16)
    flags[duplicate & ~backward] |= np.uint16(Flag.DUPLICATE_TIME)
    flags[backward] |= np.uint16(Flag.BACKWARD_TIME)
    rows = np.ones(time.size, dtype=bool)
    steps: list[str] = []
    if seen.coarse or seen.quantised or backward.any() or seen.jitter > JITTER_FRACTION * median:
        kind, words = irregularity(seen.quantised, median, seen.jitter, coarse=seen.coarse)
        rebuilt = _rebuilt(time, seen)
        if rebuilt is None:
            rebuilt = _spread(time)
            text = f"{words}, and rows are missing: stamps that repeat are spread evenly, true to {words}"
            severity = Severity.WARNING
        else:
            away = float(np.max(np.abs(rebuilt - time)))
            text, severity = rebuilt_words(words, away, seen.quantised)
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
        more = f", and {back.size - 1} more times" if back.size > 1 else ""
        message = (
            f"time goes backwards at row {row + 1} ({time[row]:.6g} s after {time[row - 1]:.6g} s, "
            f"from the run's date{more})"
        )
        remedy = "export the log again, sorted by time"
        raise DataError(message, remedy, path=raw.path, line=raw.line_of(row))


def irregularity(
    quantised: Quantised | None, median: float, jitter: float, *, coarse: bool
) -> tuple[str, str]:
    """Return the kind of finding that uneven steps are, and what they are in words.

    Parameters
    ----------
    quantised, median, jitter, coarse
        As in `Steps`.
    """
    if quantised is not None:
        quantum, step = 1e3 * quantised.quantum, 1e3 * quantised.step
        return "quantised_time", f"rows every {step:.4g} ms have stamps cut to {quantum:.4g} ms"
    if coarse:
        return "quantised_time", f"steps of {1e3 * median:.4g} ms with repeats"
    return "jitter", f"jitter {1e3 * jitter:.3g} ms"


def rebuilt_words(words: str, away: float, quantised: Quantised | None) -> tuple[str, Severity]:
    """Return what is said of rebuilt time, and how severe it is.

    Parameters
    ----------
    words : str
        What the stamps are like.
    away : float
        Farthest rebuilt from written [s].
    quantised : Quantised or None
    """
    text = f"{words}: time rebuilt from row numbers, at most {1e3 * away:.3g} ms from the stamps"
    if quantised is None or not quantised.pattern:
        return text, Severity.NOTE
    return f"{text}; {look_the_same(quantised)}: export the log with finer stamps to tell", Severity.WARNING


def look_the_same(quantised: Quantised) -> str:
    """Return what else stamps may be that repeat themselves in a pattern, in words."""
    rows = f"rows every {1e3 * quantised.quantum:.4g} ms"
    return f"{rows}, some missing in a pattern of {quantised.pattern}, look the same"


def rebuild_gap(median: float, quantised: Quantised | None) -> float:
    """Return the longest step between stamps that rebuilt time reaches across [s]."""
    return REBUILD_GAP_STEPS * median if quantised is None else quantised.longest


def _rebuilt(time: FloatArray, seen: Steps) -> FloatArray | None:
    """Return uniform time through the stamps between gaps, or None where that strays too far."""
    slope, even = even_rows(time, rebuild_gap(seen.median, seen.quantised))
    if slope <= 0 or np.max(np.abs(even - time)) > REBUILD_STEPS * seen.median or np.any(np.diff(even) <= 0):
        return None
    return even


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
