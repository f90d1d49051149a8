"""Rows of a text table into numbers: one pass that counts, checks and converts.

A number becomes the double next to it, as Python's ``float`` does: its digits, a 64-bit integer ``w``, are
multiplied by a power of ten held to 128 bits, and the product is rounded to even.

References
----------
D. Lemire, Number parsing at a gigabyte per second, Software: Practice and Experience 51 (2021), 1700-1727.
N. Mushtak, D. Lemire, Fast number parsing without fallback, ibid. 53 (2023), 1467-1471.
"""

from __future__ import annotations

from typing import Final, TypeAlias

import numpy as np
import numpy.typing as npt

from tethertest.kernels.jit import compiled

Bytes: TypeAlias = npt.NDArray[np.uint8]
Integers: TypeAlias = npt.NDArray[np.int64]
FloatArray: TypeAlias = npt.NDArray[np.float64]
Words: TypeAlias = npt.NDArray[np.uint64]

#: what a column is to the scan: a number, a stamp, not used, or blank by right
NUMBER: Final = 0
STAMP: Final = 1
UNUSED: Final = 2
BLANK: Final = 3
#: how a scan ended
DONE: Final = 0
FULL: Final = 1  #: the list of odd cells is full; call again from where it stopped
WIDTH: Final = 2  #: a row has too few or too many fields
QUOTE: Final = 3  #: a quoted cell is not closed in its row

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
_SIGN: Final = np.uint64(1 << 63)
#: integers and powers of ten that doubles hold exactly: their quotient is rounded once
_EXACT: Final = np.uint64(1 << 53)
_TENS: Final = np.array([10.0**power for power in range(23)])


@compiled
def _product(a: np.uint64, b: np.uint64) -> tuple[np.uint64, np.uint64]:
    """Return the high and the low word of a product."""
    a0, a1, b0, b1 = a & _HALF, a >> _32, b & _HALF, b >> _32
    low = a0 * b0
    middle = a1 * b0 + (low >> _32)
    crossed = a0 * b1 + (middle & _HALF)
    return a1 * b1 + (middle >> _32) + (crossed >> _32), ((crossed & _HALF) << _32) | (low & _HALF)


@compiled
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


@compiled
def scan_rows(
    text: Bytes,
    begin: int,
    separator: int,
    decimal: int,
    least: int,
    kinds: Bytes,
    places: Integers,
    counter: int,
    decimals: int,
    rows: int,
    line: int,
    values: FloatArray,
    bits: Words,
    ticks: Integers,
    stamps: npt.NDArray[np.uint8],
    lines: Integers,
    odd: Integers,
) -> tuple[int, int, int, int, int, int]:
    """Convert rows until the text ends or something stops the scan.

    Empty rows, rows of blanks and rows that begin with ``#`` are passed over, but counted as lines.

    Parameters
    ----------
    text : (n,) uint8
        Whole rows, each ended by a line feed.
    begin : int
        Where to start in the text.
    separator : int
        A character, or 0 where runs of blanks separate.
    decimal : int
        ``.`` or ``,``.
    least : int
        Fewest fields of a row.
    kinds, places : (most,) uint8, int64
        What each column is, and its place among the numbers or the stamps; its length is the most fields.
    counter, decimals : int
        Column whose numbers are also returned as whole multiples of ``10**-decimals``, or -1.
    rows, line : int
        Rows and lines before `begin`.
    values : (numbers, capacity) float64
        Filled; NaN where a cell is blank or odd.
    bits : (numbers, capacity) uint64
        The same memory.
    ticks : (capacity,) int64
        Filled for the counter.
    stamps : (columns, capacity, characters) uint8
        Filled with cells without the blanks around them, zero behind their end.
    lines : (capacity,) int64
        Filled with the line of each row, from 0.
    odd : (m, 4) int64
        Filled with row, column, start and end of every cell that is no plain number, or too long, or
        not blank behind the last column.

    Returns
    -------
    position, rows, line, odds, status, fields : int
        Where the scan stopped, how many rows, lines and odd cells it found, and why it stopped; `fields` are
        those of the row that stopped it.
    """
    most = len(kinds)
    end = len(text)
    longest = stamps.shape[2]
    odds = 0
    at = begin
    while at < end:
        i = at
        while text[i] == 32 or text[i] == 13 or (text[i] == 9 and separator != 9):
            i += 1
        if text[i] == 10 or text[at] == 35:
            while text[i] != 10:
                i += 1
            at = i + 1
            line += 1
            continue
        if odds + most > len(odd):
            return at, rows, line, odds, FULL, 0
        field = 0
        before = odds
        i = at
        while True:  # one field each time
            sign = text[i]
            while sign <= 32 and (sign in (32, 13) or (sign == 9 and separator != 9)):
                i += 1
                sign = text[i]
            if separator == 0 and sign == 10:
                break
            start = i
            quoted = sign == 34
            if quoted:
                i += 1
            digits = np.uint64(0)
            exponent = 0
            negative = plain = False
            kind = kinds[field] if field < most else UNUSED
            if kind == NUMBER:
                while quoted and text[i] == 32:
                    i += 1
                sign = text[i]
                if sign in (45, 43):
                    negative = sign == 45
                    i += 1
                    sign = text[i]
                room = i + _MOST_DIGITS
                first = i
                while 48 <= sign <= 57 and i < room:
                    digits = digits * _TEN + np.uint64(sign - 48)
                    i += 1
                    sign = text[i]
                written = i - first
                if sign == decimal:
                    i += 1
                    sign = text[i]
                    first = i
                    room += 1
                    while 48 <= sign <= 57 and i < room:
                        digits = digits * _TEN + np.uint64(sign - 48)
                        i += 1
                        sign = text[i]
                    exponent = first - i
                    written -= exponent
                plain = written > 0
                if plain and sign in (101, 69):
                    i += 1
                    falling = text[i] == 45
                    if text[i] == 45 or text[i] == 43:
                        i += 1
                    plain = 48 <= text[i] <= 57
                    power = 0
                    while 48 <= text[i] <= 57:
                        power = min(power * 10 + int(text[i]) - 48, 10_000)
                        i += 1
                    exponent += -power if falling else power
                plain = plain and LOWEST <= exponent <= HIGHEST
            if quoted:
                while text[i] == 32 or (text[i] == 9 and kind == NUMBER):
                    i += 1
                plain = plain and text[i] == 34
                while text[i] != 10 and (text[i] != 34 or text[i + 1] == 34):
                    i += 2 if text[i] == 34 else 1
                if text[i] == 10:
                    return at, rows, line, before, QUOTE, field
                i += 1
            stop = i
            if separator == 0:
                while text[i] != 32 and text[i] != 9 and text[i] != 13 and text[i] != 10:
                    plain = False
                    i += 1
                stop = i
            else:
                while text[i] != separator and text[i] != 10:
                    if text[i] != 32 and text[i] != 9 and text[i] != 13:
                        plain = False
                        stop = i + 1
                    i += 1
            if field < most:
                place = places[field]
                if kind == NUMBER:
                    if not plain:
                        values[place, rows] = np.nan
                    elif digits <= _EXACT and -22 <= exponent <= 0:
                        value = np.float64(np.int64(digits)) / _TENS[-exponent]
                        values[place, rows] = -value if negative else value
                    else:
                        word = double_bits(digits, exponent)
                        bits[place, rows] = word | _SIGN if negative else word
                    if field == counter:
                        shift = exponent + decimals
                        tick = digits
                        while shift > 0 and tick < _ALL // _TEN:
                            tick *= _TEN
                            shift -= 1
                        while shift < -1:
                            tick //= _TEN
                            shift += 1
                        if shift == -1:
                            tick = (tick + np.uint64(5)) // _TEN
                            shift = 0
                        if shift > 0 or tick >= _SIGN:
                            plain = False
                        else:
                            ticks[rows] = -np.int64(tick) if negative else np.int64(tick)
                elif kind == STAMP:
                    inner = start + 1 if quoted else start
                    size = (stop - 1 if quoted else stop) - inner
                    while quoted and size > 0 and text[inner] == 32:
                        inner += 1
                        size -= 1
                    while quoted and size > 0 and text[inner + size - 1] == 32:
                        size -= 1
                    plain = size <= longest and (not quoted or text[stop - 1] == 34)
                    for k in range(longest):
                        stamps[place, rows, k] = text[inner + k] if plain and k < size else 0
                if not plain and kind != UNUSED and stop > start:
                    odd[odds, 0], odd[odds, 1], odd[odds, 2], odd[odds, 3] = rows, field, start, stop
                    odds += 1
            field += 1
            if text[i] == 10:
                break
            if separator != 0:
                i += 1
        if field < least or field > most:
            return at, rows, line, before, WIDTH, field
        for column in range(field, most):
            if kinds[column] == NUMBER:
                values[places[column], rows] = np.nan
            elif kinds[column] == STAMP:
                stamps[places[column], rows] = 0
        lines[rows] = line
        rows += 1
        line += 1
        at = i + 1
    return at, rows, line, odds, DONE, 0
