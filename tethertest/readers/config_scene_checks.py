"""What must hold between the keys of a scene file."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from tethertest.errors import QuantityError
from tethertest.readers.config_cable_checks import cable_problems
from tethertest.readers.config_problems import Problem, suggestion
from tethertest.records.scene import Bottom, Scene, Top
from tethertest.units import channel_scale, format_quantity

#: motion -> keys it needs; of the others it may only have those of `OPTIONAL_MOTION_KEYS`
MOTION_KEYS = {
    "harmonic": {"amplitude", "frequency"},
    "crank-slider": {"radius", "rod_ratio", "frequency"},
    "measured": {"file", "time_column", "displacement_column", "unit"},
    "step": {"velocity"},
    "fixed": set[str](),
}
OPTIONAL_MOTION_KEYS = {"harmonic": {"ramp"}, "crank-slider": {"ramp"}}
_ALL_MOTION_KEYS = sorted(set().union(*MOTION_KEYS.values()) | {"ramp"})
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
#: how far two statements of the same tension may differ, relative
SAME_TENSION = 1e-6


def scene_problems(scene: Scene, folder: Path) -> Iterator[Problem]:
    """Yield everything that is wrong between the keys of a scene and the files it names in `folder`."""
    yield from cable_problems(scene.cable, scene.air)
    yield from _motion_problems(scene.bottom, folder)
    yield from _geometry_problems(scene)
    yield from _top_problems(scene.top)
    if scene.geometry.kind == "vertical":
        yield from _vertical_problems(scene)
    if scene.air is not None and scene.air.wind_file is not None:
        yield from _file_problems(("air", "wind_file"), scene.air.wind_file, folder)
    gauges = scene.output.gauges
    if not gauges:
        yield Problem(("output", "gauges"), "found no gauge", "write `gauges = [0.0, 1.0]`")
    if len(set(gauges)) < len(gauges):
        yield Problem(("output", "gauges"), "found a gauge twice", "name every place once")


def _motion_problems(bottom: Bottom, folder: Path) -> Iterator[Problem]:
    needed = MOTION_KEYS[bottom.motion]
    optional = OPTIONAL_MOTION_KEYS.get(bottom.motion, set())
    for key in _ALL_MOTION_KEYS:
        is_there = getattr(bottom, key) is not None
        if key in needed and not is_there:
            text = f"is missing; a {bottom.motion} motion needs it"
            yield Problem(("bottom", key), text, f"add `{key} = {_EXAMPLES[key]}`")
        elif is_there and key not in needed | optional:
            text = f"does not belong to the motion {bottom.motion!r}"
            yield Problem(("bottom", key), text, f"remove {key}, or correct the motion")
    can_ramp = "ramp" in optional
    if bottom.start == "ramp" and not can_ramp:
        text = f"found 'ramp', but the motion {bottom.motion!r} has no ramp"
        yield Problem(("bottom", "start"), text, "remove start")
    elif bottom.start == "ramp" and bottom.ramp is None:
        text = 'is missing; start = "ramp" needs its duration'
        yield Problem(("bottom", "ramp"), text, 'add `ramp = "10 s"`')
    elif bottom.start == "jump" and bottom.ramp is not None and can_ramp:
        text = 'found beside start = "jump", which has no ramp'
        yield Problem(("bottom", "ramp"), text, 'write `start = "ramp"`, or remove ramp')
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


def _geometry_problems(scene: Scene) -> Iterator[Problem]:
    geometry = scene.geometry
    needed = {"shallow": {"tension"}, "straight": {"tension"}, "ends": {"top"}}.get(geometry.kind, set())
    allowed = needed | ({"tension"} if geometry.kind == "vertical" else set())
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
    if geometry.kind == "hovering":
        if scene.top.kind != "platform":
            text = f"found {scene.top.kind!r}, expected a platform for the geometry 'hovering'"
            yield Problem(("top", "kind"), text, 'write `kind = "platform"` with its mass and lift')
        elif scene.top.lift is None and scene.top.static_tension is None:
            text = "is missing; a hovering platform needs its lift or static_tension"
            yield Problem(("top", "lift"), text, 'add `lift = "120 N"`')


def _top_problems(top: Top) -> Iterator[Problem]:
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
    if top.lift is not None and top.static_tension is not None:
        text = "found beside static_tension, expected one of the two"
        yield Problem(("top", "lift"), text, "keep the lift, or the static tension that it must hold")
    for key in ("lift", "hover_stiffness", "hover_damping"):
        value = getattr(top, key)
        if isinstance(value, tuple):
            yield from _vector_problems(("top", key), value)


def _not_fixed(key: str) -> Problem:
    remedy = f'remove {key}, or write `kind = "platform"`'
    return Problem(("top", key), "does not belong to a fixed top", remedy)


def _vertical_problems(scene: Scene) -> Iterator[Problem]:
    bottom, top = scene.geometry.tension, scene.top.static_tension
    weight = scene.cable.length * scene.cable.mass_per_length * scene.gravity
    if bottom is None and top is None:
        if scene.top.lift is None:
            text = "is missing; a vertical cable needs it, or the platform's static_tension"
            yield Problem(("geometry", "tension"), text, 'add `tension = "50 N"`, the bottom tension at rest')
    elif bottom is None and top is not None:
        if top <= weight:
            text = (
                f"found {format_quantity(top, 'N')}, expected more than the cable's weight of "
                f"{format_quantity(weight, 'N')}"
            )
            yield Problem(("top", "static_tension"), text, "raise the static tension, or shorten the cable")
    elif bottom is not None and top is not None and abs(bottom + weight - top) > SAME_TENSION * top:
        text = (
            f"found {format_quantity(bottom, 'N')} at the bottom, which with the cable's weight of "
            f"{format_quantity(weight, 'N')} makes {format_quantity(bottom + weight, 'N')} at the top, but "
            f"top.static_tension is {format_quantity(top, 'N')}"
        )
        yield Problem(("geometry", "tension"), text, "keep one of the two")


def _vector_problems(key: tuple[str, str], vector: tuple[float, ...]) -> Iterator[Problem]:
    if len(vector) not in {2, 3}:
        yield Problem(key, f"found {len(vector)} components, expected 2 or 3", "write [x, z] or [x, y, z]")


def _file_problems(key: tuple[str, str], file: str, folder: Path) -> Iterator[Problem]:
    if not (folder / file).is_file():
        nearby = sorted(entry.name for entry in folder.iterdir() if entry.is_file())
        text = f"found {file!r}, but there is no such file beside the scene"
        yield Problem(key, text, suggestion(file, nearby))
