"""Numbers as people write them: no more digits than the uncertainty earns."""

from __future__ import annotations

import math
from fractions import Fraction

ABSENT = "–"
COVERAGE_95 = 1.96  #: standard errors in half a 95 % interval
_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_PLAIN_FROM, _PLAIN_TO = -3, 6  #: decimal exponents written without a power of ten


def number(value: float | None, digits: int = 4) -> str:
    """Return a number with so many significant digits; a dash where there is none."""
    if value is None or not math.isfinite(value):
        return ABSENT
    if value == 0.0:
        return "0"
    rounded = float(f"{value:.{digits - 1}e}")
    exponent = math.floor(math.log10(abs(rounded)))
    if _PLAIN_FROM <= exponent < _PLAIN_TO:
        shown = rounded if exponent < digits else value  # whole numbers are not rounded to hundreds
        return f"{shown:.{max(digits - 1 - exponent, 0)}f}".replace("-", "−")
    mantissa = f"{rounded / 10.0**exponent:.{digits - 1}f}".replace("-", "−")
    return f"{mantissa}×10{str(exponent).translate(_SUPERSCRIPTS)}"


def decimals_for(spread: float, digits: int = 2) -> int:
    """Return the decimals that show `digits` significant digits of a spread."""
    if not math.isfinite(spread) or spread <= 0.0:
        return 4
    return min(max(digits - 1 - math.floor(math.log10(spread)), 0), 9)


def fixed(value: float | None, decimals: int) -> str:
    """Return a number with so many decimals; a dash where there is none."""
    if value is None or not math.isfinite(value):
        return ABSENT
    text = f"{value:.{decimals}f}"
    return (text if float(text) else text.lstrip("-")).replace("-", "−")


def plus_minus(value: float | None, spread: float) -> str:
    """Return ``value ± spread``, both to the second digit of the spread."""
    if value is None or not math.isfinite(value):
        return ABSENT
    if not math.isfinite(spread):
        return f"{number(value)} ± unknown"
    decimals = decimals_for(spread)
    return f"{fixed(value, decimals)} ± {fixed(spread, decimals)}"


def percent(value: float | None, *, signed: bool = False) -> str:
    """Return a ratio in percent with two or three digits."""
    if value is None or not math.isfinite(value):
        return ABSENT
    shown = 100.0 * value
    decimals = 2 if abs(shown) < 1 else 1 if abs(shown) < 100 else 0
    text = fixed(shown, decimals)
    return f"{'+' if signed and value > 0 else ''}{text} %"


def span(start: float, stop: float) -> str:
    """Return a span of time."""
    return f"{fixed(start, 2)} to {fixed(stop, 2)} s"


def words(key: str) -> str:
    """Return a snake_case key as words."""
    return key.replace("_", " ")


def power_product(exponents: dict[str, Fraction]) -> str:
    """Return a product of powers such as ``F / (E · l²)``."""
    over = [_power(name, power) for name, power in exponents.items() if power > 0]
    under = [_power(name, -power) for name, power in exponents.items() if power < 0]
    top = " · ".join(over) or "1"
    if not under:
        return top
    bottom = " · ".join(under)
    return f"{top} / ({bottom})" if len(under) > 1 else f"{top} / {bottom}"


def _power(name: str, power: Fraction) -> str:
    if power == 1:
        return name
    if power.denominator == 1:
        return f"{name}{str(power.numerator).translate(_SUPERSCRIPTS)}"
    return f"{name}^({power})"
