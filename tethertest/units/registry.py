"""One pint registry, made when it is first asked for, and the aliases that field texts need."""

from __future__ import annotations

import re
from functools import cache
from typing import Any

from tethertest.errors import QuantityError

STANDARD_GRAVITY = 9.80665  #: [m/s^2], CGPM 1901


@cache
def registry() -> Any:
    """Return the shared pint registry (importing pint costs a quarter of a second)."""
    import pint

    units: Any = pint.UnitRegistry(autoconvert_offset_to_baseunit=False, cache_folder=None)
    units.define("percent_ = 0.01")
    units.define("microstrain_ = 1e-6")
    units.define("cycle_per_minute_ = hertz / 60")
    units.define("logger_count_ = [logger_count]")
    return units


#: spellings found in rig files and logs, and what pint is to read; applied to the whole unit text
_WHOLE = {
    "": "dimensionless",
    "-": "dimensionless",
    "1": "dimensionless",
    "%": "percent_",
    "ppm": "1e-6 dimensionless",
    "ue": "microstrain_",
    "µe": "microstrain_",
    "με": "microstrain_",
    "µε": "microstrain_",
    "ustrain": "microstrain_",
    "microstrain": "microstrain_",
    "um/m": "microstrain_",
    "µm/m": "microstrain_",
    "μm/m": "microstrain_",
    "um\\m": "microstrain_",
    "µm\\m": "microstrain_",
    "strain": "dimensionless",
    "m/m": "dimensionless",
    "rpm": "cycle_per_minute_",
    "1/min": "cycle_per_minute_", "r/min": "cycle_per_minute_", "rev/min": "cycle_per_minute_",
    "u/min": "cycle_per_minute_", "cpm": "cycle_per_minute_", "bpm": "cycle_per_minute_",
    "cps": "hertz", "rps": "hertz", "r/s": "hertz", "rev/s": "hertz",
    "deg c": "degC",
    "°c": "degC",
    "℃": "degC",
    "degc": "degC",
    "celsius": "degC",
    "volts": "volt",
    "volt": "volt",
    "newton": "newton",
    "newtons": "newton",
    "counts": "logger_count_",
    "count": "logger_count_",
    "nm": "nanometer",
    "n m": "newton * meter",
    "n/m": "newton / meter",
    "lbf": "force_pound",
    "kip": "1000 force_pound",
    "kips": "1000 force_pound",
    "in": "inch",
    # as Chinese acquisition systems write them
    "牛": "newton", "牛顿": "newton", "千牛": "kilonewton", "毫牛": "millinewton",
    "微应变": "microstrain_", "应变": "dimensionless",
    "米": "meter", "厘米": "centimeter", "毫米": "millimeter", "微米": "micrometer", "纳米": "nanometer",
    "米/秒": "meter / second", "毫米/秒": "millimeter / second",
    "米/秒²": "meter / second ** 2", "米/秒^2": "meter / second ** 2",
    "摄氏度": "degC", "伏": "volt", "伏特": "volt", "毫伏": "millivolt", "赫兹": "hertz", "秒": "second",
}  # fmt: skip

#: capitals that stand for a unit of quite another size than the one that may be meant
_CAPITALS = {"MV": "mV", "MV/V": "mV/V", "MA": "mA", "NM": "nm or N m"}
#: the longest unit that is read: a parser takes minutes for thousands of letters
_LONGEST = 60
#: a whole number becomes a float: powers of powers then overflow at once, and do not run without end
_WHOLE_NUMBER = re.compile(r"(?<![\w.])(?<![eE][-+])\d+(?![\w.])")
_POWER = re.compile(r"(?<=[A-Za-z])([2-4])(?![A-Za-z0-9])")

_WORD = re.compile(r"[^\W\d]\w*")
#: prefixes that pint knows and no load cell, interrogator or rig file has
_RARE_PREFIXES = frozenset({
    "quecto", "ronto", "yocto", "zepto", "atto", "femto", "exa", "peta", "zetta", "yotta", "ronna", "quetta",
    "kibi", "mebi", "gibi", "tebi", "pebi", "exbi", "zebi", "yobi",
})  # fmt: skip


def parse_unit(text: str) -> Any:
    """Return the pint quantity that a unit text stands for.

    Raises
    ------
    QuantityError
        The text is no unit that this package or pint knows.
    """
    import pint

    cleaned = text.strip()
    if len(cleaned) > _LONGEST:
        message = f"unit {cleaned[:_LONGEST]!r}... is not known"
        raise QuantityError(message, "use a unit such as N, kN, mm, Hz, mV/V, nm or degC")
    if cleaned in _CAPITALS:
        message = f"unit {cleaned!r} is written in capitals and may be {_CAPITALS[cleaned]}"
        raise QuantityError(message, f"state the unit that is meant, such as {_CAPITALS[cleaned]}")
    alias = _WHOLE.get(cleaned.lower() if cleaned != "Nm" else "Nm")
    if cleaned == "Nm":
        alias = "newton * meter"
    if alias is None:
        alias = _POWER.sub(r"**\1", cleaned.replace("·", " ").replace("²", "**2").replace("³", "**3"))
        alias = _WHOLE_NUMBER.sub(r"\g<0>.0", alias)
    if (rare := _rarely_prefixed(alias)) is not None:
        message = f"unit {text!r} would be {rare}, which nobody logs"
        raise QuantityError(message, "state the unit that is meant, such as N, or none")
    try:
        return registry().parse_expression(alias) * registry().dimensionless
    except (pint.UndefinedUnitError, pint.DefinitionSyntaxError) as error:
        message = f"unit {text!r} is not known"
        raise QuantityError(message, "use a unit such as N, kN, mm, Hz, mV/V, nm or degC") from error
    except pint.OffsetUnitCalculusError as error:
        if registry().parse_units(alias) == registry().degC:
            return registry().Quantity(1.0, registry().kelvin)
        message = f"unit {text!r} has a zero of its own or is a level, and no factor makes it SI"
        raise QuantityError(message, "log the quantity itself, such as N, V or degC") from error
    except Exception as error:  # pint lets tokenizer and type errors of its parser through
        message = f"unit {text!r} cannot be read"
        raise QuantityError(message, "write it like kg/m, N s/m or m/s^2") from error


def _rarely_prefixed(alias: str) -> str | None:
    """Return the full name of a unit with a prefix that no instrument uses: RN is a record number."""
    for word in _WORD.findall(alias):
        readings = registry().parse_unit_name(word)
        if readings and readings[0][0] in _RARE_PREFIXES:
            return f"{readings[0][0]}{readings[0][1]}"
    return None


def is_ratio(quantity: Any) -> bool:
    """Return whether a dimensionless unit is a share or a ratio; an angle or a bit is none."""
    shares = {"percent_", "microstrain_", "percent", "ppm"}
    length = registry().meter.dimensionality
    names = [name for name, _ in quantity.unit_items()]
    return all(name in shares or registry().Unit(name).dimensionality == length for name in names)


def is_voltage_ratio(quantity: Any) -> bool:
    """Return whether a unit is a voltage over a voltage, as a bridge puts out."""
    items = list(quantity.unit_items())
    volt = registry().volt.dimensionality
    powers = [power for name, power in items if registry().Unit(name).dimensionality == volt]
    return bool(powers) and len(powers) == len(items) and sum(powers) == 0


def si_unit(text: str) -> Any:
    """Return the pint unit of one of the package's own SI texts: ``"1"``, ``"count"`` or plain SI."""
    return registry().parse_units({"1": "dimensionless", "count": "logger_count_"}.get(text, text))
