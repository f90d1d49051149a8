"""The measured bottom displacement, made smooth enough to drive the solver.

A stiff cable turns a hundredth of a millimetre of encoder noise into tenths of a newton of ringing at its
axial resonance. So the drive is kept up to the highest frequency at which the encoder sees more than its own
noise, and the wide band is kept only where something sudden happened, as at the marker taps.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from tethertest.errors import DataError
from tethertest.records.arrays import BoolArray, FloatArray
from tethertest.records.channel import Channel, Window
from tethertest.records.scene import MeasuredMotion
from tethertest.signal.filters import filled

#: band kept where something sudden happens [Hz]; a marker tap of 60 ms has little above it
WIDE_BAND = 40.0
#: orders of the drive that are always kept; a crank-slider's fourth is a thousandth of its first
KEPT_ORDERS = 3.5
#: lowest cut-off while the drive runs [Hz], so that ramps keep their shape
LOWEST_CUTOFF = 2.0
#: a line of the encoder counts as motion when its power density is this many times the noise floor
ABOVE_NOISE = 30.0
#: width of the transition band over the cut-off, and the ripple of the pass band [dB below 1]
TRANSITION, RIPPLE = 0.5, 80.0
#: motion outside the drive's band is sudden when it stands out of the noise by this factor
SUDDEN_SIGMAS = 8.0
#: and keeps the wide band this far around it [s], faded in and out over `FADE` [s]
SUDDEN_REACH, FADE = 0.15, 0.1
#: standard deviation of a normal variable over the median of its absolute value
DEVIATION_OF_MEDIAN = 1.4826


@dataclass(frozen=True, slots=True, eq=False)
class BottomMotion:
    """Smooth bottom displacement from rest, on the run's clock."""

    start: float  #: run time of the motion's time zero [s]
    motion: MeasuredMotion
    cutoff: float  #: [Hz], band kept of the drive
    wide_cutoff: float  #: [Hz], band kept where something sudden happens

    @property
    def duration(self) -> float:
        """Length of the record [s]."""
        return float(self.motion.time[-1])


def bottom_motion(
    heave: Channel,
    *,
    frequency: float | None,
    rest_before: Window | None = None,
    steady: Window | None = None,
) -> BottomMotion:
    """Return the measured bottom displacement as the solver takes it.

    Parameters
    ----------
    heave : Channel
        Bottom displacement [m].
    frequency : float or None
        Drive frequency [Hz]; None where there is no drive.
    rest_before, steady : Window or None
        Windows of the run; displacement counts from the rest before the drive.

    Raises
    ------
    DataError
        Fewer than ten usable samples.
    """
    if np.count_nonzero(heave.usable) < 10:
        message = f"channel {heave.name!r} has {np.count_nonzero(heave.usable)} usable samples"
        raise DataError(message, "the replay needs the bottom motion: export the encoder's log again")
    rate = heave.rate
    count = int((heave.time[-1] - heave.time[0]) * rate) + 1
    time = np.arange(count, dtype=np.float64) / rate
    start = float(heave.time[0])
    values = np.interp(time, heave.time - start, filled(heave))
    at_rest = time < 1.0 if rest_before is None else time <= rest_before.stop - start
    values = values - float(np.median(values[at_rest])) if at_rest.any() else values - values[0]

    cutoff = _drive_band(values, rate, frequency, time + start, steady)
    sudden = _sudden(values - _passed(values, rate, cutoff), rate)
    calm = values if sudden.all() else np.interp(time, time[~sudden], values[~sudden])
    share = _faded(sudden, rate)
    smooth = share * _passed(values, rate, WIDE_BAND) + (1.0 - share) * _passed(calm, rate, cutoff)
    fade_in = np.clip(time / FADE, 0.0, 1.0)
    smooth = smooth * fade_in**2 * (3.0 - 2.0 * fade_in)
    return BottomMotion(start, MeasuredMotion(time, np.asarray(smooth)), cutoff, WIDE_BAND)


def _passed(values: FloatArray, rate: float, cutoff: float) -> FloatArray:
    """Return the values with all up to `cutoff` [Hz] untouched and nothing from 1.5 times it upwards.

    A flat pass band matters: a Butterworth filter with half power there would take 4 % off the second order
    of a drive at a quarter of it.
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


def _low_pass(cutoff: float, taps: int) -> FloatArray:
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


def _drive_band(
    values: FloatArray, rate: float, frequency: float | None, time: FloatArray, steady: Window | None
) -> float:
    """Return the cut-off [Hz] that keeps what the encoder sees above its own noise in the steady window."""
    lowest = min(max(LOWEST_CUTOFF, KEPT_ORDERS * (frequency or 0.0)), WIDE_BAND)
    if steady is None:
        return lowest
    part = values[(time >= steady.start) & (time <= steady.stop)]
    if part.size < 64:
        return lowest
    axis, power = _power(part - part.mean(), rate, min(part.size, int(8 * rate)))
    floor = float(np.median(power[axis > 0.5 * axis[-1]]))
    seen = axis[power > ABOVE_NOISE * floor]
    highest = 1.2 * float(seen[-1]) if seen.size else 0.0
    return float(min(max(lowest, highest), WIDE_BAND))


def _power(values: FloatArray, rate: float, length: int) -> tuple[FloatArray, FloatArray]:
    """Return Welch's power density over frequency [Hz], from half overlapping parts in a Hann window."""
    window = 0.5 - 0.5 * np.cos(2.0 * np.pi * np.arange(length) / length)
    parts = np.lib.stride_tricks.sliding_window_view(values, length)[:: length - length // 2]
    transforms = np.fft.rfft(window * (parts - parts.mean(axis=1, keepdims=True)), axis=1)
    power = np.mean(np.abs(transforms) ** 2, axis=0) / (rate * np.sum(window**2))
    power[1 : (length + 1) // 2] *= 2.0  # the negative frequencies; zero and half the rate have none
    return np.asarray(np.fft.rfftfreq(length, 1.0 / rate), dtype=np.float64), np.asarray(power)


def _sudden(rough: FloatArray, rate: float) -> BoolArray:
    """Return where motion outside the drive's band stands out of the noise, and what lies next to it."""
    level = DEVIATION_OF_MEDIAN * float(np.median(np.abs(rough)))
    far = (np.abs(rough) > SUDDEN_SIGMAS * level).astype(np.float64)
    reach = 2 * max(1, round(SUDDEN_REACH * rate)) + 1
    return np.convolve(far, np.ones(reach), mode="same") > 0.5


def _faded(mask: BoolArray, rate: float) -> FloatArray:
    """Return 1 where the mask is true, smoothly down to 0 within `FADE` inside its edges."""
    length = 2 * max(1, round(0.5 * FADE * rate)) + 1
    kernel = np.hanning(length + 2)[1:-1]
    padded = np.pad(mask.astype(np.float64), length // 2, mode="edge")
    return np.asarray(np.convolve(padded, kernel / kernel.sum(), mode="valid"))
