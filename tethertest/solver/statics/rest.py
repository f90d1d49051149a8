"""The cable at rest: unstretched length and density, end tensions, and the lift that holds them."""

from __future__ import annotations

import math
from dataclasses import dataclass

from tethertest.errors import DataError
from tethertest.records.scene import Scene
from tethertest.solver.terms import axial_stiffness

#: largest relative difference between two statements of one tension that still counts as agreement
_TENSION_AGREEMENT = 1e-6


@dataclass(frozen=True, slots=True)
class RestState:
    """A straight cable at rest under its own weight; tension grows upwards."""

    length: float  #: unstretched [m]
    mass_per_length: float  #: unstretched [kg/m]
    axial_stiffness: float  #: EA [N]
    bottom_tension: float  #: [N]
    gravity: float  #: along the cable [m/s^2]

    @property
    def weight(self) -> float:
        """Weight of the whole cable [N]."""
        return self.mass_per_length * self.length * self.gravity

    @property
    def top_tension(self) -> float:
        """Tension at the upper end [N]."""
        return self.bottom_tension + self.weight

    @property
    def wave_speed(self) -> float:
        """Axial wave speed in the material coordinate [m/s]."""
        return math.sqrt(self.axial_stiffness / self.mass_per_length)

    def tension(self, fraction: float) -> float:
        """Return the tension [N] at a fraction of the length from the bottom."""
        return self.bottom_tension + fraction * self.weight


def rest_state(scene: Scene) -> RestState:
    """Return the rest of a vertical or straight scene, in still air.

    Raises
    ------
    DataError
        The tension is not given, given twice at odds, or leaves part of the cable slack.
    """
    cable, stiffness = scene.cable, axial_stiffness(scene)
    gravity = scene.gravity if scene.geometry.kind == "vertical" else 0.0
    total_weight = cable.length * cable.mass_per_length * gravity
    bottom = _bottom_tension(scene, total_weight)
    if bottom <= 0.0:
        message = (
            f"scene {scene.name!r}: the top tension leaves {bottom:.4g} N at the bottom; the cable weighs "
            f"{total_weight:.4g} N"
        )
        raise DataError(message, "raise the lift or the static tension above the weight of the cable")
    if cable.length_state == "unstretched":
        return RestState(cable.length, cable.mass_per_length, stiffness, bottom, gravity)
    mean = bottom + 0.5 * total_weight
    length = cable.length / (1.0 + mean / stiffness)
    return RestState(length, cable.mass_per_length * cable.length / length, stiffness, bottom, gravity)


def _bottom_tension(scene: Scene, weight: float) -> float:
    """Return the bottom tension [N], from whichever key states it."""
    stated = {"[geometry] tension": scene.geometry.tension}
    if scene.top.static_tension is not None:
        stated["[top] static_tension"] = scene.top.static_tension - weight
    if scene.top.lift is not None and scene.geometry.kind != "shallow":
        stated["[top] lift"] = _top_tension_under_lift(scene, scene.top.lift) - weight
    given = {key: tension for key, tension in stated.items() if tension is not None}
    if not given:
        message = f"scene {scene.name!r}: no tension at rest is given"
        raise DataError(message, "give [geometry] tension or, for a platform, [top] static_tension")
    (first, tension), *others = given.items()
    for key, other in others:
        if abs(tension - other) > _TENSION_AGREEMENT * abs(tension):
            message = (
                f"scene {scene.name!r}: {first} says {tension:.6g} N at the bottom, {key} says {other:.6g} N"
            )
            raise DataError(message, "give one of the two")
    return tension


def _top_tension_under_lift(scene: Scene, lift: float | tuple[float, ...]) -> float:
    """Return what a lift leaves for the cable [N].

    Raises
    ------
    DataError
        The lift is not vertical: the platform would not rest above the bottom end.
    """
    if isinstance(lift, tuple) and any(lift[:-1]):
        message = f"scene {scene.name!r}: a lift of {lift} N does not hold the platform above the bottom end"
        raise DataError(message, 'give a vertical [top] lift, or set [geometry] kind = "hovering"')
    upwards = lift[-1] if isinstance(lift, tuple) else lift
    gravity = scene.gravity if scene.geometry.kind == "vertical" else 0.0
    return upwards - (scene.top.mass or 0.0) * gravity
