"""The units that nearly every file is written in, so that pint is loaded for the others alone.

Loading pint and its registry takes as long as reading a run. A test holds every entry against pint.
"""

from __future__ import annotations

from typing import Final, NamedTuple


class SIUnit(NamedTuple):
    """One SI unit with what is often written for it."""

    dimension: dict[str, int]  #: exponents, in pint's order
    factors: dict[str, float]  #: unit as written -> what it is in this SI unit


#: SI unit -> its dimension and spellings; each spelling stands in one place only
SI_UNITS: Final = {
    "1": SIUnit({}, {"": 1.0, "1": 1.0, "%": 0.01, "ppm": 1e-6, "mV/V": 1e-3, "um/m": 1e-6, "µm/m": 1e-6}),
    "m": SIUnit({"L": 1}, {"m": 1.0, "cm": 0.01, "mm": 1e-3, "um": 1e-6, "nm": 1e-9, "pm": 1e-12}),
    "kg": SIUnit({"M": 1}, {"kg": 1.0, "g": 1e-3}),
    "s": SIUnit({"T": 1}, {"s": 1.0, "ms": 1e-3, "us": 1e-6}),
    "Hz": SIUnit({"T": -1}, {"Hz": 1.0, "kHz": 1e3}),
    "1/s": SIUnit({"T": -1}, {"1/s": 1.0}),
    "1/m": SIUnit({"L": -1}, {"1/m": 1.0}),
    "1/K": SIUnit({"K": -1}, {"1/K": 1.0, "1/delta_degC": 1.0}),
    "rad": SIUnit({}, {"rad": 1.0, "deg": 0.017453292519943295}),
    "m^2": SIUnit({"L": 2}, {"m^2": 1.0, "mm^2": 1e-6}),
    "m/s": SIUnit({"L": 1, "T": -1}, {"m/s": 1.0, "mm/s": 1e-3}),
    "m/s^2": SIUnit({"L": 1, "T": -2}, {"m/s^2": 1.0}),
    "kg/m": SIUnit({"M": 1, "L": -1}, {"kg/m": 1.0, "g/m": 1e-3}),
    "kg/m^3": SIUnit({"M": 1, "L": -3}, {"kg/m^3": 1.0}),
    "N": SIUnit({"M": 1, "L": 1, "T": -2}, {"N": 1.0, "kN": 1e3, "mN": 1e-3}),
    "N/m": SIUnit({"M": 1, "T": -2}, {"N/m": 1.0, "kN/m": 1e3}),
    "N s/m": SIUnit({"M": 1, "T": -1}, {"N s/m": 1.0}),
    "N m^2": SIUnit({"M": 1, "L": 3, "T": -2}, {"N m^2": 1.0}),
    "Pa": SIUnit({"M": 1, "L": -1, "T": -2}, {"Pa": 1.0, "MPa": 1e6, "GPa": 1e9}),
    "V": SIUnit({"M": 1, "L": 2, "T": -3, "A": -1}, {"V": 1.0, "mV": 1e-3}),
    "count": SIUnit({"[logger_count]": 1}, {"count": 1.0}),
}  # fmt: skip

_NAMES: Final = {"L": "[length]", "M": "[mass]", "T": "[time]", "K": "[temperature]", "A": "[current]"}


def common_dimension(written: str) -> dict[str, int] | None:
    """Return the dimension of a unit as written, None where pint is to be asked."""
    return next((known.dimension for known in SI_UNITS.values() if written in known.factors), None)


def dimension_text(dimension: dict[str, int]) -> str:
    """Return a dimension as pint writes it: ``[mass] * [length] / [time] ** 2``."""
    if not dimension:
        return "dimensionless"
    powers = {name: f" ** {abs(power)}" if abs(power) != 1 else "" for name, power in dimension.items()}
    over = " * ".join(
        f"{_NAMES.get(name, name)}{powers[name]}" for name, power in dimension.items() if power > 0
    )
    under = [f" / {_NAMES[name]}{powers[name]}" for name, power in dimension.items() if power < 0]
    return "".join((over or "1", *under))


def common_factor(written: str, unit: str) -> float | None:
    """Return what a unit as written is in an SI unit, None where pint is to be asked."""
    known = SI_UNITS.get(unit)
    return None if known is None else known.factors.get(written)
