"""What a log is: what it holds, what its stamps are like, and what its values show."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from tethertest.jobs.inspect_flags import shown_flags
from tethertest.jobs.log_entry import entry_text
from tethertest.jobs.time_bases import time_bases
from tethertest.readers.inspect import described_channels
from tethertest.records.channel import RawLog
from tethertest.records.inspected import ChannelSeen, FewStamps, LogSeen


def described(log: RawLog, settings: Mapping[str, Any] | None = None) -> LogSeen:
    """Describe a log as read: what it holds, what its stamps are like, and what its values show.

    Parameters
    ----------
    log : RawLog
        As read.
    settings : mapping, optional
        What was given to read a bare log, as TOML has it; absent for a log that run.toml has.
    """
    channels, of_units = described_channels(log)
    bases = time_bases(log)
    shown, of_values = shown_flags(log)
    base_of = {name: base for base in bases for name in base.channels}
    return LogSeen(
        path=str(log.path),
        refused=False,
        format=log.format,
        reason=log.reason,
        encoding=log.encoding,
        start=None if log.start is None else log.start.isoformat(),
        decimal=log.decimal,
        separator=log.separator,
        date_order=log.date_order,
        header_line=log.header_line,
        rate=log.rate,
        sha256=log.sha256,
        channels=tuple(_seen(channel, base_of[channel.name], shown) for channel in channels),
        time_bases=bases,
        remarks=(*log.remarks, *of_units, *of_values),
        entry=None if settings is None else entry_text(log, settings),
    )


def _seen(channel: ChannelSeen, base: FewStamps, shown: Mapping[str, dict[str, int]]) -> ChannelSeen:
    """Return a channel with what its stamps and its values show."""
    flags = {**channel.flags, **base.flags, **shown.get(channel.name, {})}
    rate = channel.rate if base.quantum is None or base.step is None else 1.0 / base.step
    return replace(channel, flags=flags, rate=rate)
