"""A low-pass with a flat pass band, for motion whose orders must keep their size."""

from __future__ import annotations

import math

import numpy as np

from tethertest.signal.series import Floats

#: width of the transition band over the cut-off, and the ripple of the pass band [dB below 1]
TRANSITION, RIPPLE = 0.5, 80.0
#: periods of the cut-off within which lies half of the filter, and all of its weight but a hundredth
HALF_PERIODS, REACH_PERIODS = 5.1, 3.0


def flat_passed(values: Floats, rate: float, cutoff: float) -> Floats:
    """Return uniform values with all up to a frequency untouched and nothing from 1.5 times it upwards.

    A Butterworth filter with half power there would take 4 % off what lies at half of it.

    Parameters
    ----------
    values : ndarray
        (n,) without NaN; beyond both ends they are continued by their reflection in the end's point.
    rate, cutoff : float
        Sampling rate and the end of the pass band [Hz].
    """
    from scipy.fft import irfft, next_fast_len, rfft

    nyquist = 0.5 * rate
    if cutoff * (1.0 + TRANSITION) >= nyquist:
        return values
    taps = math.ceil((RIPPLE - 7.95) / 2.285 / (np.pi * (TRANSITION * cutoff / nyquist)) + 1.0)
    taps = min(taps | 1, (values.size - 1) | 1)
    half = taps // 2
    window = _low_pass((1.0 + 0.5 * TRANSITION) * cutoff / nyquist, taps)
    padded = np.pad(values, half, mode="reflect", reflect_type="odd")
    full = padded.size + taps - 1
    size = next_fast_len(full, real=True)
    smooth = irfft(rfft(padded, size) * rfft(window, size), size)[:full]
    return np.array(smooth[taps - 1 : padded.size], dtype=np.float64)


def _low_pass(cutoff: float, taps: int) -> Floats:
    """Return a finite low-pass of so many taps, in Kaiser's window; the cut-off is a share of half the rate.

    References
    ----------
    A. V. Oppenheim and R. W. Schafer, Discrete-Time Signal Processing, section 7.5.3.
    """
    from scipy.special import i0

    beta = 0.1102 * (RIPPLE - 8.7)
    middle = 0.5 * (taps - 1)
    index = np.arange(taps, dtype=np.float64)
    window = i0(beta * np.sqrt(1.0 - ((index - middle) / middle) ** 2)) / i0(beta)
    ideal = cutoff * np.sinc(cutoff * (index - middle)) * window
    return np.asarray(ideal / np.sum(ideal))
