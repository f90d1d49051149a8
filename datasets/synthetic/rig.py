"""Numbers of the 3 m rig that the truth is computed with."""

from __future__ import annotations

import math
from dataclasses import dataclass

GRAVITY = 9.80665


@dataclass(frozen=True)
class Rig:
    """Cable, UAV and air of the rig, in SI units.

    Parameters
    ----------
    length, mass_per_length, axial_stiffness, diameter : float
        The unstretched cable.
    axial_damping : float
        Force per strain rate in N s: axial stiffness times the damping time.
    uav_mass, static_tension : float
        Mass on top and tension at the top at rest.
    air_density, normal_drag, tangential_drag : float
        Drag of the cable.
    """

    length: float = 3.0
    mass_per_length: float = 0.0484
    axial_stiffness: float = 10_020.0
    diameter: float = 0.006
    axial_damping: float = 1.002
    uav_mass: float = 0.4
    static_tension: float = 5.0
    air_density: float = 1.2
    normal_drag: float = 1.2
    tangential_drag: float = 0.01

    @property
    def cable_mass(self) -> float:
        """Mass of the whole cable."""
        return self.mass_per_length * self.length

    @property
    def wave_speed(self) -> float:
        """Speed of axial waves along the unstretched cable."""
        return math.sqrt(self.axial_stiffness / self.mass_per_length)


@dataclass(frozen=True)
class Hover:
    """The UAV's position loop: a spring and a damper about its rest position."""

    stiffness: float = 0.0
    damping: float = 0.0


MODES = {
    "free": Hover(),
    "soft": Hover(stiffness=20.0, damping=4.0),
    "hold": Hover(stiffness=50.0, damping=5.0),
}

GAUGES = (0.1, 0.3, 0.5, 0.7, 0.9)
