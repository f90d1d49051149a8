"""What columns of time are called, and what their numbers count."""

from __future__ import annotations

import datetime as dt
import re
from dataclasses import dataclass
from typing import Final

_NAMES: Final = frozenset([
    "time", "timestamp", "time stamp", "datetime", "date time", "date", "x_value", "elapsed",
    "elapsed time", "relative time", "epoch", "unix", "unix time", "seconds", "secs", "sec", "zeit",
    "temps", "tiempo", "tempo", "时间", "采样时间", "时刻",
])  # fmt: skip
_NAME_WITH_UNIT = re.compile(
    r"(?:time|t|elapsed|timestamp|epoch|(?:.*[_. ])?(?:stamp|tv))[_ /.](s|secs?|seconds|ms|msec|us|min|h)",
    re.IGNORECASE,
)
#: names that are a unit of time written out
_UNIT_AS_NAME: Final = {
    "millis": "ms", "milliseconds": "ms", "micros": "us", "microseconds": "us",
    "nanos": "ns", "nanoseconds": "ns",
}  # fmt: skip
#: a column of fractions of a second beside stamps or seconds: ``ms``, ``header.stamp.nsecs``, ``fraction``
_SUBSECOND = re.compile(
    r"(ms|us|µs|ns|毫秒|(?:.*(?:time|stamp|date|tv)[_. ])?(?:m|u|n|milli|micro|nano)(?:s|secs?|seconds?)"
    r"|(?:sec(?:ond)?s?[_. ]?)?frac(?:tion)?(?:al)?(?:[_. ]?s(?:ec(?:ond)?s?)?)?|sub[_. ]?sec(?:ond)?s?)",
    re.IGNORECASE,
)
_PARTS: Final = {"m": "ms", "毫": "ms", "u": "us", "µ": "us", "n": "ns"}
#: unit of a counter of time, in lower case -> seconds
SECONDS: Final = {
    "s": 1.0, "sec": 1.0, "second": 1.0, "seconds": 1.0, "秒": 1.0, "ms": 1e-3, "msec": 1e-3, "毫秒": 1e-3,
    "us": 1e-6, "usec": 1e-6, "µs": 1e-6, "μs": 1e-6, "ns": 1e-9,
    "min": 60.0, "分": 60.0, "h": 3600.0, "hr": 3600.0, "d": 86400.0, "day": 86400.0, "days": 86400.0,
}  # fmt: skip
#: unit of a counter of days, only ever as the run file or an attribute says it -> days from its zero to 1970
#: (MATLAB counts from the year 0; Excel from 1900, with a 29 February 1900 that was none, or from 1904)
CALENDARS: Final = {"datenum": 719_529, "excel": 25_569, "excel-1904": 24_107}
#: times of day as spreadsheets hold them: parts of a day
CLOCK_UNIT: Final = "time of day"
SECONDS_PER_DAY: Final = 86_400.0
#: seconds since 1970 of the years 1979 to 2065; other counters are told by their size in this unit
_EPOCH: Final = (3e8, 3e9)
#: a LabVIEW counter of seconds starts in 1904, this many seconds before 1970
_LABVIEW_EPOCH: Final = 2_082_844_800


@dataclass(frozen=True, slots=True)
class Facts:
    """What a file says beside its table."""

    step: float | None = None  #: [s] between samples
    source: str = ""  #: what says the step, as the file writes it
    time_unit: str = ""


#: of a file that says nothing beside its table
NO_FACTS: Final = Facts()


def is_time_name(name: str, unit: str) -> bool:
    """Return whether a column's name says that it is the time; a T may be a temperature."""
    letter = (name == "t" and not unit) or (name in {"t", "T"} and unit.lower() in SECONDS)
    return letter or name.lower() in _NAMES or _NAME_WITH_UNIT.fullmatch(name) is not None


def unit_in_name(name: str) -> str:
    """Return the unit in a name such as ``time_ms`` or ``millis``, in lower case, or ""."""
    plain = name.strip().lower()
    if match := _NAME_WITH_UNIT.fullmatch(plain):
        return match[1].replace("secs", "s")
    return plain if plain in SECONDS else _UNIT_AS_NAME.get(plain, "")


def subsecond_unit(name: str, unit: str) -> str:
    """Return the unit of a column that is called like a fraction of a second: s, ms, us or ns; or ""."""
    plain = name.strip().lower()
    if _SUBSECOND.fullmatch(plain) is None or (unit and unit.strip().lower() not in SECONDS):
        return ""
    last = re.split(r"[_. ]", plain)[-1]
    of_name = "" if "frac" in plain or "sub" in plain else _PARTS[last[0]]
    return unit.strip().lower() or of_name or "s"


def is_time_unit(unit: str) -> bool:
    """Return whether a column of time may have this unit."""
    return unit.strip().lower() in SECONDS or unit.strip().lower() in CALENDARS


def epoch_start(first: float, unit: str) -> tuple[dt.datetime, float, str] | None:
    """Recognise a counter since 1970 or 1904 by its size.

    Parameters
    ----------
    first : float
        The counter's first value.
    unit : str
        Its unit as written, "" if there is none.

    Returns
    -------
    tuple or None
        The first instant in UTC, seconds per count, and a remark; None for a counter that starts anywhere.
    """
    written = SECONDS.get(unit.lower())
    for name in ("s", "ms", "us", "ns"):
        factor = SECONDS[name]
        if written not in {None, factor}:
            continue
        seconds = first * factor
        zero = _LABVIEW_EPOCH if name == "s" and seconds >= _EPOCH[1] else 0
        if _EPOCH[0] <= seconds - zero < _EPOCH[1]:
            start = dt.datetime(1970, 1, 1, tzinfo=dt.UTC) + dt.timedelta(seconds=seconds - zero)
            return start, factor, f"the time counts {name} since {1904 if zero else 1970}, UTC"
    return None


def calendar_start(first: float, unit: str) -> dt.datetime | None:
    """Return the instant of a count of days in one of `CALENDARS`, without a zone; None for another unit.

    Raises
    ------
    OverflowError
        The count is of no year that a date can have.
    """
    zero = CALENDARS.get(unit.strip().lower())
    if zero is None:
        return None
    microseconds = round((first - zero) * SECONDS_PER_DAY * 1e6)
    return dt.datetime(1970, 1, 1) + dt.timedelta(microseconds=microseconds)
