"""The audit of `tethertest.conditioning.stamps`, block by block."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from tethertest.conditioning.stamp_steps import (
    COARSE_FRACTION,
    DUPLICATE_FRACTION,
    GAP_STEPS,
    Quantised,
    quantised_steps,
)
from tethertest.conditioning.stamps import (
    BACKWARD_FRACTION,
    JITTER_FRACTION,
    REBUILD_STEPS,
    irregularity,
    rebuild_gap,
    rebuilt_words,
)
from tethertest.errors import DataError
from tethertest.pipeline.long_runs.columns import Column, Scratch, Sizes
from tethertest.pipeline.long_runs.gather import Gathered
from tethertest.records.arrays import FloatArray
from tethertest.records.channel import Finding, Flag
from tethertest.signal.passes import blocks_of

#: rows of one piece of a sample of steps, and pieces of it
_PIECE, _PIECES = 1 << 14, 64


@dataclass(frozen=True, slots=True, eq=False)
class Audited:
    """Stamps of a log on disk: rows that are dropped stay in the columns and are marked."""

    time: Column  #: [s] after the run's date, strictly increasing over the rows that are kept
    flags: Column
    kept: Column
    step: float  #: usual step [s]
    findings: tuple[Finding, ...] = ()
    steps: tuple[str, ...] = ()
    dropped: int = 0  #: rows that are not kept


@dataclass(slots=True)
class _Seen:
    """What all steps say together."""

    duplicates: int = 0
    backward: int = 0
    ordinary: int = 0
    total: float = 0.0  #: of ordinary steps less the median
    square: float = 0.0


def audited(log: Gathered, scratch: Scratch, sizes: Sizes) -> Audited:
    """Audit the stamps of a log.

    Parameters
    ----------
    log : Gathered
        The log.
    scratch : Scratch
        For further columns.
    sizes : Sizes
        Rows at once.

    Raises
    ------
    DataError
        Time goes backwards, stamps are missing, or stamps repeat where rows are missing too, which takes the
        whole record to mend.
    """
    median = _median_step(log, sizes)
    seen = _seen(log, median, sizes)
    deviation = max(seen.square / max(seen.ordinary, 1) - (seen.total / max(seen.ordinary, 1)) ** 2, 0.0)
    jitter = float(np.sqrt(deviation))
    coarse = seen.duplicates > COARSE_FRACTION * log.rows
    quantised = quantised_steps(log.time.read(0, min(log.rows, sizes.whole)))
    columns = (scratch.column("<f8"), scratch.column("<u2"), scratch.column("?"))
    if coarse or quantised or seen.backward or jitter > JITTER_FRACTION * median:
        kind, words = irregularity(quantised, median, jitter, coarse=coarse)
        away, step = _rebuild(log, median, quantised, columns, sizes)
        text, severity = rebuilt_words(words, away, quantised)
        finding = Finding(log.entry.clock, kind, f"{log.raw.path.name}: {text}", severity)
        return Audited(*columns, step, (finding,), (text,))
    spans, stood, dropped = _plain(log, median, columns, sizes)
    if not spans:
        return Audited(*columns, median)
    words = f"{stood} stamps stood still and were moved, {dropped} rows came twice and count once"
    text = f"{log.raw.path.name}: {words}"
    found = Finding(log.entry.clock, "duplicate_time", text, spans=tuple(spans), samples=len(spans))
    return Audited(*columns, median, (found,), (text,), dropped)


def _median_step(log: Gathered, sizes: Sizes) -> float:
    """Return the median of the positive steps: of all of them, or of a sample spread over the record."""
    if log.rows <= sizes.whole:
        step = np.diff(log.time.read(0, log.rows))
    else:
        starts = np.linspace(0, log.rows - _PIECE, _PIECES).astype(int)
        step = np.concatenate([np.diff(log.time.read(start, start + _PIECE)) for start in starts.tolist()])
    forward = step[step > 0]
    if not forward.size:
        message = "no stamp is later than the one before it"
        raise DataError(message, "export the log again with its time column", path=log.raw.path)
    return float(np.median(forward))


def _seen(log: Gathered, median: float, sizes: Sizes) -> _Seen:
    seen = _Seen()
    for start, stop in blocks_of(log.rows, sizes.block):
        time = log.time.read(start - 1, stop)
        if not np.isfinite(time).all():
            message = f"the log is larger than is read at once, and rows from {start + 1} on have no stamp"
            raise DataError(message, "export the log again with all of its stamps", path=log.raw.path)
        step = np.diff(time)
        back = np.flatnonzero(step < -BACKWARD_FRACTION * median)
        if back.size:
            raise _backwards(log, max(start, 1) + int(back[0]), time[back[0] : back[0] + 2])
        seen.backward += int(np.count_nonzero(step < 0))
        seen.duplicates += int(np.count_nonzero(step <= DUPLICATE_FRACTION * median))
        ordinary = step[(step > (2.0 - GAP_STEPS) * median) & (step < GAP_STEPS * median)] - median
        seen.ordinary += ordinary.size
        seen.total += float(np.sum(ordinary))
        seen.square += float(np.sum(ordinary**2))
    return seen


def _backwards(log: Gathered, row: int, pair: FloatArray) -> DataError:
    message = (
        f"time goes backwards at row {row + 1} ({pair[1]:.6g} s after {pair[0]:.6g} s, from the run's date)"
    )
    return DataError(message, "export the log again, sorted by time", path=log.raw.path)


def _plain(
    log: Gathered, median: float, columns: tuple[Column, Column, Column], sizes: Sizes
) -> tuple[list[tuple[float, float]], int, int]:
    """Take the stamps as they are; give one that stood still its own time, drop a row that came twice."""
    spans: list[tuple[float, float]] = []
    stood = dropped = 0
    before = -np.inf  # stamp of the latest row that was kept
    for start, stop in blocks_of(log.rows, sizes.block):
        raw = log.time.read(start - 1, stop + 1) + log.start
        lead = 1 if start else 0
        time = raw[lead : lead + stop - start].copy()
        step = np.diff(raw)
        here = step[: time.size] if lead else np.concatenate(([np.inf], step[: time.size - 1]))
        flags = np.zeros(time.size, dtype=np.uint16)
        kept = np.ones(time.size, dtype=bool)
        flags[here <= DUPLICATE_FRACTION * median] |= np.uint16(Flag.DUPLICATE_TIME)
        for row in np.flatnonzero(here <= DUPLICATE_FRACTION * median).tolist():
            following = raw[lead + row + 1] - raw[lead + row] if lead + row + 1 < raw.size else 0.0
            spans.append((float(time[row]), float(time[row])))
            if following > GAP_STEPS * median:
                time[row] = (time[row - 1] if row else before) + 0.5 * following
                stood += 1
            else:
                kept[row] = False
                dropped += 1
        stays = np.flatnonzero(kept)
        gap = np.diff(time[stays], prepend=before) > GAP_STEPS * median
        if not start:
            gap[0] = False
        flags[stays[gap]] |= np.uint16(Flag.GAP)
        if stays.size:
            before = float(time[stays[-1]])
        _append(columns, time, flags, kept)
    return spans, stood, dropped


def _rebuild(
    log: Gathered,
    median: float,
    quantised: Quantised | None,
    columns: tuple[Column, Column, Column],
    sizes: Sizes,
) -> tuple[float, float]:
    """Put rows between gaps on a straight line of one slope; return the largest change, and the step."""
    longest = rebuild_gap(median, quantised)
    count, row_sum, time_sum = _sums(log, longest, sizes)
    row_mean, time_mean = row_sum / count, time_sum / count
    product = square = 0.0
    for stretch, row, time, _ in _stretches(log, longest, sizes):
        off = row - row_mean[stretch]
        product += float(np.sum(off * (time - time_mean[stretch])))
        square += float(np.sum(off**2))
    slope = product / square
    away, before = 0.0, -np.inf
    for stretch, row, time, step in _stretches(log, longest, sizes):
        rebuilt = time_mean[stretch] + slope * (row - row_mean[stretch])
        away = max(away, float(np.max(np.abs(rebuilt - time))))
        forward = np.diff(rebuilt, prepend=before)
        if slope <= 0 or away > REBUILD_STEPS * median or np.any(forward <= 0):
            message = (
                "the log is larger than is read at once, its stamps repeat or jitter, and rows are missing"
            )
            remedy = "export the log again with finer stamps, or in parts of less than 256 MB"
            raise DataError(message, remedy, path=log.raw.path)
        flags = np.zeros(time.size, dtype=np.uint16)
        flags[(step <= DUPLICATE_FRACTION * median) & (step >= 0)] |= np.uint16(Flag.DUPLICATE_TIME)
        flags[step < 0] |= np.uint16(Flag.BACKWARD_TIME)
        gap = forward > GAP_STEPS * slope
        gap[0] &= bool(np.isfinite(before))
        flags[gap] |= np.uint16(Flag.GAP)
        before = float(rebuilt[-1])
        _append(columns, rebuilt, flags, np.ones(time.size, dtype=bool))
    return away, slope


def _append(columns: tuple[Column, Column, Column], *parts: npt.NDArray[Any]) -> None:
    for column, values in zip(columns, parts, strict=True):
        column.append(values)


def _stretches(
    log: Gathered, longest: float, sizes: Sizes
) -> Iterator[tuple[npt.NDArray[np.int64], FloatArray, FloatArray, FloatArray]]:
    """Yield the number of the stretch, row, stamp and step of each row, block by block."""
    number = 0
    for start, stop in blocks_of(log.rows, sizes.block):
        time = log.time.read(start - 1, stop) + log.start
        step = np.diff(time) if start else np.concatenate(([np.inf], np.diff(time)))
        gaps = step > longest
        if not start:
            gaps[0] = False
        stretch = number + np.cumsum(gaps)
        number = int(stretch[-1])
        row = np.arange(start, stop, dtype=float)
        yield stretch, row, time[-row.size :], step


def _sums(log: Gathered, longest: float, sizes: Sizes) -> tuple[FloatArray, FloatArray, FloatArray]:
    sums = np.zeros((3, 1))
    for stretch, row, time, _ in _stretches(log, longest, sizes):
        short = int(stretch[-1]) + 1
        if short > sums.shape[1]:
            sums = np.pad(sums, ((0, 0), (0, short - sums.shape[1])))
        for line, weights in enumerate((np.ones(row.size), row, time)):
            sums[line, :short] += np.bincount(stretch, weights, short)
    return sums[0], sums[1], sums[2]
