"""Which grating each peak of an interrogator's rows belongs to, or that this cannot be told."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tethertest.conditioning.gratings.pattern import GAIN_SPREAD, MOTION_SHARE, Pattern, coarse, learnt
from tethertest.conditioning.gratings.spurious_peaks import stray, unmoved
from tethertest.records.arrays import BoolArray, FloatArray

#: capture ranges that touch do not overlap
CLOSE = 1e-9
#: no peak
NONE = -1
#: shifts of the pattern that are tried in one row, at most
MOST_SHIFTS = 256
#: shifts closer than this share of the smallest tolerance are one
SHIFT_GRID = 0.5
#: where ghosts are about, one peak alone is believed only this many rows after or before a decided row
ALONE = 5
#: decided rows are looked for this many rows away
SEARCHED = 20_000


@dataclass(frozen=True, slots=True, eq=False)
class Owners:
    """The peaks of every grating of one fibre."""

    column: np.ndarray  #: (n, g) column of each grating's peak, `NONE` where none is its own beyond doubt
    doubtful: BoolArray  #: (n, g) True where a peak was there that may also be another grating's, or a ghost


def assign_peaks(
    peaks: FloatArray, time: FloatArray, expected: FloatArray, capture: FloatArray, strained: BoolArray
) -> Owners:
    """Give peaks to gratings so that no peak is ever given to a wrong one.

    Where capture ranges do not overlap and never hold two peaks, they decide. Else rows in which all gratings
    are seen, in their order, teach how they move together. In the other rows every
    common shift is tried that the rows before and after leave possible; a peak is given to a grating only
    if all shifts that explain the most peaks agree on it.

    Parameters
    ----------
    peaks : ndarray
        (n, p) wavelengths in any order, NaN where a column is empty [m].
    time : ndarray
        (n,) [s].
    expected, capture : ndarray
        (g,) expected wavelengths, rising, and the largest believable distance from them [m].
    strained : ndarray
        (g,) False for gratings that are free of strain.
    """
    by_capture = _captured(peaks, expected, capture)
    if by_capture is not None:
        return Owners(by_capture, np.zeros(by_capture.shape, dtype=bool))
    size = peaks.shape[0], expected.size
    column = np.full(size, NONE)
    doubtful = np.zeros(size, dtype=bool)
    base = coarse(expected, capture, strained, peaks, time)
    rows, whole_columns = _whole(peaks, expected, capture)
    whole = np.where(whole_columns == NONE, np.nan, _taken(peaks[rows], whole_columns))
    found = learnt(base, whole, rows, size[0])
    shift = np.full(size[0], np.nan)
    pattern = base
    ghosts = True
    if found is not None:
        pattern, shifts, keeps = found
        column[rows[keeps]] = whole_columns[keeps]
        shift[rows[keeps]] = shifts[keeps]
        usual = int(np.count_nonzero(np.isfinite(whole[0])))
        ghosts = bool(np.any(np.sum(np.isfinite(peaks), axis=1) > usual) or not keeps.all())
    search = _Search(pattern, peaks, time, shift, column, doubtful, ghosts)
    left = np.flatnonzero(np.isnan(shift) & np.isfinite(peaks).any(axis=1))
    search.run(left)
    search.run(left[np.isnan(shift[left]) | doubtful[left].any(axis=1)][::-1])
    false = stray(peaks, column, time) | unmoved(peaks, column, shift, pattern)
    false &= column != NONE
    return Owners(np.where(false, NONE, column), doubtful | false)


def _captured(peaks: FloatArray, expected: FloatArray, capture: FloatArray) -> np.ndarray | None:
    """Return the columns of peaks by capture range alone, which is enough where nothing speaks against it.

    None where capture ranges overlap, or where one holds two peaks in some row: then there are ghosts.
    """
    if np.any(np.diff(expected) < (capture[1:] + capture[:-1]) * (1.0 - CLOSE)):
        return None
    column = np.full((peaks.shape[0], expected.size), NONE)
    for grating in range(expected.size):
        inside = np.abs(peaks - expected[grating]) <= capture[grating]
        count = inside.sum(axis=1)
        if np.any(count > 1):
            return None
        column[:, grating] = np.where(count == 1, np.argmax(inside, axis=1), NONE)
    return column


def _whole(peaks: FloatArray, expected: FloatArray, capture: FloatArray) -> tuple[np.ndarray, np.ndarray]:
    """Return rows that show every grating of the log in order, and the columns of the gratings there.

    Where too few rows have as many peaks as the rig has gratings, some are dead: then the most common set of
    gratings whose capture ranges hold one peak each.
    """
    order = np.argsort(peaks, axis=1)
    count = np.sum(np.isfinite(peaks), axis=1)
    rows = np.flatnonzero(count == expected.size)
    if rows.size:
        columns = order[rows][:, : expected.size]
        inside = np.all(np.abs(_taken(peaks[rows], columns) - expected) <= capture, axis=1)
        rows, columns = rows[inside], columns[inside]
        if rows.size >= 0.05 * peaks.shape[0]:
            return rows, columns
    near = np.abs(peaks[:, :, None] - expected) <= capture
    each = near.sum(axis=1)
    one = (each <= 1).all(axis=1) & (near.sum(axis=2) == np.isfinite(peaks)).all(axis=1)
    sets, inverse, numbers = np.unique(each[one] > 0, axis=0, return_inverse=True, return_counts=True)
    if not sets.size:
        return np.zeros(0, int), np.zeros((0, expected.size), int)
    # the largest set among the common ones: a smaller one lacks gratings that are only lost for a while
    common = np.flatnonzero(numbers >= 0.05 * peaks.shape[0])
    best = max(common, key=lambda item: (sets[item].sum(), numbers[item])) if common.size else 0
    rows = np.flatnonzero(one)[np.ravel(inverse) == best]
    columns = np.where(sets[best], np.argmax(near[rows], axis=1), NONE)
    return rows, columns


def _taken(peaks: FloatArray, columns: np.ndarray) -> FloatArray:
    return np.take_along_axis(peaks, np.maximum(columns, 0), axis=1)


@dataclass(slots=True, eq=False)
class _Search:
    """Rows that lack peaks or have too many, one after the other; fills the arrays that it is given."""

    pattern: Pattern
    peaks: FloatArray
    time: FloatArray
    shift: FloatArray  #: (n,) common shift of rows that are done, NaN elsewhere
    column: np.ndarray
    doubtful: BoolArray
    ghosts: bool  #: the log shows peaks that are no grating's

    def run(self, rows: np.ndarray) -> None:
        """Decide rows in the order given; a row that is decided tells the next one."""
        for row in rows:
            self._decide(int(row))

    def _window(self, row: int) -> tuple[float, float, float]:
        """Return the smallest and largest shift that the nearest decided rows allow, and the one expected."""
        low, high = -self.pattern.reach, self.pattern.reach
        known = np.isfinite(self.shift)
        at, weight = 0.0, 0.0
        for other in (_before(known, row), _after(known, row)):
            if other is None:
                continue
            reach = self.pattern.rate * abs(self.time[row] - self.time[other]) + self.pattern.slack
            low, high = max(low, self.shift[other] - reach), min(high, self.shift[other] + reach)
            near = 1.0 / abs(row - other)
            at, weight = at + near * self.shift[other], weight + near
        return low, high, at / weight if weight else 0.5 * (low + high)

    def _decide(self, row: int) -> None:
        columns = np.flatnonzero(np.isfinite(self.peaks[row]))
        values = self.peaks[row, columns]
        low, high, usual = self._window(row)
        shifts = self._shifts(values, low, high, usual)
        if not shifts.size:
            return
        # gratings part from the pattern by their own tolerance and by a share of the motion since
        calm = usual if np.isfinite(self.pattern.rate) else None
        fits = self._fits(values, shifts, calm)
        explained = np.minimum(fits.any(axis=2).sum(axis=1), fits.any(axis=1).sum(axis=1))
        most = int(explained.max())
        if most == 0:
            return
        if most == 1 and self.ghosts and not self._beside_decided(row):
            self.doubtful[row] = fits.any(axis=(0, 1))
            return
        best = fits[explained == most]
        spare = 1 if self.ghosts and most > 1 else 0
        possible = fits[explained >= most - spare].any(axis=0)
        certain = best.all(axis=0) if best.shape[0] == 1 else best.any(axis=0)
        alone = (possible.sum(axis=1) == 1)[:, None] & (possible.sum(axis=0) == 1)[None, :]
        given = certain & alone
        self.column[row] = NONE
        self.doubtful[row] = possible.any(axis=0)
        for peak, grating in zip(*np.nonzero(given), strict=True):
            self.column[row, grating] = columns[peak]
            self.doubtful[row, grating] = False
        seen = self.column[row] != NONE
        if seen.any():
            told = self.pattern.shift_of(
                np.where(seen, self.peaks[row, np.maximum(self.column[row], 0)], np.nan)
            )
            if np.isfinite(told).any():
                self.shift[row] = float(np.nanmedian(told))

    def _beside_decided(self, row: int) -> bool:
        near = self.shift[max(row - ALONE, 0) : row + ALONE + 1]
        return bool(np.isfinite(near).any())

    def _shifts(self, values: FloatArray, low: float, high: float, usual: float) -> FloatArray:
        """Return the common shifts to try: each puts one peak exactly on one grating."""
        asked = self.pattern.shift_of(values[:, None])
        inside = np.abs(values[:, None] - self.pattern.expected) <= self.pattern.capture
        tried = asked[inside & (asked >= low) & (asked <= high)]
        tried = np.append(tried, np.clip(usual, low, high)) if low <= high else tried
        grid = SHIFT_GRID * float(np.min(self.pattern.tolerance))
        _, first = np.unique(np.round(tried / grid), return_index=True)
        unique = tried[first]
        if unique.size > MOST_SHIFTS:
            unique = unique[np.linspace(0, unique.size - 1, MOST_SHIFTS).astype(int)]
        return unique

    def _fits(self, values: FloatArray, shifts: FloatArray, calm: float | None) -> BoolArray:
        """Return (shifts, peaks, gratings) where a peak lies on a grating of the shifted pattern."""
        pattern = self.pattern
        motion = MOTION_SHARE * np.abs(shifts - (shifts if calm is None else calm))[:, None]
        unknown = np.maximum(np.maximum(pattern.low - shifts, shifts - pattern.high), 0.0)
        parting = motion + GAIN_SPREAD * unknown[:, None]
        reach = pattern.expected * (pattern.tolerance + parting)
        away = np.abs(values[None, :, None] - pattern.wavelength(shifts)[:, None, :])
        inside = np.abs(values[:, None] - pattern.expected) <= pattern.capture
        return np.asarray((away <= reach[:, None, :]) & inside, dtype=bool)


def _before(known: BoolArray, row: int) -> int | None:
    found = np.flatnonzero(known[:row][::-1][:SEARCHED])
    return row - 1 - int(found[0]) if found.size else None


def _after(known: BoolArray, row: int) -> int | None:
    found = np.flatnonzero(known[row + 1 :][:SEARCHED])
    return row + 1 + int(found[0]) if found.size else None
