"""Text files of the crank's encoder, in three layouts."""

from __future__ import annotations

from datetime import datetime

from .instruments import Record
from .stamps import clock_texts, moment


def write_relative(record: Record, date: datetime) -> bytes:
    """Return seconds from a start that a comment states."""
    start = moment(date, float(record.reading[0]))
    stamp = f"{start:%Y-%m-%d %H:%M:%S}.{start.microsecond // 10:05d}"
    rows = [f"# start: {stamp}", "time [s],heave [mm]"]
    since = record.reading - record.reading[0]
    rows += [f"{time:.3f},{value:.2f}" for time, value in zip(since, record.channels["heave"], strict=True)]
    return ("\n".join(rows) + "\n").encode()


def write_iso(record: Record, date: datetime, swapped: bool) -> bytes:
    """Return ISO stamps; swapped, the month stands where the day should and the day there."""
    start = moment(date, float(record.reading[0]))
    day = f"{start:%Y-%d-%m}" if swapped else f"{start:%Y-%m-%d}"
    rows = ["time,heave [mm]"]
    rows += [
        f"{day}T{stamp},{value:.2f}"
        for stamp, value in zip(clock_texts(date, record.reading), record.channels["heave"], strict=True)
    ]
    return ("\n".join(rows) + "\n").encode()


def write_split(record: Record, date: datetime) -> bytes:
    """Return a date and a time column, semicolons between."""
    start = moment(date, float(record.reading[0]))
    rows = ["date;time;heave [mm]"]
    rows += [
        f"{start:%Y-%m-%d};{stamp};{value:.2f}"
        for stamp, value in zip(clock_texts(date, record.reading), record.channels["heave"], strict=True)
    ]
    return ("\r\n".join(rows) + "\r\n").encode()
