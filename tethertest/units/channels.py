"""Units of logged channels: what a logger wrote, checked against the kind of the channel."""

from __future__ import annotations

import re
from dataclasses import dataclass
from enum import StrEnum
from typing import Any, Final

from tethertest.errors import QuantityError
from tethertest.units.common import common_dimension, common_factor, dimension_text
from tethertest.units.registry import STANDARD_GRAVITY, is_ratio, is_voltage_ratio, parse_unit, si_unit


class Kind(StrEnum):
    """What a channel measures; the value is the word in JSON."""

    TENSION = "tension"
    STRAIN = "strain"
    WAVELENGTH = "wavelength"
    DISPLACEMENT = "displacement"
    VELOCITY = "velocity"
    ACCELERATION = "acceleration"
    TEMPERATURE = "temperature"
    VOLTAGE = "voltage"
    RATIO = "ratio"
    COUNT = "count"
    OTHER = "other"


#: kind of channel -> SI unit of its values ("" where the logger's own unit stays)
KINDS: Final[dict[str, str]] = {
    Kind.TENSION: "N",
    Kind.STRAIN: "1",
    Kind.WAVELENGTH: "m",
    Kind.DISPLACEMENT: "m",
    Kind.VELOCITY: "m/s",
    Kind.ACCELERATION: "m/s^2",
    Kind.TEMPERATURE: "K",
    Kind.VOLTAGE: "V",
    Kind.RATIO: "1",
    Kind.COUNT: "count",
    Kind.OTHER: "",
}

#: a mass unit on a load cell's channel means the weight of that mass
_FORCE_OF_MASS = {"kg": 1.0, "g": 1e-3, "t": 1e3, "lb": 0.45359237, "lbs": 0.45359237, "kgf": 1.0, "tf": 1e3}
#: in this order a unit without a declared kind is given one
_KINDS_BY_DIMENSION = (
    "tension",
    "displacement",
    "velocity",
    "acceleration",
    "temperature",
    "voltage",
    "count",
    "strain",
)
_FAHRENHEIT = {"degf", "°f", "℉", "deg f", "deg_f", "fahrenheit", "degree_fahrenheit", "degrees_fahrenheit"}
_CELSIUS = {
    "degc", "°c", "℃", "deg c", "celsius", "c", "degree celsius", "degrees celsius", "degree_celsius",
    "degrees_celsius", "degreec", "degreesc", "degree_c", "degrees_c", "deg_c", "deg. c", "摄氏度",
}  # fmt: skip


#: one volt over another, which cancels
_VOLT_OVER_VOLT = re.compile(r"([mµμu]?V|volts?)\s*/\s*\1", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class UnitScale:
    """Linear map from a value as written to SI: ``si = factor * written + offset``."""

    kind: Kind
    unit: str  #: SI unit of the result
    factor: float
    offset: float = 0.0


def channel_scale(written: str, kind: str | None = None) -> UnitScale:
    """Return how a channel's values become SI.

    Parameters
    ----------
    written : str
        Unit as the logger wrote it.
    kind : str, optional
        Kind of the channel if it is known; without it the kind follows from the unit. The unit nm is a
        wavelength unless the channel is known to be something else.

    Returns
    -------
    UnitScale
        Kind, SI unit, factor and offset.

    Raises
    ------
    QuantityError
        Unknown unit, or one whose dimension does not belong to the kind.
    """
    text = written.strip()
    if kind == "tension" and text.lower() in _FORCE_OF_MASS:
        return UnitScale(Kind.TENSION, "N", _FORCE_OF_MASS[text.lower()] * STANDARD_GRAVITY)
    if kind == "acceleration" and text.lower() in {"g", "gn", "g0"}:
        return UnitScale(Kind.ACCELERATION, "m/s^2", STANDARD_GRAVITY)
    if text.lower() in _CELSIUS and kind in {None, "temperature"}:
        return UnitScale(Kind.TEMPERATURE, "K", 1.0, 273.15)
    if text.lower() in _FAHRENHEIT and kind in {None, "temperature"}:
        return UnitScale(Kind.TEMPERATURE, "K", 5.0 / 9.0, 459.67 * 5.0 / 9.0)
    if not text and kind is None:
        return UnitScale(Kind.OTHER, "", 1.0)
    if (common := _common_scale(text, written, _likely_kind(text) if kind is None else kind)) is not None:
        return common
    quantity = parse_unit(text)
    dimension = quantity.dimensionality
    found = kind if kind is not None else _kind_of(text, quantity)
    target = KINDS.get(found)
    if target is None:
        message = f"kind {found!r} is not known"
        raise QuantityError(message, f"use one of {', '.join(KINDS)}")
    if not target:
        return UnitScale(Kind.OTHER, text, 1.0)
    unit = si_unit(target)
    if found == "ratio" and not (_VOLT_OVER_VOLT.fullmatch(text) or is_voltage_ratio(quantity)):
        raise _no_ratio(written)
    if dimension != unit.dimensionality:
        raise _wrong_dimension(written, str(dimension), found)
    return UnitScale(Kind(found), target, float(quantity.to(unit).magnitude))


def _common_scale(text: str, written: str, kind: str) -> UnitScale | None:
    """Return the scale of a common unit, None where pint is to be asked."""
    target = KINDS.get(kind)
    if not target:
        return None
    if kind == "ratio" and text != "mV/V":
        if common_dimension(text) is None:
            return None
        raise _no_ratio(written)
    factor = common_factor(text, target)
    if factor is not None:
        return UnitScale(Kind(kind), target, factor)
    found, wanted = common_dimension(text), common_dimension(target)
    if found is not None and wanted is not None and found != wanted:
        raise _wrong_dimension(written, dimension_text(found), kind)
    return None


def _no_ratio(written: str) -> QuantityError:
    message = f"unit {written!r} is no output of a bridge, volt over volt"
    return QuantityError(message, "log it in mV/V: um/m holds the amplifier's gauge factor too")


def _wrong_dimension(written: str, dimension: str, kind: str) -> QuantityError:
    message = f"unit {written!r} has dimension {dimension}, expected one of {kind} ({KINDS[kind]})"
    return QuantityError(message, "correct the sensor's kind in the rig file or the log's units")


def _likely_kind(text: str) -> str:
    """Return the kind of a common unit that has a dimension, else nothing."""
    if text == "nm":
        return "wavelength"
    kinds = (kind for kind in _KINDS_BY_DIMENSION if KINDS[kind] != "1")
    return next((kind for kind in kinds if common_factor(text, KINDS[kind]) is not None), "")


def _kind_of(text: str, quantity: Any) -> str:
    if text == "nm":
        return "wavelength"
    if text.replace(" ", "") in {"mV/V", "V/V", "uV/V", "µV/V"}:
        return "ratio"
    if not text or text in {"-", "1"}:
        return "other"
    if quantity.dimensionless and not is_ratio(quantity):
        return "other"
    for kind in _KINDS_BY_DIMENSION:
        if si_unit(KINDS[kind]).dimensionality == quantity.dimensionality:
            return kind
    return "other"
