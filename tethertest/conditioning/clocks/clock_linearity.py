"""Whether a clock runs straight: the delays that a fit leaves, span by span."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tethertest.conditioning.clocks.alignment import ClockAlignment, Fit
from tethertest.conditioning.clocks.coloured import noise_of
from tethertest.records.arrays import FloatArray

#: a span whose own delay is worse than this says nothing about the clock [s]
USELESS = 0.02
#: a span whose slope has less than this share of the usual energy is at rest: what it has is noise
QUIET_SHARE = 0.05
#: a delay that its span can tell from nothing is this many standard errors
TOLD = 5.0


@dataclass(frozen=True, slots=True)
class Delay:
    """What one span says: how late the clock's signal is against the line fitted."""

    time: float  #: middle of the span, on the clock [s]
    delay: float  #: [s]
    error: float  #: standard error [s]


def delays(comparison: ClockAlignment, fit: Fit) -> tuple[Delay, ...]:
    """Return the delay that each span has left, where it can tell.

    Parameters
    ----------
    comparison : ClockAlignment
        For its spans.
    fit : Fit
        The line fitted.
    """
    number = comparison.numbers(fit.at)
    found = []
    columns: FloatArray = np.zeros((number.size, len(comparison.spans)))
    inside = fit.use & (number >= 0)
    columns[inside, number[inside]] = fit.slope[inside]
    energy = np.sum(columns**2, axis=0)
    kept = np.flatnonzero(energy > QUIET_SHARE * np.mean(energy))
    columns, energy = columns[:, kept], energy[kept]
    late = columns.T @ fit.residual / energy
    # what the spans' own delays leave: a clock that jumps would else pass for noise
    left = fit.residual - columns @ late
    count = int(np.count_nonzero(fit.use))
    shortest = min(stop - start for start, stop in comparison.spans) if comparison.only else np.inf
    noise = noise_of(left, count, len(kept), comparison.slow.step, shortest)
    usual = max(noise.variance, np.finfo(float).tiny)
    own = np.array([np.mean(left[fit.use & (number == index)] ** 2) for index in kept])
    # what the rig does not know delays a ramp and a steady drive differently
    rig = np.sum((columns.T @ fit.changes) ** 2, axis=1)
    errors = np.sqrt(np.diag(noise.covariance(columns)) * np.maximum(own / usual, 1.0) + rig) / energy
    for index, delay, error in zip(kept, late, errors, strict=True):
        if error < USELESS:
            start, stop = comparison.spans[index]
            found.append(Delay(0.5 * (start + stop), float(delay), float(error)))
    return tuple(found)


def worst(left: tuple[Delay, ...]) -> Delay | None:
    """Return the largest delay left that its span can tell from nothing."""
    told = [item for item in left if abs(item.delay) > TOLD * item.error]
    return max(told, key=lambda item: abs(item.delay), default=None)
