"""One physical signal on two clocks: strain as tension, and bottom motion as tension."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from tethertest.conditioning.alignment import Pair
from tethertest.records.arrays import BoolArray, FloatArray
from tethertest.records.channel import Channel, Flag
from tethertest.records.rig import Rig
from tethertest.signal.filters import HOLE_INTERVALS, filled, low_passed, resampled, without_line

#: strain and tension are compared above this: below it temperature and zero drift differ [Hz]
STRAIN_HIGH_PASS = 0.5
#: taps are compared above this: what the crank starts to do does not enter [Hz]
TAP_HIGH_PASS = 2.0
#: without taps the start and stop of the drive must enter [Hz]
DRIVE_HIGH_PASS = 0.05
#: noise above this says nothing about a tap of 60 ms or a UAV bouncing at 14 Hz [Hz]
LOW_PASS = 45.0
#: hum is followed over this time: the mains may wander by a tenth of a hertz [s]
HUM_SPAN = 1.0
#: the UAV bounces on the cable faster than this [Hz]
SLOWEST_BOUNCE = 5.0
#: a grating that lacks more than this fraction of its samples is left out of the mean
LARGEST_LOSS = 0.2
#: a load cell that lacks more than this is left out: the other end alone stands for the cable, a little late
LARGEST_CELL_LOSS = 0.5
#: a filter carries a bad sample this far [s]
FILTER_REACH = 0.1


def strain_pair(
    gratings: Sequence[Channel], tensions: Sequence[Channel], rig: Rig, mains: float
) -> Pair | str:
    """Return mean strain of the gratings as tension, beside the measured tension at their mean place.

    Parameters
    ----------
    gratings : sequence of Channel
        Wavelengths [m] on one clock.
    tensions : sequence of Channel
        Tension [N] on the reference clock; between two ends it is interpolated along the cable, which is
        exact as long as the cable between them accelerates as one.
    rig : Rig
        For gauge factors and the axial stiffness.
    mains : float
        Mains frequency [Hz]: hum is taken out of the tension.

    Returns
    -------
    Pair or str
        The pair, or why there is none.
    """
    stiffness = rig.cable.axial_stiffness
    kept = [item for item in gratings if np.mean(item.usable) >= 1.0 - LARGEST_LOSS]
    if not kept:
        return "every grating lacks too many samples to compare its clock by"
    factors = {sensor.name: sensor.gauge_factor or 1.0 for sensor in rig.sensor}
    time = kept[0].time
    total, usable = np.zeros(time.size), np.ones(time.size, dtype=bool)
    for channel in kept:
        values = filled(channel)
        strain = np.log(values / np.median(values)) / factors[channel.name]
        total += strain / len(kept)
        usable &= channel.usable
    tension = (stiffness or 1.0) * total
    place = float(np.mean([channel.at or 0.0 for channel in kept]))
    rate = kept[0].rate
    uniform = np.arange(time[0], time[-1] + 0.5 / rate, 1.0 / rate)
    slow = low_passed(np.interp(uniform, time, tension), rate, STRAIN_HIGH_PASS)
    there = _at_place(tensions, place)
    return Pair(
        there.time,
        _band(there, STRAIN_HIGH_PASS, mains),
        _worn(there.usable, there.rate),
        time,
        tension - np.interp(time, uniform, slow),
        _worn(usable, rate),
    )


def expected_pair(
    expected: Channel, heave: Channel, bottom: Channel, mains: float, *, transients: bool
) -> Pair:
    """Return the bottom tension that the motion asks for, beside the measured one.

    Parameters
    ----------
    expected : Channel
        Bottom tension [N] that the displacement asks for, on its clock, at any times.
    heave : Channel
        The displacement, for its unusable samples.
    bottom : Channel
        Measured bottom tension [N] on the reference clock.
    mains : float
        Mains frequency [Hz]: hum is taken out of the measured tension.
    transients : bool
        True to leave out what is as slow as the drive.
    """
    sound = _worn(heave.usable, heave.rate).astype(float)
    seen = np.interp(expected.time, heave.time, sound, left=0.0, right=0.0)
    cutoff = TAP_HIGH_PASS if transients else DRIVE_HIGH_PASS
    there = _uniform(bottom)
    answer, measured = _band(expected, cutoff, mains), _band(there, cutoff, mains)
    if transients:
        quarter = 0.25 / _bounce(answer, expected.rate)
        answer = _without_bounce(expected.time, answer, quarter)
        measured = _without_bounce(there.time, measured, quarter)
    return Pair(
        there.time,
        measured,
        _worn(there.usable, there.rate),
        expected.time,
        answer,
        expected.usable & (seen == 1.0),
    )


def _bounce(answer: FloatArray, rate: float) -> float:
    """Return the frequency of the UAV's bouncing [Hz], where the expected tension is largest."""
    spectrum = np.abs(np.fft.rfft(answer))
    frequency = np.fft.rfftfreq(answer.size, 1.0 / rate)
    inside = (frequency >= SLOWEST_BOUNCE) & (frequency <= LOW_PASS)
    return float(frequency[inside][np.argmax(spectrum[inside])])


def _without_bounce(time: FloatArray, values: FloatArray, quarter: float) -> FloatArray:
    """Return the mean of two values half a bounce apart: free bouncing drops out, whatever started it."""
    return 0.5 * (np.interp(time - quarter, time, values) + np.interp(time + quarter, time, values))


def _band(channel: Channel, cutoff: float, mains: float) -> FloatArray:
    """Return what a uniformly sampled channel has between a frequency and `LOW_PASS`, without hum."""
    values = filled(channel)
    values = values - np.median(values)
    if mains < 0.4 * channel.rate:
        values = without_line(channel.time, values, mains, HUM_SPAN)
    return low_passed(values, channel.rate, LOW_PASS) - low_passed(values, channel.rate, cutoff)


def _uniform(channel: Channel) -> Channel:
    """Return the channel at uniform times; what lies in holes of its stamps is not usable."""
    rate = channel.rate
    if float(np.max(np.diff(channel.time))) * rate < HOLE_INTERVALS:
        return channel
    time = np.arange(channel.time[0], channel.time[-1], 1.0 / rate)
    values = resampled(channel, time)
    missing = np.where(np.isfinite(values), np.uint16(0), np.uint16(Flag.MISSING))
    return replace(channel, time=time, values=values, flags=missing.astype(np.uint16))


def _worn(usable: BoolArray, rate: float) -> BoolArray:
    """Return the mask without the samples that a filter has mixed with bad ones."""
    reach = max(round(FILTER_REACH * rate), 1)
    bad = np.concatenate(([0], np.cumsum(~usable)))
    index = np.arange(usable.size)
    first, last = np.maximum(index - reach, 0), np.minimum(index + reach + 1, usable.size)
    return np.asarray(bad[last] == bad[first], dtype=bool)


def _at_place(tensions: Sequence[Channel], place: float) -> Channel:
    """Return tension at a fraction of the length at uniform times, from both ends where they are sound."""
    ends = sorted(
        (channel for channel in tensions if channel.at is not None), key=lambda item: item.at or 0.0
    )
    sound = [channel for channel in ends if np.mean(channel.usable) >= 1.0 - LARGEST_CELL_LOSS] or ends[:1]
    first, last = _uniform(sound[0]), sound[-1]
    span = (last.at or 0.0) - (first.at or 0.0)
    if span == 0.0:
        return first
    share = (place - (first.at or 0.0)) / span
    high = np.interp(first.time, last.time, filled(last))
    known = np.interp(first.time, last.time, last.usable.astype(float)) == 1.0
    both = first.with_values((1.0 - share) * filled(first) + share * high)
    return both.with_flags(~(known & first.usable), Flag.MISSING)
