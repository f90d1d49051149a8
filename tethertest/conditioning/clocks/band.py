"""The band in which two records say most about their clocks."""

from __future__ import annotations

import numpy as np

from tethertest.conditioning.clocks.alignment import AlignmentSignals
from tethertest.conditioning.clocks.uniform import LOW_PASS
from tethertest.records.arrays import FloatArray

#: a bin of the spectrum is signal when its power is this many times the noise's: by chance one in 2e5 is
ABOVE_NOISE = 12.0
#: nothing above this fraction of the slower sampling is compared: the low-pass falls to a tenth up to where
#: it is aliased
NYQUIST_SHARE = 0.33
#: lowest upper end of the band [Hz], and the ratio between the ends tried
LOWEST, RATIO = 1.0, 1.3


def best_cutoff(pair: AlignmentSignals, slowest: float) -> float:
    """Return the upper end of the band [Hz].

    Noise in the slope of the record that is looked up adds to the variance of the delay, in proportion to the
    slope's own power: a band that reaches far beyond the signal is worse than one that ends with it.

    Parameters
    ----------
    pair : AlignmentSignals
        Both records up to `LOW_PASS`.
    slowest : float
        Lower end of the band [Hz].
    """
    frequency, signal, noise = _powers(pair)
    top = min(LOW_PASS, NYQUIST_SHARE * min(pair.reference.sampled, pair.clock.sampled))
    lowest = min(max(LOWEST, 2.5 * slowest), top)
    count = max(int(np.ceil(np.log(top / lowest) / np.log(RATIO))), 0) + 1
    cutoffs = np.geomspace(lowest, top, count)
    scores = []
    for cutoff in cutoffs:
        passed = (2.0 * np.pi * frequency) ** 2 / (1.0 + (frequency / cutoff) ** 4) ** 2
        slope, disturbance = float(np.sum(passed * signal)), float(np.sum(passed * noise))
        scores.append(np.inf if slope <= 0.0 else (1.0 + disturbance / slope) / slope)
    return float(cutoffs[int(np.argmin(scores))]) if np.isfinite(min(scores)) else float(top)


def _powers(pair: AlignmentSignals) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return frequency and power of signal and noise per bin, by the record whose noise is white."""
    sound, other = pair.reference, pair.clock
    values = np.where(sound.usable, sound.values, 0.0)
    frequency = np.asarray(np.fft.rfftfreq(values.size, sound.step), dtype=np.float64)
    power = np.abs(np.fft.rfft(values)) ** 2 * sound.step / values.size
    level = max(sound.density, 0.0)
    is_signal = power > ABOVE_NOISE * level
    signal = np.where(is_signal, power - level, 0.0)
    elsewhere = np.abs(np.fft.rfft(np.where(other.usable, other.values, 0.0))) ** 2
    elsewhere *= other.step / other.values.size
    there = np.interp(frequency, np.fft.rfftfreq(other.values.size, other.step), elsewhere)
    coloured = np.where(is_signal, 0.0, there)
    return frequency, signal, np.maximum(level, coloured)
