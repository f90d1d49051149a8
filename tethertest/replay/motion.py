"""The measured bottom displacement, made smooth enough to drive the solver.

A stiff cable turns a hundredth of a millimetre of encoder noise into tenths of a newton of ringing at its
axial resonance. So the drive is kept up to the highest frequency at which the encoder sees more than its own
noise, and the wide band is kept only where something sudden happened, as at the marker taps.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tethertest.errors import DataError
from tethertest.records.arrays import BoolArray, FloatArray
from tethertest.records.channel import Channel, Window
from tethertest.records.scene import MeasuredMotion
from tethertest.replay.record_ends import (
    Span,
    continued,
    holes_of,
    lead_in,
    record_from_rest,
    with_holes_filled,
)
from tethertest.signal.flat_pass import HALF_PERIODS, REACH_PERIODS, flat_passed

#: band kept where something sudden happens [Hz]; a marker tap of 60 ms has little above it
WIDE_BAND = 40.0
#: orders of the drive that are always kept; a crank-slider's fourth is a thousandth of its first
KEPT_ORDERS = 3.5
#: lowest cut-off while the drive runs [Hz], so that ramps keep their shape
LOWEST_CUTOFF = 2.0
#: a line of the encoder counts as motion when its power density is this many times the noise floor
ABOVE_NOISE = 30.0
#: motion outside the drive's band is sudden when it stands out of the noise by this factor
SUDDEN_SIGMAS = 8.0
#: and keeps the wide band this far around it [s], faded in and out over `FADE` [s]
SUDDEN_REACH, FADE = 0.15, 0.1
#: standard deviation of a normal variable over the median of its absolute value
DEVIATION_OF_MEDIAN = 1.4826
#: a hole shorter than this many periods of the cut-off is bridged to a thousandth of the drive
SHORT_HOLE = 0.1
#: motion that repeats itself is known beside a longer hole, but for this many periods of the cut-off
BESIDE_HOLE = 0.5


@dataclass(frozen=True, slots=True, eq=False)
class BottomMotion:
    """Smooth bottom displacement from rest, on the run's clock."""

    start: float  #: run time of the motion's time zero [s], before the record where the drive is led in
    motion: MeasuredMotion
    cutoff: float  #: [Hz], band kept of the drive
    wide_cutoff: float  #: [Hz], band kept where something sudden happens
    #: run times where it is no measurement: near an end at which the drive runs, and in holes [s]
    unknown: tuple[Span, ...] = ()

    @property
    def duration(self) -> float:
        """Length of the motion [s]."""
        return float(self.motion.time[-1])


def bottom_motion(
    heave: Channel,
    *,
    frequency: float | None,
    rest_before: Window | None = None,
    rest_after: Window | None = None,
    steady: Window | None = None,
) -> BottomMotion:
    """Return the measured bottom displacement as the solver takes it.

    Where the record begins or ends with the drive running, the drive is continued as it repeats itself: led
    in from rest before the first sample, so that the replay meets the record in its steady state, and past
    the last one, so that no filter invents a stop. What lies within the reach of the low-pass from such an
    end is not known, nor are long holes.

    Parameters
    ----------
    heave : Channel
        Bottom displacement [m].
    frequency : float or None
        Drive frequency [Hz]; None where there is no drive.
    rest_before, rest_after, steady : Window or None
        Windows of the run; displacement counts from the rest before the drive, else from that after it.

    Raises
    ------
    DataError
        Fewer than ten usable samples.
    """
    known = np.flatnonzero(heave.usable)
    if known.size < 10:
        message = f"channel {heave.name!r} has {known.size} usable samples"
        raise DataError(message, "the replay needs the bottom motion: export the encoder's log again")
    heave = heave.rows(int(known[0]), int(known[-1]) + 1)
    lowest = _lowest_cutoff(frequency)
    holes = holes_of(heave, SHORT_HOLE / lowest)
    record, were_filled = with_holes_filled(
        record_from_rest(heave, frequency, rest_before, rest_after), holes
    )
    starts_moving, ends_moving = record.starts_moving, record.ends_moving
    lead = lead_in(record) if starts_moving else np.zeros(0)
    tail = continued(record, HALF_PERIODS / lowest) if ends_moving else np.zeros(0)
    values = np.concatenate((lead, record.values, tail))
    time = record.time[0] + (np.arange(values.size) - lead.size) / record.rate

    cutoff = _drive_band(values, record.rate, frequency, time, steady)
    smooth = _smoothed(values, record.rate, cutoff)[: values.size - tail.size]
    after_start = np.arange(smooth.size) / record.rate
    fade_in = np.clip(after_start / FADE, 0.0, 1.0)
    smooth = smooth * fade_in**2 * (3.0 - 2.0 * fade_in)

    def reach(is_continued: bool) -> float:
        return (REACH_PERIODS if is_continued else HALF_PERIODS) / cutoff

    beside = [(BESIDE_HOLE if was_filled else HALF_PERIODS) / cutoff for was_filled in were_filled]
    unknown = [(first - near, last + near) for (first, last), near in zip(holes, beside, strict=True)]
    start, begin, end = float(time[0]), float(record.time[0]), float(record.time[-1])
    if starts_moving:
        unknown.insert(0, (start, begin + reach(lead.size > 0)))
    if ends_moving:
        unknown.append((end - reach(tail.size > 0), end))
    motion = MeasuredMotion(after_start, np.asarray(smooth))
    return BottomMotion(start, motion, cutoff, WIDE_BAND, tuple(unknown))


def motion_reach(frequency: float | None) -> float:
    """Return how far from an end of the record at which the drive runs the motion is not known [s].

    Parameters
    ----------
    frequency : float or None
        Of the drive [Hz].
    """
    return REACH_PERIODS / _lowest_cutoff(frequency)


def _lowest_cutoff(frequency: float | None) -> float:
    return min(max(LOWEST_CUTOFF, KEPT_ORDERS * (frequency or 0.0)), WIDE_BAND)


def _smoothed(values: FloatArray, rate: float, cutoff: float) -> FloatArray:
    """Return the drive's band, and the wide band where something sudden happens."""
    sudden = _sudden(values - flat_passed(values, rate, cutoff), rate)
    index = np.arange(values.size, dtype=np.float64)
    calm = values if sudden.all() else np.interp(index, index[~sudden], values[~sudden])
    share = _faded(sudden, rate)
    wide, narrow = flat_passed(values, rate, WIDE_BAND), flat_passed(calm, rate, cutoff)
    return np.asarray(share * wide + (1.0 - share) * narrow)


def _drive_band(
    values: FloatArray, rate: float, frequency: float | None, time: FloatArray, steady: Window | None
) -> float:
    """Return the cut-off [Hz] that keeps what the encoder sees above its own noise in the steady window."""
    lowest = _lowest_cutoff(frequency)
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
