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

from tethertest.readers.formats.fbgs_leaps import moved_values
from tethertest.readers.formats.fbgs_wavelengths import fibres_of, put_back
from tethertest.records.arrays import BoolArray, FlagArray, FloatArray
from tethertest.records.channel import Flag

#: interrogators see the bands O to U [nm]
BAND: Final = (1260.0, 1680.0)
#: lines named in a remark
_LINES_NAMED: Final = 4


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
        found[column] = seen.size > 0 and BAND[0] <= float(np.median(seen)) <= BAND[1]
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
            for fibre in fibres_of(written, columns, alarmed):
                found = put_back(written[:, fibre], alarmed)
                values[:, fibre], flags[:, fibre] = found.values, found.flags
                moved |= found.moved
                label = names[fibre[0]] if len(fibre) == 1 else f"{names[fibre[0]]} to {names[fibre[-1]]}"
                remarks += [f"{label}: {text}" for text in _named(found.remarks, lines)]
        else:
            gone, suspect = moved_values(written[:, columns], alarmed)
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


def _named(remarks: Sequence[tuple[str, BoolArray]], lines: np.ndarray) -> list[str]:
    return [f"{text}{lines_named(rows, lines)}" for text, rows in remarks]


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
            f"{lines_named(rows, lines)}"
        )
    if suspect.any():
        remarks.append(
            f"{np.count_nonzero(suspect)} lines without an error status leap in neighbouring "
            f"columns and come "
            f"back, as slipped lines do; they are kept{lines_named(suspect, lines)}"
        )
    return remarks


def lines_named(rows: BoolArray, lines: np.ndarray) -> str:
    """Return which lines the rows are, the first few by number."""
    places = lines[rows]
    first = ", ".join(str(line) for line in places[:_LINES_NAMED])
    more = ", ..." if places.size > _LINES_NAMED else ""
    return f" (line {first}{more})" if places.size == 1 else f" (lines {first}{more}, last {places[-1]})"
