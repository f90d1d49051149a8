"""What single cells of a text log are: numbers, stamps, names with units, units."""

from __future__ import annotations

import csv
import re
from collections import Counter
from collections.abc import Sequence
from contextlib import suppress
from typing import Final

from tethertest.readers.tables.text.stamps import stamp_kind
from tethertest.readers.tables.text.table import MISSING_TOKENS, SPACES, is_number

_SQUARE = re.compile(r"(.*?)\s*[\[【]\s*([^\]】]*?)\s*[\]】]\s*", re.DOTALL)
_ROUND = re.compile(
    r"(.*?)\s*[(（]\s*(-|[^)）]*[^\W\d][^)）]*|[%°℃µ][^)）]*|1/[^)）]*)\s*[)）]\s*", re.DOTALL
)
_BRACKETS: Final = "[]()【】（） "
#: spellings that show that a row under the names is a row of units
_UNITS: Final = frozenset([
    "s", "sec", "ms", "us", "µs", "min", "h", "hz", "khz", "n", "kn",
    "mn", "mm", "cm", "m", "um", "µm", "nm", "pm", "km", "v", "mv",
    "mv/v", "v/v", "g", "kg", "t", "pa", "kpa", "mpa", "bar", "k", "degc",
    "°c", "℃", "deg", "c", "%", "-", "1", "rpm", "deg", "°", "rad",
    "m/s", "m/s2", "m/s^2", "m/s²", "gn", "ue", "µe", "με", "µε", "µm/m", "μm/m",
    "um/m", "ustrain", "microstrain", "strain", "m/m", "count", "counts", "nm/n", "a", "ma", "w",
    "j", "nms", "lb", "lbf", "kip", "in", "ft", "hh:mm:ss", "秒", "毫秒", "分",
    "牛", "千牛", "牛顿", "毫牛", "毫米", "厘米", "米", "微米", "纳米", "微应变", "应变", "摄氏度",
    "伏", "毫伏", "伏特", "赫兹", "米/秒", "毫米/秒", "米/秒²", "米/秒^2",
])  # fmt: skip


def split_row(line: str, separator: str) -> list[str]:
    """Split one row into cells without the blanks around them; quotes are honoured."""
    if separator == SPACES:
        return line.split()
    if '"' in line:
        with suppress(csv.Error):
            cells = next(csv.reader([line], delimiter=separator, skipinitialspace=True))
            return [cell.strip() for cell in cells]
    return [cell.strip() for cell in line.split(separator)]


def is_datum(cell: str) -> bool:
    """Return whether a cell may stand in a data row: number with either sign, stamp, blank or missing."""
    return not cell or is_number(cell, ".") or is_number(cell, ",") or stamp_kind(cell) is not None


def split_unit(text: str) -> tuple[str, str]:
    """Split ``F_top [N]`` or ``F_top (N)`` into name and unit; the unit is "" where none is written."""
    for pattern in (_SQUARE, _ROUND):
        match = pattern.fullmatch(text)
        if match and match[1].strip():
            return match[1].strip(), match[2].strip()
    return text.strip(), ""


def bare_unit(cell: str) -> str:
    """Return the text of a cell of a row of units, without brackets."""
    return cell.strip(_BRACKETS) if cell not in {"()", "[]"} else ""


def is_units_row(cells: Sequence[str]) -> bool:
    """Return whether a row under the names holds their units."""
    filled = [bare_unit(cell) for cell in cells if cell]
    if not filled or any(len(cell) > 14 for cell in filled):
        return False
    known = sum(cell.lower() in _UNITS for cell in filled)
    return known * 2 >= len(filled) and not any(is_number(cell, ".") and cell != "1" for cell in filled)


def column_kind(cells: Sequence[str]) -> str:
    """Return ``number``, ``datetime``, ``date``, ``time``, ``text`` or ``blank`` for a sample of a column."""
    counts: Counter[str] = Counter()
    for cell in cells:
        if not cell or cell.lower() in MISSING_TOKENS:
            counts["blank"] += 1
        elif is_number(cell, ".") or is_number(cell, ","):
            counts["number"] += 1
        else:  # a date may be written with points; what is no date and has only digits and signs is a number
            kind = stamp_kind(cell)
            counts[kind or ("number" if re.fullmatch(r"[-+]?[\d.,' ]+", cell) else "text")] += 1
    filled = [(count, kind) for kind, count in counts.items() if kind != "blank"]
    return max(filled)[1] if filled else "blank"
