"""Sets of variables: the source article's, and the fuller one that decides the rig.

References
----------
Tao, Y.; Zhang, S. Drones 2022, 6(11), 349: equation (56), Table 2 and the five groups after it. The printed
groups have lost their fraction bars; those below are the readings without a dimension.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from tethertest.records.similarity import Variable
from tethertest.similitude.groups import Exponents


def _product(**powers: int | Fraction) -> Exponents:
    return {name: Fraction(power) for name, power in powers.items()}


_HALF = Fraction(1, 2)

#: force, circular frequency, length, Young's modulus, density, acceleration, section, drive amplitude
PAPER_VARIABLES = (
    Variable("F", "N"),
    Variable("w", "1/s"),
    Variable("l", "m"),
    Variable("E", "Pa"),
    Variable("rho", "kg/m^3"),
    Variable("a", "m/s^2"),
    Variable("A", "m^2"),
    Variable("Ae", "m"),
)
PAPER_REPEATING = ("E", "l", "a")
PAPER_GROUPS = {
    "F/(E l^2)": _product(F=1, E=-1, l=-2),
    "Ae/l": _product(Ae=1, l=-1),
    "rho a l/E": _product(rho=1, a=1, l=1, E=-1),
    "w^2 l/a": _product(w=2, l=1, a=-1),
    "A/l^2": _product(A=1, l=-2),
}
#: the acceleration of a harmonic drive is no variable of its own
PAPER_DEFINITIONS = {"a": _product(Ae=1, w=2)}

#: what decides a tether rig; names as in the rig file, frequency as circular frequency of the drive
TETHER_UNITS = {
    "length": "m",
    "mass_per_length": "kg/m",
    "axial_stiffness": "N",
    "diameter": "m",
    "axial_damping_time": "s",
    "bending_stiffness": "N m^2",
    "static_tension": "N",
    "gravity": "m/s^2",
    "platform_mass": "kg",
    "hover_stiffness": "N/m",
    "hover_damping": "N s/m",
    "drag_area": "m^2",
    "air_density": "kg/m^3",
    "normal_drag": "1",
    "angular_frequency": "1/s",
    "amplitude": "m",
}


@dataclass(frozen=True, slots=True)
class NamedGroup:
    """A group of the fuller set that has a name and a meaning."""

    name: str  #: formula in the symbols people use
    exponents: Exponents
    meaning: str  #: one short phrase


TETHER_GROUPS = (
    NamedGroup("Ae/L", _product(amplitude=1, length=-1), "drive amplitude per cable length"),
    NamedGroup(
        "w L/cl",
        _product(angular_frequency=1, length=1, mass_per_length=_HALF, axial_stiffness=-_HALF),
        "axial wave travel per drive period",
    ),
    NamedGroup(
        "w L/ct",
        _product(angular_frequency=1, length=1, mass_per_length=_HALF, static_tension=-_HALF),
        "lateral wave travel per drive period",
    ),
    NamedGroup("w^2 L/g", _product(angular_frequency=2, length=1, gravity=-1), "inertia against gravity"),
    NamedGroup("T/EA", _product(static_tension=1, axial_stiffness=-1), "stretch at rest"),
    NamedGroup(
        "rl g L/T",
        _product(mass_per_length=1, gravity=1, length=1, static_tension=-1),
        "cable weight per pull (sag)",
    ),
    NamedGroup(
        "M/(rl L)",
        _product(platform_mass=1, mass_per_length=-1, length=-1),
        "UAV mass per cable mass",
    ),
    NamedGroup(
        "EA Ae/(L T)",
        _product(axial_stiffness=1, amplitude=1, length=-1, static_tension=-1),
        "drive stretch per stretch at rest (slack)",
    ),
    NamedGroup(
        "k L/T", _product(hover_stiffness=1, length=1, static_tension=-1), "stiffness of the UAV's hold"
    ),
    NamedGroup(
        "c/(EA rl)^(1/2)",
        _product(hover_damping=1, axial_stiffness=-_HALF, mass_per_length=-_HALF),
        "how well the UAV's hold absorbs waves",
    ),
    NamedGroup("w td", _product(angular_frequency=1, axial_damping_time=1), "damping of the cable material"),
    NamedGroup(
        "Cd rho d Ae/rl",
        _product(normal_drag=1, air_density=1, diameter=1, amplitude=1, mass_per_length=-1),
        "air drag against cable inertia",
    ),
    NamedGroup(
        "rho S w^2 Ae^2/T",
        _product(air_density=1, drag_area=1, angular_frequency=2, amplitude=2, static_tension=-1),
        "air drag of the UAV per pull",
    ),
    NamedGroup(
        "EI/(T L^2)",
        _product(bending_stiffness=1, static_tension=-1, length=-2),
        "bending stiffness of the cable",
    ),
)
