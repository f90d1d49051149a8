"""Where the slower of two instruments folds what it cannot follow into the band that is compared."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from tethertest.conditioning.clocks.alignment import AlignmentSignals
from tethertest.conditioning.clocks.uniform import LOW_PASS, Signal
from tethertest.signal.filters import moving_mean

#: an instrument follows up to this share of its rate
FOLLOWED = 0.5
#: power above that is a knock, or the bouncing behind it, where it is this many times its usual self
UNUSUAL = 16.0
#: over this time [s]
SMOOTHED = 0.25


def without_folding(pair: AlignmentSignals) -> AlignmentSignals:
    """Return both records, the faster one not usable where the slower one folds a knock.

    A knock of 60 ms and the UAV's bouncing behind it are no signal that an instrument at 30 Hz has in common
    with one that follows them: what it samples of them is something else at every offset.

    Parameters
    ----------
    pair : AlignmentSignals
        Both records up to `LOW_PASS`.
    """
    limit = FOLLOWED * min(pair.reference.sampled, pair.clock.sampled)
    if limit >= LOW_PASS:
        return pair
    if pair.reference.sampled < pair.clock.sampled:
        return replace(pair, clock=_calm(pair.clock, limit))
    return replace(pair, reference=_calm(pair.reference, limit))


def _calm(signal: Signal, limit: float) -> Signal:
    if FOLLOWED / signal.step <= limit or not signal.usable.any():
        return signal
    power = np.where(signal.usable, signal.high_passed(limit).values, 0.0) ** 2
    smooth = moving_mean(power, max(SMOOTHED / signal.step, 1.0))
    usual = float(np.median(smooth[signal.usable]))
    return replace(signal, usable=signal.usable & (smooth <= UNUSUAL * usual))
