"""Slack intervals and the snaps that end them."""

from __future__ import annotations

from typing import Final

import numpy as np

from tethertest.errors import DataError
from tethertest.records.arrays import BoolArray, FloatArray
from tethertest.records.channel import Channel
from tethertest.records.lines import Event, EventKind
from tethertest.signal.filters import filled, low_passed
from tethertest.signal.passes import blocks_of

#: standard uncertainty of a load cell's zero where the caller knows none [N]: tare and temperature drift of a
#: cell for 100 N over a run
ZERO_UNCERTAINTY: Final = 0.03
#: tension is low-passed here before it is compared with zero [Hz]: above the rig's own motion, below mains
#: hum
CUTOFF: Final = 150.0
#: the cable counts as slack within this many standard uncertainties of zero tension
ENTER: Final = 2.0
#: and as taut again above this many; between the two the state stays as it was
LEAVE: Final = 4.0
#: share of the largest tension that a low-pass rings ahead of a snap, and that round-off of a replay stays
#: below
RINGING: Final = 2e-3
#: a slack interval lasts at least this long, and so does a taut one between two [s]: half a period of the
#: cut-off
SHORTEST: Final = 0.01
#: the snap is the largest tension within this time after re-tightening [s]
SNAP_SPAN: Final = 0.25
#: but a rise that still goes on then is followed until the tension falls below this share of its largest,
#: and by this many standard deviations of a sample: a peak has two sides
FALLEN: Final = 0.9
CLEAR: Final = 4.0


def find_events(
    channel: Channel,
    zero_uncertainty: float | None = None,
    *,
    cutoff: float = CUTOFF,
    shortest: float = SHORTEST,
    snap_span: float = SNAP_SPAN,
) -> tuple[Event, ...]:
    """Find where a tension channel is slack, and the peak after each slack interval.

    The low-passed tension enters slack within `ENTER` standard uncertainties of zero and leaves it above
    `LEAVE`; the edges are then interpolated on the side of the interval at the entering threshold. Touching
    zero for less than `shortest` is no slack.

    Parameters
    ----------
    channel : Channel
        Total tension [N], measured or replayed, over any span.
    zero_uncertainty : float, optional
        Standard uncertainty of the channel's zero [N]; the low-passed noise is added to it in quadrature.
        Where absent, `ZERO_UNCERTAINTY` and the channel's own uncertainty of a reading.
    cutoff : float
        Of the low-pass [Hz]; at most 0.4 of the channel's rate is used.
    shortest : float
        Shortest slack or taut interval [s].
    snap_span : float
        Time after re-tightening within which the peak is looked for [s]; a rise that still goes on then is
        followed to its top, up to the next slack interval.

    Returns
    -------
    tuple of Event
        In order of time. "slack": start, stop and the lowest tension of the low-passed series. "snap": start
        at the re-tightening, stop at the peak, value the largest usable sample.

    Raises
    ------
    DataError
        The channel is not a tension, or has no usable sample.
    """
    if channel.kind != "tension":
        message = f"channel {channel.name!r} holds {channel.kind}, expected tension"
        raise DataError(message, "look for slack in a load cell's channel")
    if channel.time.size < 3:
        return ()
    if zero_uncertainty is None:
        zero_uncertainty = float(np.hypot(ZERO_UNCERTAINTY, channel.offset_uncertainty))
    limit = min(cutoff, 0.4 * channel.rate)
    smooth = low_passed(filled(channel), channel.rate, limit)
    zero = float(np.hypot(zero_uncertainty, channel.noise * np.sqrt(2.0 * limit / channel.rate)))
    zero = max(zero, RINGING * max(float(np.max(smooth)), -float(np.min(smooth))))
    events: list[Event] = []
    intervals = _slack_intervals(channel.time, smooth, zero, shortest)
    for number, (start, stop) in enumerate(intervals):
        inside = (channel.time >= start) & (channel.time <= stop)
        lowest = float(smooth[inside].min()) if inside.any() else 0.0
        events.append(Event(EventKind.SLACK, channel.name, start, stop, lowest))
        following = intervals[number + 1][0] if number + 1 < len(intervals) else np.inf
        snap = _snap(channel, stop, stop + snap_span, following)
        if snap is not None:
            events.append(snap)
    return tuple(events)


def slack_intervals(events: tuple[Event, ...], channel: str) -> tuple[tuple[float, float], ...]:
    """Return the slack intervals [s] of one channel among events."""
    return tuple(
        (event.start, event.stop)
        for event in events
        if event.kind == EventKind.SLACK and event.channel == channel
    )


def _slack_intervals(
    time: FloatArray, tension: FloatArray, zero: float, shortest: float
) -> list[tuple[float, float]]:
    enter, leave = ENTER * zero, LEAVE * zero
    slack = _hysteresis(tension <= enter, tension > leave)
    edges = np.flatnonzero(np.diff(slack, prepend=False, append=False))
    merged: list[tuple[float, float]] = []
    for first, after in edges.reshape(-1, 2):
        last = int(first + np.flatnonzero(tension[first:after] <= enter)[-1])
        start = _crossing(time, tension, first - 1, int(first), enter) if first > 0 else float(time[0])
        stop = _crossing(time, tension, last + 1, last, enter) if last + 1 < time.size else float(time[-1])
        if merged and start - merged[-1][1] < shortest:
            merged[-1] = (merged[-1][0], stop)
        else:
            merged.append((start, stop))
    return [(start, stop) for start, stop in merged if stop - start >= shortest]


def _hysteresis(enters: BoolArray, leaves: BoolArray) -> BoolArray:
    """Return the state that starts where `enters` and ends where `leaves`, and stays between."""
    state = np.empty(enters.size, dtype=bool)
    before = False
    for start, stop in blocks_of(enters.size):
        entered = enters[start:stop]
        decided = np.flatnonzero(entered | leaves[start:stop])
        latest = np.searchsorted(decided, np.arange(stop - start), "right") - 1
        known = np.concatenate(([before], entered[decided]))
        state[start:stop] = known[latest + 1]
        before = bool(state[stop - 1])
    return state


def _crossing(time: FloatArray, tension: FloatArray, outside: int, inside: int, level: float) -> float:
    """Return when the straight line between two samples crosses a level."""
    rise = tension[outside] - tension[inside]
    share = (level - tension[inside]) / rise if rise > 0.0 else 0.0
    return float(time[inside] + share * (time[outside] - time[inside]))


def _snap(channel: Channel, start: float, stop: float, following: float) -> Event | None:
    first = int(np.searchsorted(channel.time, start))
    last, end = np.searchsorted(channel.time, [min(stop, following), following], "right")
    part = channel.rows(first, int(end))
    values = np.where(part.usable, part.values, np.nan)
    if not np.isfinite(values[: last - first]).any():
        return None
    peak = int(np.nanargmax(values[: last - first]))
    largest = np.fmax.accumulate(values[peak:])
    fallen = values[peak:] < np.minimum(FALLEN * largest, largest - CLEAR * channel.noise)
    top = int(np.argmax(fallen)) if fallen.any() else fallen.size
    peak += int(np.nanargmax(values[peak : peak + top]))
    return Event(EventKind.SNAP, channel.name, start, float(part.time[peak]), float(values[peak]))
