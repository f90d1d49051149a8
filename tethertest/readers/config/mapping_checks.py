"""What must hold between the keys of a log that say where its table, columns and time are."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator

from tethertest.readers.config.problems import Problem
from tethertest.readers.tables.time_units import CALENDARS, is_time_unit
from tethertest.records.run import Log

_CONTROL = re.compile(r"[\x00-\x1f\x7f]")


def mapping_problems(key: tuple[str | int, ...], log: Log) -> Iterator[Problem]:
    """Yield what is wrong in `table`, `columns`, `time` and `rate`, before the file is opened."""
    for name, value in (("table", log.table), ("time", log.time)):
        if value is not None and not value.strip():
            yield Problem((*key, name), "found an empty name", f"remove {name}, or name what the file has")
    if log.time is not None and log.rate is not None:
        text = "found rate beside time, expected one of them"
        yield Problem((*key, "rate"), text, "remove rate if the log has a time, else remove time")
    for index, name in enumerate(log.columns):
        if not name.strip() or _CONTROL.search(name):
            text = f"found {name!r}, expected the name of a column on one line"
            yield Problem((*key, "columns", index), text, "give every column a name, also those not used")
    for name, count in Counter(log.columns).items():
        if count > 1:
            text = f"found {name!r} {count} times"
            yield Problem((*key, "columns"), text, "give every column a name of its own")
    if log.time is not None and log.time in log.channels:
        text = f"found {log.time!r}, which is the time"
        yield Problem((*key, "channels", log.time), text, "give sensors to the other columns")
    for name, unit in log.units.items():
        if unit.strip().lower() in CALENDARS and log.time not in {None, name}:
            text = f"found {unit!r}, which counts the days of a calendar, on a column that is not the time"
            yield Problem((*key, "units", name), text, f"the time of this log is {log.time!r}")
    time_unit = log.units.get(log.time or "")
    if time_unit is not None and not is_time_unit(time_unit):
        text = f"found {time_unit!r}, expected a unit of time"
        calendars = " or ".join(CALENDARS)
        yield Problem((*key, "units", log.time or ""), text, f"use s, ms, us, ns, min, h, {calendars}")
