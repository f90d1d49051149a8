"""Scenes and series that were built in Python: the same bounds that a scene file is held to."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import is_dataclass
from functools import cache
from typing import Annotated, Any, get_args, get_origin, get_type_hints

import numpy as np

from tethertest.errors import DataError
from tethertest.records.arrays import FloatArray
from tethertest.records.quantity import SI
from tethertest.records.scene import MeasuredMotion, Scene, WindSeries

#: keys whose arrays are vectors [x, z] or [x, y, z]
_VECTORS = {"direction", "lift", "hover_stiffness", "hover_damping", "wind"}
#: fewest rows of a series
_FEWEST_ROWS = 4


def check_scene(scene: Scene, measured: MeasuredMotion | None, wind: WindSeries | None) -> None:
    """Refuse numbers out of range, and series that do not cover the record.

    Raises
    ------
    DataError
        With the key, what was found and what was expected.
    """
    for key, found, expected in _problems(Scene, scene, ""):
        message = f"scene {scene.name!r}: {key} is {found}, expected {expected}"
        raise DataError(message, f"correct {key}")
    if not scene.output.gauges:
        message = f"scene {scene.name!r}: output.gauges is empty"
        raise DataError(message, "name at least one place, such as 1.0")
    if wind is not None and scene.air is None:
        message = f"scene {scene.name!r}: a wind series, but no air that could push"
        raise DataError(message, "give the scene its air, or leave out the wind")
    if measured is not None and scene.bottom.motion == "measured":
        _check_series("the measured motion", measured.time, measured.displacement, scene.output.duration)
    if wind is not None:
        _check_series("the wind series", wind.time, wind.velocity, scene.output.duration)


@cache
def _hints(kind: Any) -> dict[str, Any]:
    return get_type_hints(kind, include_extras=True)


def _problems(kind: Any, record: Any, path: str) -> Iterator[tuple[str, str, str]]:
    for name, hint in _hints(kind).items():
        yield from _checked(hint, getattr(record, name), f"{path}{name}", name)


def _checked(hint: Any, value: Any, key: str, name: str) -> Iterator[tuple[str, str, str]]:
    if is_dataclass(value):
        yield from _problems(type(value), value, f"{key}.")
    elif isinstance(value, tuple | list):
        if (name in _VECTORS or key == "geometry.top") and len(value) not in {2, 3}:
            yield key, f"a vector of {len(value)}", "2 or 3 components"
        for entry in value:
            yield from _checked(hint, entry, key, "")
    elif isinstance(value, float | int) and not isinstance(value, bool):
        yield from _bounded(next(_parts(hint), None), value, key)


def _bounded(bound: SI | None, value: float, key: str) -> Iterator[tuple[str, str, str]]:
    unit = "" if bound is None or bound.unit == "1" else f" {bound.unit}"
    found = f"{value:g}{unit}"
    if not math.isfinite(value):
        yield key, found, "a finite number"
    elif bound is not None and bound.above is not None and value <= bound.above:
        yield key, found, f"more than {bound.above:g}{unit}"
    elif bound is not None and bound.minimum is not None and value < bound.minimum:
        yield key, found, f"at least {bound.minimum:g}{unit}"
    elif bound is not None and bound.maximum is not None and value > bound.maximum:
        yield key, found, f"at most {bound.maximum:g}{unit}"


def _parts(hint: Any) -> Iterator[SI]:
    """Yield the bounds anywhere in an annotation."""
    if get_origin(hint) is Annotated:
        kind, *extras = get_args(hint)
        yield from (extra for extra in extras if isinstance(extra, SI))
        yield from _parts(kind)
    else:
        for inner in get_args(hint):
            yield from _parts(inner)


def _check_series(what: str, time: FloatArray, values: FloatArray, duration: float) -> None:
    time, values = np.asarray(time), np.asarray(values)
    if time.ndim != 1 or time.size < _FEWEST_ROWS or values.shape[0] != time.size:
        message = f"{what} has {time.size} times and values of shape {values.shape}"
        raise DataError(message, f"give one value for each of at least {_FEWEST_ROWS} times")
    if not (np.all(np.isfinite(time)) and np.all(np.isfinite(values))):
        message = f"{what} has values that are not finite"
        raise DataError(message, "fill or leave out what is missing")
    steps = np.diff(time)
    if np.any(steps <= 0.0):
        message = f"{what} goes backwards at row {int(np.argmax(steps <= 0.0)) + 1}"
        raise DataError(message, "sort it by time, each time once")
    usual = float(np.median(steps))
    if time[0] > 0.5 * usual or time[-1] < duration - 1.5 * usual:
        message = f"{what} covers {time[0]:g} to {time[-1]:g} s, the record 0 to {duration:g} s"
        raise DataError(message, "shorten the output, or give a series that covers it")
