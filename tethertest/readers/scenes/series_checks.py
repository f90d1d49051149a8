"""What a series must be before it can drive the solver: ordered, whole, long and fine enough."""

from __future__ import annotations

import numpy as np

from tethertest.errors import QuantityError
from tethertest.readers.scenes.series_table import Column, SeriesTable
from tethertest.records.arrays import FloatArray
from tethertest.signal.spline import spline
from tethertest.units import channel_scale, parse_quantity

#: longest step of the time, in median steps, that is no hole
LONGEST_STEP = 3.0
#: a spline through every second row must meet the others within this share of the motion's RMS; a sine with
#: eight rows a period misses them by 2.8 %, and a spline through all its rows has its velocity within 0.5 %
COARSE = 0.03
#: rows at each end that do not count, since a spline bends there, and fewest rows for the test
END_ROWS, LEAST_ROWS_TO_THIN = 5, 17


def checked_time(table: SeriesTable, column: Column, least: int) -> FloatArray:
    """Return the time [s] from the first row, checked for order and holes."""
    values = filled(table, column)
    if values.size < least:
        problem = f"found {values.size} rows, expected at least {least}"
        raise table.error(problem, "export a longer record")
    try:
        unit = parse_quantity(f"1 {column.unit or 's'}", "s").value
    except QuantityError:
        problem = f"the time column {column.name!r} has the unit {column.unit!r}, expected one of time"
        raise table.error(problem, "write its unit as s, ms or min, or name another column") from None
    time = unit * (values - values[0])
    steps = np.diff(time)
    wrong = np.flatnonzero(steps <= 0.0)
    if wrong.size:
        row = int(wrong[0])
        before, after = values[row], values[row + 1]
        what = "stands still" if after == before else "goes backward"
        problem = f"the time {what}: found {after:.9g} after {before:.9g}, expected a later one"
        raise table.error(problem, "sort the rows by time and keep one of equal stamps", row + 1)
    usual = float(np.median(steps))
    holes = np.flatnonzero(steps > LONGEST_STEP * usual)
    if holes.size:
        row = int(holes[0])
        problem = (
            f"found a hole of {steps[row]:.6g} s before this row, expected steps of about {usual:.6g} s "
            f"and none above {LONGEST_STEP:g} times that"
        )
        raise table.error(problem, "export the record without gaps, or use the part before it", row + 1)
    return np.asarray(time, dtype=np.float64)


def filled(table: SeriesTable, column: Column) -> FloatArray:
    """Return a column's values, all of them numbers."""
    if column.values is None:
        problem = f"column {column.name!r} holds text, expected numbers"
        raise table.error(problem, "name another column")
    blank = np.flatnonzero(~np.isfinite(column.values))
    if blank.size:
        rows = f"{blank.size} of {column.values.size} rows"
        problem = f"column {column.name!r} has no number here ({rows} have none)"
        raise table.error(problem, "fill the gap, or export the record again", int(blank[0]))
    return column.values


def si_factor(table: SeriesTable, column: Column, unit: str, kind: str) -> float:
    """Return SI per unit of a column, whose unit must be one of the kind."""
    try:
        return channel_scale(unit, kind).factor
    except QuantityError as error:
        problem = f"column {column.name!r}: {error.problem}"
        raise table.error(problem, f"give the unit of a {kind}, or name another column") from None


def check_span(table: SeriesTable, time: FloatArray, duration: float) -> None:
    """Refuse a record that ends more than one step before the output."""
    if time[-1] + float(np.median(np.diff(time))) < duration * (1.0 - 1e-9):
        problem = f"the record ends {time[-1]:.6g} s after its first row, expected {duration:g} s of output"
        remedy = f'write [output] duration = "{time[-1]:.6g} s", or export a longer record'
        raise table.error(problem, remedy, time.size - 1)


def check_rate(table: SeriesTable, time: FloatArray, values: FloatArray, name: str) -> None:
    """Refuse a motion that its rows do not follow: half of them must predict the other half."""
    size = float(np.std(values))
    if time.size < LEAST_ROWS_TO_THIN or size <= 1e-12 * float(np.max(np.abs(values))):
        return
    inside = slice(END_ROWS, time.size - END_ROWS, 2)
    predicted = spline(time[::2], values[::2])(time[inside])
    miss = float(np.sqrt(np.mean((predicted - values[inside]) ** 2))) / size
    if miss > COARSE:
        rate = (time.size - 1) / time[-1]
        problem = (
            f"column {name!r} at {rate:.4g} Hz is too coarse or too noisy to drive the cable: every second "
            f"row misses the curve through the others by {100 * miss:.2g} % of the motion, expected at most "
            f"{100 * COARSE:g} %"
        )
        remedy = "log at least eight rows in each period of the fastest part, or filter the noise"
        raise table.error(problem, remedy)
