"""What a log is that is too long to be held at once: described part by part, and put together."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from typing import Any, Final

import numpy as np

from tethertest.jobs.describe_log import described
from tethertest.jobs.log_entry import entry_text
from tethertest.jobs.time_bases import seconds_text, time_bases
from tethertest.records.channel import RawChannel, RawLog
from tethertest.records.inspected import ChannelSeen, FewStamps, LogSeen, TimeBase

#: rows of a part; a dozen columns of them are what `MEMORY` allows
ROWS: Final = 1 << 21
#: what `shown_flags` says of a channel whose values are all one
_CONSTANT: Final = re.compile(r"^channel '.*': constant, ")


def described_in_parts(parts: Iterable[RawLog], settings: Mapping[str, Any] | None = None) -> LogSeen:
    """Describe a log as `described` does.

    Parameters
    ----------
    parts : iterable of RawLog
        The log in consecutive parts with the same channels.
    settings : mapping, optional
        As for `described`.
    """
    whole: LogSeen | None = None
    count, before, entry = 0, None, None
    for part in parts:
        found = _without_constants(described(part))
        if before is not None:
            # the step from one part into the next belongs to the next
            found = replace(found, time_bases=time_bases(_behind(before, part)))
        whole = found if whole is None else _joined(whole, found)
        if not count and settings is not None:
            entry = entry_text(part, settings)
        before, count = _last_rows(part), count + 1
    if whole is None:
        raise AssertionError  # a reader refuses a log without rows
    text = f"looked at in {count} parts: what reaches from one into the next is told by each of them"
    if count > 1:
        whole = replace(whole, remarks=(*_once(whole.remarks), text))
    return _with_constants(replace(whole, entry=entry))


def _last_rows(part: RawLog) -> dict[str, RawChannel]:
    return {
        channel.name: replace(channel, time=channel.time[-1:].copy(), values=channel.values[-1:].copy())
        for channel in part.channels
    }


def _behind(before: Mapping[str, RawChannel], part: RawLog) -> RawLog:
    """Return the stamps of a part behind the last row of the part before it."""
    times: dict[int, np.ndarray] = {}
    for channel in part.channels:
        if id(channel.time) not in times:
            times[id(channel.time)] = np.concatenate((before[channel.name].time, channel.time))
    channels = (
        replace(channel, time=times[id(channel.time)], values=times[id(channel.time)], flags=None)
        for channel in part.channels
    )
    return replace(part, channels=tuple(channels))


def _joined(one: LogSeen, other: LogSeen) -> LogSeen:
    """Return what two consecutive parts are together; the other's stamps begin with the one's last."""
    return replace(
        one,
        channels=tuple(_channel(*both) for both in zip(one.channels, other.channels, strict=True)),
        time_bases=tuple(_base(*both) for both in zip(one.time_bases, other.time_bases, strict=True)),
        remarks=(*one.remarks, *other.remarks),
        encoding=other.encoding,
    )


def _channel(one: ChannelSeen, other: ChannelSeen) -> ChannelSeen:
    known = [seen.n - seen.flags["missing"] for seen in (one, other)]
    lows, highs = ([x for x in pair if x is not None] for pair in _pairs(one, other, "minimum", "maximum"))
    total = sum(count * (seen.mean or 0.0) for count, seen in zip(known, (one, other), strict=True))
    return replace(
        one,
        n=one.n + other.n,
        rate=other.rate if one.rate is None else one.rate,
        minimum=min(lows, default=None),
        mean=total / sum(known) if sum(known) else None,
        maximum=max(highs, default=None),
        flags=_added(one.flags, other.flags),
    )


def _pairs(one: ChannelSeen, other: ChannelSeen, *names: str) -> Iterator[tuple[Any, Any]]:
    for name in names:
        yield getattr(one, name), getattr(other, name)


def _added(one: Mapping[str, int], other: Mapping[str, int]) -> dict[str, int]:
    return {name: one.get(name, 0) + other.get(name, 0) for name in (*one, *(set(other) - set(one)))}


def _base(one: FewStamps, other: FewStamps) -> FewStamps:
    if not isinstance(one, TimeBase) or not isinstance(other, TimeBase):
        return other if isinstance(other, TimeBase) else one
    first, last = min(one.first or 0.0, other.first or 0.0), max(one.last or 0.0, other.last or 0.0)
    rows = one.n + other.n - 1
    stamps = rows - one.flags["missing_time"] - other.flags["missing_time"]
    joined = replace(
        one,
        n=rows,
        first=first,
        last=last,
        quantum=one.quantum if other.quantum is not None else None,
        uneven=one.uneven + other.uneven,
        flags=_added(one.flags, other.flags),
        shortest_step=min(one.shortest_step, other.shortest_step),
        longest_step=max(one.longest_step, other.longest_step),
        mean_rate=(stamps - 1) / (last - first) if last > first else None,
        jitter=float(np.sqrt((one.n * one.jitter**2 + other.n * other.jitter**2) / (one.n + other.n))),
    )
    return replace(joined, text=_sentence(joined))


def _sentence(base: TimeBase) -> str:
    every = "none later than the one before" if base.step is None else f"every {seconds_text(base.step)}"
    said = [f"{base.n} stamps from {base.first:.6g} to {base.last:.6g} s, {every}"]
    if base.quantum is not None:
        said.append(f"stamps cut to {seconds_text(base.quantum)}")
    words = {"gap": "gaps", "duplicate_time": "repeated", "backward_time": "steps backward"}
    words["missing_time"] = "rows without a stamp"
    said += [f"{base.flags[name]} {text}" for name, text in words.items() if base.flags[name]]
    if base.uneven:
        shortest, longest = seconds_text(base.shortest_step), seconds_text(base.longest_step)
        said.append(f"{base.uneven} uneven steps, from {shortest} to {longest}")
    return "; ".join(said) if len(said) > 1 else f"{said[0]}, even"


def _without_constants(part: LogSeen) -> LogSeen:
    """Return a part without what is said of channels that stand still in it: elsewhere they may move."""
    channels = [
        replace(seen, flags={**seen.flags, "stuck": 0}) if _constant(seen) and "stuck" in seen.flags else seen
        for seen in part.channels
    ]
    remarks = tuple(text for text in part.remarks if not _CONSTANT.match(text))
    return replace(part, channels=tuple(channels), remarks=remarks)


def _with_constants(whole: LogSeen) -> LogSeen:
    """Return a log with its durations, and what is to be said of channels that never move."""
    base_of = {name: base for base in whole.time_bases for name in base.channels}
    channels, remarks = [], []
    for seen in whole.channels:
        base = base_of[seen.name]
        length = 0.0 if base.first is None or base.last is None else base.last - base.first
        changed = replace(seen, duration=length, flags={**seen.flags, **base.flags})
        if _constant(seen) and "stuck" in seen.flags:
            changed.flags["stuck"] = seen.n - seen.flags["missing"]
            remarks.append(f"channel {seen.name!r}: constant, all values are {seen.minimum:.6g} {seen.unit}")
        channels.append(changed)
    return replace(whole, channels=tuple(channels), remarks=(*whole.remarks, *remarks))


def _constant(seen: ChannelSeen) -> bool:
    return seen.minimum is not None and seen.minimum == seen.maximum


def _once(remarks: Iterable[str]) -> Iterator[str]:
    """Yield the first of remarks that differ by their numbers only, and how many more there are."""
    alike: dict[str, list[str]] = {}
    for text in remarks:
        alike.setdefault(re.sub(r"[\d.e+-]+", "0", text), []).append(text)
    for texts in alike.values():
        more = len(texts) - 1
        yield texts[0] + (f" (and in {more} more parts)" if more and len(set(texts)) > 1 else "")
