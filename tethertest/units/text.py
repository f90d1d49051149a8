"""Quantities as text: ``"48.4 g/m"``, ``"10.02 kN +/- 0.2 kN"``, ``"5 %"``."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import Any

from tethertest.errors import QuantityError
from tethertest.units.common import common_factor
from tethertest.units.registry import parse_unit, si_unit

_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
#: a unit starts with a letter, a sign such as % or °, or with "1/"; so "1,5 kN" is no quantity
_QUANTITY = re.compile(rf"^\s*({_NUMBER})\s*((?:1\s*/|[^\W\d]|[%°℃µ-]).*?)?\s*$")
#: pint's names of a whole turn, and of angles that are none
_TURNS = frozenset(["turn", "cycle", "revolution", "revolution_per_minute", "revolution_per_second"])
_ANGLES = frozenset(["radian", "degree", "arcminute", "arcsecond", "grade", "milliarcsecond"])
_PLUS_MINUS = re.compile(r"\+/-|±")


@dataclass(frozen=True, slots=True)
class Quantity:
    """A number in SI with its standard uncertainty, when one was written."""

    value: float  #: in the SI unit asked for
    uncertainty: float | None  #: standard uncertainty, same unit


def parse_quantity(text: str | float, unit: str) -> Quantity:
    """Turn a text with a unit into a number in the SI unit asked for.

    Parameters
    ----------
    text : str or float
        ``"48.4 g/m"``, with ``"+/- 0.3 g/m"`` if its uncertainty is known. A bare number is read only where
        a dimensionless one is asked for. An uncertainty in % is a share of the value, unless the value itself
        is in %. Turns, cycles and revolutions per time are frequencies; angles per time are refused.
    unit : str
        The SI unit of the result, e.g. ``"kg/m"``; ``"1"`` for a pure number.

    Returns
    -------
    Quantity
        Value and standard uncertainty in ``unit``.

    Raises
    ------
    QuantityError
        No number, an unknown unit, the wrong dimension, or a value that is not finite.
    """
    if isinstance(text, bool) or not isinstance(text, str | int | float):
        message = f"found {text!r}, expected a quantity in {unit}"
        raise QuantityError(message, f'write text with its unit, such as "1.5 {unit}"')
    if isinstance(text, int | float):
        if unit != "1":
            message = f"found the bare number {text!r}, expected a quantity in {unit}"
            raise QuantityError(message, f'write it as text with its unit: "{text:g} {unit}"')
        return Quantity(_finite(float(text), text), None)
    parts = _PLUS_MINUS.split(text)
    if len(parts) > 2:
        message = f"found {text!r} with more than one '+/-'"
        raise QuantityError(message, f'write "value {unit} +/- uncertainty {unit}"')
    value_text = parts[0]
    if len(parts) == 2 and re.fullmatch(rf"\s*{_NUMBER}\s*", value_text) and unit != "1":
        value_text = f"{value_text} {_split(parts[1], unit)[1]}"
    value = _single(value_text, unit)
    if len(parts) == 1:
        return Quantity(value, None)
    number, written = _split(parts[1], unit)
    if written == "%" and _split(value_text, unit)[1] != "%":
        return Quantity(value, abs(value) * _finite(number, text) / 100.0)
    uncertainty = _single(parts[1], unit, difference=True)
    if uncertainty < 0:
        message = f"found a negative uncertainty in {text!r}"
        raise QuantityError(message, "write the uncertainty as a positive number")
    return Quantity(value, uncertainty)


def format_quantity(value: float, unit: str, digits: int = 4) -> str:
    """Return a number with its unit for people: engineering prefix where the unit takes one."""
    if not math.isfinite(value):
        return f"{value} {unit}".strip()
    if unit in {"1", ""}:
        return f"{value:.{digits}g}"
    prefixed = {"N", "m", "Hz", "s", "Pa", "V", "W", "J"}
    if unit in prefixed and value != 0.0:
        exponent = math.floor(math.log10(abs(value)) / 3.0 + 1e-9) * 3
        prefixes = {-9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G"}
        if exponent in prefixes:
            return f"{value / 10.0**exponent:.{digits}g} {prefixes[exponent]}{unit}"
    return f"{value:.{digits}g} {unit}"


def _split(text: str, unit: str) -> tuple[float, str]:
    match = _QUANTITY.match(text)
    if match is None:
        hint = " (a decimal comma is not read here)" if re.match(r"^\s*[-+]?\d+,\d", text) else ""
        message = f"found {text!r}, expected a number with a unit of {unit}{hint}"
        example = "0.25" if unit == "1" else f"1.5 {unit}"
        raise QuantityError(message, f'write text such as "{example}"')
    return float(match.group(1)), match.group(2) or ""


def _single(text: str, unit: str, *, difference: bool = False) -> float:
    number, written = _split(text, unit)
    if not written and unit != "1":
        message = f"found {text!r} without a unit, expected a quantity in {unit}"
        raise QuantityError(message, f'add the unit: "{text.strip()} {unit}"')
    common = common_factor(written, unit)
    if common is not None:
        return _finite(number * common, text)
    target = si_unit(unit)
    if unit == "K" and written.lower() in {"degc", "°c", "℃", "deg c"} and not difference:
        return _finite(number + 273.15, text)
    found = parse_unit(written)
    if unit == "Hz":
        number *= _turns(found, text)
    if found.dimensionality != target.dimensionality:
        message = f"found {text.strip()!r} of dimension {found.dimensionality}, expected a quantity in {unit}"
        raise QuantityError(message, f"give the value in {unit} or another unit of that dimension")
    return _finite(number * float(found.to(target).magnitude), text)


def _turns(found: Any, text: str) -> float:
    """Return what makes a frequency of whole turns one in Hz: pint counts their angle in radians.

    Raises
    ------
    QuantityError
        It counts another angle, such as an angular frequency in rad/s or deg/s.
    """
    factor = 1.0
    for name, power in found.unit_items():
        if name in _TURNS:
            factor /= (2.0 * math.pi) ** power
        elif name in _ANGLES:
            message = f"found {text!r}: an angular frequency where a frequency in Hz is expected"
            raise QuantityError(message, "divide by 2 pi, or by 360 degrees, and write Hz")
    return factor


def _finite(value: float, text: object) -> float:
    if not math.isfinite(value):
        message = f"found {text!r}, which is not a finite number"
        raise QuantityError(message, "give a finite number")
    return value
