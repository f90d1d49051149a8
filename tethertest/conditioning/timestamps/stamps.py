"""Audit of a log's time stamps: what is wrong with them, and uniform time where the evidence allows it."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from tethertest.conditioning.timestamps.stamp_steps import (
    DUPLICATE_FRACTION,
    GAP_STEPS,
    EvenRows,
    Quantised,
    StampReader,
    Stepping,
    reader_of,
    stepping_of,
)
from tethertest.errors import DataError
from tethertest.records.arrays import BoolArray, FlagArray, FloatArray
from tethertest.records.channel import Finding, Flag, RawLog, Severity
from tethertest.signal.passes import BLOCK, blocks_of

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
    rows: BoolArray | slice  #: of the log: which of them are the n rows that are kept
    flags: FlagArray  #: (n,)
    findings: tuple[Finding, ...]  #: spans on the log's own clock
    steps: tuple[str, ...]  #: for the record


@dataclass(frozen=True, slots=True, eq=False)
class StampBlock:
    """Audited stamps of some consecutive rows."""

    time: FloatArray  #: (n,) [s] of the rows that are kept
    rows: BoolArray | None  #: (rows of the block,) True for those; None where all are kept
    flags: FlagArray  #: (n,)


@dataclass(frozen=True, slots=True, eq=False)
class StampAudit:
    """What the stamps of a log are like, and how each block of them is mended."""

    step: float  #: usual step of the mended stamps [s]
    mended: bool  #: whether any stamp is not as it was logged
    findings: tuple[Finding, ...]  #: spans on the log's own clock
    steps: tuple[str, ...]  #: for the record
    mend: Callable[[], Iterator[StampBlock]]  #: without flags of gaps

    def blocks(self) -> Iterator[StampBlock]:
        """Yield all stamps in their order, with their flags."""
        before = None
        for part in self.mend():
            if part.time.size:
                first = part.time[0] if before is None else before
                gap = np.diff(part.time, prepend=first) > GAP_STEPS * self.step
                part.flags[gap] |= np.uint16(Flag.GAP)
                before = float(part.time[-1])
            yield part


def audit_stamps(time: FloatArray, raw: RawLog, clock: str) -> Stamps:
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
    audit = audit_of(reader_of(time), time.size, raw, clock)
    flags = np.empty(time.size, dtype=np.uint16)
    rows = np.ones(time.size, dtype=bool)
    mended = np.empty(time.size) if audit.mended else time
    row = kept = 0
    for part in audit.blocks():
        size = part.time.size
        flags[kept : kept + size] = part.flags
        if audit.mended:
            mended[kept : kept + size] = part.time
        if part.rows is not None:
            rows[row : row + part.rows.size] = part.rows
        row, kept = row + (size if part.rows is None else part.rows.size), kept + size
    chosen = slice(None) if kept == time.size else rows
    return Stamps(mended[:kept], chosen, flags[:kept], audit.findings, audit.steps)


def audit_of(
    read: StampReader, size: int, raw: RawLog, clock: str, block: int = BLOCK, most: int = sys.maxsize
) -> StampAudit:
    """Audit the stamps of a record that need not be in memory; see `audit_stamps`.

    Parameters
    ----------
    read : callable
        The stamps, as logged; some may be NaN.
    size, block : int
        Rows, and rows at once.
    raw, clock
        As for `audit_stamps`.
    most : int
        Rows up to which a fault is mended that takes all stamps at once.

    Raises
    ------
    DataError
        As `audit_stamps`, or a log of more rows than `most` whose stamps are missing, or repeat where rows
        are missing too.
    """
    if size < 2:
        message = f"the log has {size} rows, expected a record"
        raise DataError(message, "export the log again", path=raw.path)
    missing = _missing(read, size, block)
    findings: list[Finding] = []
    if missing is not None:
        count = int(np.count_nonzero(missing))
        if size > most:
            raise _too_long(raw, f"{count} of its rows have no stamp")
        read = reader_of(_interpolated(read(0, size), missing, raw))
        text = f"{raw.path.name}: {count} rows have no stamp; interpolated by row"
        findings.append(Finding(clock, "missing_time", text, samples=count))
    seen = stepping_of(read, size, block)
    _check_order(read, size, block, seen.median, raw)
    told = _Told(read, size, block, seen, missing)
    if seen.coarse or seen.quantised or seen.backward or seen.jitter > JITTER_FRACTION * seen.median:
        kind, words = irregularity(seen.quantised, seen.median, seen.jitter, coarse=seen.coarse)
        even = EvenRows.of(read, size, rebuild_gap(seen.median, seen.quantised), block)
        away = _strays(even)
        if away <= REBUILD_STEPS * seen.median:
            text, severity = rebuilt_words(words, away, seen.quantised)
            step, mend = even.step, lambda: told.rebuilt(rows for _, _, rows in even.blocks())
        elif size > most:
            raise _too_long(raw, "its stamps repeat or jitter where rows are missing too")
        else:
            spread = _spread(read(0, size))
            text = f"{words}, and rows are missing: stamps that repeat are spread evenly, true to {words}"
            severity = Severity.WARNING
            step = float(np.median(np.diff(spread)))
            mend = lambda: told.rebuilt(spread[start:stop] for start, stop in blocks_of(size, block))  # noqa: E731
        findings.append(Finding(clock, kind, f"{raw.path.name}: {text}", severity))
        return StampAudit(step, True, tuple(findings), (text,), mend)
    if not seen.duplicates:
        return StampAudit(seen.median, missing is not None, tuple(findings), (), told.as_logged)
    found = _repeats_finding(told, raw, clock)
    return StampAudit(seen.median, True, (*findings, found), (found.text,), told.without_repeats)


@dataclass(frozen=True, slots=True, eq=False)
class _Told:
    """Stamps as logged, with what is known of their steps."""

    read: StampReader
    size: int
    block: int
    seen: Stepping
    missing: BoolArray | None

    def _flags(self, start: int, stop: int) -> FlagArray:
        """Return the flags that stamps have as logged."""
        flags = np.zeros(stop - start, dtype=np.uint16)
        step = np.diff(self.read(max(start - 1, 0), stop))
        inside = flags if start else flags[1:]
        inside[step <= DUPLICATE_FRACTION * self.seen.median] = np.uint16(Flag.DUPLICATE_TIME)
        inside[step < 0] = np.uint16(Flag.BACKWARD_TIME)
        if self.missing is not None:
            flags[self.missing[start:stop]] |= np.uint16(Flag.MISSING)
        return flags

    def as_logged(self) -> Iterator[StampBlock]:
        """Yield the stamps as they are."""
        for start, stop in blocks_of(self.size, self.block):
            yield StampBlock(self.read(start, stop), None, self._flags(start, stop))

    def rebuilt(self, times: Iterator[FloatArray]) -> Iterator[StampBlock]:
        """Yield other times for all rows."""
        for (start, stop), time in zip(blocks_of(self.size, self.block), times, strict=True):
            yield StampBlock(time, None, self._flags(start, stop))

    def repeats(self) -> Iterator[tuple[FloatArray, BoolArray, list[tuple[float, bool]]]]:
        """Yield mended stamps, rows that are kept, and stamp and whether it stood still of each repeat."""
        before = 0.0
        for start, stop in blocks_of(self.size, self.block):
            logged = self.read(start, min(stop + 1, self.size))
            time, kept = logged[: stop - start].copy(), np.ones(stop - start, dtype=bool)
            found = []
            for row in np.flatnonzero(self._flags(start, stop) & np.uint16(Flag.DUPLICATE_TIME)).tolist():
                following = logged[row + 1] - logged[row] if row + 1 < logged.size else 0.0
                stood = bool(following > GAP_STEPS * self.seen.median)
                found.append((float(time[row]), stood))
                if stood:
                    time[row] = (time[row - 1] if row else before) + 0.5 * following
                else:
                    kept[row] = False
            before = float(time[-1])
            yield time, kept, found

    def without_repeats(self) -> Iterator[StampBlock]:
        """Give a stamp that stood still its own time; drop a row that was written twice."""
        start = 0
        for time, kept, _ in self.repeats():
            flags = self._flags(start, start + time.size)
            start += time.size
            yield StampBlock(time[kept], kept, flags[kept])


def _missing(read: StampReader, size: int, block: int) -> BoolArray | None:
    """Return which rows have no stamp; None where all have one."""
    if all(np.isfinite(read(start, stop)).all() for start, stop in blocks_of(size, block)):
        return None
    return np.concatenate([~np.isfinite(read(start, stop)) for start, stop in blocks_of(size, block)])


def _too_long(raw: RawLog, why: str) -> DataError:
    message = f"the log is larger than is read at once, and {why}"
    remedy = "export it again with all of its stamps, as fine as the rows are, or in parts"
    return DataError(message, remedy, path=raw.path)


def _interpolated(time: FloatArray, missing: BoolArray, raw: RawLog) -> FloatArray:
    if np.count_nonzero(~missing) < 2:
        message = "the log has no time stamps"
        raise DataError(message, "export the log again with its time column", path=raw.path)
    row = np.arange(time.size, dtype=float)
    return np.asarray(np.interp(row, row[~missing], time[~missing]), dtype=np.float64)


def _check_order(read: StampReader, size: int, block: int, median: float, raw: RawLog) -> None:
    if median == 0.0:
        message = "no stamp is later than the one before it"
        raise DataError(message, "export the log again with its time column", path=raw.path)
    count, row, pair = 0, 0, (0.0, 0.0)
    for start, stop in blocks_of(size - 1, block):
        time = read(start, stop + 1)
        back = np.flatnonzero(np.diff(time) < -BACKWARD_FRACTION * median)
        if back.size and not count:
            row = start + int(back[0]) + 1
            pair = (float(time[back[0]]), float(time[back[0] + 1]))
        count += back.size
    if count:
        more = f", and {count - 1} more times" if count > 1 else ""
        message = (
            f"time goes backwards at row {row + 1} ({pair[1]:.6g} s after {pair[0]:.6g} s, "
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


def _strays(even: EvenRows) -> float:
    """Return the farthest even time from its stamp [s]; infinite where even times do not increase."""
    away, before = 0.0, -np.inf
    for _, time, rows in even.blocks():
        if even.step <= 0 or np.any(np.diff(rows, prepend=before) <= 0):
            return np.inf
        away, before = max(away, float(np.max(np.abs(rows - time)))), float(rows[-1])
    return away


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


def _repeats_finding(told: _Told, raw: RawLog, clock: str) -> Finding:
    found = [item for _, _, items in told.repeats() for item in items]
    stood = sum(stood for _, stood in found)
    words = f"{stood} stamps stood still and were moved, {len(found) - stood} rows came twice and count once"
    spans = tuple((stamp, stamp) for stamp, _ in found)
    return Finding(clock, "duplicate_time", f"{raw.path.name}: {words}", spans=spans, samples=len(spans))
