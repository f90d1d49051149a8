"""Scaling laws by name: three scales that are chosen, from which all others follow by dimension."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

from tethertest.errors import DataError
from tethertest.similitude.rational import solve
from tethertest.units import dimension_of


@dataclass(frozen=True, slots=True)
class Law:
    """A scaling law: quantities whose ratios are chosen, some of them 1 by the law."""

    name: str
    scales: tuple[tuple[str, str], ...]  #: (quantity, SI unit), dimensionally independent
    same: tuple[str, ...] = ()  #: quantities of `scales` that are equal at both scales

    def exponents(self, unit: str) -> dict[str, Fraction]:
        """Return how the ratio of a quantity follows from the law's free ratios.

        Parameters
        ----------
        unit : str
            SI unit of the quantity, e.g. ``"N"``.

        Returns
        -------
        dict
            Scale -> exact exponent, e.g. ``{"length": 3, "density": 1}`` for a force under Froude's law.

        Raises
        ------
        DataError
            The unit has a dimension, such as temperature, that the law does not scale.
        """
        wanted = dimension_of(unit)
        columns = [dimension_of(written) for _, written in self.scales]
        dimensions = sorted({name for column in (wanted, *columns) for name in column})
        rows = [[column.get(name, Fraction(0)) for column in columns] for name in dimensions]
        powers = solve(rows, [wanted.get(name, Fraction(0)) for name in dimensions]) if rows else None
        if powers is None and wanted:
            message = f"the law {self.name!r} does not scale {unit!r}"
            raise DataError(message, "ask for a mechanical quantity")
        return {
            name: power
            for (name, _), power in zip(self.scales, powers or (), strict=False)
            if power and name not in self.same
        }

    def ratio(self, unit: str, scales: Mapping[str, float]) -> float:
        """Return the ratio of a quantity [1] from the ratios of the law's free scales.

        Raises
        ------
        DataError
            A ratio that the quantity needs is not given.
        """
        product = 1.0
        for name, power in self.exponents(unit).items():
            if name not in scales:
                message = f"the law {self.name!r} needs the ratio of {name}"
                raise DataError(message, f"give ratios of {', '.join(self.free)}")
            product *= scales[name] ** float(power)
        return product

    @property
    def free(self) -> tuple[str, ...]:
        """Quantities whose ratios may be chosen."""
        return tuple(name for name, _ in self.scales if name not in self.same)


#: gravity and inertia: w l^-1/2, v l^1/2, F rho l^3, E rho l
FROUDE = Law("froude", (("length", "m"), ("density", "kg/m^3"), ("gravity", "m/s^2")), same=("gravity",))
#: elasticity and inertia: v (E/rho)^1/2, w v/l
CAUCHY = Law("cauchy", (("length", "m"), ("density", "kg/m^3"), ("youngs_modulus", "Pa")))
#: the same cable at both scales, or another one of known EA: F = EA at equal strain
FIXED_SECTION_CABLE = Law(
    "fixed_section_cable", (("length", "m"), ("mass_per_length", "kg/m"), ("axial_stiffness", "N"))
)
#: tension and inertia: w (T/rl)^1/2/l
TAUT_STRING = Law("taut_string", (("length", "m"), ("mass_per_length", "kg/m"), ("tension", "N")))

LAWS = (FROUDE, CAUCHY, FIXED_SECTION_CABLE, TAUT_STRING)
