"""Date and time stamps as loggers write them, parsed by their layout, many at once.

A stamp's layout is its text with every digit replaced by 0: ``2026/5/19 09:38:55.04646`` has the layout
``0000/0/00 00:00:00.00000``. Rows of one layout are read together by position, so nothing is guessed per row.
"""

from __future__ import annotations

import datetime as dt
import re
from collections.abc import Iterable, Iterator, Sequence
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
#: years of two digits up to this one are hardly those of a log: such a dotted date may begin with the year
_LONG_AGO: Final = 14
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
    parts = split_stamps(characters_of(cells), path, rows)
    order = ""
    if parts.dated:
        order = settle_order([parts], date_order, path, int(rows[0]))
    return Stamps(parts.nanoseconds(order, path, rows), order, int(parts.zone[0]) if parts.zoned else None)


@dataclass(frozen=True, slots=True, eq=False)
class StampParts:
    """The numbers in stamps, before it is settled which of them is the day."""

    date: Integers  #: (3, n) as written; zero without a date
    clock: Integers  #: (n,) [ns] since midnight
    zone: Integers  #: (n,) [s] east of UTC
    long_first: npt.NDArray[np.bool_]  #: (n,) the date begins with four digits
    dated: bool
    dotted: bool  #: points stand between the numbers of the dates
    short: bool  #: no date has a year of four digits
    zoned: bool  #: some stamps have a zone

    def nanoseconds(self, order: str, path: Path, lines: npt.NDArray[np.int64]) -> Integers:
        """Return (n,) nanoseconds since 1970, or since midnight without a date.

        Raises
        ------
        FileFormatError
            A date is impossible in that order.
        """
        if not self.dated:
            return self.clock
        days = _days(self.date, order, path, lines)
        return self.clock + days * 86400 * _SECOND - self.zone * _SECOND


def split_stamps(characters: Characters, path: Path, lines: npt.NDArray[np.int64]) -> StampParts:
    """Split stamps into their numbers.

    Parameters
    ----------
    characters : (n, m) uint8
        UTF-8, zero behind the end of each stamp.
    path, lines : Path, (n,) int64
        File and line numbers, for messages.

    Raises
    ------
    FileFormatError
        A cell is no stamp, or only some have a date.
    """
    if np.any(characters >= 128):
        cells = characters.view(f"S{characters.shape[1]}")[:, 0].tolist()
        characters = _characters(b"\n".join(cells).decode(errors="replace"))
    count = len(characters)
    date = np.zeros((3, count), np.int64)
    clock, zone = np.zeros(count, np.int64), np.zeros(count, np.int64)
    long_first = np.zeros(count, np.bool_)
    dated: set[bool] = set()
    dotted, short, zoned = True, True, False
    for layout, chosen in _by_layout(characters):
        match = _match(layout)
        part = characters[chosen]
        if match is not None and match["first"] is None and not match["whole"] and not match["half"]:
            raise _two_numbers(
                part[0].tobytes().rstrip(b"\0").decode(errors="replace"), path, lines[chosen[0]]
            )
        wrong = np.ones(len(chosen), np.bool_) if match is None else _impossible_clock(part, match)
        if match is None or np.any(wrong):
            row = int(chosen[np.argmax(wrong)])
            cell = characters[row].tobytes().rstrip(b"\0").decode(errors="replace")
            message = f"found {cell!r}, expected a date and time"
            remedy = "export the stamps in full, such as 2026-09-05 14:20:00.000"
            raise FileFormatError(message, remedy, path=path, line=int(lines[row]))
        dated.add(match["first"] is not None)
        if match["first"] is not None:
            for place, name in enumerate(("first", "second", "third")):
                date[place, chosen] = _number(part, match.span(name))
            long_first[chosen] = len(match["first"]) == 4
            dotted &= match["sign"] == "."
            short &= max(len(match["first"]), len(match["third"])) < 4
        clock[chosen] = _clock(part, match)
        zone[chosen] = _offset(part, match)
        zoned |= match["zone"] is not None
    if len(dated) > 1:
        message = "some stamps have a date and some have none"
        raise FileFormatError(message, "export the log again with full stamps", path=path, line=int(lines[0]))
    return StampParts(date, clock, zone, long_first, dated == {True}, dotted, short, zoned)


def _two_numbers(cell: str, path: Path, line: np.int64) -> FileFormatError:
    message = f"found {cell!r} without a date: hours and minutes, or minutes and seconds"
    remedy = 'export the time as h:mm:ss, or write for this log in run.toml: rate = "1 Hz" or what it was'
    return FileFormatError(message, remedy, path=path, line=int(line))


def settle_order(blocks: Iterable[StampParts], wanted: str | None, path: Path, line: int) -> str:
    """Return the order of day, month and year, as the first dates that leave no choice show it.

    Parameters
    ----------
    blocks : iterable of StampParts
        The stamps of the log from its start; no more are taken than are needed.
    wanted : str, optional
        What the settings say; it counts only where the year does not stand first.
    path, line : Path, int
        File and line of the first stamp, for the message.

    Raises
    ------
    FileFormatError
        All dates can be read in more than one order.
    """
    first: tuple[int, int, int] | None = None
    possible = {"dmy", "mdy"}
    first_as_second = first_as_third = True
    for parts in blocks:
        one, two, three = parts.date
        if first is None:
            first = int(one[0]), int(two[0]), int(three[0])
            if np.all(parts.long_first):
                return "ymd"
            if wanted is not None:
                return wanted
            if parts.dotted and not (parts.short and _year_may_lead(one, three)):
                return "dmy"
            if parts.dotted:
                possible = {"dmy", "ymd"}
            if parts.short:
                possible.add("ymd")
        if np.any(one > 12):
            possible.discard("mdy")
        if np.any(one > 31):
            possible.discard("dmy")
        if np.any(two > 12):
            possible -= {"dmy", "ymd"}
        if not parts.short or np.any(three > 31):
            possible.discard("ymd")
        if len(possible) == 1:
            return possible.pop()
        first_as_second &= bool(np.all(one == two))
        first_as_third &= bool(np.all(one == three))
    alike = (first_as_second or "mdy" not in possible) and (first_as_third or "ymd" not in possible)
    if alike or not possible:  # an impossible date is named when it is read
        return "dmy" if "dmy" in possible or not possible else "mdy"
    numbers = () if first is None else first[: 3 if "ymd" in possible else 2]
    shown = "/".join([*map(str, numbers), *(["..."] if "ymd" not in possible else [])])
    words = {"dmy": "day/month", "mdy": "month/day", "ymd": "year/month/day"}
    ways = [words[order] for order in ("dmy", "mdy", "ymd") if order in possible]
    message = f"the date {shown} can be read as {' and as '.join(ways)}"
    choices = [f'"{order}"' for order in ("dmy", "mdy", "ymd") if order in possible]
    remedy = f"set date_order = {' or '.join(choices)} for this log in run.toml"
    raise FileFormatError(message, remedy, path=path, line=line)


def _year_may_lead(first: Integers, third: Integers) -> bool:
    """Return whether dates such as 26.09.05 are rather of 2026 than of 2005."""
    return bool(np.any((first > _LONG_AGO) & (third <= _LONG_AGO)))


def characters_of(cells: Sequence[str]) -> Characters:
    """Return (n, m) characters of stamps, zero behind the end of each."""
    return _characters("\n".join(cell.replace("\n", " ") for cell in cells))


def _characters(together: str) -> Characters:
    """Return (n, m) characters of stamps that are joined by line feeds."""
    if not together.isascii():
        together = together.translate(_CHINESE)
    joined = np.strings.strip(np.array(together.encode(errors="replace").split(b"\n"), dtype=bytes))
    characters: Characters = joined.view(np.uint8).reshape(joined.size, joined.itemsize)
    return characters


def _match(layout: str) -> re.Match[str] | None:
    match = _LAYOUT.fullmatch(layout)
    if match is None:
        return None
    dated, timed = match["first"] is not None, match["hour"] is not None
    return match if (dated or timed) and bool(match["gap"]) == (dated and timed) else None


def _by_layout(characters: Characters) -> Iterator[tuple[str, Integers]]:
    """Yield each layout with the rows that have it."""
    zero = np.uint8(ord("0"))
    shapes = np.where(characters - zero < 10, zero, characters)  # below "0" the difference wraps around
    whole = shapes.view(f"S{shapes.shape[1]}")[:, 0]
    remaining = np.arange(len(shapes))
    while remaining.size:
        same = whole[remaining] == whole[remaining[0]]
        yield whole[remaining[0]].decode(errors="replace"), remaining[same]
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


def _days(date: Integers, order: str, path: Path, rows: npt.NDArray[np.int64]) -> Integers:
    """Return days since 1970-01-01."""
    year, month, day = (date[place] for place in _ORDERS[order])
    year = np.where(year < 70, year + 2000, np.where(year < 100, year + 1900, year))
    months = ((year - 1970) * 12 + month - 1).astype("datetime64[M]")
    dates = months.astype("datetime64[D]") + (day - 1)
    wrong = (month < 1) | (month > 12) | (day < 1) | (dates.astype("datetime64[M]") != months)
    if np.any(wrong):
        row = int(np.argmax(wrong))
        message = f"there is no day {day[row]} of month {month[row]} when the date is read as {order}"
        remedy = "correct date_order in run.toml, or export the log again"
        raise FileFormatError(message, remedy, path=path, line=int(rows[row]))
    days: Integers = dates.astype(np.int64)
    return days
