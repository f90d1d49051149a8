"""What must hold between the keys of a cable, its air and its platform, in rigs, prototypes and scenes."""

from __future__ import annotations

from collections.abc import Iterator

from tethertest.readers.config.problems import Problem
from tethertest.records.cable import Air, Cable, Platform
from tethertest.units import format_quantity


def cable_problems(cable: Cable, air: Air | None) -> Iterator[Problem]:
    """Yield what is wrong between the keys of a cable and the air around it."""
    if cable.axial_stiffness is not None and cable.youngs_modulus is not None:
        yield Problem(
            ("cable", "youngs_modulus"),
            "found beside axial_stiffness, expected one of the two",
            "keep axial_stiffness, or youngs_modulus with diameter",
        )
    elif cable.axial_stiffness is None and cable.youngs_modulus is None:
        yield Problem(
            ("cable", "axial_stiffness"),
            "is missing, expected a quantity in N, or youngs_modulus with diameter",
            'add `axial_stiffness = "10 kN"`',
        )
    elif cable.youngs_modulus is not None and cable.diameter is None:
        yield Problem(
            ("cable", "diameter"),
            "is missing, expected a quantity in m beside youngs_modulus",
            'add `diameter = "6 mm"`, or give axial_stiffness instead',
        )
    if cable.diameter is None and air is not None and (air.normal_drag or air.tangential_drag):
        yield Problem(
            ("cable", "diameter"),
            "is missing, expected a quantity in m because [air] gives the cable drag",
            'add `diameter = "6 mm"`, or take the drag out',
        )
    if air is not None and isinstance(air.wind, tuple) and len(air.wind) not in {2, 3}:
        yield Problem(
            ("air", "wind"),
            f"found {len(air.wind)} components, expected 2 or 3",
            'write a speed along x, or ["5 m/s", "0 m/s"]',
        )


def weight_problems(cable: Cable, platform: Platform, gravity: float) -> Iterator[Problem]:
    """Yield a top tension at rest that cannot carry the cable."""
    weight = cable.length * cable.mass_per_length * gravity
    if platform.static_tension <= weight:
        yield Problem(
            ("platform", "static_tension"),
            f"found {format_quantity(platform.static_tension, 'N')}, expected more than the cable's weight "
            f"of {format_quantity(weight, 'N')}",
            "raise the static tension or correct the cable's length and mass_per_length",
        )
