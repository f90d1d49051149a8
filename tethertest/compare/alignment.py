"""Measured and replayed brought to the same times, the same band and the same window."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from tethertest.records.arrays import BoolArray, FloatArray
from tethertest.records.channel import Channel, Window
from tethertest.signal.filters import filled, low_passed, moving_mean

#: both signals are low-passed here [Hz]; above it the cells carry hum and noise
CUTOFF: Final = 30.0
#: of a slow channel's rate
CUTOFF_SHARE: Final = 0.4
#: peaks are read from means over this time [s]: one period of 50 Hz
PEAK_SPAN: Final = 0.020
#: white noise keeps this many times ``2 cutoff / rate`` of its variance in the low-pass of `low_passed`
NOISE_BANDWIDTH: Final = 1.04
#: a hole is long from so many periods of the cut-off, and so many sampling intervals
LONG_HOLE, LONG_INTERVALS = 0.25, 2.5
#: a long hole, and an end, spoil what lies closer, in periods of the cut-off: a hundredth of the low-pass
#: reaches farther
REACH = 1.0
#: fewer samples of a window compare nothing
FEWEST_SAMPLES: Final = 3


@dataclass(frozen=True, slots=True, eq=False)
class Pair:
    """One channel, measured and replayed, in one window and one band."""

    time: FloatArray  #: (n,) [s], measured times in the window
    usable: BoolArray  #: (n,) samples that both sides know, none within the reach of the low-pass from a hole
    measured: FloatArray  #: (n,) low-passed
    replayed: FloatArray  #: (n,) low-passed alike
    measured_peak: float  #: largest mean over 20 ms among samples that count
    replayed_peak: float
    cutoff: float  #: of the low-pass [Hz]
    noise: float  #: standard deviation of the low-passed measurement's noise
    peak_noise: float  #: standard deviation of a measured mean over 20 ms


@dataclass(frozen=True, slots=True, eq=False)
class Band:
    """A measured channel, ready to be paired with several replays of it."""

    channel: Channel
    part: slice
    cutoff: float
    usable: BoolArray  #: (n,) of the whole record, away from its ends and holes
    smooth: FloatArray  #: (m,) low-passed, in the window
    means: FloatArray  #: (m,) over 20 ms, in the window


def prepare(measured: Channel, window: Window) -> Band | None:
    """Low-pass a measured channel and cut out the window, or return None where nothing in it can be used.

    The zero-phase filter runs over the whole record, so that the window's edges are no edges of the filter.
    Gaps are bridged by straight lines for the filter; they, and what lies within its reach from them or from
    an end of the record, do not count afterwards.
    """
    first, after = np.searchsorted(measured.time, (window.start, window.stop))
    part = slice(int(first), int(after))
    if after - first < FEWEST_SAMPLES or not measured.usable[part].any():
        return None
    cutoff = min(CUTOFF, CUTOFF_SHARE * measured.rate)
    values = filled(measured)
    smooth = low_passed(values, measured.rate, cutoff)[part]
    means = moving_mean(values, _peak_samples(measured))[part]
    return Band(measured, part, cutoff, _away_from_holes(measured, cutoff), smooth, means)


def pair_with(band: Band, replayed: Channel) -> Pair | str:
    """Bring a replay to the times and the band of a measurement.

    Parameters
    ----------
    band : Band
        The measured side.
    replayed : Channel
        The replay, at any times; its flagged samples are those of which the motion is not known.

    Returns
    -------
    Pair or str
        Why there is none, where the replay does not cover the window.
    """
    measured, part = band.channel, band.part
    time = measured.time[part]
    tolerance = 1.0 / measured.rate
    if replayed.time.size == 0 or (
        replayed.time[0] > time[0] + tolerance or replayed.time[-1] < time[-1] - tolerance
    ):
        return "the replay does not cover the window"
    values, known = replayed.values, replayed.usable
    if not np.array_equal(replayed.time, measured.time):
        values = np.interp(measured.time, replayed.time, values)
        known = np.interp(measured.time, replayed.time, known.astype(np.float64)) == 1.0
    usable = (band.usable & known)[part]
    if not usable.any():
        return "nothing is known of both sides, away from holes and ends, in the window"
    kept = min(1.0, NOISE_BANDWIDTH * 2.0 * band.cutoff / measured.rate)
    means = moving_mean(values, _peak_samples(measured))[part]
    return Pair(
        time=time,
        usable=usable,
        measured=band.smooth,
        replayed=low_passed(values, measured.rate, band.cutoff)[part],
        measured_peak=float(np.max(band.means[usable])),
        replayed_peak=float(np.max(means[usable])),
        cutoff=band.cutoff,
        noise=measured.noise * float(np.sqrt(kept)),
        peak_noise=measured.noise / float(np.sqrt(_peak_samples(measured))),
    )


def _peak_samples(measured: Channel) -> int:
    return max(1, round(PEAK_SPAN * measured.rate))


def _away_from_holes(channel: Channel, cutoff: float) -> BoolArray:
    """Return the usable samples that no low-pass mixes with an end of the record or a hole.

    A hole of one sample, as a spike leaves it, is bridged well enough: only that sample drops out.
    """
    usable = channel.usable
    known = np.flatnonzero(usable)
    times = channel.time[known]
    gaps = np.flatnonzero(np.diff(times) > max(LONG_HOLE / cutoff, LONG_INTERVALS / channel.rate))
    edges = np.concatenate(([times[0]], times[gaps], times[gaps + 1], [times[-1]]))
    for edge in edges:
        first, last = np.searchsorted(channel.time, (edge - REACH / cutoff, edge + REACH / cutoff))
        usable[first:last] = False
    return usable
