"""Which grating each value of an FBGS export belongs to, row by row and fibre by fibre.

A lost peak moves the later gratings of its fibre one column to the left; a peak too many moves them to the
right. Wavelengths say themselves which grating they are and are put back. Strain and temperature are counted
from the reference of the column they stand in, so a moved value is of no use in either column and is lost.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from tethertest.readers.channels import INTERROGATOR_BAND
from tethertest.records.arrays import BoolArray, FlagArray, FloatArray
from tethertest.records.channel import Flag

#: lines named in a remark
_LINES_NAMED: Final = 4
#: gratings closer than this cannot be told apart while strain moves them: they are not of one fibre [nm]
_CLOSEST: Final = 0.8
#: a peak that moved is believed this close to its grating, as a fraction of the distance to the next one
_CAPTURE: Final = 0.3
#: rounds in which sound rows widen what is known of the gratings' course
_ROUNDS: Final = 4
#: a value leaps when it strays from its sound neighbours by this many times what nearly all others do
_LEAP: Final = 3.0
#: nearly all: the rest may be true snaps
_NEARLY_ALL: Final = 99.9
#: without an error status only a leap this many times larger than most is worth a remark
_SUSPECT: Final = 30.0
#: most
_MOST: Final = 95.0
#: fewer rows without an error status than this say nothing; then the bulk of all rows does
_FEWEST: Final = 10
#: the bulk lies within so many median deviations
_BULK: Final = 10.0


@dataclass(frozen=True, slots=True, eq=False)
class Placed:
    """Every value under its own grating."""

    values: FloatArray  #: (n, gratings), NaN where a grating was lost
    flags: FlagArray  #: (n, gratings) `Flag.LOST` and `Flag.SLIPPED`
    remarks: tuple[str, ...]


def is_wavelength(values: FloatArray) -> BoolArray:
    """Return (columns,) True for columns whose values lie in an interrogator's band."""
    found = np.zeros(values.shape[1], dtype=bool)
    for column in range(values.shape[1]):
        seen = values[:, column][np.isfinite(values[:, column]) & (values[:, column] > 0.0)]
        found[column] = (
            seen.size > 0 and INTERROGATOR_BAND[0] <= float(np.median(seen)) <= INTERROGATOR_BAND[1]
        )
    return found


def placed(
    written: FloatArray, names: Sequence[str], alarmed: BoolArray, lines: np.ndarray, wavelengths: BoolArray
) -> Placed:
    """Put every value back under its own grating.

    Parameters
    ----------
    written : ndarray
        (n, columns) as the file has them, NaN where blank.
    names : sequence of str
        Of the columns.
    alarmed : ndarray
        (n,) True where the error status is not all zero.
    lines : ndarray
        (n,) lines of the rows, for remarks.
    wavelengths : ndarray
        (columns,) True for wavelengths, see `is_wavelength`; a column that was never seen counts with the one
        before it.

    Returns
    -------
    Placed
        What cannot be told is NaN with `Flag.LOST`, never under a wrong name.
    """
    values, flags = written.copy(), np.zeros(written.shape, dtype=np.uint16)
    remarks: list[str] = []
    moved = np.zeros(len(written), dtype=bool)
    for columns in _alike(wavelengths):
        if wavelengths[columns[0]]:
            for fibre in _fibres_of(written, columns, alarmed):
                found = _put_back(written[:, fibre], alarmed)
                values[:, fibre], flags[:, fibre] = found.values, found.flags
                moved |= found.moved
                label = names[fibre[0]] if len(fibre) == 1 else f"{names[fibre[0]]} to {names[fibre[-1]]}"
                remarks += [f"{label}: {text}{_lines_named(rows, lines)}" for text, rows in found.remarks]
        else:
            gone, suspect = _moved_values(written[:, columns], alarmed)
            values[:, columns] = np.where(gone, np.nan, written[:, columns])
            flags[:, columns] |= np.where(gone, np.uint16(Flag.LOST), np.uint16(0))
            rows = np.any(gone, axis=1)
            moved |= rows
            remarks += _leap_remarks(gone, suspect, [names[column] for column in columns], lines)
    quiet = int(np.count_nonzero(alarmed & ~moved))
    if quiet:
        remarks.append(
            f"{quiet} more lines have an error status, but their values run on smoothly and are kept"
        )
    return Placed(values, flags, tuple(remarks))


def _alike(wavelengths: BoolArray) -> list[list[int]]:
    """Return the runs of neighbouring columns of one kind."""
    edges = np.flatnonzero(np.diff(wavelengths.astype(int))) + 1
    return [part.tolist() for part in np.split(np.arange(wavelengths.size), edges)]


def _leap_remarks(gone: BoolArray, suspect: BoolArray, names: list[str], lines: np.ndarray) -> list[str]:
    remarks: list[str] = []
    rows = np.any(gone, axis=1)
    if rows.any():
        columns = np.flatnonzero(np.any(gone, axis=0))
        always = int(np.min(np.count_nonzero(gone[rows], axis=1)))
        remarks.append(
            f"slipped: in {np.count_nonzero(rows)} lines the gratings of a fibre are in wrong columns "
            f"({names[columns[0]]} to {names[columns[-1]]}, {always} to {columns.size} of "
            f"them a line); these are no "
            f"wavelengths, so the {np.count_nonzero(gone)} values cannot be put back and are lost"
            f"{_lines_named(rows, lines)}"
        )
    if suspect.any():
        remarks.append(
            f"{np.count_nonzero(suspect)} lines without an error status leap in neighbouring "
            f"columns and come "
            f"back, as slipped lines do; they are kept{_lines_named(suspect, lines)}"
        )
    return remarks


def _lines_named(rows: BoolArray, lines: np.ndarray) -> str:
    """Return which lines the rows are, the first few by number."""
    places = lines[rows]
    first = ", ".join(str(line) for line in places[:_LINES_NAMED])
    more = ", ..." if places.size > _LINES_NAMED else ""
    return f" (line {first}{more})" if places.size == 1 else f" (lines {first}{more}, last {places[-1]})"


@dataclass(frozen=True, slots=True, eq=False)
class _PutBack:
    """One fibre's gratings in their own columns."""

    values: FloatArray  #: (n, gratings) [nm]
    flags: FlagArray  #: (n, gratings)
    moved: BoolArray  #: (n,) rows in which anything was changed
    remarks: tuple[tuple[str, BoolArray], ...]  #: a text and the rows it speaks of


def _fibres_of(written: FloatArray, columns: Sequence[int], alarmed: BoolArray) -> list[list[int]]:
    """Return the columns of each fibre: along a fibre the usual wavelengths go one way.

    Parameters
    ----------
    written : ndarray
        (n, all columns).
    columns : sequence of int
        Neighbouring columns that hold wavelengths.
    alarmed : ndarray
        (n,) True where the error status is not all zero.
    """
    usual = _usual(_peaks(written[:, list(columns)]), alarmed)
    seen = usual[np.isfinite(usual)]
    falling = np.count_nonzero(np.diff(seen) < 0) * 2 > max(seen.size - 1, 1)
    fibres: list[list[int]] = [[]]
    last = np.nan
    for column, value in zip(columns, -usual if falling else usual, strict=True):
        if fibres[-1] and np.isfinite(last) and value - last < _CLOSEST:
            fibres.append([])
        fibres[-1].append(column)
        last = value if np.isfinite(value) else last
    return fibres


def _put_back(written: FloatArray, alarmed: BoolArray) -> _PutBack:
    """Return the wavelengths of one fibre, each in its own grating's column.

    Parameters
    ----------
    written : ndarray
        (n, gratings) [nm] as the file has them; blank or zero where there is no peak.
    alarmed : ndarray
        (n,) True where the error status is not all zero.
    """
    peaks = _peaks(written)
    count, width = peaks.shape
    none = np.zeros(count, dtype=bool)
    missing = np.isnan(peaks)
    flags = np.where(missing, np.uint16(Flag.LOST), np.uint16(0)).astype(np.uint16)
    whole = ~np.any(missing, axis=1)
    if width == 1 or (
        not missing[:, -1].any() and not alarmed.any() and _in_place(peaks, _usual(peaks, alarmed)).all()
    ):
        lost = np.any(missing, axis=1)
        return _PutBack(peaks, flags, none, (("no peak, lost", lost),) if lost.any() else ())
    if not whole.any() and np.all(missing[:, -1]):
        text = (
            f"never all {width} gratings are seen, and the last column is always blank: "
            f"which grating is missing "
            "cannot be told, so all are lost; a rig file with `expected` wavelengths finds them"
        )
        flags[:] = np.uint16(Flag.LOST)
        return _PutBack(np.full_like(peaks, np.nan), flags, ~none, ((text, ~none),))
    usual = _usual(peaks, alarmed)
    course = np.broadcast_to(usual, peaks.shape)
    sound = none
    for _ in range(_ROUNDS):
        found = _in_place(peaks, usual) | _in_place(peaks, course)
        if not found.any() or np.array_equal(found, sound):
            break
        sound = found
        course = _course(peaks, sound, usual)
    wrong = np.flatnonzero(~sound)
    values = peaks.copy()
    if not wrong.size:
        lost = np.any(missing, axis=1)
        return _PutBack(values, flags, none, (("no peak, lost", lost),) if lost.any() else ())
    values[wrong], own = _assigned(peaks[wrong], course[wrong])
    gone = np.isnan(values[wrong])
    flags[wrong] = np.where(gone, np.uint16(Flag.LOST), np.where(own, np.uint16(0), np.uint16(Flag.SLIPPED)))
    moved = ~sound
    dropped = int(np.count_nonzero(~missing[wrong]) - np.count_nonzero(~gone))
    back = int(np.count_nonzero(~gone & ~own))
    text = (
        f"slipped: in {wrong.size} lines the peaks stand in wrong columns; {back} values "
        f"put back under their "
        f"gratings by wavelength, {int(np.count_nonzero(gone))} lost, {dropped} peaks left "
        f"out that fit no grating"
    )
    remarks = [(text, moved)]
    lost = np.any(missing, axis=1) & sound
    if lost.any():
        remarks.append(("no peak, lost", lost))
    return _PutBack(values, flags, moved, tuple(remarks))


def _peaks(written: FloatArray) -> FloatArray:
    return np.where(written > 0.0, written, np.nan)


def _usual(peaks: FloatArray, alarmed: BoolArray) -> FloatArray:
    """Return the median wavelength of each column, of rows that lack no peak and have no error status."""
    whole = ~np.any(np.isnan(peaks), axis=1)
    for rows in (whole & ~alarmed, whole, ~alarmed, np.ones_like(whole)):
        if rows.any():
            part = peaks[rows]
            result = np.full(peaks.shape[1], np.nan)
            for column in range(peaks.shape[1]):
                seen = part[:, column][np.isfinite(part[:, column])]
                result[column] = float(np.median(seen)) if seen.size else np.nan
            return result
    return np.full(peaks.shape[1], np.nan)


def _in_place(peaks: FloatArray, expected: FloatArray) -> BoolArray:
    """Return the rows whose every peak is nearer to its own grating than to any other."""
    apart = np.abs(peaks[:, :, None] - np.atleast_2d(expected)[:, None, :])
    apart[np.isnan(apart)] = np.inf
    own = np.argmin(apart, axis=2) == np.arange(peaks.shape[1])
    return np.asarray(np.all(own | np.isnan(peaks), axis=1))


def _course(peaks: FloatArray, sound: BoolArray, usual: FloatArray) -> FloatArray:
    """Return (n, gratings) wavelengths expected from the sound rows before and after."""
    row = np.arange(len(peaks))
    result = np.empty_like(peaks)
    for column in range(peaks.shape[1]):
        good = np.flatnonzero(sound & np.isfinite(peaks[:, column]))
        result[:, column] = np.interp(row, good, peaks[good, column]) if good.size else usual[column]
    return result


def _assigned(peaks: FloatArray, expected: FloatArray) -> tuple[FloatArray, BoolArray]:
    """Give each peak to the grating it is plainly at; return values, and which peaks were in place."""
    order = np.argsort(expected, axis=1)
    ranked = np.take_along_axis(expected, order, axis=1)
    gaps = np.diff(ranked, axis=1)
    edge = np.full((len(peaks), 1), np.inf)
    below, above = np.hstack((edge, gaps)), np.hstack((gaps, edge))
    room = np.empty_like(expected)
    np.put_along_axis(room, order, np.minimum(below, above), axis=1)
    apart = np.abs(peaks[:, :, None] - expected[:, None, :])
    close = apart <= _CAPTURE * room[:, None, :]
    once = np.count_nonzero(close, axis=1) == 1
    column = np.argmax(close, axis=1)
    rising = np.sign(expected[:, -1] - expected[:, 0])
    values = np.where(once, np.take_along_axis(peaks, column, axis=1), np.nan)
    for line in range(len(values)):
        seen = np.flatnonzero(once[line])
        if np.any(np.diff(column[line, seen]) <= 0) or np.any(
            np.diff(values[line, seen]) * rising[line] <= 0
        ):
            values[line] = np.nan
    own = once & (column == np.arange(peaks.shape[1]))
    return values, own


def _moved_values(values: FloatArray, alarmed: BoolArray) -> tuple[BoolArray, BoolArray]:
    """Find values that do not belong to their column.

    Parameters
    ----------
    values : ndarray
        (n, columns) no wavelengths.
    alarmed : ndarray
        (n,) True where the error status is not all zero; only there values are condemned, and only those that
        leap, with all behind them up to the end of their fibre.

    Returns
    -------
    tuple of ndarray
        (n, columns) True where a value belongs elsewhere; (n,) True for rows without an error status that
        look like slipped ones.
    """
    gone = np.zeros(values.shape, dtype=bool)
    calm = ~alarmed
    if np.count_nonzero(calm) < _FEWEST:
        middle = np.nanmedian(values, axis=0) if len(values) else values
        spread = np.nanmedian(np.abs(values - middle), axis=0)
        calm = np.all(~(np.abs(values - middle) > _BULK * spread), axis=1)
        if np.count_nonzero(calm) < _FEWEST:
            return gone, np.zeros(len(values), dtype=bool)
    suspect = np.zeros(values.shape, dtype=bool)
    for column in range(values.shape[1]):
        gone[:, column] = _leaps(values[:, column], calm)
        suspect[:, column] = _outliers(values[:, column], calm)
    together = suspect[:, 1:] & suspect[:, :-1]
    return _to_the_ends(gone), np.asarray(np.any(together, axis=1))


def _leaps(values: FloatArray, calm: BoolArray) -> BoolArray:
    """Return which values of the other rows stray from the course of the calm rows around them."""
    seen = np.isfinite(values)
    good = np.flatnonzero(calm & seen)
    result = np.zeros(values.size, dtype=bool)
    if good.size < _FEWEST:
        return result
    course, row = values[good], np.arange(values.size)
    usual = _usual_steps(course)
    place = np.searchsorted(good, row)
    before = np.maximum(place - 1, 0)
    after = np.minimum(place, good.size - 1)
    expected = 0.5 * (course[before] + course[after])
    apart = np.minimum(np.abs(row - good[before]), np.abs(good[after] - row))
    allowed = _LEAP * usual[np.minimum(np.ceil(np.log2(np.maximum(apart, 1))).astype(int), usual.size - 1)]
    allowed = allowed + np.abs(course[after] - course[before])
    leaps: BoolArray = ~calm & seen & (np.abs(values - expected) > allowed)
    return leaps


def _outliers(values: FloatArray, calm: BoolArray) -> BoolArray:
    """Return which values of the calm rows leave their neighbours' mean far more than most do."""
    result = np.zeros(values.size, dtype=bool)
    rows = np.flatnonzero(calm & np.isfinite(values))
    if rows.size < _FEWEST:
        return result
    course = values[rows]
    away = np.abs(course[1:-1] - 0.5 * (course[:-2] + course[2:]))
    back = np.abs(course[2:] - course[:-2])
    most = float(np.percentile(away, _MOST))
    result[rows[1:-1]] = (away > _SUSPECT * most) & (away > _LEAP * back) & (most > 0.0)
    return result


def _usual_steps(course: FloatArray) -> FloatArray:
    """Return what nearly all values change by over 1, 2, 4, ... rows, never less than the smallest step."""
    steps = np.abs(np.diff(course))
    floor = float(np.min(steps[steps > 0.0], initial=np.inf))
    floor = floor if np.isfinite(floor) else 1e-9 * float(np.max(np.abs(course)))
    result = [max(float(np.percentile(steps, _NEARLY_ALL)), floor)]
    lag = 2
    while lag < course.size // 2:
        result.append(
            max(float(np.percentile(np.abs(course[lag:] - course[:-lag]), _NEARLY_ALL)), result[-1])
        )
        lag *= 2
    return np.array(result)


def _to_the_ends(gone: BoolArray) -> BoolArray:
    """Condemn all columns from the first that leapt to the end of the fibre, as far as it is known."""
    result = gone.copy()
    width = gone.shape[1]
    behind = np.zeros(gone.shape, dtype=bool)
    behind[:, :-1] = gone[:, 1:]
    last = np.count_nonzero(gone & ~behind, axis=0)
    ends = [column for column in range(width) if last[column] * 2 > np.count_nonzero(gone[:, column]) > 0]
    first = 0
    for end in ends:
        result[:, first : end + 1] |= np.maximum.accumulate(gone[:, first : end + 1], axis=1)
        first = end + 1
    return result
