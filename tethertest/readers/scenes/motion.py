"""What must hold between the keys of a scene's bottom motion."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from tethertest.errors import QuantityError
from tethertest.readers.config.problems import Problem
from tethertest.readers.scenes.shared import file_problems, vector_problems
from tethertest.records.scene import Bottom
from tethertest.units import channel_scale

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
}


def motion_problems(bottom: Bottom, folder: Path) -> Iterator[Problem]:
    """Yield what is wrong between the keys of a motion and the file it names in `folder`."""
    yield from _key_problems(bottom)
    yield from _ramp_problems(bottom)
    if isinstance(bottom.direction, tuple):
        yield from vector_problems(("bottom", "direction"), bottom.direction)
        if not any(bottom.direction):
            text = "found a vector of zeros, expected a direction"
            yield Problem(("bottom", "direction"), text, "write [0.0, 1.0] for upwards")
    if bottom.file is not None:
        yield from file_problems(("bottom", "file"), bottom.file, folder)
    if bottom.unit is not None:
        try:
            channel_scale(bottom.unit, "displacement")
        except QuantityError as error:
            yield Problem(("bottom", "unit"), error.problem, "give the unit of the column, such as mm")
    if bottom.time_column is not None and bottom.time_column == bottom.displacement_column:
        text = f"found {bottom.time_column!r}, which is also the time_column"
        yield Problem(("bottom", "displacement_column"), text, "name the column of the displacement")


def _key_problems(bottom: Bottom) -> Iterator[Problem]:
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


def _ramp_problems(bottom: Bottom) -> Iterator[Problem]:
    can_ramp = "ramp" in OPTIONAL_MOTION_KEYS.get(bottom.motion, set())
    if bottom.start == "ramp" and not can_ramp:
        text = f"found 'ramp', but the motion {bottom.motion!r} has no ramp"
        yield Problem(("bottom", "start"), text, "remove start")
    elif bottom.start == "ramp" and bottom.ramp is None:
        text = 'is missing; start = "ramp" needs its duration'
        yield Problem(("bottom", "ramp"), text, 'add `ramp = "10 s"`')
    elif bottom.start == "jump" and bottom.ramp is not None and can_ramp:
        text = 'found beside start = "jump", which has no ramp'
        yield Problem(("bottom", "ramp"), text, 'write `start = "ramp"`, or remove ramp')
