"""Date and time stamps as loggers write them, parsed by their layout, many at once.

A stamp's layout is its text with every digit replaced by 0: ``2026/5/19 09:38:55.04646`` has the layout
``0000/0/00 00:00:00.00000``. Rows of one layout are read together by position, so nothing is guessed per row.
"""

from __future__ import annotations

import datetime as dt
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final, TypeAlias
from zoneinfo import ZoneInfo, ZoneInfoNotFoundError

import numpy as np
import numpy.typing as npt

from tethertest.errors import FileFormatError
from tethertest.records.arrays import FloatArray

Integers: TypeAlias = npt.NDArray[np.int64]
Characters: TypeAlias = npt.NDArray[np.uint8]

_DATE = r"(?P<first>0{1,4})(?P<sign>[-/.])(?P<second>00?)(?P=sign)(?P<third>0{4}|00?)"
_SECONDS = r"(?::(?P<whole>00)(?:[.,:](?P<fraction>0+))?)?"
_TIME = rf"(?P<hour>00?):(?P<minute>00){_SECONDS}(?:\s?(?P<half>[AaPp])\.?[Mm]\.?)?"
_ZONE = r"\s?(?P<zone>[Zz]|UTC|GMT|[+-](?P<zone_hour>00):?(?P<zone_minute>00)?)"
_LAYOUT = re.compile(rf"(?:{_DATE})?(?P<gap>[T\s,-]*)(?:{_TIME})?(?:{_ZONE})?")
_DIGIT = re.compile(r"\d", re.ASCII)
_CHINESE = str.maketrans({"年": "-", "月": "-", "日": " ", "\u3000": " "})
_SECOND: Final = 1_000_000_000  #: [ns]
_ORDERS: Final = {"ymd": (0, 1, 2), "dmy": (2, 1, 0), "mdy": (2, 0, 1)}  #: places of year, month, day


@dataclass(frozen=True, slots=True, eq=False)
class Stamps:
    """Parsed stamps of one column."""

    nanoseconds: (
        Integers  #: (n,) [ns] since 1970 (UTC where the stamps have a zone), or since midnight without a date
    )
    date_order: str  #: "ymd", "dmy", "mdy", or "" without a date
    zone_offset: int | None  #: [s] east of UTC of the first stamp, where it has a zone

    def seconds(self) -> FloatArray:
        """Return (n,) seconds since the first stamp, exact to the nanosecond."""
        seconds: FloatArray = (self.nanoseconds - self.nanoseconds[0]) / _SECOND
        return seconds

    def start(self, time_zone: dt.tzinfo | None = None) -> dt.datetime | None:
        """Return the first stamp as written, in `time_zone` where it has no zone of its own."""
        if not self.date_order:
            return None
        moment = dt.datetime(1970, 1, 1) + dt.timedelta(microseconds=int(self.nanoseconds[0]) // 1000)
        if self.zone_offset is None:
            return moment.replace(tzinfo=time_zone)
        return moment.replace(tzinfo=dt.UTC).astimezone(dt.timezone(dt.timedelta(seconds=self.zone_offset)))


def stamp_kind(text: str) -> str | None:
    """Return ``"datetime"``, ``"date"`` or ``"time"`` for a cell that is a stamp, else None."""
    match = _match(_DIGIT.sub("0", text.translate(_CHINESE).strip()))
    if match is None:
        return None
    if match["first"] is None:
        return "time"
    return "date" if match["hour"] is None else "datetime"


def time_zone_of(name: str | None, path: Path) -> dt.tzinfo | None:
    """Return the zone that the settings name.

    Raises
    ------
    FileFormatError
        There is no such zone.
    """
    if name is None:
        return None
    offset = re.fullmatch(r"([+-])(\d\d):?(\d\d)", name)
    if offset:
        minutes = int(offset[2]) * 60 + int(offset[3])
        return dt.timezone(dt.timedelta(minutes=-minutes if offset[1] == "-" else minutes))
    try:
        return ZoneInfo(name)
    except (ZoneInfoNotFoundError, ValueError) as error:
        message = f"time_zone {name!r} is not known"
        raise FileFormatError(message, 'use a name such as "Asia/Shanghai" or "+08:00"', path=path) from error


def parse_stamps(
    cells: Sequence[str], path: Path, lines: npt.ArrayLike, date_order: str | None = None
) -> Stamps:
    """Parse one column of stamps.

    Parameters
    ----------
    cells : sequence of str
        (n,) stamps; their layout may change from row to row (hours without a leading zero).
    path, lines : Path, array_like
        File and (n,) line numbers, for messages.
    date_order : str, optional
        ``ymd``, ``dmy`` or ``mdy`` where the stamps themselves leave it open.

    Raises
    ------
    FileFormatError
        A cell is no stamp, is no possible date, or day and month can be read both ways.
    """
    rows = np.asarray(lines)
    together = "\n".join(cells)
    if not together.isascii():
        together = together.translate(_CHINESE)
    joined = np.strings.strip(np.array(together.encode(errors="replace").split(b"\n"), dtype=bytes))
    characters = joined.view(np.uint8).reshape(joined.size, joined.itemsize)
    parts = {name: np.zeros(joined.size, np.int64) for name in ("first", "second", "third", "clock", "zone")}
    long_first = np.zeros(joined.size, np.bool_)
    dated: set[bool] = set()
    dotted, zoned = True, False
    for layout, chosen in _by_layout(characters):
        match = _match(layout)
        part = characters[chosen]
        wrong = np.ones(len(chosen), np.bool_) if match is None else _impossible_clock(part, match)
        if match is None or np.any(wrong):
            row = int(chosen[np.argmax(wrong)])
            message = f"found {cells[row]!r}, expected a date and time"
            remedy = "export the stamps in full, such as 2026-09-05 14:20:00.000"
            raise FileFormatError(message, remedy, path=path, line=int(rows[row]))
        dated.add(match["first"] is not None)
        if match["first"] is not None:
            for name in ("first", "second", "third"):
                parts[name][chosen] = _number(part, match.span(name))
            long_first[chosen] = len(match["first"]) == 4
            dotted &= match["sign"] == "."
        parts["clock"][chosen] = _clock(part, match)
        parts["zone"][chosen] = _offset(part, match)
        zoned |= match["zone"] is not None
    if len(dated) > 1:
        message = "some stamps have a date and some have none"
        raise FileFormatError(message, "export the log again with full stamps", path=path, line=int(rows[0]))
    total = parts["clock"]
    order = ""
    if dated == {True}:
        order = _date_order(
            parts["first"], parts["second"], long_first, date_order, dotted, path, int(rows[0])
        )
        total = total + _days(parts, order, path, rows) * 86400 * _SECOND - parts["zone"] * _SECOND
    return Stamps(total, order, int(parts["zone"][0]) if zoned else None)


def _match(layout: str) -> re.Match[str] | None:
    match = _LAYOUT.fullmatch(layout)
    if match is None:
        return None
    dated, timed = match["first"] is not None, match["hour"] is not None
    return match if (dated or timed) and bool(match["gap"]) == (dated and timed) else None


def _by_layout(characters: Characters) -> Iterator[tuple[str, Integers]]:
    """Yield each layout with the rows that have it."""
    is_digit = (characters >= ord("0")) & (characters <= ord("9"))
    shapes = np.where(is_digit, np.uint8(ord("0")), characters)
    remaining = np.arange(len(shapes))
    while remaining.size:
        layout = shapes[remaining[0]]
        same = np.all(shapes[remaining] == layout, axis=1)
        yield layout.tobytes().rstrip(b"\0").decode(errors="replace"), remaining[same]
        remaining = remaining[~same]


def _number(part: Characters, span: tuple[int, int]) -> Integers:
    value = np.zeros(len(part), np.int64)
    for column in range(*span):
        value = value * 10 + (part[:, column] - ord("0"))
    return value


def _clock(part: Characters, match: re.Match[str]) -> Integers:
    """Return nanoseconds since midnight."""
    if match["hour"] is None:
        return np.zeros(len(part), np.int64)
    hour, minute = _number(part, match.span("hour")), _number(part, match.span("minute"))
    if match["half"] is not None:
        hour = hour % 12 + (12 if match["half"] in "Pp" else 0)
    total = (hour * 60 + minute) * 60
    if match["whole"] is not None:
        total = total + _number(part, match.span("whole"))
    nanoseconds = total * _SECOND
    if match["fraction"] is not None:
        begin, end = match.span("fraction")
        end = min(end, begin + 9)
        nanoseconds = nanoseconds + _number(part, (begin, end)) * 10 ** (9 - (end - begin))
    return nanoseconds


def _impossible_clock(part: Characters, match: re.Match[str]) -> npt.NDArray[np.bool_]:
    wrong = np.zeros(len(part), np.bool_)
    for name, limit in (("hour", 24), ("minute", 60), ("whole", 61)):
        if match[name] is not None:
            wrong |= _number(part, match.span(name)) >= limit
    return wrong


def _offset(part: Characters, match: re.Match[str]) -> Integers:
    """Return seconds east of UTC."""
    if match["zone_hour"] is None:
        return np.zeros(len(part), np.int64)
    minutes = _number(part, match.span("zone_hour")) * 60
    if match["zone_minute"] is not None:
        minutes = minutes + _number(part, match.span("zone_minute"))
    return minutes * (-60 if match["zone"].lstrip()[0] == "-" else 60)


def _date_order(
    first: Integers, second: Integers, long_first: npt.NDArray[np.bool_], wanted: str | None, dotted: bool,
    path: Path, line: int,
) -> str:  # fmt: skip
    if np.all(long_first):
        return "ymd"
    if wanted is not None:
        return wanted
    if dotted:
        return "dmy"
    day_first, month_first = bool(np.any(first > 12)), bool(np.any(second > 12))
    if day_first != month_first:
        return "dmy" if day_first else "mdy"
    if not day_first and np.all(first == second):
        return "dmy"
    message = f"the date {first[0]}/{second[0]}/... can be read as day/month and as month/day"
    remedy = 'set date_order = "dmy" or "mdy" for this log in run.toml'
    raise FileFormatError(message, remedy, path=path, line=line)


def _days(parts: dict[str, Integers], order: str, path: Path, rows: npt.NDArray[np.int64]) -> Integers:
    """Return days since 1970-01-01."""
    places = (parts["first"], parts["second"], parts["third"])
    year, month, day = (places[place] for place in _ORDERS[order])
    year = np.where(year < 70, year + 2000, np.where(year < 100, year + 1900, year))
    months = ((year - 1970) * 12 + month - 1).astype("datetime64[M]")
    dates = months.astype("datetime64[D]") + (day - 1)
    wrong = (month < 1) | (month > 12) | (day < 1) | (dates.astype("datetime64[M]") != months)
    if np.any(wrong):
        row = int(np.argmax(wrong))
        message = f"there is no day {day[row]} of month {month[row]} when the date is read as {order}"
        remedy = "correct date_order in run.toml, or export the log again"
        raise FileFormatError(message, remedy, path=path, line=int(rows[row]))
    return dates.astype(np.int64)
