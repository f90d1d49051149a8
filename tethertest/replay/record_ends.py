"""The displacement as recorded, continued where the record stops with the drive running and across holes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from tethertest.records.arrays import BoolArray, FloatArray
from tethertest.records.channel import Channel, Window
from tethertest.replay.repetition import PERIODS, Repetition, fit_repetition
from tethertest.signal.filters import HOLE_INTERVALS, filled

Span = tuple[float, float]

#: the drive runs at an end of the record where the motion there spans more than this share of its whole
#: range, over a quarter of a period or this time [s]
MOVING_SHARE, MOVING_SPAN = 0.02, 1.0
#: a drive that runs from the first sample on is led in from rest over this many periods, at least this
#: time [s], and runs in full for the last quarter of it
LEAD_PERIODS, SHORTEST_LEAD, GROWING = 3.0, 5.0, 0.75


@dataclass(frozen=True, slots=True, eq=False)
class Record:
    """The displacement at even steps, counted from rest."""

    time: FloatArray  #: (n,) run time [s]
    values: FloatArray  #: (n,) [m]
    known: BoolArray  #: (n,) not in a hole
    rate: float  #: [Hz]
    frequency: float | None  #: of the drive [Hz]

    @property
    def starts_moving(self) -> bool:
        """The drive runs at the first sample."""
        return self._spans(self.values[: self._end_size])

    @property
    def ends_moving(self) -> bool:
        """The drive runs at the last sample."""
        return self._spans(self.values[-self._end_size :])

    def repetition(self, start: float, stop: float) -> Repetition | None:
        """Return the drive as it repeats itself between two times; None where it does not."""
        if self.frequency is None:
            return None
        near = slice(*np.searchsorted(self.time, (start, stop)))
        return fit_repetition(self.time[near], self.values[near], self.known[near], self.frequency)

    @property
    def _end_size(self) -> int:
        span = max(MOVING_SPAN, 0.25 / self.frequency if self.frequency else 0.0)
        return max(2, round(span * self.rate))

    def _spans(self, part: FloatArray) -> bool:
        """Tell whether a part spans much of the whole motion; rare values, as of taps, left out."""
        whole = np.ptp(np.quantile(self.values, (0.005, 0.995)))
        return bool(np.ptp(np.quantile(part, (0.1, 0.9))) > MOVING_SHARE * whole)


def record_from_rest(
    heave: Channel, frequency: float | None, before: Window | None, after: Window | None
) -> Record:
    """Return a displacement at even steps, straight lines in its holes, counted from where the base rests.

    Parameters
    ----------
    heave : Channel
        Bottom displacement [m].
    frequency : float or None
        Of the drive [Hz].
    before, after : Window or None
        Rest before and after the drive; without both the calmer end of the record.
    """
    rate = heave.rate
    count = int((heave.time[-1] - heave.time[0]) * rate) + 1
    time = heave.time[0] + np.arange(count, dtype=np.float64) / rate
    values = np.interp(time, heave.time, filled(heave))
    record = Record(time, values, np.ones(count, dtype=np.bool_), rate, frequency)
    if before is not None:
        at_rest = time <= before.stop
    elif after is not None:
        at_rest = (time >= after.start) & (time <= after.stop)
    elif record.starts_moving and not record.ends_moving:
        at_rest = time > time[-1] - MOVING_SPAN
    else:
        at_rest = time < time[0] + MOVING_SPAN
    level = float(np.median(values[at_rest])) if at_rest.any() else float(values[0])
    return replace(record, values=values - level)


def holes_of(heave: Channel, shortest: float) -> list[Span]:
    """Return the spans without a usable sample that are longer than `shortest` [s]."""
    time = heave.time[heave.usable]
    edges = np.flatnonzero(np.diff(time) > max(shortest, HOLE_INTERVALS / heave.rate))
    return [(float(time[edge]), float(time[edge + 1])) for edge in edges]


def with_holes_filled(record: Record, holes: Sequence[Span]) -> tuple[Record, list[bool]]:
    """Return the record with holes filled by the drive as it repeats itself, and which of them were."""
    if not holes:
        return record, []
    known, values = record.known.copy(), record.values.copy()
    for first, last in holes:
        known[_rows_between(record, first, last)] = False
    record = replace(record, known=known)
    were_filled = []
    for first, last in holes:
        around = 0.5 * PERIODS / record.frequency if record.frequency else 0.0
        found = record.repetition(first - around, last + around)
        were_filled.append(found is not None)
        if found is not None:
            inside = _rows_between(record, first, last)
            left = np.interp([first, last], record.time, record.values) - found.at(np.array([first, last]))
            values[inside] = found.at(record.time[inside])
            values[inside] += np.interp(record.time[inside], [first, last], left)
    return replace(record, values=values), were_filled


def _rows_between(record: Record, first: float, last: float) -> slice:
    """Return the rows after `first` and before `last` [s]."""
    return slice(int(np.searchsorted(record.time, first, "right")), int(np.searchsorted(record.time, last)))


def lead_in(record: Record) -> FloatArray:
    """Return motion before the record that grows from rest into the drive [m]; empty where that ramps."""
    if record.frequency is None:
        return np.zeros(0)
    begin = float(record.time[0])
    found = record.repetition(begin, begin + PERIODS / record.frequency)
    if found is None:
        return np.zeros(0)
    count = round(max(LEAD_PERIODS / record.frequency, SHORTEST_LEAD) * record.rate)
    time = begin - np.arange(count, 0, -1) / record.rate
    share = np.clip((time - time[0]) / (GROWING * (begin - time[0])), 0.0, 1.0)
    grown = share**3 * (10.0 - 15.0 * share + 6.0 * share**2)
    return np.asarray(grown * _joined(found, time, begin, record.values[0]))


def continued(record: Record, span: float) -> FloatArray:
    """Return the drive past the end of the record [m], for so long [s]; empty where it ramps."""
    if record.frequency is None:
        return np.zeros(0)
    end = float(record.time[-1])
    found = record.repetition(end - PERIODS / record.frequency, end)
    if found is None:
        return np.zeros(0)
    time = end + np.arange(1, round(span * record.rate) + 2) / record.rate
    return _joined(found, time, end, record.values[-1])


def _joined(found: Repetition, time: FloatArray, edge: float, value: float) -> FloatArray:
    """Return the repetition, what the fit leaves at the record's edge faded out over a period."""
    left = value - float(found.at(np.array([edge]))[0])
    phase = np.clip(np.abs(time - edge) * found.frequency, 0.0, 1.0)
    return found.at(time) + left * 0.5 * (1.0 + np.cos(np.pi * phase))
