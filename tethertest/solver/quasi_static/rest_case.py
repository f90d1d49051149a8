"""A scene as the quasi-static model sees it: a uniformly loaded catenary at rest and what holds its ends."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from tethertest.errors import DataError
from tethertest.records.arrays import FloatArray
from tethertest.records.scene import Scene
from tethertest.solver.quasi_static.hanging import HangingCable
from tethertest.solver.statics.catenary_shape import (
    catenary_between,
    catenary_of_rest_length,
    shallow_catenary,
)
from tethertest.solver.statics.rest import rest_state
from tethertest.solver.terms import (
    axial_stiffness,
    bottom_direction,
    drag_coefficients,
    per_direction,
    spatial,
    steady_wind,
)

#: relative difference between two statements of the upper end's tension that still counts as agreement
_TENSION_AGREEMENT = 1e-6
#: relative change of the wind's load at which it counts as found
_SETTLED = 1e-13
_SUBSTITUTIONS = 200
#: points along the cable over which the wind's load is averaged
_WIND_POINTS = (np.arange(40) + 0.5) / 40


@dataclass(frozen=True, slots=True, eq=False)
class RestCase:
    """A cable at rest in steady wind, its ends and what moves them."""

    cable: HangingCable
    mass: float  #: unstretched, per length [kg/m]
    drag: tuple[float, float]  #: normal and tangential, per length and velocity squared [N s^2/m^3]
    wind: FloatArray  #: (3,) [m/s]
    force: FloatArray  #: (3,) of the cable on its bottom end at rest, up the cable [N]
    chord: FloatArray  #: (3,) upper end at rest from the bottom end [m]
    direction: FloatArray  #: (3,) unit vector of the bottom motion
    platform: bool  #: False for a fixed top
    body_mass: float  #: [kg]
    hover_stiffness: FloatArray  #: (3,) [N/m]
    hover_damping: FloatArray  #: (3,) [N s/m]

    @property
    def top_force(self) -> FloatArray:
        """Force (3,) [N] that the upper end at rest exerts on the cable."""
        return np.asarray(self.force - self.cable.length * self.cable.load)

    def tangents(self, force: FloatArray, fraction: FloatArray) -> FloatArray:
        """Return the unit vectors (n, m, 3) up the cable, for bottom forces (n, 3) [N]."""
        along = force[:, None, :] - self.cable.length * fraction[:, None] * self.cable.load
        return np.asarray(along / np.maximum(np.linalg.norm(along, axis=2), 1e-300)[..., None])


def rest_case(scene: Scene) -> RestCase:
    """Return the rest of a scene; steady wind acts as the uniform load that is its mean over the rest shape.

    A length "at equilibrium" is that in still air.

    Raises
    ------
    DataError
        The scene has no rest, or has what the quasi-static model leaves out.
    """
    _check(scene)
    drag, wind = drag_coefficients(scene), steady_wind(scene)
    bare, held, chord = _without_wind(scene)
    mass = scene.cable.mass_per_length
    if scene.cable.length_state == "equilibrium":
        mass *= scene.cable.length / bare.length
    cable, force = _in_wind(bare, drag, wind, held, chord)
    if chord is None:
        chord = np.asarray(cable.position(force[None], np.ones(1))[0, 0])
    top = scene.top
    platform = top.kind == "platform"
    _check_tension(scene, force - cable.length * cable.load, still=not np.any(wind))
    return RestCase(
        cable=cable,
        mass=mass,
        drag=drag,
        wind=wind,
        force=force,
        chord=chord,
        direction=bottom_direction(scene, force),
        platform=platform,
        body_mass=(top.mass or 0.0) if platform else 0.0,
        hover_stiffness=per_direction(top.hover_stiffness) if platform else np.zeros(3),
        hover_damping=per_direction(top.hover_damping) if platform else np.zeros(3),
    )


def air_push(tangent: FloatArray, relative: FloatArray, drag: tuple[float, float]) -> FloatArray:
    """Return the air's force per length along unit vectors (..., 3) in a relative wind (..., 3)."""
    slip = np.sum(tangent * relative, axis=-1, keepdims=True)
    across = relative - slip * tangent
    speed = np.linalg.norm(across, axis=-1, keepdims=True)
    return np.asarray(drag[0] * speed * across + drag[1] * np.abs(slip) * slip * tangent)


def _check(scene: Scene) -> None:
    left_out = {
        "bending stiffness": (scene.cable.bending_stiffness > 0.0, "leave out [cable] bending_stiffness"),
        "wind from a file": (
            scene.air is not None and scene.air.wind_file is not None,
            "give [air] wind, or use --fidelity nonlinear",
        ),
        "drag of the body": (
            scene.top.drag_area is not None and any(scene.top.drag_area),
            "leave out [top] drag_area, or use --fidelity nonlinear",
        ),
        "a lift for a geometry that already has its rest": (
            scene.top.lift is not None and scene.geometry.kind in {"ends", "shallow"},
            'leave out [top] lift, or give [geometry] kind = "hovering"',
        ),
        "hovering without a platform": (
            scene.geometry.kind == "hovering" and scene.top.kind != "platform",
            'give [top] kind = "platform"',
        ),
        "a straight cable moved across its axis": (
            scene.geometry.kind == "straight" and scene.bottom.direction != "tangent",
            'set [bottom] direction = "tangent"',
        ),
    }
    for what, (given, remedy) in left_out.items():
        if given:
            message = f"scene {scene.name!r}: {what} is not in the quasi-static model"
            raise DataError(message, remedy)


def _without_wind(scene: Scene) -> tuple[HangingCable, FloatArray | None, FloatArray | None]:
    """Return the cable in still air with the force on its upper end (hovering) or else its chord.

    A straight cable, which has no gravity, stands along z.
    """
    cable, kind = scene.cable, scene.geometry.kind
    if kind in {"vertical", "straight"}:
        rest = rest_state(scene)
        bare = HangingCable(
            rest.length, rest.axial_stiffness, np.array([0.0, 0.0, -rest.mass_per_length * rest.gravity])
        )
        force = np.array([[0.0, 0.0, rest.bottom_tension]])
        return bare, None, np.asarray(bare.position(force, np.ones(1))[0, 0])
    stiffness = axial_stiffness(scene)
    load = np.array([0.0, -cable.mass_per_length * scene.gravity])
    if kind == "shallow":
        if scene.geometry.tension is None:
            message = f'scene {scene.name!r}: geometry "shallow" has no tension'
            raise DataError(message, "give [geometry] tension")
        shape = shallow_catenary(
            cable.length,
            cable.length_state,
            cable.mass_per_length,
            stiffness,
            scene.geometry.tension,
            scene.gravity,
        )
        end = shape.position(np.array([shape.length]))[0]
        chord = np.array([end[0], 0.0, end[1]])
    elif kind == "ends":
        if scene.geometry.top is None:
            message = f'scene {scene.name!r}: geometry "ends" has no upper end'
            raise DataError(message, "give [geometry] top = [x, z]")
        chord = spatial(scene.geometry.top)
        plane = np.array([math.hypot(chord[0], chord[1]), chord[2]])
        if cable.length_state == "unstretched":
            shape = catenary_between(plane, cable.length, stiffness, load)
        else:
            shape = catenary_of_rest_length(plane, cable.length, stiffness, load * cable.length)
    else:
        return _hovering(scene, stiffness)
    return HangingCable(shape.length, stiffness, np.array([0.0, 0.0, shape.load[1]])), None, chord


def _hovering(scene: Scene, stiffness: float) -> tuple[HangingCable, FloatArray, None]:
    """Return the cable in still air under a platform whose lift is known, and the force on its upper end."""
    cable, top = scene.cable, scene.top
    if cable.length_state != "unstretched":
        message = f"scene {scene.name!r}: a hovering platform's cable has its length at equilibrium"
        raise DataError(message, 'give [cable] length_state = "unstretched"')
    if top.lift is not None:
        lift = spatial(top.lift) if isinstance(top.lift, tuple) else np.array([0.0, 0.0, top.lift])
        held = lift - np.array([0.0, 0.0, (top.mass or 0.0) * scene.gravity])
    elif top.static_tension is not None:
        held = np.array([0.0, 0.0, top.static_tension])
    else:
        message = f"scene {scene.name!r}: nothing says how hard the hovering platform pulls"
        raise DataError(message, "give [top] lift or static_tension")
    weight = cable.mass_per_length * scene.gravity
    if held[2] <= weight * cable.length:
        message = (
            f"scene {scene.name!r}: {held[2]:.4g} N are left to lift a cable that weighs "
            f"{weight * cable.length:.4g} N"
        )
        raise DataError(message, "raise [top] lift")
    return HangingCable(cable.length, stiffness, np.array([0.0, 0.0, -weight])), held, None


def _in_wind(
    bare: HangingCable,
    drag: tuple[float, float],
    wind: FloatArray,
    held: FloatArray | None,
    chord: FloatArray | None,
) -> tuple[HangingCable, FloatArray]:
    """Return the cable under its weight and the wind's mean load, and its bottom force at rest (3,) [N]."""
    cable, blown = bare, np.zeros(3)
    for _ in range(_SUBSTITUTIONS):
        if held is not None:
            force = held + cable.length * cable.load
        elif chord is not None:
            force = cable.between(chord[None])[0]
        along = force - cable.length * _WIND_POINTS[:, None] * cable.load
        tangent = along / np.maximum(np.linalg.norm(along, axis=1), 1e-300)[:, None]
        new = np.mean(air_push(tangent, wind, drag), axis=0)
        change, blown = float(np.linalg.norm(new - blown)), new
        if change <= _SETTLED * float(np.linalg.norm(new)):
            return cable, force
        cable = HangingCable(bare.length, bare.stiffness, bare.load + blown)
    message = "no rest found in this wind: its drag folds the cable over"
    raise DataError(message, "lower [air] wind, or raise the tension of the cable")


def _check_tension(scene: Scene, top_force: FloatArray, *, still: bool) -> None:
    """Refuse a static tension that contradicts the cable's rest."""
    stated, tension = scene.top.static_tension, float(np.linalg.norm(top_force))
    if stated is not None and still and abs(stated - tension) > _TENSION_AGREEMENT * tension:
        message = (
            f"scene {scene.name!r}: at rest the cable pulls with {tension:.6g} N at the top, "
            f"[top] static_tension says {stated:.6g} N"
        )
        raise DataError(message, "leave out [top] static_tension, or change the length of the cable")
