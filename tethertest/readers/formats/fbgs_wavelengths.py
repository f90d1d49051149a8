"""Wavelengths of slipped gratings: each is known by its place in the fibre's usual spectrum and put back."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from tethertest.records.arrays import BoolArray, FlagArray, FloatArray
from tethertest.records.channel import Flag

#: gratings closer than this cannot be told apart while strain moves them: they are not of one fibre [nm]
_CLOSEST: Final = 0.8
#: a peak that moved is believed this close to its grating, as a fraction of the distance to the next one
_CAPTURE: Final = 0.3
#: rounds in which sound rows widen what is known of the gratings' course
_ROUNDS: Final = 4


@dataclass(frozen=True, slots=True, eq=False)
class PutBack:
    """One fibre's gratings in their own columns."""

    values: FloatArray  #: (n, gratings) [nm]
    flags: FlagArray  #: (n, gratings)
    moved: BoolArray  #: (n,) rows in which anything was changed
    remarks: tuple[tuple[str, BoolArray], ...]  #: a text and the rows it speaks of


def fibres_of(written: FloatArray, columns: Sequence[int], alarmed: BoolArray) -> list[list[int]]:
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


def put_back(written: FloatArray, alarmed: BoolArray) -> PutBack:
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
        return PutBack(peaks, flags, none, (("no peak, lost", lost),) if lost.any() else ())
    if not whole.any() and np.all(missing[:, -1]):
        text = (
            f"never all {width} gratings are seen, and the last column is always blank: "
            f"which grating is missing "
            "cannot be told, so all are lost; a rig file with `expected` wavelengths finds them"
        )
        flags[:] = np.uint16(Flag.LOST)
        return PutBack(np.full_like(peaks, np.nan), flags, ~none, ((text, ~none),))
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
        return PutBack(values, flags, none, (("no peak, lost", lost),) if lost.any() else ())
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
    return PutBack(values, flags, moved, tuple(remarks))


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
