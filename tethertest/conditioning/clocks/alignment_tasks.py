"""Which signals of two clocks can be compared, and where."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from tethertest.conditioning.clocks.alignment import AlignmentSignals
from tethertest.conditioning.clocks.folding import without_folding
from tethertest.conditioning.clocks.signals import (
    MOTION_STEP,
    TAP_HIGH_PASS,
    expected_signals,
    handed_over,
    strain_signals,
    tap_signals,
)
from tethertest.conditioning.clocks.taps import tap_spans
from tethertest.conditioning.rig_priors import UNSTATED_DAMPING_TIME, RigPriors
from tethertest.records.arrays import FloatArray
from tethertest.records.channel import Channel
from tethertest.records.run import Run
from tethertest.signal.windows import Span, find_rest

#: the record is looked at in spans of this length for a clock that does not run straight [s]
SPAN = 8.0
#: slower than this, temperature and zeros drift [Hz]; and slower than this share of the drive's frequency
SLOWEST, SLOWEST_SHARE = 0.03, 0.3
#: a record slower than this folds the UAV's bouncing after a tap into the band [Hz]
TAP_RATE = 60.0
#: timing error that strain and tension share besides the damper's lag: the wave needs 7 ms along the cable,
#: and a straight line between its ends is late by 3 us up to 14 Hz, by 16 us at 30 Hz [s]
STRAIN_SYSTEMATIC = 2e-5
#: timing error of each span by itself [s]: of strain what its bounce and its drive differ by, of an expected
#: tap what the mode of the UAV's loop and the ringing before it make of it
STRAIN_SPAN, TAP_SPAN = 1e-5, 1e-4
#: and of strain that has nothing but knocks, where an instrument is too slow to follow them, as a share of
#: its sampling interval: what it folds is not the same at either end
FOLDED_KNOCK = 0.04
#: the changes by what the rig does not know are computed on every so many samples of the motion
THINNED = 2


@dataclass(frozen=True, slots=True, eq=False)
class AlignmentTask:
    """A clock's signal beside the reference's, and where to compare."""

    pair: AlignmentSignals
    spans: tuple[Span, ...]
    slowest: float  #: the records differ below this [Hz]; 0 where nothing but the spans is compared
    drive: float  #: frequency of the drive [Hz], or of what else must be in the band
    lag: float  #: how late the clock's signal is by the rig itself [s]
    lag_error: float  #: standard uncertainty of that, and of what else all samples share [s]
    systematic: float  #: timing error of each span by itself [s]
    method: str
    remarks: tuple[str, ...] = ()


def alignment_tasks(
    channels: Sequence[Channel], reference: Sequence[Channel], run: Run, priors: RigPriors
) -> Iterator[AlignmentTask | str]:
    """Yield what can be compared, the best first, or why nothing can.

    Parameters
    ----------
    channels, reference : sequence of Channel
        Channels on the clock and on the reference clock.
    run : Run
        For the rig.
    priors : RigPriors
        For the expected tension.
    """
    heave = next((channel for channel in channels if channel.kind == "displacement"), None)
    gratings = [channel for channel in channels if channel.kind == "wavelength" and channel.at is not None]
    tensions = [channel for channel in reference if channel.kind == "tension"]
    drive = priors.drive_frequency or run.file.drive.frequency
    if not tensions:
        yield f"the reference clock {priors.reference_clock!r} has no tension to compare with"
    elif gratings:
        yield _by_strain(gratings, tensions, run, priors.mains, drive)
    elif heave is None:
        yield "the clock has neither gratings nor a bottom displacement"
    else:
        bottom = next((channel for channel in tensions if channel.at == 0.0), None)
        if priors.expected_tension is None or bottom is None:
            yield "the bottom displacement needs a bottom tension and the tension the cable would answer with"
        else:
            yield from _by_motion(heave, bottom, run, priors, priors.expected_tension, drive)


def _by_strain(
    gratings: Sequence[Channel], tensions: Sequence[Channel], run: Run, mains: float, drive: float | None
) -> AlignmentTask | str:
    pair = strain_signals(gratings, tensions, run.rig, mains)
    if isinstance(pair, str):
        return pair
    slowest = _slowest(drive)
    sampled = min(pair.reference.sampled, pair.clock.sampled)
    own = STRAIN_SPAN
    if drive is not None:
        pair = without_folding(pair)
    elif sampled < TAP_RATE:
        own = FOLDED_KNOCK / sampled
    lag = run.rig.cable.axial_damping_time or 0.0
    error = run.rig.uncertainty.get("cable.axial_damping_time", UNSTATED_DAMPING_TIME)
    return AlignmentTask(
        pair,
        _cut(pair.clock.time),
        slowest,
        drive or 0.0,
        lag,
        float(np.hypot(error, STRAIN_SYSTEMATIC)),
        own,
        "strain of the gratings against tension",
    )


def _by_motion(
    heave: Channel,
    bottom: Channel,
    run: Run,
    priors: RigPriors,
    expected_tension: Callable[[Channel], Channel],
    drive: float | None,
) -> Iterator[AlignmentTask | str]:
    rest = find_rest(heave)
    taps = tap_spans(heave, rest)
    start = heave if rest.before is None else heave.between(*rest.before)
    height = handed_over(heave.with_values(heave.values - np.nanmedian(start.values)))
    expected = expected_tension(height)
    changes = _changes(height, priors)
    at_rest = (rest.before is not None, rest.after is not None)
    pair = expected_signals(expected, height, heave.rate, bottom, priors.mains, changes, at_rest=at_rest)
    if pair is None:
        yield "holes leave no stretch of the bottom displacement long enough for the rig to settle"
        return
    sampled = min(pair.reference.sampled, pair.clock.sampled)
    taps = taps if sampled >= TAP_RATE else ()
    if taps:
        method = f"tension expected from the bottom's motion against bottom tension, {len(taps)} taps at rest"
        yield AlignmentTask(tap_signals(pair), taps, 0.0, TAP_HIGH_PASS, 0.0, 0.0, TAP_SPAN, method)
    if not taps or drive is not None:
        method = "tension expected from the bottom's motion against bottom tension, start to stop"
        pair = pair if drive is None else without_folding(pair)
        remark = "no marker tap: the drive's own phase enters, so the phases compared are not independent"
        yield AlignmentTask(
            pair, _cut(pair.clock.time), _slowest(drive), drive or 0.0, 0.0, 0.0, 0.0, method, (remark,)
        )


def _changes(height: Channel, priors: RigPriors) -> tuple[FloatArray, ...]:
    """Return what each thing that the rig does not know for certain changes in the bottom tension."""
    thin = slice(None, None, THINNED)
    found = priors.tension_changes(height.values[thin], THINNED * MOTION_STEP)
    return tuple(np.interp(height.time, height.time[thin], change) for change in found)


def _slowest(drive: float | None) -> float:
    return SLOWEST if drive is None else min(SLOWEST, SLOWEST_SHARE * drive)


def _cut(time: FloatArray) -> tuple[Span, ...]:
    count = max(round((time[-1] - time[0]) / SPAN), 2)
    edges = np.linspace(time[0], time[-1], count + 1)
    return tuple((float(start), float(stop)) for start, stop in pairwise(edges))
