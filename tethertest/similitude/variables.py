"""The values of the fuller set of variables at both scales, from rig and prototype files."""

from __future__ import annotations

import math
from dataclasses import dataclass

from tethertest.errors import DataError
from tethertest.records.cable import Cable
from tethertest.records.rig import Prototype, Rig
from tethertest.records.similarity import Variable
from tethertest.similitude.sets import TETHER_UNITS


@dataclass(frozen=True, slots=True)
class Motion:
    """Harmonic motion of the bottom end at one scale; None where there is no drive."""

    frequency: float | None  #: [Hz]
    amplitude: float | None  #: [m]


def tether_variables(
    rig: Rig, prototype: Prototype, mode: str, rig_motion: Motion, prototype_motion: Motion
) -> tuple[Variable, ...]:
    """Return the fuller set of variables with their values.

    Parameters
    ----------
    rig, prototype : Rig, Prototype
        Model and prototype.
    mode : str
        Platform mode, by its name at both scales.
    rig_motion, prototype_motion : Motion
        Motion of the bottom end.

    Returns
    -------
    tuple of Variable
        In the order of `TETHER_UNITS`; a value is None where its file does not give it.

    Raises
    ------
    DataError
        The rig has no such mode.
    """
    if mode not in rig.platform.modes:
        message = f"the rig {rig.name!r} has no platform mode {mode!r}"
        raise DataError(message, f"use one of {', '.join(rig.platform.modes)}")
    model = _values(rig, mode, rig_motion)
    full = _values(prototype, mode, prototype_motion)
    return tuple(Variable(name, unit, model[name], full[name]) for name, unit in TETHER_UNITS.items())


def _values(system: Rig | Prototype, mode: str, motion: Motion) -> dict[str, float | None]:
    cable, platform, air = system.cable, system.platform, system.air
    hold = platform.modes.get(mode)
    frequency = motion.frequency
    return {
        "length": cable.length,
        "mass_per_length": cable.mass_per_length,
        "axial_stiffness": _axial_stiffness(cable),
        "diameter": cable.diameter,
        "axial_damping_time": cable.axial_damping_time,
        "bending_stiffness": cable.bending_stiffness,
        "static_tension": platform.static_tension,
        "gravity": system.gravity,
        "platform_mass": platform.mass,
        "hover_stiffness": None if hold is None else hold.hover_stiffness,
        "hover_damping": None if hold is None else hold.hover_damping,
        "drag_area": None if platform.drag_area is None else platform.drag_area[1],
        "air_density": None if air is None else air.density,
        "normal_drag": None if air is None else air.normal_drag,
        "angular_frequency": None if frequency is None else 2.0 * math.pi * frequency,
        "amplitude": motion.amplitude,
    }


def _axial_stiffness(cable: Cable) -> float | None:
    if cable.axial_stiffness is not None:
        return cable.axial_stiffness
    if cable.youngs_modulus is None or cable.diameter is None:
        return None
    return cable.youngs_modulus * math.pi * cable.diameter**2 / 4.0
