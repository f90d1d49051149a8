"""What must hold between the keys of a scene's geometry and of its upper end, tensions above all."""

from __future__ import annotations

import math
from collections.abc import Iterator

from tethertest.readers.config.problems import Problem
from tethertest.readers.scenes.shared import vector_problems
from tethertest.records.scene import Scene, Top
from tethertest.units import format_quantity

#: geometry -> keys it needs, and those it may have besides
_NEEDED = {"shallow": {"tension"}, "straight": {"tension"}, "ends": {"top"}}
_OPTIONAL = {"vertical": {"tension"}}
_EXAMPLES = {"tension": '"80 N"', "top": '["100 m", "80 m"]'}
#: how far two statements of the same tension may differ, relative
SAME_TENSION = 1e-6


def geometry_problems(scene: Scene) -> Iterator[Problem]:
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
        yield from vector_problems(("geometry", "top"), geometry.top)
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


def top_problems(top: Top) -> Iterator[Problem]:
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
            yield from vector_problems(("top", key), value)


def tension_problems(scene: Scene) -> Iterator[Problem]:
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
    if stated < least * (1.0 - SAME_TENSION) or stated > most * (1.0 + SAME_TENSION):
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
