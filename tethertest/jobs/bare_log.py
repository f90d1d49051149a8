"""The channels of a log that belongs to no run: what its own units say, and no more."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final

import numpy as np

from tethertest.conditioning.timestamps.stamp_steps import EvenRows, quantised_steps, reader_of
from tethertest.conditioning.timestamps.stamps import irregularity
from tethertest.errors import DataError, QuantityError
from tethertest.jobs.read_bare import read_bare
from tethertest.jobs.shown_flags import SHOWN, with_shown_flags, without_codes
from tethertest.records.arrays import FloatArray, IndexArray, increases
from tethertest.records.channel import Channel, Flag, RawChannel, RawLog, Source
from tethertest.signal.noise import white_noise
from tethertest.signal.series import some_steps
from tethertest.units import Kind, UnitScale, channel_scale

#: a slower channel in a table of a faster one fills this share of its rows
EVEN: Final = 0.95
#: and one that is held between its samples changes at this share of them: two alike are no change
HELD_EVEN: Final = 0.8
_SHOWN_NAMES: Final = tuple((flag.name or "").lower() for flag in SHOWN)
#: a record of fewer samples has nothing to analyse
FEWEST_SAMPLES: Final = 16
#: a log is not used whose time goes back, or does not go on, for more than these shares of its samples
MOST_BACKWARD: Final = 0.05
MOST_REPEATED: Final = 0.5
#: spacing that varies more than this, relative, between the tenth and the ninetieth per cent is remarked on
JITTER: Final = 0.05


def bare_channels(
    path: Path, names: Sequence[str] = (), words: Sequence[str] = ()
) -> tuple[tuple[Channel, ...], tuple[str, ...]]:
    """Read a log's channels in SI, on the log's own clock.

    Parameters
    ----------
    path : Path
        The log.
    names : sequence of str
        Channels wanted; all of those that can be used where empty.
    words : sequence of str
        What the file itself leaves open, as ``KEY=VALUE``.

    Returns
    -------
    tuple
        The channels, and remarks on what was left out or could not be told.

    Raises
    ------
    TethertestError
        The log cannot be read, has no such channel, or a channel asked for cannot be used.
    """
    log = read_bare(path, words)
    known = {channel.name: channel for channel in log.channels}
    for name in names:
        if name not in known:
            message = f"there is no channel {name!r}; the log has {', '.join(known)}"
            raise DataError(message, "give --channel one of these names", path=path)
    channels: list[Channel] = []
    remarks, remedies = list(log.remarks), []
    for name in names or known:
        try:
            channel, said = si_channel(known[name], log)
            rows, used = known[name].time.size, channel.time.size
            if used < FEWEST_SAMPLES <= rows:
                message = f"channel {name!r}: the time goes forward in {used} of {rows} rows only"
                raise DataError(message, "export the log again sorted by time, the oldest row first")
            _refuse_backward(known[name])
            check_usable(channel)
        except DataError as error:
            if names:
                raise error.located(path) from error
            remarks.append(f"left out: {error.problem}")
            remedies.append(error.remedy)
            continue
        channels.append(channel)
        remarks += said
    if not channels:
        message = f"none of its {len(known)} channels can be analysed: {'; '.join(remarks) or 'it has none'}"
        remedy = (*remedies, "export the log again, with numbers in its columns")[0]
        raise DataError(message, remedy, path=path)
    flagged, said = with_shown_flags(channels)
    remarks += said + [text for channel in flagged if (text := _left_out(channel))]
    # noise is that of the samples that are used
    quiet = [replace(channel, noise=white_noise(_used(channel))) for channel in flagged]
    return tuple(quiet), tuple(remarks)


def _refuse_backward(raw: RawChannel) -> None:
    """Refuse a channel whose time goes back or stands still so often that the rest is not the record."""
    if isinstance(_forward(raw.time), slice):
        return
    time = raw.time[np.isfinite(raw.time)]
    if time.size < FEWEST_SAMPLES:
        return
    latest = np.maximum.accumulate(time)[:-1]
    back, held = (int(np.count_nonzero(told)) for told in (time[1:] < latest, time[1:] <= latest))
    if back > MOST_BACKWARD * time.size or held > MOST_REPEATED * time.size:
        first = float(latest[np.argmax(time[1:] <= latest)])
        message = (
            f"channel {raw.name!r}: the time of {held} of {time.size} samples does not go forward, "
            f"first after {first:.6g} s"
        )
        remedy = 'export each recording by itself and with its full time, or give --set rate="100 Hz"'
        raise DataError(message, remedy)


def _left_out(channel: Channel) -> str:
    """Say how many samples of a channel no analysis uses, and why."""
    counts = {name: count for name, count in channel.flag_counts().items() if name in _SHOWN_NAMES}
    if not counts:
        return ""
    words = ", ".join(f"{count} {name}" for name, count in counts.items())
    return f"channel {channel.name!r}: {words} of {channel.time.size} samples are left out"


def _used(channel: Channel) -> FloatArray:
    """Return the values of the usable samples."""
    usable = channel.usable
    return channel.values if usable.all() else channel.values[usable]


def check_usable(channel: Channel) -> None:
    """Refuse a channel that nothing can be learnt from.

    Raises
    ------
    DataError
        It has next to no samples, none that is usable, or all of them are alike.
    """
    used = _used(channel)
    name = channel.name
    if channel.time.size < FEWEST_SAMPLES:
        message = f"channel {name!r} has {channel.time.size} samples, expected at least {FEWEST_SAMPLES}"
        raise DataError(message, "take a longer record")
    if used.size < FEWEST_SAMPLES:
        message = f"channel {name!r} has {used.size} usable samples of {channel.time.size}"
        raise DataError(message, "take the channel out, or export the log again")
    if not np.any(used != used[0]):
        message = f"channel {name!r} is constant: all {used.size} samples are {used[0]:.6g} {channel.unit}"
        raise DataError(message, "check that the sensor was connected, or take the channel out")


def _forward(time: FloatArray) -> IndexArray | slice:
    """Return the rows whose time goes forward."""
    if np.isfinite(time).all() and increases(time):
        return slice(None)
    finite = np.flatnonzero(np.isfinite(time))
    latest = np.maximum.accumulate(time[finite]) if finite.size else np.empty(0)
    forward = np.ones(finite.size, dtype=bool)
    forward[1:] = time[finite][1:] > latest[:-1]
    return finite[forward]


def _slower(values: FloatArray) -> slice | None:
    """Return the rows that hold values, if all do that stand at even steps and no others."""
    finite = np.isfinite(values)
    if finite.all():
        return None
    known = np.flatnonzero(finite)
    if known.size < FEWEST_SAMPLES:
        return None
    step = round(float(known[-1] - known[0]) / (known.size - 1))
    if step < 2 or np.any(np.diff(known) % step) or np.mean(np.diff(known) == step) < EVEN:
        return None
    return slice(int(known[0]), int(known[-1]) + 1, step)


def _held(values: FloatArray) -> slice | None:
    """Return the rows at which values change, if nearly all do at even steps and none in between."""
    changed = values[1:] != values[:-1]
    if np.any(changed[1:] & changed[:-1]) or not np.isfinite(values).all():
        return None
    changes = np.flatnonzero(changed) + 1
    if changes.size < FEWEST_SAMPLES:
        return None
    step = int(np.median(np.diff(changes)))
    if step < 2 or np.any(np.diff(changes) % step) or np.mean(np.diff(changes) == step) < HELD_EVEN:
        return None
    return slice(int(changes[0]) % step, values.size, step)


def si_channel(raw: RawChannel, log: RawLog) -> tuple[Channel, list[str]]:
    """Return a channel in SI on the log's own clock, and remarks on what was left out or is not known.

    Parameters
    ----------
    raw : RawChannel
        A channel of the log.
    log : RawLog
        The log.
    """
    remarks: list[str] = []
    try:
        scale = channel_scale(raw.unit)
    except QuantityError as error:
        scale = UnitScale(Kind.OTHER, raw.unit, 1.0)
        remarks.append(f"channel {raw.name!r}: {error.problem}; its values stay as written")
    values, coded = without_codes(raw.values)
    remarks += [f"channel {raw.name!r}: {text}; they are left out" for text in coded]
    if (scale.factor, scale.offset) != (1.0, 0.0):
        values = values * scale.factor
        values += scale.offset
    kept = _forward(raw.time)
    count = raw.time.size - raw.time[kept].size
    if count:
        remarks.append(f"channel {raw.name!r}: {count} samples whose time does not go forward are left out")
    slower, held = _slower(values[kept]), _held(values[kept])
    if held is not None:
        text = (
            f"the values change at every {held.step} rows only, as of a slower channel that is held between"
        )
        remarks.append(f"channel {raw.name!r}: {text}; the first of each is used")
        kept = np.arange(raw.time.size)[kept][held]
    elif slower is not None:
        text = f"one row of {slower.step} holds a value, as of a slower channel in the table of a faster one"
        remarks.append(f"channel {raw.name!r}: {text}; the empty rows are no holes")
        kept = np.arange(raw.time.size)[kept][slower]
    time = raw.time[kept]
    quantised = quantised_steps(reader_of(time), time.size)
    if quantised is not None:
        even = EvenRows.of(reader_of(time), time.size, quantised.longest)
        time = np.concatenate([rows for _, _, rows in even.blocks()])
        _, words = irregularity(quantised, 0.0, 0.0, coarse=False)
        remarks.append(f"channel {raw.name!r}: {words}: its time is rebuilt from the rows")
    elif time.size > 2:
        low, usual, high = np.quantile(some_steps(time), (0.1, 0.5, 0.9))
        if high - low > JITTER * usual:
            text = f"its samples are {low:.4g} to {high:.4g} s apart; spectra take them as {usual:.4g} s"
            remarks.append(f"channel {raw.name!r}: {text}")
    flags = np.zeros(time.size, dtype=np.uint16)
    flags[~np.isfinite(values[kept])] = np.uint16(Flag.MISSING)
    source = Source(log.path.name, log.sha256, log.format, raw.unit, "log")
    channel = Channel(raw.name, scale.kind, scale.unit, time, values[kept], flags, source=source)
    return replace(channel, noise=white_noise(channel.values)), remarks
