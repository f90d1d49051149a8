"""When a log started, in seconds since the date of the run file."""

from __future__ import annotations

import datetime as dt
from zoneinfo import ZoneInfo

from tethertest.errors import DataError
from tethertest.records.channel import Finding, RawLog, Severity
from tethertest.records.run import Log

#: logs of a run start this close to its date: the date is typed by hand, to the minute [s]
START_TOLERANCE = 300.0
#: clocks in another zone are off by whole hours [s], or by halves where the laboratory's own zone is; a log
#: half an hour off is one of another run
HOUR, HALF_HOUR = 3600.0, 1800.0
#: and by no more than this [s]
LARGEST_ZONE = 14 * HOUR


def start_after(raw: RawLog, entry: Log, date: dt.datetime) -> tuple[float, tuple[Finding, ...]]:
    """Return when a log started and what had to be corrected to know it.

    Parameters
    ----------
    raw : RawLog
        The log; a naive start is in the zone of its entry in the run file, else in the run date's.
    entry : Log
        Its entry in the run file.
    date : datetime
        The run's date, with its zone.

    Returns
    -------
    tuple
        Seconds since `date`, and the findings.

    Raises
    ------
    DataError
        The log started at another time than the run, and neither a swap of day and month nor another zone
        explains it: its channels never overlap with the others in time.
    """
    if raw.start is None:
        text = "the log has no date: its first sample is taken at the run's date"
        return 0.0, (Finding(entry.clock, "no_start", f"{raw.path.name}: {text}", Severity.NOTE),)
    start = _aware(raw.start, entry, date)
    seconds = (start - date).total_seconds()
    if abs(seconds) <= START_TOLERANCE:
        return seconds, ()
    swapped = _swapped(start)
    candidates = [("hours_off", start)]
    if swapped is not None and abs((swapped - date).total_seconds()) < abs(seconds):
        candidates = [("day_month_swapped", swapped), ("hours_off", swapped), *candidates]
    zone = date.utcoffset() or dt.timedelta()
    step = HALF_HOUR if zone.total_seconds() % HOUR else HOUR
    for kind, candidate in candidates:
        off = (candidate - date).total_seconds()
        shift = 0.0 if kind == "day_month_swapped" else step * round(off / step)
        if abs(off - shift) <= START_TOLERANCE and abs(shift) <= LARGEST_ZONE:
            return off - shift, _findings(raw, entry, start, candidate, shift)
    message = (
        f"the log starts at {raw.start.isoformat(' ')}, the run at {date.isoformat(' ')}: its channels never "
        "overlap in time with the run's"
    )
    remedy = "correct date in run.toml, or date_order or time_zone of the log, or use the log of this run"
    raise DataError(message, remedy, path=raw.path)


def _aware(start: dt.datetime, entry: Log, date: dt.datetime) -> dt.datetime:
    if start.tzinfo is not None:
        return start
    zone = ZoneInfo(entry.time_zone) if entry.time_zone else date.tzinfo
    return start.replace(tzinfo=zone)


def _swapped(start: dt.datetime) -> dt.datetime | None:
    if start.day > 12 or start.day == start.month:
        return None
    return start.replace(month=start.day, day=start.month)


def _findings(
    raw: RawLog, entry: Log, start: dt.datetime, used: dt.datetime, shift: float
) -> tuple[Finding, ...]:
    found: list[Finding] = []
    if used != start:
        text = (
            f"{raw.path.name}: starts on {start.date().isoformat()}, which is the run's date with day and "
            f"month swapped; read as {used.date().isoformat()}"
        )
        found.append(Finding(entry.clock, "day_month_swapped", text))
    if shift:
        text = f"{raw.path.name}: starts {shift / HOUR:+g} h from the run's date; shifted back"
        found.append(Finding(entry.clock, "hours_off", text))
    return tuple(found)
