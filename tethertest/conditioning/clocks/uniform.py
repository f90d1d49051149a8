"""A channel as uniform samples in the band in which two clocks are compared."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from tethertest.records.arrays import BoolArray, FloatArray
from tethertest.records.channel import Channel
from tethertest.signal.filters import HOLE_INTERVALS, filled, low_passed, without_line
from tethertest.signal.noise import white_noise
from tethertest.signal.spline import spline

#: noise above this says nothing about a tap of 60 ms or a UAV bouncing at 14 Hz [Hz]
LOW_PASS = 45.0
#: samples per period of the low-pass that are kept: a cubic through ten per period of the signal is exact to
#: 1e-5
THINNED = 5.5
#: samples per period of a signal's upper end that a cubic through them needs, and never fewer per second
SAMPLES_PER_PERIOD, SPARSEST = 10.0, 20.0
#: hum is followed over this time: the mains may wander by a tenth of a hertz [s]
HUM_SPAN = 1.0
#: a low-pass carries a bad sample this many periods of its cut-off far
FILTER_REACH = 1.0
#: stamps within this fraction of a step of equal spacing are taken as they are, else the values are
#: interpolated
REGULAR = 0.01
#: knots of a cubic closer than this fraction of a step are one
DISTINCT = 1e-3


@dataclass(frozen=True, slots=True, eq=False)
class Signal:
    """Uniform samples."""

    start: float  #: time of the first sample [s]
    step: float  #: [s]
    values: FloatArray  #: (n,)
    usable: BoolArray  #: (n,)
    density: float  #: of the white noise of the channel that it comes from, per hertz, two-sided
    sampled: float  #: rate at which the instrument sampled [Hz]

    @property
    def time(self) -> FloatArray:
        """(n,) [s]."""
        return np.asarray(self.start + self.step * np.arange(self.values.size), dtype=np.float64)

    @property
    def stop(self) -> float:
        """Time of the last sample [s]."""
        return self.start + self.step * (self.values.size - 1)

    def usable_at(self, time: FloatArray) -> BoolArray:
        """Return where both neighbours of a time may be used."""
        place = (time - self.start) / self.step
        inside = (place >= 0.0) & (place <= self.values.size - 1)
        below = np.clip(place.astype(np.int64), 0, max(self.values.size - 2, 0))
        return np.asarray(inside & self.usable[below] & self.usable[below + 1], dtype=bool)

    def low_passed(self, cutoff: float) -> Signal:
        """Return the signal below a frequency, thinned; samples mixed with bad ones are not usable."""
        rate = 1.0 / self.step
        usable = worn(self.usable, rate, cutoff)
        every = max(int(rate / max(SAMPLES_PER_PERIOD * cutoff, SPARSEST)), 1)
        kept = slice(None, None, every)
        values = low_passed(self.values, rate, cutoff)[kept]
        return replace(self, step=every * self.step, values=values, usable=usable[kept])

    def high_passed(self, cutoff: float) -> Signal:
        """Return the signal above a frequency."""
        return replace(self, values=self.values - low_passed(self.values, 1.0 / self.step, cutoff))


def uniform(channel: Channel, mains: float | None = None, top: float = LOW_PASS) -> Signal:
    """Return a channel below a frequency.

    Parameters
    ----------
    channel : Channel
        Any strictly increasing stamps.
    mains : float, optional
        Hum to take out [Hz].
    top : float
        The frequency [Hz].
    """
    values, usable, start, step = _regular(channel)
    density = white_noise(values) ** 2 * step
    values = values - np.median(values)
    rate = 1.0 / step
    if mains is not None and mains < 0.4 * rate:
        seconds = np.asarray(start + step * np.arange(values.size), dtype=np.float64)
        values = without_line(seconds, values, mains, HUM_SPAN)
    values = low_passed(values, rate, top)
    usable = worn(usable, rate, top)
    every = max(int(rate / (THINNED * top)), 1)
    return Signal(start, every * step, values[::every], usable[::every], density, rate)


def worn(usable: BoolArray, rate: float, cutoff: float) -> BoolArray:
    """Return the mask without the samples that a low-pass has mixed with bad ones or bent at the ends."""
    edges = np.flatnonzero(np.diff(np.concatenate(([True], usable, [True])).astype(np.int8)))
    first, last = edges[::2], edges[1::2]
    # a single bad sample is bridged well, a hole is not, and nothing is known beyond the ends
    far = round(FILTER_REACH * rate / cutoff) + 1
    reach = np.minimum(far, 3 * (last - first))
    change = np.zeros(usable.size + 1, dtype=np.int64)
    np.add.at(change, np.maximum(first - reach, 0), 1)
    np.add.at(change, np.minimum(last + reach, usable.size), -1)
    kept = np.cumsum(change[:-1]) == 0
    kept[:far] = kept[max(kept.size - far, 0) :] = False
    return np.asarray(kept, dtype=bool)


def _regular(channel: Channel) -> tuple[FloatArray, BoolArray, float, float]:
    """Return values and mask at uniform times, the first of them and their step."""
    time, usable = channel.time, channel.usable
    known = filled(channel)
    steps = np.diff(time)
    step = float(np.mean(steps[steps < HOLE_INTERVALS * np.median(steps)]))
    count = int((time[-1] - time[0]) / step + 0.5) + 1
    if count == time.size:
        step = float(time[-1] - time[0]) / (count - 1)
        if float(np.max(np.abs(time - time[0] - step * np.arange(count)))) < REGULAR * step:
            return known, usable, float(time[0]), step
    grid = time[0] + step * np.arange(count)
    grid = grid[grid <= time[-1]]
    after = np.clip(np.searchsorted(time, grid), 1, time.size - 1)
    hole = time[after] - time[after - 1] > 2.0 * step
    sound = usable[after] & usable[after - 1] & ~hole
    # straight lines across the holes, so that the cubic does not swing out there
    bridge = grid[hole]
    knots = np.concatenate((time, bridge))
    order = np.argsort(knots, kind="stable")
    knots, heights = knots[order], np.concatenate((known, np.interp(bridge, time, known)))[order]
    new = np.concatenate(([True], np.diff(knots) > DISTINCT * step))
    return spline(knots[new], heights[new])(grid), sound, float(time[0]), step
