"""Decimal numbers as they are written, into the nearest double or into whole ticks.

A number becomes the double next to it, as Python's ``float`` does: its digits, a 64-bit integer ``w``, are
multiplied by a power of ten held to 128 bits, and the product is rounded to even.

References
----------
D. Lemire, Number parsing at a gigabyte per second, Software: Practice and Experience 51 (2021), 1700-1727.
N. Mushtak, D. Lemire, Fast number parsing without fallback, ibid. 53 (2023), 1467-1471.
"""

from __future__ import annotations

from typing import Final, NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt

from tethertest.kernels.jit import compiled_small

Bytes: TypeAlias = npt.NDArray[np.uint8]
Words: TypeAlias = npt.NDArray[np.uint64]

_PLUS: Final = 43
_MINUS: Final = 45
_ZERO: Final = 48
_NINE: Final = 57
_EXPONENTS: Final = (69, 101)  # E and e

#: powers of ten that logs write; a cell beyond them is left to the caller
LOWEST: Final = -40
HIGHEST: Final = 40
_MOST_DIGITS: Final = 19  # any number of so many digits is below 2**64


def _powers_of_five() -> Words:
    """Return (n, 2) high and low words of 5**q, scaled to 128 bits and rounded as the method asks."""
    words = np.empty((HIGHEST - LOWEST + 1, 2), np.uint64)
    for row, exponent in enumerate(range(LOWEST, HIGHEST + 1)):
        power: int = 5 ** abs(exponent)
        if exponent < 0:
            size = (power - 1).bit_length()
            value = (1 << (size + 127 if exponent >= -27 else 2 * size + 128)) // power + 1
        else:
            value = power << max(128 - power.bit_length(), 0)
        value >>= max(value.bit_length() - 128, 0)
        words[row] = value >> 64, value & (2**64 - 1)
    return words


_POWERS: Final = _powers_of_five()
_ONE: Final = np.uint64(1)
_TWO: Final = np.uint64(2)
_THREE: Final = np.uint64(3)
_TEN: Final = np.uint64(10)
_32: Final = np.uint64(32)
_63: Final = np.uint64(63)
_52: Final = np.uint64(52)
_HALF: Final = np.uint64(0xFFFFFFFF)
_ALL: Final = np.uint64(0xFFFFFFFFFFFFFFFF)
_PRECISION_MASK: Final = np.uint64(0x1FF)  # 64 - (52 + 3) low bits: the product may lack a carry
_HIDDEN: Final = np.uint64(1 << 52)
SIGN: Final = np.uint64(1 << 63)
#: integers and powers of ten that doubles hold exactly: their quotient is rounded once
EXACT: Final = np.uint64(1 << 53)
TENS: Final = np.array([10.0**power for power in range(23)])
_HIGHEST_POWER: Final = 10_000  #: of a written exponent that is still counted up


class Number(NamedTuple):
    """A number as written: ``digits * 10**exponent``."""

    digits: np.uint64
    exponent: int
    is_negative: bool
    is_plain: bool  #: it is whole, and its exponent in range


NOTHING: Final = Number(np.uint64(0), 0, False, False)


@compiled_small
def _product(a: np.uint64, b: np.uint64) -> tuple[np.uint64, np.uint64]:
    """Return the high and the low word of a product."""
    a0, a1, b0, b1 = a & _HALF, a >> _32, b & _HALF, b >> _32
    low = a0 * b0
    middle = a1 * b0 + (low >> _32)
    crossed = a0 * b1 + (middle & _HALF)
    return a1 * b1 + (middle >> _32) + (crossed >> _32), ((crossed & _HALF) << _32) | (low & _HALF)


@compiled_small
def double_bits(digits: np.uint64, exponent: int) -> np.uint64:
    """Return the bits of the double next to ``digits * 10**exponent``.

    Parameters
    ----------
    digits : uint64
        Any.
    exponent : int
        From `LOWEST` to `HIGHEST`, so that no result overflows or is subnormal.
    """
    if digits == 0:
        return digits
    shift = 0
    word = digits
    for step in (32, 16, 8, 4, 2, 1):
        if word >> np.uint64(64 - step) == 0:
            word <<= np.uint64(step)
            shift += step
    high, low = _product(word, _POWERS[exponent - LOWEST, 0])
    if (high & _PRECISION_MASK) == _PRECISION_MASK:
        carry, _ = _product(word, _POWERS[exponent - LOWEST, 1])
        if carry > _ALL - low:
            high += _ONE
            low = carry - (_ALL - low) - _ONE
        else:
            low += carry
    upper = high >> _63
    cut = upper + np.uint64(9)
    mantissa = high >> cut
    binary = ((217706 * exponent) >> 16) + 63 + np.int64(upper) - shift + 1023
    if low <= _ONE and -4 <= exponent <= 23 and (mantissa & _THREE) == _ONE and (mantissa << cut) == high:
        mantissa &= ~_ONE  # exactly half way: to even
    mantissa += mantissa & _ONE
    mantissa >>= _ONE
    if mantissa >= _TWO << _52:
        mantissa = _HIDDEN
        binary += 1
    return (mantissa & ~_HIDDEN) | (np.uint64(binary) << _52)


@compiled_small
def _read_digits(text: Bytes, i: int, digits: np.uint64, most: int) -> tuple[np.uint64, int]:
    """Append digits to a number; return it and the place behind them."""
    end = i + most
    sign = text[i]
    while _ZERO <= sign <= _NINE and i < end:
        digits = digits * _TEN + np.uint64(sign - _ZERO)
        i += 1
        sign = text[i]
    return digits, i


@compiled_small
def _read_power(text: Bytes, i: int) -> tuple[int, int, bool]:
    """Return what is written behind an ``e``, the place behind it, and whether it is a power."""
    falling = text[i] == _MINUS
    if text[i] in (_MINUS, _PLUS):
        i += 1
    is_plain = _ZERO <= text[i] <= _NINE
    power = 0
    while _ZERO <= text[i] <= _NINE:
        power = min(power * 10 + int(text[i]) - _ZERO, _HIGHEST_POWER)
        i += 1
    return -power if falling else power, i, is_plain


@compiled_small
def read_number(text: Bytes, i: int, decimal: int) -> tuple[Number, int]:
    """Return the number that begins at a place, and the place behind it."""
    is_negative = text[i] == _MINUS
    if is_negative or text[i] == _PLUS:
        i += 1
    first = i
    digits, i = _read_digits(text, i, np.uint64(0), _MOST_DIGITS)
    written = i - first
    exponent = 0
    if text[i] == decimal:
        first = i + 1
        digits, i = _read_digits(text, first, digits, _MOST_DIGITS - written)
        exponent = first - i
        written -= exponent
    is_plain = written > 0
    if is_plain and text[i] in _EXPONENTS:
        power, i, is_plain = _read_power(text, i + 1)
        exponent += power
    is_plain = is_plain and LOWEST <= exponent <= HIGHEST
    return Number(digits, exponent, is_negative, is_plain), i


@compiled_small
def tick_of(digits: np.uint64, shift: int) -> np.int64:
    """Return ``digits * 10**shift`` as a whole number, a half rounded up; -1 where it is too large."""
    while shift > 0 and digits < _ALL // _TEN:
        digits *= _TEN
        shift -= 1
    while shift < -1:
        digits //= _TEN
        shift += 1
    if shift == -1:
        digits = (digits + np.uint64(5)) // _TEN
        shift = 0
    return np.int64(-1) if shift > 0 or digits >= SIGN else np.int64(digits)
