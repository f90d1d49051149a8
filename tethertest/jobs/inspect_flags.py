"""Flags that a log shows by itself, by the functions that condition a run; a range needs a rig."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from tethertest.jobs.bare_log import FEWEST_SAMPLES, si_channel
from tethertest.jobs.shown_flags import SHOWN, with_shown_flags, without_codes
from tethertest.records.channel import Channel, RawLog


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
    varied: list[Channel] = []
    for raw in log.channels:
        finite = np.isfinite(raw.values)
        count = int(np.count_nonzero(finite))
        if count < FEWEST_SAMPLES:
            continue
        first = float(raw.values[np.argmax(finite)])
        if not np.any((raw.values != first) & finite):
            flags[raw.name] = {"stuck": count, "saturated": 0, "spike": 0}
            remarks.append(f"channel {raw.name!r}: constant, all values are {first:.6g}")
            continue
        remarks += [f"channel {raw.name!r}: {text}" for text in without_codes(raw.values)[1]]
        known = raw.values if finite.all() else np.where(finite, raw.values, np.nan)
        channel = si_channel(replace(raw, values=known), log)[0]
        if channel.time.size >= FEWEST_SAMPLES and np.isfinite(channel.values).any():
            varied.append(channel)
    flagged, said = with_shown_flags(varied)
    for channel in flagged:
        flags[channel.name] = {
            (flag.name or "").lower(): int(np.count_nonzero(channel.flags & np.uint16(flag)))
            for flag in SHOWN
        }
    return flags, remarks + said
