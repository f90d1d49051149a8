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
#: fewer samples of a window compare nothing
FEWEST_SAMPLES: Final = 3


@dataclass(frozen=True, slots=True, eq=False)
class Pair:
    """One channel, measured and replayed, in one window and one band."""

    time: FloatArray  #: (n,) [s], measured times in the window
    usable: BoolArray  #: (n,) samples of the measurement that count
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
    smooth: FloatArray  #: (n,) low-passed, in the window
    peak: float


def prepare(measured: Channel, window: Window) -> Band | None:
    """Low-pass a measured channel and cut out the window, or return None where nothing in it can be used.

    The zero-phase filter runs over the whole record, so that the window's edges are no edges of the filter.
    Gaps are bridged by straight lines for the filter and do not count afterwards.
    """
    first, after = np.searchsorted(measured.time, (window.start, window.stop))
    part = slice(int(first), int(after))
    if after - first < FEWEST_SAMPLES or not measured.usable[part].any():
        return None
    cutoff = min(CUTOFF, CUTOFF_SHARE * measured.rate)
    values = filled(measured)
    smooth = low_passed(values, measured.rate, cutoff)[part]
    return Band(measured, part, cutoff, smooth, _peak(measured, values, part))


def pair_with(band: Band, replayed: Channel) -> Pair | None:
    """Bring a replay to the times and the band of a measurement.

    Parameters
    ----------
    band : Band
        The measured side.
    replayed : Channel
        The replay, at any times.

    Returns
    -------
    Pair or None
        None where the replay does not cover the window.
    """
    measured, part = band.channel, band.part
    time = measured.time[part]
    tolerance = 1.0 / measured.rate
    if replayed.time.size == 0 or (
        replayed.time[0] > time[0] + tolerance or replayed.time[-1] < time[-1] - tolerance
    ):
        return None
    values = filled(replayed)
    if not np.array_equal(replayed.time, measured.time):
        values = np.interp(measured.time, replayed.time, values)
    kept = min(1.0, NOISE_BANDWIDTH * 2.0 * band.cutoff / measured.rate)
    return Pair(
        time=time,
        usable=measured.usable[part],
        measured=band.smooth,
        replayed=low_passed(values, measured.rate, band.cutoff)[part],
        measured_peak=band.peak,
        replayed_peak=_peak(measured, values, part),
        cutoff=band.cutoff,
        noise=measured.noise * float(np.sqrt(kept)),
        peak_noise=measured.noise / float(np.sqrt(_peak_samples(measured))),
    )


def _peak_samples(measured: Channel) -> int:
    return max(1, round(PEAK_SPAN * measured.rate))


def _peak(measured: Channel, values: FloatArray, part: slice) -> float:
    means = moving_mean(values, _peak_samples(measured))[part]
    return float(np.max(means[measured.usable[part]]))
