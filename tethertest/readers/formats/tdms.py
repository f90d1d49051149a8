"""NI TDMS files, through npTDMS."""

from __future__ import annotations

import datetime as dt
import io
import logging
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np

from tethertest.errors import FileFormatError
from tethertest.readers.channels import raw_channel, unique_names, with_units
from tethertest.readers.text.document import Head, file_sha256, read_bytes
from tethertest.readers.text.stamps import time_zone_of
from tethertest.records.arrays import FloatArray
from tethertest.records.channel import RawChannel, RawLog
from tethertest.records.run import Log

NAME = "tdms"
_EPOCH = np.datetime64(0, "ns")


def sniff(head: Head) -> str | None:
    """Claim files that begin with ``TDSm``."""
    return "the first bytes are 'TDSm'" if head.data.startswith(b"TDSm") else None


def read(path: Path, settings: Log | None = None) -> RawLog:
    """Read an NI TDMS file.

    Parameters
    ----------
    path : Path
        The log, plain or in gzip or zip.
    settings : Log, optional
        Settings of the run file: units, and time_zone, in which the start is then shown.

    Returns
    -------
    RawLog
        Times follow each channel's ``wf_start_time`` (UTC) and ``wf_increment``, or the group's time channel;
        rates may differ. Raw counts stay counts.

    Raises
    ------
    FileFormatError
        The file is cut or damaged, holds no data, or a channel has no time.
    """
    file = _opened(path)
    found = [channel for group in file.groups() for channel in group.channels()]
    clocks = {group.name: _time_channel(group) for group in file.groups()}
    remarks: list[str] = []
    data = []
    for channel in found:
        if channel is clocks[channel.group_name]:
            continue
        if channel.data_type is None or not _is_numeric(channel):
            remarks.append(f"channel {channel.name!r} holds no numbers and is left out")
        else:
            data.append(channel)
    if not any(len(channel) for channel in data):
        message = "the log has no data: it is empty or was cut"
        raise FileFormatError(message, "copy the whole file from the logger again", path=path)
    starts = [_start(channel, clocks[channel.group_name]) for channel in data]
    known = [start for start in starts if start is not None]
    first = min(known) if known else None
    repeated = Counter(channel.name for channel in data)
    names, renamed = unique_names(
        f"{channel.group_name}/{channel.name}" if repeated[channel.name] > 1 else channel.name
        for channel in data
    )
    channels = [
        _channel(path, channel, clocks[channel.group_name], name, start, first)
        for channel, name, start in zip(data, names, starts, strict=True)
    ]
    remarks.extend(
        f"channel {channel.name!r} has no samples" for channel in channels if not channel.values.size
    )
    rates = {1.0 / increment for channel in data if (increment := _increment(channel)) > 0}
    if len(rates) > 1:
        remarks.append(
            f"the channels have {len(rates)} rates: {', '.join(f'{rate:g} Hz' for rate in sorted(rates))}"
        )
    zone = time_zone_of(settings.time_zone if settings is not None else None, path)
    return RawLog(
        path=path,
        format=NAME,
        sha256=file_sha256(path),
        start=None if first is None else _as_datetime(first, zone),
        channels=with_units(path, channels, settings),
        rate=rates.pop() if len(rates) == 1 else None,
        remarks=(*renamed, *remarks),
    )


def _opened(path: Path) -> Any:
    from nptdms import TdmsFile
    from nptdms.log import log_manager

    # what npTDMS would print about a cut file is in our own message
    log_manager.set_level(logging.CRITICAL)
    data = read_bytes(path)
    try:
        file = TdmsFile.read(io.BytesIO(data))
    except Exception as error:  # npTDMS lets errors of struct and of its own parser through
        message = f"the TDMS file is damaged or cut ({error})"
        raise FileFormatError(message, "copy the whole file from the logger again", path=path) from error
    status = file.file_status
    if status is not None and status.incomplete_final_segment:
        message = "the TDMS file is cut: its last segment is incomplete"
        raise FileFormatError(message, "copy the whole file from the logger again", path=path)
    return file


def _is_numeric(channel: Any) -> bool:
    return np.issubdtype(channel.dtype, np.number) and not np.issubdtype(channel.dtype, np.complexfloating)


def _time_channel(group: Any) -> Any | None:
    """Return the group's channel of stamps or seconds, if its other channels are no waveforms."""
    if any(_increment(channel) > 0 for channel in group.channels()):
        return None
    stamped = [channel for channel in group.channels() if channel.dtype.kind == "M"]
    named = [
        channel
        for channel in group.channels()
        if _is_numeric(channel) and channel.name.strip().lower() in {"time", "t", "timestamp", "x_value"}
    ]
    return next(iter([*stamped, *named]), None)


def _increment(channel: Any) -> float:
    return float(channel.properties.get("wf_increment", 0.0))


def _start(channel: Any, clock: Any | None) -> np.datetime64 | None:
    """Return the channel's first instant, UTC."""
    if clock is not None:
        stamped = clock.dtype.kind == "M" and len(clock) > 0
        return clock[0].astype("datetime64[ns]") if stamped else None
    stamp = channel.properties.get("wf_start_time")
    if stamp is None:
        return None
    stamp = np.datetime64(stamp).astype("datetime64[ns]")
    # a waveform without a clock has LabVIEW's zero, 1904
    return stamp if stamp > _EPOCH else None


def _channel(
    path: Path,
    channel: Any,
    clock: Any | None,
    name: str,
    start: np.datetime64 | None,
    first: np.datetime64 | None,
) -> RawChannel:
    values = np.asarray(channel[:], dtype=np.float64)
    unit = str(channel.properties.get("unit_string", "")).strip()
    return raw_channel(name, unit, _time(path, channel, clock, len(values), start, first), values)


def _time(
    path: Path,
    channel: Any,
    clock: Any | None,
    count: int,
    start: np.datetime64 | None,
    first: np.datetime64 | None,
) -> FloatArray:
    if clock is not None:
        if len(clock) != count:
            message = (
                f"channel {channel.name!r} has {count} samples, its time {clock.name!r} has {len(clock)}"
            )
            raise FileFormatError(message, "export the log again", path=path)
        ticks = clock[:]
        if clock.dtype.kind != "M":
            return np.asarray(ticks, dtype=np.float64)
        seconds: FloatArray = (ticks - ticks[:1]) / np.timedelta64(1, "s")
        return seconds
    increment = _increment(channel)
    if increment <= 0 and count:
        message = f"channel {channel.name!r} has neither wf_increment nor a time channel"
        raise FileFormatError(message, "log it as a waveform, or export it with a time channel", path=path)
    shift = 0.0 if start is None or first is None else float((start - first) / np.timedelta64(1, "s"))
    offset = shift + float(channel.properties.get("wf_start_offset", 0.0))
    time: FloatArray = offset + increment * np.arange(count, dtype=np.float64)
    return time


def _as_datetime(instant: np.datetime64, zone: dt.tzinfo | None) -> dt.datetime:
    microseconds = int(instant.astype("datetime64[us]").astype(np.int64))
    start = dt.datetime(1970, 1, 1, tzinfo=dt.UTC) + dt.timedelta(microseconds=microseconds)
    return start if zone is None else start.astimezone(zone)
