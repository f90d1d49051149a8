"""One physical signal on two clocks: strain as tension, and bottom motion as tension."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from tethertest.conditioning.clocks.alignment import AlignmentSignals
from tethertest.conditioning.clocks.uniform import LOW_PASS, Signal, uniform
from tethertest.records.arrays import BoolArray, FloatArray
from tethertest.records.channel import Channel, Flag
from tethertest.records.rig import Rig
from tethertest.signal.filters import filled
from tethertest.signal.spline import spline

#: the motion is handed to the rig's mechanics below this [Hz] at this step [s]: what a tap of 60 ms has
MOTION_TOP, MOTION_STEP = 100.0, 2e-3
#: a motion that is under way when its record begins, or goes on after a hole, makes the rig settle for this
#: long [s]; a hole shorter than this is bridged well enough [s]
SETTLING, SHORTEST_HOLE = 2.5, 0.05
#: and one that is still under way when it ends bends the filtered answer over this time [s]
BENT = 0.5
#: taps are compared above this: what the crank starts to do does not enter [Hz]
TAP_HIGH_PASS = 2.0
#: the UAV bounces on the cable faster than this [Hz]
SLOWEST_BOUNCE = 5.0
#: a grating that lacks more than this fraction of its samples is left out of the mean
LARGEST_LOSS = 0.2
#: a load cell that lacks more than this is left out: the other end alone stands for the cable
LARGEST_CELL_LOSS = 0.5


def strain_signals(
    gratings: Sequence[Channel], tensions: Sequence[Channel], rig: Rig, mains: float
) -> AlignmentSignals | str:
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
    AlignmentSignals or str
        The pair, or why there is none.
    """
    stiffness = rig.cable.axial_stiffness
    kept = [item for item in gratings if np.mean(item.usable) >= 1.0 - LARGEST_LOSS]
    if not kept:
        return "every grating lacks too many samples to compare its clock by"
    factors = {sensor.name: sensor.gauge_factor or 1.0 for sensor in rig.sensor}
    total, usable = np.zeros(kept[0].time.size), np.ones(kept[0].time.size, dtype=bool)
    for channel in kept:
        values = filled(channel)
        strain = np.log(values / np.median(values)) / factors[channel.name]
        total += strain / len(kept)
        usable &= channel.usable
    if not usable.any():
        return "no sample has a value of every grating to compare its clock by"
    mean = kept[0].with_values((stiffness or 1.0) * total).with_flags(~usable, Flag.MISSING)
    place = float(np.mean([channel.at or 0.0 for channel in kept]))
    return AlignmentSignals(uniform(_at_place(tensions, place), mains), uniform(mean))


def handed_over(heave: Channel) -> Channel:
    """Return a displacement as the rig's mechanics is to have it.

    It is band-limited and at uniform close times: straight lines between the samples of a slow log would bend
    the answer.
    """
    signal = uniform(heave, top=MOTION_TOP)
    time = np.arange(signal.start, signal.stop, MOTION_STEP)
    values = spline(signal.time, signal.values)(time)
    flags = np.where(signal.usable_at(time), np.uint16(0), np.uint16(Flag.MISSING)).astype(np.uint16)
    return replace(heave, time=time, values=values, flags=flags)


def expected_signals(
    expected: Channel,
    heave: Channel,
    sampled: float,
    bottom: Channel,
    mains: float,
    changes: tuple[FloatArray, ...],
    *,
    at_rest: tuple[bool, bool],
) -> AlignmentSignals | None:
    """Return the bottom tension that the motion asks for, beside the measured one.

    Parameters
    ----------
    expected : Channel
        Bottom tension [N] that the displacement asks for, on its clock, at any times.
    heave : Channel
        The displacement as `handed_over`, for its unusable samples.
    sampled : float
        Rate at which the displacement was logged [Hz].
    bottom : Channel
        Measured bottom tension [N] on the reference clock.
    mains : float
        Mains frequency [Hz]: hum is taken out of the measured tension.
    changes : tuple of ndarray
        (n,) each: change [N] of the expected tension at the displacement's times by what the rig does not
        know.
    at_rest : tuple of bool
        Whether the record begins and ends at rest.

    Returns
    -------
    AlignmentSignals or None
        None where nothing is known of one of the two.
    """
    first = expected.time[0] + (0.0 if at_rest[0] else SETTLING)
    last = expected.time[-1] - (0.0 if at_rest[1] else BENT)
    known = np.interp(expected.time, heave.time, _settled(heave).astype(float), left=0.0, right=0.0) == 1.0
    known &= (expected.time >= first) & (expected.time <= last)
    if not known.any() or not bottom.usable.any():
        return None
    answer = replace(uniform(expected.with_flags(~known, Flag.MISSING)), sampled=sampled)
    moved = tuple(_like(answer, heave, change) for change in changes)
    return AlignmentSignals(uniform(bottom, mains), answer, moved)


def tap_signals(pair: AlignmentSignals) -> AlignmentSignals:
    """Return what an expected pair has of taps: above the drive, without the UAV's free bouncing.

    An error of the bounce's frequency adds up with every period, and noise of the motion rings there.
    """
    clock = pair.clock.high_passed(TAP_HIGH_PASS)
    quarter = 0.25 / _bounce(clock)
    changes = tuple(
        _without_bounce(replace(clock, values=change).high_passed(TAP_HIGH_PASS), quarter).values
        for change in pair.changes
    )
    reference = pair.reference.high_passed(TAP_HIGH_PASS)
    return AlignmentSignals(_without_bounce(reference, quarter), _without_bounce(clock, quarter), changes)


def _bounce(answer: Signal) -> float:
    """Return the frequency of the UAV's bouncing [Hz], where the expected tension is largest."""
    spectrum = np.abs(np.fft.rfft(answer.values))
    frequency = np.fft.rfftfreq(answer.values.size, answer.step)
    inside = (frequency >= SLOWEST_BOUNCE) & (frequency <= LOW_PASS)
    return float(frequency[inside][np.argmax(spectrum[inside])])


def _without_bounce(signal: Signal, quarter: float) -> Signal:
    """Return the mean of two values half a bounce apart: free bouncing drops out, whatever started it."""
    through = spline(signal.time, signal.values)
    before = np.maximum(signal.time - quarter, signal.start)
    after = np.minimum(signal.time + quarter, signal.stop)
    return replace(signal, values=0.5 * (through(before) + through(after)))


def _settled(heave: Channel) -> BoolArray:
    """Return where the motion is known, and was for long enough that the answer to it is."""
    edges = np.flatnonzero(np.diff(np.concatenate(([True], heave.usable, [True])).astype(np.int8)))
    settled = heave.usable.copy()
    for first, last in zip(edges[::2], edges[1::2], strict=True):
        if (last - first) * MOTION_STEP > SHORTEST_HOLE:
            settled[first : last + round(SETTLING / MOTION_STEP)] = False
    return settled


def _like(answer: Signal, heave: Channel, change: FloatArray) -> FloatArray:
    """Return a change at the answer's times, filtered as the answer is."""
    there = uniform(heave.with_values(change))
    return spline(there.time, there.values)(answer.time)


def _at_place(tensions: Sequence[Channel], place: float) -> Channel:
    """Return tension at a fraction of the length, from both ends where they are sound."""
    ends = sorted(
        (channel for channel in tensions if channel.at is not None), key=lambda item: item.at or 0.0
    )
    sound = [channel for channel in ends if np.mean(channel.usable) >= 1.0 - LARGEST_CELL_LOSS] or ends[:1]
    first, last = sound[0], sound[-1]
    span = (last.at or 0.0) - (first.at or 0.0)
    if span == 0.0:
        return first
    share = (place - (first.at or 0.0)) / span
    high = np.interp(first.time, last.time, filled(last))
    known = np.interp(first.time, last.time, last.usable.astype(float)) == 1.0
    both = first.with_values((1.0 - share) * filled(first) + share * high)
    return both.with_flags(~(known & first.usable), Flag.MISSING)
