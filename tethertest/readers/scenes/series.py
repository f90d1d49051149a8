"""The series that a scene names: the measured bottom motion and the wind.

Both count time from their own first row, which is the scene's start, and must reach to the end of its output.
"""

from __future__ import annotations

import difflib
from pathlib import Path

import numpy as np

from tethertest.readers.config.problems import suggestion
from tethertest.readers.scenes.series_checks import check_rate, check_span, checked_time, filled, si_factor
from tethertest.readers.scenes.series_table import Column, SeriesTable, read_series_table
from tethertest.records.arrays import frozen
from tethertest.records.scene import MeasuredMotion, Scene, WindSeries

#: fewest rows of a motion: a cubic spline needs them
LEAST_MOTION_ROWS = 4
LEAST_WIND_ROWS = 2
#: first names of a time column and of the wind's components, without unit and in small letters
_TIME_NAMES = ("time", "t", "timestamp", "elapsed")
_WIND_NAMES = {
    "wind_x": 0, "wind_y": 1, "wind_z": 2, "wind": 0, "wind_speed": 0, "u": 0, "v": 1, "w": 2,
    "x": 0, "y": 1, "z": 2, "wind_u": 0, "wind_v": 1, "wind_w": 2,
}  # fmt: skip
_WIND_REMEDY = "name the columns time_s and wind_x_m_s, wind_y_m_s, wind_z_m_s, or those of them you have"


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
    time = checked_time(table, _named(table, bottom.time_column), LEAST_MOTION_ROWS)
    column = _named(table, bottom.displacement_column)
    values = _displacement_scale(table, column, bottom.unit) * filled(table, column)
    check_span(table, time, scene.output.duration)
    check_rate(table, time, values, column.name)
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
    time = checked_time(table, clock, LEAST_WIND_ROWS)
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
        velocity[:, axis] = si_factor(table, column, column.unit or "m/s", "velocity") * filled(table, column)
    check_span(table, time, scene.output.duration)
    return WindSeries(frozen(time), frozen(velocity))


def _named(table: SeriesTable, name: str | None) -> Column:
    column = None if name is None else table.column(name)
    if column is None:
        raise AssertionError(name)  # the caller has looked for it
    return column


def _displacement_scale(table: SeriesTable, column: Column, unit: str | None) -> float:
    """Return metres per unit of the column; what the file itself says must agree with the scene."""
    factor = si_factor(table, column, unit or column.unit or "m", "displacement")
    if not column.unit:
        return factor
    own = si_factor(table, column, column.unit, "displacement")
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
