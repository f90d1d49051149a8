"""The series that a scene names: the measured bottom motion and the wind, and what is asked of their rows.

Both count time from their own first row, which is the scene's start, and must reach to the end of its output.
"""

from __future__ import annotations

import difflib
from pathlib import Path

import numpy as np

from tethertest.errors import QuantityError
from tethertest.readers.config.problems import suggestion
from tethertest.readers.config.scene_series_table import Column, SeriesTable, read_series_table
from tethertest.records.arrays import FloatArray, frozen
from tethertest.records.scene import MeasuredMotion, Scene, WindSeries
from tethertest.signal.spline import spline
from tethertest.units import channel_scale, parse_quantity

#: fewest rows of a motion: a cubic spline needs them
_LEAST_MOTION_ROWS = 4
_LEAST_WIND_ROWS = 2
#: first names of a time column and of the wind's components, without unit and in small letters
_TIME_NAMES = ("time", "t", "timestamp", "elapsed")
_WIND_NAMES = {
    "wind_x": 0, "wind_y": 1, "wind_z": 2, "wind": 0, "wind_speed": 0, "u": 0, "v": 1, "w": 2,
    "x": 0, "y": 1, "z": 2, "wind_u": 0, "wind_v": 1, "wind_w": 2,
}  # fmt: skip
_WIND_REMEDY = "name the columns time_s and wind_x_m_s, wind_y_m_s, wind_z_m_s, or those of them you have"
#: longest step of the time, in median steps, that is no hole
_LONGEST_STEP = 3.0
#: a spline through every second row must meet the others within this share of the motion's RMS; a sine with
#: eight rows a period misses them by 2.8 %, and a spline through all its rows has its velocity within 0.5 %
_COARSE = 0.03
#: rows at each end that do not count, since a spline bends there, and fewest rows for the test
_END_ROWS, _LEAST_ROWS_TO_THIN = 5, 17


def read_motion(scene: Scene) -> MeasuredMotion | None:
    """Return the measured displacement of a scene's bottom; None where its motion is not measured.

    Raises
    ------
    TethertestError
        With file and row: a column is missing or blank, its unit is at odds with the scene's, the time is
        unsorted or has holes, the record is too short or too coarse.
    """
    bottom = scene.bottom
    if bottom.motion != "measured" or bottom.file is None:
        return None
    table = read_series_table(Path(bottom.file))
    wanted = {"time_column": bottom.time_column, "displacement_column": bottom.displacement_column}
    missing = {key: name for key, name in wanted.items() if name is None or table.column(name) is None}
    if missing:
        keys = " and ".join(f"{key} = {name!r}" for key, name in missing.items())
        names = [column.name for column in table.columns]
        remedy = "; ".join(f"{key}: {suggestion(str(name), names)}" for key, name in missing.items())
        problem = f"[bottom] {keys} is not among the columns {table.names()}"
        raise table.error(problem, f"correct the scene; {remedy}")
    time = _checked_time(table, _named(table, bottom.time_column), _LEAST_MOTION_ROWS)
    column = _named(table, bottom.displacement_column)
    values = _displacement_scale(table, column, bottom.unit) * _filled(table, column)
    _check_span(table, time, scene.output.duration)
    _check_rate(table, time, values, column.name)
    return MeasuredMotion(frozen(time), frozen(values - values[0]))


def read_wind(scene: Scene) -> WindSeries | None:
    """Return the wind of a scene's wind file; None where it names none.

    The time is the column ``time_s`` (or ``time``, ``t`` with a unit in brackets), the components are
    ``wind_x_m_s``, ``wind_y_m_s`` and ``wind_z_m_s``; one that is missing is zero.

    Raises
    ------
    TethertestError
        As in `read_motion`.
    """
    if scene.air is None or scene.air.wind_file is None:
        return None
    table = read_series_table(Path(scene.air.wind_file))
    clock = next((column for column in table.columns if column.stem.lower() in _TIME_NAMES), None)
    if clock is None:
        problem = f"there is no time column among {table.names()}"
        raise table.error(problem, _WIND_REMEDY)
    time = _checked_time(table, clock, _LEAST_WIND_ROWS)
    components: dict[int, Column] = {}
    for column in table.columns:
        axis = _WIND_NAMES.get(column.stem.lower())
        if column is clock:
            continue
        if axis is None:
            _refuse_misspelled(table, column)
        elif axis in components:
            problem = f"columns {components[axis].name!r} and {column.name!r} give the same component"
            raise table.error(problem, "keep one of them")
        else:
            components[axis] = column
    if not components:
        problem = f"there is no component of the wind among {table.names()}"
        raise table.error(problem, _WIND_REMEDY)
    velocity = np.zeros((time.size, 3))
    for axis, column in components.items():
        velocity[:, axis] = _si_factor(table, column, column.unit or "m/s", "velocity") * _filled(
            table, column
        )
    _check_span(table, time, scene.output.duration)
    return WindSeries(frozen(time), frozen(velocity))


def _named(table: SeriesTable, name: str | None) -> Column:
    column = None if name is None else table.column(name)
    if column is None:
        raise AssertionError(name)  # the caller has looked for it
    return column


def _displacement_scale(table: SeriesTable, column: Column, unit: str | None) -> float:
    """Return metres per unit of the column; what the file itself says must agree with the scene."""
    factor = _si_factor(table, column, unit or column.unit or "m", "displacement")
    if not column.unit:
        return factor
    own = _si_factor(table, column, column.unit, "displacement")
    if not np.isclose(own, factor, rtol=1e-9, atol=0.0):
        problem = f"column {column.name!r} is in {column.unit}, but [bottom] unit is {unit!r}"
        raise table.error(problem, "correct unit in the scene, or the name of the column")
    return factor


def _refuse_misspelled(table: SeriesTable, column: Column) -> None:
    """Refuse a column that is nearly a component, which would otherwise be left out without a word."""
    meant = difflib.get_close_matches(column.stem.lower(), ("wind_x", "wind_y", "wind_z"), n=1, cutoff=0.75)
    if meant:
        problem = f"column {column.name!r} is no component of the wind"
        remedy = f"did you mean {meant[0]}_m_s?"
        raise table.error(problem, remedy)


def _checked_time(table: SeriesTable, column: Column, least: int) -> FloatArray:
    """Return the time [s] from the first row, checked for order and holes."""
    values = _filled(table, column)
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
    holes = np.flatnonzero(steps > _LONGEST_STEP * usual)
    if holes.size:
        row = int(holes[0])
        problem = (
            f"found a hole of {steps[row]:.6g} s before this row, expected steps of about {usual:.6g} s "
            f"and none above {_LONGEST_STEP:g} times that"
        )
        raise table.error(problem, "export the record without gaps, or use the part before it", row + 1)
    return np.asarray(time, dtype=np.float64)


def _filled(table: SeriesTable, column: Column) -> FloatArray:
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


def _si_factor(table: SeriesTable, column: Column, unit: str, kind: str) -> float:
    """Return SI per unit of a column, whose unit must be one of the kind."""
    try:
        return channel_scale(unit, kind).factor
    except QuantityError as error:
        problem = f"column {column.name!r}: {error.problem}"
        raise table.error(problem, f"give the unit of a {kind}, or name another column") from None


def _check_span(table: SeriesTable, time: FloatArray, duration: float) -> None:
    """Refuse a record that ends more than one step before the output."""
    if time[-1] + float(np.median(np.diff(time))) < duration * (1.0 - 1e-9):
        problem = f"the record ends {time[-1]:.6g} s after its first row, expected {duration:g} s of output"
        remedy = f'write [output] duration = "{time[-1]:.6g} s", or export a longer record'
        raise table.error(problem, remedy, time.size - 1)


def _check_rate(table: SeriesTable, time: FloatArray, values: FloatArray, name: str) -> None:
    """Refuse a motion that its rows do not follow: half of them must predict the other half."""
    size = float(np.std(values))
    if time.size < _LEAST_ROWS_TO_THIN or size <= 1e-12 * float(np.max(np.abs(values))):
        return
    inside = slice(_END_ROWS, time.size - _END_ROWS, 2)
    predicted = spline(time[::2], values[::2])(time[inside])
    miss = float(np.sqrt(np.mean((predicted - values[inside]) ** 2))) / size
    if miss > _COARSE:
        rate = (time.size - 1) / time[-1]
        problem = (
            f"column {name!r} at {rate:.4g} Hz is too coarse or too noisy to drive the cable: every second "
            f"row misses the curve through the others by {100 * miss:.2g} % of the motion, expected at most "
            f"{100 * _COARSE:g} %"
        )
        remedy = "log at least eight rows in each period of the fastest part, or filter the noise"
        raise table.error(problem, remedy)
