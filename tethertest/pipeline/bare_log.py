"""The channels of a log that belongs to no run: what its own units say, and no more."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final

import numpy as np

from tethertest.errors import DataError, QuantityError
from tethertest.pipeline.read_bare import read_bare
from tethertest.records.channel import Channel, Flag, RawChannel, RawLog, Source
from tethertest.signal.noise import white_noise
from tethertest.units import UnitScale, channel_scale

#: a record of fewer samples has nothing to analyse
FEWEST_SAMPLES: Final = 16
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
    remarks = list(log.remarks)
    for name in names or known:
        try:
            channel, said = si_channel(known[name], log)
            check_usable(channel)
        except DataError as error:
            if names:
                raise error.located(path) from error
            remarks.append(f"left out: {error.problem}")
            continue
        channels.append(channel)
        remarks += said
    if not channels:
        message = f"none of its {len(known)} channels can be analysed: {'; '.join(remarks) or 'it has none'}"
        raise DataError(message, "export the log again, with numbers in its columns", path=path)
    return tuple(channels), tuple(remarks)


def check_usable(channel: Channel) -> None:
    """Refuse a channel that nothing can be learnt from.

    Raises
    ------
    DataError
        It has next to no samples, none that is usable, or all of them are alike.
    """
    used = channel.values[channel.usable]
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
        scale = UnitScale("other", raw.unit, 1.0)
        remarks.append(f"channel {raw.name!r}: {error.problem}; its values stay as written")
    values = raw.values * scale.factor + scale.offset
    finite = np.flatnonzero(np.isfinite(raw.time))
    latest = np.maximum.accumulate(raw.time[finite]) if finite.size else np.empty(0)
    forward = np.ones(finite.size, dtype=bool)
    forward[1:] = raw.time[finite][1:] > latest[:-1]
    kept = finite[forward]
    if kept.size < raw.time.size:
        count = raw.time.size - kept.size
        remarks.append(f"channel {raw.name!r}: {count} samples whose time does not go forward are left out")
    time = raw.time[kept]
    steps = np.diff(time)
    if steps.size > 1:
        low, usual, high = np.quantile(steps, (0.1, 0.5, 0.9))
        if high - low > JITTER * usual:
            text = f"its samples are {low:.4g} to {high:.4g} s apart; spectra take them as {usual:.4g} s"
            remarks.append(f"channel {raw.name!r}: {text}")
    flags = np.where(np.isfinite(values[kept]), Flag.NONE, Flag.MISSING).astype(np.uint16)
    source = Source(log.path.name, log.sha256, log.format, raw.unit, "log")
    channel = Channel(raw.name, scale.kind, scale.unit, time, values[kept], flags, source=source)
    return replace(channel, noise=white_noise(channel.values)), remarks
