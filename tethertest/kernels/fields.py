"""Rows of a text table into numbers and stamps: one pass that counts, checks and converts."""

from __future__ import annotations

from typing import Final, NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt

from tethertest.kernels.decimals import (
    EXACT,
    NOTHING,
    SIGN,
    TENS,
    Bytes,
    Number,
    Words,
    double_bits,
    read_number,
    tick_of,
)
from tethertest.kernels.jit import compiled_small

Integers: TypeAlias = npt.NDArray[np.int64]
FloatArray: TypeAlias = npt.NDArray[np.float64]

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

_TAB: Final = 9
_LINE_FEED: Final = 10
_RETURN: Final = 13
_SPACE: Final = 32
_QUOTE: Final = 34
_HASH: Final = 35


class RowForm(NamedTuple):
    """How rows are split into fields, and what their columns are."""

    separator: int  #: a character, or 0 where runs of blanks separate
    decimal: int  #: ``.`` or ``,``
    least: int  #: fewest fields of a row
    kinds: Bytes  #: (most,) what each column is; as many as a row has fields at most
    places: Integers  #: (most,) its place among the numbers or the stamps
    counter: int  #: column whose numbers are also returned as whole multiples of ``10**-decimals``, or -1
    decimals: int
    has_quotes: bool  #: cells may be quoted
    has_comments: bool  #: blank rows, and those that begin with ``#``, are passed over


class RowArrays(NamedTuple):
    """What the rows are written into; it holds `capacity` of them."""

    values: FloatArray  #: (numbers, capacity) NaN where a cell is blank or odd
    words: Words  #: the same memory, as bits
    ticks: Integers  #: (capacity,) of the counter
    stamps: Bytes  #: (columns, capacity, characters) without the blanks around them, zero behind their end
    lines: Integers  #: (capacity,) line of each row, from 0
    odd: Integers  #: (m, 4) row, column, start and end of every cell that is no plain number, or too long,
    #: or not blank behind the last column


class Reached(NamedTuple):
    """How far a scan came, and why it stopped."""

    position: int
    rows: int
    line: int
    odds: int = 0  #: odd cells that it listed
    status: int = FULL
    fields: int = 0  #: of the row that stopped it


@compiled_small
def _after_blanks(text: Bytes, i: int, separator: int) -> int:
    """Return the next place that is no blank; a tab is none where it separates."""
    sign = text[i]
    while sign <= _SPACE and (sign in (_SPACE, _RETURN) or (sign == _TAB and separator != _TAB)):
        i += 1
        sign = text[i]
    return i


@compiled_small
def _after_quote(text: Bytes, i: int) -> tuple[int, bool]:
    """Return the place behind a closing quote, -1 where there is none, and whether only blanks precede it."""
    while text[i] == _SPACE or text[i] == _TAB:
        i += 1
    is_blank = text[i] == _QUOTE
    while text[i] != _LINE_FEED:
        if text[i] != _QUOTE:
            i += 1
        elif text[i + 1] == _QUOTE:
            i += 2
        else:
            return i + 1, is_blank
    return -1, False


@compiled_small
def _after_field(text: Bytes, i: int, separator: int) -> tuple[int, int]:
    """Return where the content of a field ends, and where the field does."""
    stop = i
    sign = text[i]
    if separator == 0:
        while sign > _SPACE or sign not in (_SPACE, _TAB, _RETURN, _LINE_FEED):
            i += 1
            sign = text[i]
        return i, i
    while sign not in (separator, _LINE_FEED):
        i += 1
        if sign not in (_SPACE, _TAB, _RETURN):
            stop = i
        sign = text[i]
    return stop, i


@compiled_small
def _keep_number(
    number: Number, is_alone: bool, row: int, field: int, form: RowForm, found: RowArrays
) -> bool:
    """Write a number that stands alone in its cell, else NaN; return whether it did."""
    is_plain = is_alone and number.is_plain
    place = form.places[field]
    values = found.values
    if not is_plain:
        values[place, row] = np.nan
    elif number.digits <= EXACT and -22 <= number.exponent <= 0:
        value = np.float64(np.int64(number.digits)) / TENS[-number.exponent]
        values[place, row] = -value if number.is_negative else value
    else:
        word = double_bits(number.digits, number.exponent)
        found.words[place, row] = word | SIGN if number.is_negative else word
    if field != form.counter or not is_plain:
        return is_plain
    tick = tick_of(number.digits, number.exponent + form.decimals)
    if tick >= 0:
        found.ticks[row] = -tick if number.is_negative else tick
    return bool(tick >= 0)


@compiled_small
def _keep_stamp(text: Bytes, start: int, stop: int, is_quoted: bool, cell: Bytes) -> bool:
    """Write a stamp without quotes and the blanks in them; return whether it fits."""
    is_whole = True
    if is_quoted:
        is_whole = text[stop - 1] == _QUOTE
        start, stop = start + 1, stop - 1
        while stop > start and text[start] == _SPACE:
            start += 1
        while stop > start and text[stop - 1] == _SPACE:
            stop -= 1
    fits = is_whole and stop - start <= len(cell)
    for k in range(len(cell)):
        cell[k] = text[start + k] if fits and start + k < stop else 0
    return fits


@compiled_small
def _scan_row(
    text: Bytes, i: int, row: int, odds: int, form: RowForm, found: RowArrays
) -> tuple[int, int, int]:
    """Write the cells of one row; return its fields (-1 where a quote stays open), its end, and odd cells."""
    field = 0
    while True:
        i = _after_blanks(text, i, form.separator)
        if form.separator == 0 and text[i] == _LINE_FEED:
            break
        start = i
        kind = form.kinds[field] if field < len(form.kinds) else UNUSED
        is_quoted = form.has_quotes and text[i] == _QUOTE
        if is_quoted:
            i += 1
        number = NOTHING
        if kind == NUMBER:
            while is_quoted and text[i] == _SPACE:
                i += 1
            number, i = read_number(text, i, form.decimal)
        is_alone = True
        if is_quoted:
            i, is_alone = _after_quote(text, i)
            if i < 0:
                return -1, start, odds
        end = i
        stop, i = _after_field(text, end, form.separator)
        is_told = False
        if kind == NUMBER:
            is_told = _keep_number(number, is_alone and stop == end, row, field, form, found)
        elif kind == STAMP:
            is_told = _keep_stamp(text, start, stop, is_quoted, found.stamps[form.places[field], row])
        if not is_told and kind != UNUSED and stop > start:
            odd = found.odd[odds]
            odd[0], odd[1], odd[2], odd[3] = row, field, start, stop
            odds += 1
        field += 1
        if text[i] == _LINE_FEED:
            break
        if form.separator != 0:
            i += 1
    return field, i + 1, odds


@compiled_small
def _keep_blanks(row: int, field: int, form: RowForm, found: RowArrays) -> None:
    """Write that a row ends before the columns from `field` on."""
    for column in range(field, len(form.kinds)):
        if form.kinds[column] == NUMBER:
            found.values[form.places[column], row] = np.nan
        elif form.kinds[column] == STAMP:
            found.stamps[form.places[column], row] = 0


@compiled_small
def scan_rows(text: Bytes, form: RowForm, found: RowArrays, begin: Reached) -> Reached:
    """Convert rows until the text ends or something stops the scan.

    Rows that are passed over are counted as lines.

    Parameters
    ----------
    text : (n,) uint8
        Whole rows, each ended by a line feed.
    form : RowForm
        How they are read.
    found : RowArrays
        Filled.
    begin : Reached
        Where to start in the text, and the rows and lines before that.

    Returns
    -------
    Reached
        Before the row that stopped the scan; the list of odd cells is that of this call.
    """
    most = len(form.kinds)
    at, row, line, odds = begin.position, begin.rows, begin.line, 0
    while at < len(text):
        first = _after_blanks(text, at, form.separator)
        if form.has_comments and (text[first] == _LINE_FEED or text[at] == _HASH):
            while text[first] != _LINE_FEED:
                first += 1
            at = first + 1
            line += 1
            continue
        if odds + most > len(found.odd):
            return Reached(at, row, line, odds, FULL, 0)
        fields, after, more = _scan_row(text, at, row, odds, form, found)
        if fields < 0:
            return Reached(at, row, line, odds, QUOTE, 0)
        if fields < form.least or fields > most:
            return Reached(at, row, line, odds, WIDTH, fields)
        _keep_blanks(row, fields, form, found)
        found.lines[row] = line
        at, row, line, odds = after, row + 1, line + 1, more
    return Reached(at, row, line, odds, DONE, 0)
