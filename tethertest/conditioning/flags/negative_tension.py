"""Tensions that no cable can have: lower for long than its own weight can push on a cell."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from tethertest.records.arrays import BoolArray, FloatArray
from tethertest.records.channel import Channel, Finding, Severity
from tethertest.records.rig import Rig
from tethertest.signal.filters import filled_reader
from tethertest.signal.passes import blocks_of

#: standard uncertainty of a zero besides the channel's own: tare and drift of a cell for 100 N over a run [N]
ZERO: Final = 0.03
#: this many of those below the limit, for this long [s], cannot be an error of the zero
SIGMAS: Final = 5.0
LONGEST: Final = 0.05


def negative_tension_findings(channels: Sequence[Channel], rig: Rig) -> tuple[Finding, ...]:
    """Return a fatal finding for each tension that is too low for long: what it rests at is stated too low.

    Parameters
    ----------
    channels : sequence of Channel
        All channels of a run, tared; tensions [N] are looked at.
    rig : Rig
        Of its cable, what is above a cell may stand on it when it is slack.
    """
    weight = rig.cable.mass_per_length * rig.cable.length * rig.gravity
    found = []
    for channel in channels:
        if channel.kind != "tension" or not channel.usable.any() or channel.rate <= 0.0:
            continue
        lightest = -weight * (1.0 - (channel.at or 0.0))
        limit = SIGMAS * float(np.hypot(ZERO, channel.offset_uncertainty))
        below, middles = _below(channel, lightest - limit)
        edges = np.flatnonzero(np.diff(below, prepend=False, append=False)).reshape(-1, 2)
        spans = [(a, b) for a, b in edges.tolist() if (b - a) / channel.rate >= LONGEST]
        if not spans:
            continue
        counts = np.cumsum(below)
        lowest = min(float(np.min(middles[counts[a] - 1 : counts[b - 1]])) for a, b in spans)
        text = (
            f"down to {lowest:.3g} N in {len(spans)} spans, and a slack cable pushes with its weight at most "
            f"({lightest:.2g} N): the tension at rest (static_tension in the rig file) or the rest window is "
            f"off by {lightest - lowest:.2g} N at least"
        )
        when = tuple((float(channel.time[a]), float(channel.time[b - 1])) for a, b in spans)
        count = sum(b - a for a, b in spans)
        found.append(Finding(channel.name, "negative_tension", text, Severity.FATAL, when, count))
    return tuple(found)


def _below(channel: Channel, limit: float) -> tuple[BoolArray, FloatArray]:
    """Return where the running median lies below a limit, and the medians there."""
    read, size = filled_reader(channel), channel.time.size
    # a low-pass would ring below zero beside every snap
    length = max(round(LONGEST * channel.rate), 1)
    below, medians = np.zeros(size, dtype=bool), [np.empty(0)]
    for start, stop in blocks_of(size):
        first = max(start - length, 0)
        values = read(first, min(stop + length, size))
        if not np.any(values < limit):
            continue
        from scipy.ndimage import median_filter  # a sound run does without its import

        middle = median_filter(values, length)[start - first : stop - first]
        below[start:stop] = middle < limit
        medians.append(middle[below[start:stop]])
    return below, np.concatenate(medians)
