"""Fine alignment: offset and drift of a clock by least squares, with standard errors from the residuals."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tethertest.conditioning.correlation import effective_count
from tethertest.records.arrays import BoolArray, FloatArray

#: passes of the linearised fit; the coarse offset is good to a millisecond, so two suffice
PASSES = 4
#: a span whose own delay is worse than this says nothing about the clock [s]
USELESS = 0.02
#: fewest samples of a span that can carry delay, gain and level
FEWEST = 8


@dataclass(frozen=True, slots=True, eq=False)
class Pair:
    """The same physical signal on two clocks, high-passed alike."""

    reference_time: FloatArray  #: (n,) [s]
    reference: FloatArray  #: (n,)
    reference_usable: BoolArray  #: (n,)
    time: FloatArray  #: (m,) [s]
    values: FloatArray  #: (m,)
    usable: BoolArray  #: (m,)


@dataclass(frozen=True, slots=True)
class Delay:
    """What one span says: how late the clock's signal is against the line fitted so far."""

    time: float  #: where in the span the information lies, on the reference clock [s]
    delay: float  #: [s]
    error: float  #: standard error [s]


@dataclass(frozen=True, slots=True)
class Line:
    """Offset and drift with standard errors."""

    offset: float
    offset_error: float
    drift: float
    drift_error: float
    delays: tuple[Delay, ...]  #: what is left, span by span

    @property
    def worst(self) -> float:
        """Largest delay left that its span can tell from nothing [s]."""
        return max(
            (abs(item.delay) for item in self.delays if abs(item.delay) > 4.0 * item.error), default=0.0
        )


def fitted_line(
    pair: Pair,
    spans: tuple[tuple[float, float], ...],
    offset: float,
    believable_drift: float,
    systematic: float,
) -> Line | None:
    """Fit offset and drift so that the signals of a pair agree.

    Parameters
    ----------
    pair : Pair
        The signals.
    spans : tuple
        Spans of the clock's own time [s]; each has its own gain and level.
    offset : float
        Coarse offset [s].
    believable_drift : float
        Largest believable drift [1]; it enters as a prior of that half-width, which matters only where the
        spans do not reach far enough to tell the drift.
    systematic : float
        Timing error that all samples of a span share [s].

    Returns
    -------
    Line or None
        None where no span carries a delay.
    """
    drift = 0.0
    error = np.zeros((2, 2))
    delays: tuple[Delay, ...] = ()
    slope = np.gradient(pair.reference, pair.reference_time)
    for _ in range(PASSES):
        found = (_delay(pair, slope, start, stop, offset, drift) for start, stop in spans)
        delays = tuple(item for item in found if item is not None and item.error < USELESS)
        if not delays:
            return None
        change, error = _straight(delays, drift, believable_drift / np.sqrt(3.0), systematic)
        offset, drift = offset + (1.0 + drift) * change[0], drift + (1.0 + drift) * change[1]
    left = tuple(
        Delay(item.time, item.delay - change[0] - change[1] * item.time, item.error) for item in delays
    )
    return Line(float(offset), float(np.sqrt(error[0, 0])), float(drift), float(np.sqrt(error[1, 1])), left)


def _delay(
    pair: Pair, slope: FloatArray, start: float, stop: float, offset: float, drift: float
) -> Delay | None:
    first, last = np.searchsorted(pair.time, (start, stop))
    time = (pair.time[first:last] - offset) / (1.0 + drift)
    share = np.interp(time, pair.reference_time, pair.reference_usable.astype(float), left=0.0, right=0.0)
    use = pair.usable[first:last] & (share == 1.0)
    if np.count_nonzero(use) < FEWEST:
        return None
    time, values = time[use], pair.values[first:last][use]
    signal = np.interp(time, pair.reference_time, pair.reference)
    change = np.interp(time, pair.reference_time, slope)
    basis = np.column_stack((signal, change, np.ones_like(signal)))
    scale = np.linalg.norm(basis, axis=0)
    if np.any(scale == 0.0):
        return None
    inverse = np.linalg.pinv(basis / scale)
    solution = (inverse @ values) / scale
    residual = values - basis @ solution
    freedom = max(effective_count(residual) - 3.0, 1.0)
    variance = float(np.dot(residual, residual)) / freedom
    spread = np.sqrt(variance * float(np.sum(inverse[1] ** 2))) / scale[1]
    if solution[0] <= 0.0:
        return None
    centre = float(np.average(time, weights=change**2))
    return Delay(centre, float(-solution[1] / solution[0]), float(spread / solution[0]))


def _straight(
    delays: tuple[Delay, ...], drift: float, prior: float, systematic: float
) -> tuple[FloatArray, FloatArray]:
    """Return intercept and slope of the delays over time, with their covariance, scatter included."""
    time = np.array([item.time for item in delays])
    delay = np.array([item.delay for item in delays])
    weight = 1.0 / (np.array([item.error for item in delays]) ** 2 + systematic**2)
    basis = np.column_stack((np.ones_like(time), time))
    normal = basis.T @ (weight[:, None] * basis)
    normal[1, 1] += 1.0 / prior**2
    right = basis.T @ (weight * delay)
    right[1] -= drift / prior**2
    error = np.linalg.inv(normal)
    solution = error @ right
    misfit = float(np.sum(weight * (delay - basis @ solution) ** 2))
    freedom = len(delays) - 2
    if freedom > 0:
        error = error * max(misfit / freedom, 1.0)
    return solution, error
