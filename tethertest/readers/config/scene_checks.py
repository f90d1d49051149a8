"""What must hold between the keys of a scene file, and the files it names."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path, PurePosixPath, PureWindowsPath

from tethertest.errors import QuantityError
from tethertest.readers.config.cable_checks import cable_problems
from tethertest.readers.config.problems import NAME_SHOWN, Problem, is_file_name, suggestion
from tethertest.readers.config.toml import KeyPath
from tethertest.records.cable import Air
from tethertest.records.scene import Bottom, Output, Scene, Top
from tethertest.units import channel_scale, format_quantity

#: motion -> keys it needs; of the others it may only have those of `_OPTIONAL_MOTION_KEYS`
_MOTION_KEYS = {
    "harmonic": {"amplitude", "frequency"},
    "crank-slider": {"radius", "rod_ratio", "frequency"},
    "measured": {"file", "time_column", "displacement_column", "unit"},
    "step": {"velocity"},
    "fixed": set[str](),
}
_OPTIONAL_MOTION_KEYS = {"harmonic": {"ramp"}, "crank-slider": {"ramp"}}
_ALL_MOTION_KEYS = sorted(set().union(*_MOTION_KEYS.values()) | {"ramp"})
#: what a message proposes to write for a key
_EXAMPLES = {
    "amplitude": '"2 m"',
    "frequency": '"0.2 Hz"',
    "radius": '"0.1 m"',
    "rod_ratio": "0.25",
    "velocity": '"1 m/s"',
    "file": '"heave.csv"',
    "time_column": '"time_s"',
    "displacement_column": '"heave_mm"',
    "unit": '"mm"',
    "tension": '"80 N"',
    "top": '["100 m", "80 m"]',
}
#: geometry -> keys it needs, and those it may have besides
_NEEDED = {"shallow": {"tension"}, "straight": {"tension"}, "ends": {"top"}}
_OPTIONAL = {"vertical": {"tension"}}
#: how far two statements of the same tension may differ, relative
_SAME_TENSION = 1e-6
#: most numbers that one response may hold; they are 400 MB
_MOST_VALUES = 5e7
#: numbers of a row at each gauge: tension and strain, and what the fields add
_PLAIN_VALUES = 2
_FIELD_VALUES = {"position": 3, "velocity": 3, "curvature": 1}
#: fewest output rows per period of the drive; at two, all may lie on zeros of a sine
_ROWS_PER_PERIOD = 2.1


def scene_problems(scene: Scene, folder: Path) -> Iterator[Problem]:
    """Yield everything that is wrong between the keys of a scene and the files it names in `folder`."""
    yield from cable_problems(scene.cable, scene.air)
    yield from _motion_problems(scene.bottom, folder)
    yield from _geometry_problems(scene)
    yield from _top_problems(scene.top)
    yield from _tension_problems(scene)
    if scene.air is not None:
        yield from _wind_problems(scene.air, folder)
    yield from _output_problems(scene)


def _motion_problems(bottom: Bottom, folder: Path) -> Iterator[Problem]:
    """Yield what is wrong between the keys of a motion and the file it names in `folder`."""
    yield from _key_problems(bottom)
    yield from _ramp_problems(bottom)
    if isinstance(bottom.direction, tuple):
        yield from _vector_problems(("bottom", "direction"), bottom.direction)
        if not any(bottom.direction):
            text = "found a vector of zeros, expected a direction"
            yield Problem(("bottom", "direction"), text, "write [0.0, 1.0] for upwards")
    if bottom.file is not None:
        yield from _file_problems(("bottom", "file"), bottom.file, folder)
    if bottom.unit is not None:
        try:
            channel_scale(bottom.unit, "displacement")
        except QuantityError as error:
            yield Problem(("bottom", "unit"), error.problem, "give the unit of the column, such as mm")
    if bottom.time_column is not None and bottom.time_column == bottom.displacement_column:
        text = f"found {bottom.time_column!r}, which is also the time_column"
        yield Problem(("bottom", "displacement_column"), text, "name the column of the displacement")


def _key_problems(bottom: Bottom) -> Iterator[Problem]:
    needed = _MOTION_KEYS[bottom.motion]
    optional = _OPTIONAL_MOTION_KEYS.get(bottom.motion, set())
    for key in _ALL_MOTION_KEYS:
        is_there = getattr(bottom, key) is not None
        if key in needed and not is_there:
            text = f"is missing; a {bottom.motion} motion needs it"
            yield Problem(("bottom", key), text, f"add `{key} = {_EXAMPLES[key]}`")
        elif is_there and key not in needed | optional:
            text = f"does not belong to the motion {bottom.motion!r}"
            yield Problem(("bottom", key), text, f"remove {key}, or correct the motion")


def _ramp_problems(bottom: Bottom) -> Iterator[Problem]:
    can_ramp = "ramp" in _OPTIONAL_MOTION_KEYS.get(bottom.motion, set())
    if bottom.start == "ramp" and not can_ramp:
        text = f"found 'ramp', but the motion {bottom.motion!r} has no ramp"
        yield Problem(("bottom", "start"), text, "remove start")
    elif bottom.start == "ramp" and bottom.ramp is None:
        text = 'is missing; start = "ramp" needs its duration'
        yield Problem(("bottom", "ramp"), text, 'add `ramp = "10 s"`')
    elif bottom.start == "jump" and bottom.ramp is not None and can_ramp:
        text = 'found beside start = "jump", which has no ramp'
        yield Problem(("bottom", "ramp"), text, 'write `start = "ramp"`, or remove ramp')


def _geometry_problems(scene: Scene) -> Iterator[Problem]:
    """Yield what is wrong between the keys of a scene's geometry."""
    geometry = scene.geometry
    needed = _NEEDED.get(geometry.kind, set())
    allowed = needed | _OPTIONAL.get(geometry.kind, set())
    for key in ("tension", "top"):
        is_there = getattr(geometry, key) is not None
        if key in needed and not is_there:
            text = f"is missing; the geometry {geometry.kind!r} needs it"
            yield Problem(("geometry", key), text, f"add `{key} = {_EXAMPLES[key]}`")
        elif is_there and key not in allowed:
            text = f"does not belong to the geometry {geometry.kind!r}"
            yield Problem(("geometry", key), text, f"remove {key}, or correct the kind")
    if geometry.top is not None:
        yield from _vector_problems(("geometry", "top"), geometry.top)
        if not any(geometry.top):
            text = "found the bottom end itself, expected the position of the top"
            yield Problem(("geometry", "top"), text, 'write `top = ["100 m", "80 m"]`')
    if geometry.kind == "hovering":
        if scene.top.kind != "platform":
            text = f"found {scene.top.kind!r}, expected a platform for the geometry 'hovering'"
            yield Problem(("top", "kind"), text, 'write `kind = "platform"` with its mass and lift')
        elif scene.top.lift is None and scene.top.static_tension is None:
            text = "is missing; a hovering platform needs its lift or static_tension"
            yield Problem(("top", "lift"), text, 'add `lift = "120 N"`')


def _top_problems(top: Top) -> Iterator[Problem]:
    """Yield what is wrong between the keys of a scene's upper end."""
    if top.kind == "fixed":
        for key in ("mass", "static_tension", "lift", "drag_area"):
            if getattr(top, key) is not None:
                yield _not_fixed(key)
        for key in ("hover_stiffness", "hover_damping", "tilt"):
            if getattr(top, key) not in {0.0, ()}:
                yield _not_fixed(key)
        return
    if top.mass is None:
        text = "is missing; a platform needs it"
        yield Problem(("top", "mass"), text, 'add `mass = "5 kg"`')
    elif top.mass == 0.0:
        yield Problem(("top", "mass"), "found 0 kg, expected more than 0 kg", "give the platform's mass")
    if top.lift is not None and top.static_tension is not None:
        text = "found beside static_tension, expected one of the two"
        yield Problem(("top", "lift"), text, "keep the lift, or the static tension that it must hold")
    for key in ("lift", "hover_stiffness", "hover_damping"):
        value = getattr(top, key)
        if isinstance(value, tuple):
            yield from _vector_problems(("top", key), value)


def _tension_problems(scene: Scene) -> Iterator[Problem]:
    """Yield a tension at rest that is missing, cannot be, or is stated twice at odds."""
    kind = scene.geometry.kind
    if kind == "vertical":
        yield from _unstated_problems(scene)
    stated, holder = _top_tension(scene)
    if scene.geometry.tension is None or stated is None or kind not in {"vertical", "straight", "shallow"}:
        return
    weight = scene.cable.length * scene.cable.mass_per_length * scene.gravity
    tension = scene.geometry.tension
    if kind == "vertical":
        least = most = tension + weight
        text = f"at the bottom, which with the cable's weight of {format_quantity(weight, 'N')} makes"
    elif kind == "straight":
        least = most = tension
        text = "all along, which makes"
    else:  # the linear model has one tension, the nonlinear one half the weight at each end
        least, most = tension, math.hypot(tension, 0.5 * weight)
        text = "along the chord, which makes"
    if stated < least * (1.0 - _SAME_TENSION) or stated > most * (1.0 + _SAME_TENSION):
        found = (
            f"found {format_quantity(tension, 'N')} {text} {format_quantity(most, 'N')} at the top, but "
            f"{holder} {format_quantity(stated, 'N')}"
        )
        yield Problem(("geometry", "tension"), found, "keep one of the two")


def _unstated_problems(scene: Scene) -> Iterator[Problem]:
    """Yield what leaves a vertical cable without a bottom tension."""
    if scene.geometry.tension is not None:
        return
    if scene.top.static_tension is None:
        if scene.top.lift is None:
            text = "is missing; a vertical cable needs it, or the platform's static_tension"
            yield Problem(("geometry", "tension"), text, 'add `tension = "50 N"`, the bottom tension at rest')
        return
    weight = scene.cable.length * scene.cable.mass_per_length * scene.gravity
    if scene.top.static_tension <= weight:
        text = (
            f"found {format_quantity(scene.top.static_tension, 'N')}, expected more than the cable's weight "
            f"of {format_quantity(weight, 'N')}"
        )
        yield Problem(("top", "static_tension"), text, "raise the static tension, or shorten the cable")


def _top_tension(scene: Scene) -> tuple[float | None, str]:
    """Return the top tension at rest that the platform's keys state [N], and the words for it."""
    top = scene.top
    if top.static_tension is not None:
        return top.static_tension, "top.static_tension is"
    if scene.geometry.kind != "vertical" or top.lift is None or top.mass is None:
        return None, ""
    if isinstance(top.lift, tuple) and (not top.lift or any(top.lift[:-1])):
        return None, ""
    upwards = top.lift[-1] if isinstance(top.lift, tuple) else top.lift
    return upwards - top.mass * scene.gravity, "top.lift less the platform's weight is"


def _not_fixed(key: str) -> Problem:
    remedy = f'remove {key}, or write `kind = "platform"`'
    return Problem(("top", key), "does not belong to a fixed top", remedy)


def _wind_problems(air: Air, folder: Path) -> Iterator[Problem]:
    """Yield what is wrong between the wind's keys and the file they name in `folder`."""
    if air.wind_file is None:
        return
    yield from _file_problems(("air", "wind_file"), air.wind_file, folder)
    is_steady = any(air.wind) if isinstance(air.wind, tuple) else air.wind != 0.0
    if is_steady:
        text = "found beside wind_file, expected one of the two"
        yield Problem(("air", "wind"), text, "keep the file, or the steady wind")


def _output_problems(scene: Scene) -> Iterator[Problem]:
    """Yield what is wrong between the keys of a scene's output."""
    output = scene.output
    if not output.gauges:
        yield Problem(("output", "gauges"), "found no gauge", "write `gauges = [0.0, 1.0]`")
    if len({f"{gauge:g}" for gauge in output.gauges}) < len(output.gauges):
        text = "found a gauge twice (columns are named by six digits)"
        yield Problem(("output", "gauges"), text, "name every place once")
    if len(set(output.fields)) < len(output.fields):
        yield Problem(("output", "fields"), "found a field twice", "name every field once")
    yield from size_problems(output)
    rows = output.duration * output.rate
    if rows + 1e-9 < 1.0:
        text = f"found {output.rate:g} Hz, which in {output.duration:g} s gives no row but the first"
        yield Problem(("output", "rate"), text, "raise the rate or the duration")
    frequency = scene.bottom.frequency
    if frequency is not None and scene.bottom.motion in {"harmonic", "crank-slider"}:
        needed = _ROWS_PER_PERIOD * frequency
        if output.rate < needed:
            text = (
                f"found {output.rate:g} Hz, expected at least {needed:g} Hz, above twice the drive's "
                "frequency: rows so far apart would show another motion"
            )
            yield Problem(("output", "rate"), text, f'write `rate = "{20.0 * frequency:g} Hz"`, or more')


def size_problems(output: Output) -> Iterator[Problem]:
    """Yield an output that would not fit into memory."""
    per_gauge = _PLAIN_VALUES + sum(_FIELD_VALUES[name] for name in output.fields)
    values = (output.duration * output.rate + 1.0) * len(output.gauges) * per_gauge
    if not values <= _MOST_VALUES:
        text = (
            f"found {output.rate:g} Hz over {output.duration:g} s at {len(output.gauges)} gauges, which "
            f"makes {values:.2g} values, expected at most {_MOST_VALUES:.2g}"
        )
        possible = output.rate * _MOST_VALUES / values if math.isfinite(values) else 0.0
        remedy = "lower the rate, the duration or the number of gauges or fields"
        if possible:
            remedy += f"; this duration allows {possible:.3g} Hz"
        yield Problem(("output", "rate"), text, remedy)


def _vector_problems(key: KeyPath, vector: tuple[float, ...]) -> Iterator[Problem]:
    """Yield a vector that is neither [x, z] nor [x, y, z]."""
    if len(vector) not in {2, 3}:
        yield Problem(key, f"found {len(vector)} components, expected 2 or 3", "write [x, z] or [x, y, z]")


def _file_problems(key: KeyPath, file: str, folder: Path) -> Iterator[Problem]:
    """Yield what is wrong with the name of a file that must lie in the scene's folder."""
    remedy = "copy the file into the scene's folder and give its name"
    windows = PureWindowsPath(file)
    is_outside = (
        PurePosixPath(file).is_absolute() or bool(windows.drive or windows.root) or ".." in windows.parts
    )
    if not is_file_name(file):
        yield Problem(key, f"found {file[:NAME_SHOWN]!r}, which no file can be called", remedy)
    elif is_outside or not file or not _is_inside(folder / file, folder):
        yield Problem(key, f"found {file!r}, expected a file inside the scene's folder", remedy)
    elif not (folder / file).is_file():
        nearby = sorted(
            entry.name for entry in folder.iterdir() if entry.is_file() and entry.suffix != ".toml"
        )
        text = f"found {file!r}, but there is no such file beside the scene"
        yield Problem(key, text, suggestion(file, nearby) if nearby else remedy)


def _is_inside(path: Path, folder: Path) -> bool:
    try:
        return path.resolve().is_relative_to(folder.resolve())
    except (OSError, RuntimeError):  # a link that leads to itself
        return False
