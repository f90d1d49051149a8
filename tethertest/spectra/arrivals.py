"""Fronts: when a wave first reaches each sensor, with an interval."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from tethertest.errors import DataError
from tethertest.records.arrays import FloatArray
from tethertest.records.channel import Channel, Window
from tethertest.records.events import Front
from tethertest.signal.filters import filled

#: a departure from what went before counts from this many of its usual sizes on
CLEAR: Final = 6.0
#: and must last this many samples, so that one bad sample is no front
LASTING: Final = 2
#: a replay is smooth to this share of its range only: interpolation and rounding
SMOOTH: Final = 1e-4
#: degree of the polynomial that continues the record past a point, and samples it rests on
DEGREE, LEAD = 2, 40
#: samples that the continuation reaches ahead
AHEAD: Final = 12
#: the onset is continued backwards from where the departure is below this share of its first maximum
EARLY: Final = 0.5
#: with fewer samples on its early part a front counts as a jump between two samples
FEWEST: Final = 3
#: samples before the first clear departure in which a soft front may hide in the noise
GUARD: Final = 4
#: samples of the lines on either side of a kink
REACH: Final = 6
#: fewest samples to look for a kink in
FEWEST_KINKS: Final = 8 * REACH
#: a kink has this many standard deviations of the other bends: one false in 1e5 records of a minute at 1 kHz
KINK: Final = 8.0
#: standard deviation of a normal variable over the median of its absolute value
DEVIATION_OF_MEDIAN: Final = 1.4826
#: a sample this close to the first clear one, as a share of it in time from the onset, says no more
LARGEST_SHARE: Final = 0.8
#: half width of a 95 % interval in standard errors
COVERAGE: Final = 1.959964


def find_front(channel: Channel, window: Window, clock_error: float = 0.0) -> Front | None:
    """Find the first front in a window: where the record leaves what its own past says.

    A polynomial through the last `LEAD` samples is continued `AHEAD` samples; the front is where the record
    departs from it. Its onset is continued backwards through the early part of the departure, as a ramp for
    the time and as a parabola for the early end of the interval; the first sample that clearly departs is the
    late end. So a wave that sets in as a jump, a ramp or a parabola is inside.

    Parameters
    ----------
    channel : Channel
        Tension or strain with its place.
    window : Window
        Where to look; the record before it, or its first `LEAD` samples, says what is usual.
    clock_error : float
        Standard uncertainty of the channel's clock [s], added to the interval.

    Returns
    -------
    Front or None
        None where nothing departs.

    Raises
    ------
    DataError
        The channel has no place, or the window too few samples.
    """
    place = _place(channel)
    lead = LEAD / channel.rate
    part = channel.between(window.start - lead, window.stop)
    if part.time.size < LEAD + AHEAD:
        message = f"channel {channel.name!r}: {part.time.size} samples to look for a front in"
        raise DataError(message, f"choose a window of at least {LEAD + AHEAD} samples")
    values, time = filled(part), part.time
    ahead = _one_ahead(values)
    sigma = _usual(ahead, channel, values)
    far = np.abs(ahead) > CLEAR * sigma
    lasting = np.convolve(far, np.ones(LASTING), "valid") == LASTING
    starts = np.flatnonzero(lasting) + LEAD
    starts = starts[time[starts] >= window.start]
    for first in starts:
        found = _onset(time, values, int(first), sigma)
        if found is not None:
            onset, early = found
            slack = COVERAGE * clock_error
            late = float(time[first]) + slack
            return Front(channel.name, place, float(onset), (float(early - slack), late))
    return None


def _one_ahead(values: FloatArray) -> FloatArray:
    """Return what each sample from `LEAD` on departs by from the continuation of those before it."""
    past = np.arange(-LEAD, 0, dtype=np.float64)
    design = np.vander(past / LEAD, DEGREE + 1, increasing=True)
    weights = np.linalg.pinv(design)[0]  # the continuation at the next sample, 0
    continued = np.convolve(values[:-1], weights[::-1], "valid")
    departure: FloatArray = values[LEAD:] - continued
    return departure


def _usual(departure: FloatArray, channel: Channel, values: FloatArray) -> float:
    """Return the usual size of a departure: noise as seen, as stated, and round-off."""
    quiet = np.abs(departure[: max(LEAD // 2, 1)])
    seen = float(np.sqrt(np.mean(quiet**2))) if quiet.size else 0.0
    return max(seen, channel.noise, SMOOTH * float(np.ptp(values)), np.finfo(np.float64).tiny)


def _onset(time: FloatArray, values: FloatArray, first: int, sigma: float) -> tuple[float, float] | None:
    """Return the onset and its early end, or None where the departure does not go on."""
    past = slice(first - LEAD, first - GUARD)
    reach = slice(first - GUARD, min(first + AHEAD, time.size))
    origin, step = time[first], (time[first] - time[first - LEAD]) / LEAD
    trend = np.polynomial.Polynomial.fit(time[past] - origin, values[past], DEGREE - 1)
    departure = values[reach] - trend(time[reach] - origin)
    departure = np.sign(departure[GUARD]) * departure
    if departure[GUARD:].max() < CLEAR * sigma:
        return None
    # the first swing only: up to where it has fallen back to half
    swing = departure[GUARD:]
    fallen = np.flatnonzero(swing < EARLY * np.maximum.accumulate(swing))
    top = GUARD + int(np.argmax(swing[: fallen[0]] if fallen.size else swing))
    unclear = np.flatnonzero(departure[:GUARD] <= CLEAR * sigma)
    begin = int(unclear[-1]) if unclear.size else 0
    rising = departure[begin + 1 : top + 1]
    early = np.flatnonzero((rising < EARLY * departure[top]) & (rising > 0.0)) + begin + 1
    moments = time[reach]
    before, latest = float(moments[begin]), float(moments[begin + 1])
    # a parabola may have begun before the last sample that is not clear: as far as that sample allows
    hidden = max(departure[begin], 0.0) + COVERAGE * sigma
    share = min(float(np.sqrt(hidden / departure[begin + 1])), LARGEST_SHARE)
    before -= step * share / (1.0 - share)
    if early.size < FEWEST:
        return 0.5 * (float(moments[begin]) + latest), before
    ramp = _crossing(moments[early], departure[early], sigma)
    bent = _crossing(moments[early], np.sqrt(departure[early]), 0.5 * sigma / np.sqrt(departure[early].min()))
    return min(max(ramp[0], bent[0] - bent[1]), latest), min(bent[0] - bent[1], ramp[0] - ramp[1], before)


def _crossing(time: FloatArray, values: FloatArray, sigma: float) -> tuple[float, float]:
    """Return where a straight line through the points meets zero, and half its 95 % interval."""
    middle = float(time.mean())
    slope, level = np.polyfit(time - middle, values, 1)
    if slope <= 0.0:
        return float(time[0]), float(time[-1] - time[0])
    left = np.sqrt(np.mean((values - level - slope * (time - middle)) ** 2))
    spread = float(np.sum((time - middle) ** 2))
    back = level / slope
    error = max(float(left), sigma) / slope * np.sqrt(1.0 / time.size + back**2 / spread)
    return middle - float(back), COVERAGE * float(error)


def find_kink(
    channel: Channel, window: Window, apart_from: Sequence[tuple[float, float]] = ()
) -> Front | None:
    """Find the sharpest kink of a record that is already moving: a wave that changes its slope.

    A transverse front reaches the tension through the curvature only, as a kink on top of the axial waves.
    The statistic is the slope of a line through the `REACH` samples after a point less that through those
    before it, less its own running median.

    Parameters
    ----------
    channel : Channel
        Tension or strain with its place.
    window : Window
        Where to look.
    apart_from : sequence of (start, stop)
        Spans [s] where fronts of other waves are due.

    Returns
    -------
    Front or None
        None where no kink stands out of the others' scatter.

    Raises
    ------
    DataError
        The channel has no place, or the window too few samples.
    """
    place = _place(channel)
    reach = REACH / channel.rate
    part = channel.between(window.start - reach, window.stop + reach)
    if part.time.size < FEWEST_KINKS:
        message = f"channel {channel.name!r}: {part.time.size} samples to look for a kink in"
        raise DataError(message, f"choose a window of at least {FEWEST_KINKS} samples")
    line = np.arange(REACH, dtype=np.float64) - 0.5 * (REACH - 1)
    weights = line / (line @ line) * part.rate
    slopes = np.correlate(filled(part), weights, "valid")
    bend = slopes[REACH - 1 :] - slopes[: 1 - REACH]  # both lines share the sample between them
    time = part.time[REACH - 1 : REACH - 1 + bend.size]
    bend = np.abs(bend - _running_median(bend, 8 * REACH))
    allowed = np.ones(time.size, dtype=bool)
    for start, stop in apart_from:
        allowed &= (time < start - reach) | (time > stop + reach)
    if np.count_nonzero(allowed) < FEWEST_KINKS // 2:
        return None
    usual = DEVIATION_OF_MEDIAN * float(np.median(bend[allowed]))
    peak = int(np.argmax(np.where(allowed, bend, -np.inf)))
    if not bend[peak] > KINK * max(usual, SMOOTH * float(np.ptp(slopes))):
        return None
    beside = np.flatnonzero(bend >= bend[peak] - CLEAR * usual)
    beside = beside[np.abs(beside - peak) < REACH]
    step = 1.0 / part.rate
    interval = (float(time[beside[0]]) - step, float(time[beside[-1]]) + step)
    return Front(channel.name, place, float(time[peak]), interval)


def _running_median(values: FloatArray, length: int) -> FloatArray:
    padded = np.pad(values, length // 2, mode="edge")
    windows = np.lib.stride_tricks.sliding_window_view(padded, 2 * (length // 2) + 1)
    return np.asarray(np.median(windows, axis=1))


def _place(channel: Channel) -> float:
    if channel.at is None:
        message = f"channel {channel.name!r} has no place on the cable"
        raise DataError(message, "give the sensor's at in the rig file")
    return channel.at
