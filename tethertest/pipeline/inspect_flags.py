"""Flags that a log shows by itself, by the functions that condition a run; a range needs a rig."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np

from tethertest.conditioning.logged import with_same_times
from tethertest.conditioning.plateaus import with_plateaus_flagged
from tethertest.conditioning.spikes import with_spikes_flagged
from tethertest.pipeline.bare_log import FEWEST_SAMPLES, si_channel
from tethertest.records.arrays import BoolArray, FloatArray
from tethertest.records.channel import Channel, Flag, RawLog

#: flags that only the values themselves show
_SHOWN: Final = (Flag.STUCK, Flag.SATURATED, Flag.SPIKE)
#: squares of larger numbers cannot be added
LARGEST: Final = 1e100
#: a channel that mostly repeats itself is a state or a slow reading, not a signal at its limit
HELD: Final = 0.5
#: where more than this share of the values only repeats the one before, digits are coarse and a slow signal
#: stands still rightly
COARSE: Final = 0.1
#: there, what was stuck leaves its value by a leap of so many usual steps, or stays so many times longer than
#: any run that is taken for the signal's own
LEAP, LONGER = 5.0, 5.0
#: numbers that loggers write where they have no value; they count as such only far from all others
CODES: Final = (-99.0, -999.0, -9999.0, -99999.0, 99.0, 999.0, 9999.0, 99999.0)
#: so far, in ranges of the other values
CODE_RANGES: Final = 10.0


def shown_flags(log: RawLog) -> tuple[dict[str, dict[str, int]], list[str]]:
    """Count what is stuck, at a limit or a spike in each channel, and say what a person should look at.

    Parameters
    ----------
    log : RawLog
        As read.

    Returns
    -------
    flags : dict
        Channel -> lower-case name of a flag -> samples; zeros too, where it was looked for.
    remarks : list of str
        On channels that are constant, that seldom change, or that hold a number which stands for no value.
    """
    flags: dict[str, dict[str, int]] = {}
    remarks: list[str] = []
    for group in with_same_times(log.channels, lambda channel: channel.time):
        varied: list[Channel] = []
        for raw in group:
            values = raw.values[np.isfinite(raw.values)]
            if values.size < FEWEST_SAMPLES:
                continue
            if not np.any(values != values[0]):
                flags[raw.name] = {"stuck": int(values.size), "saturated": 0, "spike": 0}
                remarks.append(f"channel {raw.name!r}: constant, all values are {values[0]:.6g}")
                continue
            if float(np.max(np.abs(values))) > LARGEST:
                text = "values beyond 1e100, which no sensor gives; it is not looked at for flags"
                remarks.append(f"channel {raw.name!r}: {text}")
                continue
            remarks += [f"channel {raw.name!r}: {text}" for text in _codes(values)]
            known = np.where(np.isfinite(raw.values), raw.values, np.nan)
            channel = si_channel(replace(raw, values=known), log)[0]
            if channel.time.size >= FEWEST_SAMPLES and np.isfinite(channel.values).any():
                varied.append(with_plateaus_flagged(channel))
        for channel in with_spikes_flagged(varied):
            marked = {flag: (channel.flags & np.uint16(flag)) != 0 for flag in _SHOWN}
            if np.mean(marked[Flag.STUCK] | marked[Flag.SATURATED]) > HELD:
                changes = int(np.count_nonzero(np.diff(channel.values[np.isfinite(channel.values)])))
                marked[Flag.STUCK][:] = marked[Flag.SATURATED][:] = False
                text = f"changes only {changes} times: a state or a slow reading, or it was stuck"
                remarks.append(f"channel {channel.name!r}: {text}")
            else:
                marked[Flag.STUCK] = _truly_stuck(channel.values, marked[Flag.STUCK])
            flags[channel.name] = {
                _name(flag): int(np.count_nonzero(where)) for flag, where in marked.items()
            }
    return flags, remarks


def _truly_stuck(values: FloatArray, stuck: BoolArray) -> BoolArray:
    """Return the stuck runs that coarse digits do not explain."""
    step = np.abs(np.diff(values))
    own = ~(stuck[1:] & stuck[:-1])
    if not np.any(step > 0.0) or not np.mean(step[own] == 0.0) > COARSE:
        return stuck
    edges = np.flatnonzero(np.diff(np.concatenate(([False], stuck, [False])).astype(int)))
    usual = float(np.median(step[step > 0.0]))
    ends = np.flatnonzero(~((step == 0.0) & own))
    longest = int(np.max(np.diff(np.concatenate(([-1], ends, [step.size])))))
    kept = np.zeros(stuck.size, dtype=bool)
    for start, stop in zip(edges[::2], edges[1::2], strict=True):
        leap = stop < values.size and step[stop - 1] > LEAP * usual
        kept[start:stop] = leap or stop - start > LONGER * longest
    return kept


def _name(flag: Flag) -> str:
    return (flag.name or "").lower()


def _codes(values: FloatArray) -> list[str]:
    """Return a remark for each number that can only stand for no value."""
    found = []
    for code in CODES:
        marked = values == code
        count = int(np.count_nonzero(marked))
        rest = values[~marked]
        if not count or not rest.size:
            continue
        low, high = float(rest.min()), float(rest.max())
        away = max(low - code, code - high)
        if away > CODE_RANGES * max(high - low, abs(low), abs(high)):
            text = f"{count} values are {code:g}, and all others {low:.4g} to {high:.4g}: a code for no value"
            found.append(f"{text}? Export them as empty cells")
    return found
