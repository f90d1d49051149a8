"""Flags that the values of a log show by themselves, by the functions that condition a run."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from tethertest.conditioning.flags.spikes import with_spikes_flagged
from tethertest.conditioning.flags.stuck_saturated import with_plateaus_flagged
from tethertest.conditioning.timestamps.logged import with_same_times
from tethertest.records.arrays import FloatArray
from tethertest.records.channel import Channel, Flag

#: flags that only the values themselves show; a range needs a rig
SHOWN: Final = (Flag.STUCK, Flag.SATURATED, Flag.SPIKE)
#: a channel that mostly repeats itself, not in one long run alone, is a state or a slow reading, not a signal
#: at its limit
HELD: Final = 0.5
#: numbers that loggers write where they have no value; they count as such only far from all others
CODES: Final = (-99.0, -999.0, -9999.0, -99999.0, 99.0, 999.0, 9999.0, 99999.0)
#: so far, in ranges of the other values
CODE_RANGES: Final = 10.0
#: larger numbers no sensor gives: instruments write 9.9e37 for an overload or no reading (SCPI-99, 7.2.1.5)
LARGEST: Final = 1e30


def with_shown_flags(channels: Sequence[Channel]) -> tuple[tuple[Channel, ...], list[str]]:
    """Flag what is stuck, at a limit or a spike.

    Parameters
    ----------
    channels : sequence of Channel
        Of one log, in SI, with some finite values that differ; clocks may.

    Returns
    -------
    channels : tuple of Channel
        In the same order.
    remarks : list of str
        On channels that seldom change: those are not flagged.
    """
    result = {id(channel): channel for channel in channels}
    remarks = []
    for group in with_same_times(channels, lambda channel: channel.time):
        level = [with_plateaus_flagged(channel) for channel in group]
        for number, channel in enumerate(level):
            flat = np.uint16(Flag.STUCK | Flag.SATURATED)
            if np.mean((channel.flags & flat) != 0) <= HELD:
                continue
            values = channel.values[np.isfinite(channel.values)]
            places = np.flatnonzero(np.diff(values))
            longest = int(np.max(np.diff(np.concatenate(([-1], places, [values.size - 1])))))
            changes = int(places.size)
            if changes < HELD * (values.size - longest):
                text = f"changes only {changes} times: a state or a slow reading, or it was stuck"
                remarks.append(f"channel {channel.name!r}: {text}")
                level[number] = group[number]
        for channel, flagged in zip(group, with_spikes_flagged(level), strict=True):
            result[id(channel)] = flagged
    return tuple(result[id(channel)] for channel in channels), remarks


def without_codes(values: FloatArray) -> tuple[FloatArray, list[str]]:
    """Return the values with NaN where a number can only stand for no value, and a text for each such number.

    Parameters
    ----------
    values : (n,) float64
        As written.
    """
    result = values
    said = []
    huge = np.isfinite(values) & ((values > LARGEST) | (values < -LARGEST))
    if huge.any():
        result = np.where(huge, np.nan, result)
        first = values[huge][0]
        said.append(
            f"{np.count_nonzero(huge)} values are beyond {LARGEST:g}, the first {first:g}: no reading"
        )
    for code in CODES:
        marked = values == code
        count = int(np.count_nonzero(marked))
        if not count:
            continue
        rest = result[np.isfinite(result) & ~marked]
        if not rest.size:
            continue
        low, high = float(rest.min()), float(rest.max())
        if max(low - code, code - high) > CODE_RANGES * max(high - low, abs(low), abs(high)):
            result = np.where(marked, np.nan, result)
            said.append(
                f"{count} values are {code:g}, and all others {low:.4g} to {high:.4g}: a code for none"
            )
    return result, said
