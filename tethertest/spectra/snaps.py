"""Snaps in numbers: impact tension, rise time, impulse and the relative speed of the impact."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from statistics import NormalDist
from typing import Final

import numpy as np

from tethertest.records.arrays import FloatArray
from tethertest.records.channel import Channel
from tethertest.records.events import Snap
from tethertest.records.lines import Event, EventKind
from tethertest.spectra.waves import Medium

#: levels between which a rise is timed, as shares of the peak
RISE: Final = (0.1, 0.9)
#: the pulse ends where tension first falls below this share of its peak
PULSE_END: Final = 0.5
#: the record after the peak in which the pulse must end [s]: a snap on a tether lasts less
LONGEST_PULSE: Final = 1.0
#: a rise is resolved by this many sampling intervals
FEWEST_INTERVALS: Final = 2.0
#: half width of a 95 % interval in standard errors
COVERAGE: Final = 1.959964
#: how far a top may stand above its largest sample, as a share of the largest second difference about it: a
#: parabola asks for 1/8 at most, a wave of two samples per period for 1/4
BETWEEN: Final = 0.25
#: samples on either side of a top that tell how it bends
AROUND: Final = 2
#: samples within this many standard deviations of the largest vie with it
VYING: Final = 4.0


def measured_snaps(
    channel: Channel, events: Sequence[Event], medium: Medium | None = None
) -> tuple[Snap, ...]:
    """Measure the snaps of a tension channel.

    The front is the largest increase of tension within one round trip ``2 L/c`` between re-tightening and
    peak: a cable that is drawn taut slowly carries a little before the impact. The speed follows from
    ``dT = Z dv``: a front that starts at the sensor, where two sides meet with the relative speed dv, brings
    ``Z dv``; one that arrives at a rigid end is doubled there. One sensor cannot tell which of the two it
    saw, so both speeds are given. The closed form of a slack cable at rest, pulled at V with the slack d, is
    ``EA e (e + d) = m V^2``; ``T/Z`` is then below V by ``c d/2`` where d is small.

    Peak and front are samples. The tension may be larger between two of them, as far as the record bends
    there; and the largest of many samples as high as each other is too large by their noise. Both are in the
    intervals, which therefore are not symmetrical.

    Parameters
    ----------
    channel : Channel
        Total tension [N].
    events : sequence of Event
        What `find_events` found in it.
    medium : Medium, optional
        The cable; without it there is no speed, and the first front is the peak.

    Returns
    -------
    tuple of Snap
        In order of time.

    References
    ----------
    The closed form is held against the solver in ``tests/verification/test_exact_snap.py``.
    """
    slack = [
        event.start for event in events if event.kind == EventKind.SLACK and event.channel == channel.name
    ]
    snaps = []
    for event in events:
        if event.kind != EventKind.SNAP or event.channel != channel.name:
            continue
        following = min((start for start in slack if start > event.start), default=np.inf)
        snap = _measured(channel, event, float(following), medium)
        if snap is not None:
            snaps.append(snap)
    return tuple(snaps)


def with_snaps(channel: Channel, events: Sequence[Event], medium: Medium | None = None) -> tuple[Event, ...]:
    """Return the events of a tension channel, its snaps with their numbers; see `measured_snaps`."""
    snaps = {snap.start: snap for snap in measured_snaps(channel, events, medium)}
    return tuple(
        replace(event, snap=snaps.get(event.start)) if event.kind == EventKind.SNAP else event
        for event in events
    )


def _measured(channel: Channel, event: Event, following: float, medium: Medium | None) -> Snap | None:
    # one sample before the re-tightening and what follows, up to the next slack but past the top itself
    stop = max(min(event.stop + LONGEST_PULSE, following), event.stop + AROUND / channel.rate)
    part = channel.between(event.start - 1.0 / channel.rate, stop)
    usable = part.usable
    time, values = part.time[usable], part.values[usable]
    if time.size < 3:
        return None
    at_peak = int(np.argmin(np.abs(time - event.stop)))
    peak = event.value
    low, high = (_first_above(time, values, share * peak, at_peak) for share in RISE)
    front = peak
    speed = interval = arrived = None
    error = float(np.hypot(channel.uncertainty * peak, channel.offset_uncertainty))
    below = float(np.hypot(_vying(values, peak, channel.noise), COVERAGE * error))
    above = float(np.hypot(COVERAGE * np.hypot(error, channel.noise), _between(values, at_peak)))
    if medium is not None:
        rise = values[: at_peak + 1]
        front, top = _steepest(time[: at_peak + 1], rise, 2.0 * medium.length / medium.speed)
        speed = front / medium.impedance
        share = float(np.hypot(channel.uncertainty, medium.impedance_error)) * speed
        half = COVERAGE * float(np.hypot(share, np.sqrt(2.0) * channel.noise / medium.impedance))
        between = _between(values, top) / medium.impedance
        interval, arrived = (speed - half, speed + float(np.hypot(half, between))), 0.5 * speed
    return Snap(
        channel=channel.name,
        start=event.start,
        peak_time=event.stop,
        peak=peak,
        peak_interval=(peak - below, peak + above),
        rise_time=high - low,
        rise_resolved=bool((high - low) * channel.rate >= FEWEST_INTERVALS),
        impulse=_impulse(time, values, event.start, at_peak, peak),
        front=front,
        speed=speed,
        speed_interval=interval,
        arrived_speed=arrived,
    )


def _between(values: FloatArray, top: int) -> float:
    """Return how far the tension may rise above a sample between it and its neighbours [N]."""
    around = values[max(top - AROUND, 0) : top + AROUND + 1]
    return BETWEEN * float(np.max(np.abs(np.diff(around, 2)), initial=0.0))


def _vying(values: FloatArray, peak: float, noise: float) -> float:
    """Return what noise adds at most to the largest of the samples about as high as the peak [N]."""
    count = max(int(np.count_nonzero(values >= peak - VYING * noise)), 1)
    return noise * NormalDist().inv_cdf(NormalDist().cdf(COVERAGE) ** (1.0 / count))


def _steepest(time: FloatArray, values: FloatArray, span: float) -> tuple[float, int]:
    """Return the largest increase within a span of time [N] and its top; one sampling interval at least."""
    last = np.searchsorted(time, time + span, "right") - 1
    last = np.minimum(np.maximum(last, np.arange(time.size) + 1), time.size - 1)
    steepest = int(np.argmax(values[last] - values))
    return float(values[last[steepest]] - values[steepest]), int(last[steepest])


def _first_above(time: FloatArray, values: FloatArray, level: float, last: int) -> float:
    """Return when the tension first crosses a level on its way up, by a straight line between samples."""
    above = np.flatnonzero(values[: last + 1] >= level)
    index = int(above[0]) if above.size else last
    if index == 0 or values[index] <= values[index - 1]:
        return float(time[index])
    share = (level - values[index - 1]) / (values[index] - values[index - 1])
    return float(time[index - 1] + share * (time[index] - time[index - 1]))


def _impulse(time: FloatArray, values: FloatArray, start: float, at_peak: int, peak: float) -> float:
    """Return the impulse [N s] from re-tightening until tension first falls below half the peak."""
    below = np.flatnonzero(values[at_peak:] < PULSE_END * peak)
    last = at_peak + int(below[0]) if below.size else time.size - 1
    inside = (time >= start) & (np.arange(time.size) < last)
    moments, tension = time[inside], values[inside]
    if below.size:  # the straight line to the first sample below, cut at half the peak
        share = (PULSE_END * peak - values[last - 1]) / (values[last] - values[last - 1])
        moments = np.append(moments, time[last - 1] + share * (time[last] - time[last - 1]))
        tension = np.append(tension, PULSE_END * peak)
    if moments.size < 2:
        return 0.0
    return float(np.trapezoid(tension, moments))
