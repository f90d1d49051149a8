"""Fine alignment: offset and drift of a clock by least squares, standard errors from coloured residuals."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from tethertest.conditioning.clocks.coloured import Noise, noise_of
from tethertest.conditioning.clocks.uniform import Signal
from tethertest.records.arrays import BoolArray, FloatArray
from tethertest.signal.spline import spline
from tethertest.signal.windows import Span

IntegerArray: TypeAlias = npt.NDArray[np.int64]

#: passes of the linearised fit, and the change of the offset that ends them [s]
PASSES, CONVERGED = 8, 1e-7
#: fewest samples that can carry offset, drift, gain and level
FEWEST = 12
#: a pass moves the offset by no more than this fraction of the shortest period in the band
LARGEST_STEP = 0.25
#: least share of the slopes' energy that both records are taken to have in common: an aliased knock can have
#: none
LEAST_SHARED = 0.05
#: relative size of what stabilises an inverse
RIDGE = 1e-11
#: spans whose misfit is this many times the usual variance are weighted down to it: among offsets that may be
#: wrong, and once one is chosen
UNUSUAL, UNUSUAL_ONCE_CHOSEN = 4.0, 1.5


@dataclass(frozen=True, slots=True, eq=False)
class AlignmentSignals:
    """One physical signal on two clocks, filtered alike."""

    reference: Signal
    clock: Signal
    changes: tuple[
        FloatArray, ...
    ] = ()  #: (n,) each: one standard uncertainty's change of the clock's signal

    def low_passed(self, cutoff: float) -> AlignmentSignals:
        """Return both below a frequency."""
        clock = self.clock
        slow = tuple(replace(clock, values=change).low_passed(cutoff).values for change in self.changes)
        return AlignmentSignals(self.reference.low_passed(cutoff), clock.low_passed(cutoff), slow)


@dataclass(frozen=True, slots=True, eq=False)
class Looked:
    """Both records at the slower one's samples."""

    use: BoolArray  #: (n,) samples that both have
    values: FloatArray  #: (n,) the record with more noise
    model: FloatArray  #: (n,) the record with less
    slopes: FloatArray  #: (n, 2) what an offset and a drift add to the model's difference from the values
    others: FloatArray  #: (n, 2) the same slopes of the values
    changes: FloatArray  #: (n, m) the clock's changes there
    at: FloatArray  #: (n,) time on the clock [s]


@dataclass(frozen=True, slots=True, eq=False)
class Fit:
    """Offset and drift with their covariance, and what is left."""

    offset: float  #: [s]
    drift: float
    covariance: FloatArray  #: (2, 2), with what is known beforehand
    gain: float  #: of the reference over the clock
    explained: float  #: fraction of the signal's energy
    use: BoolArray  #: (n,) samples compared
    at: FloatArray  #: (n,) time on the clock [s]
    residual: FloatArray  #: (n,) in the clock's scale, zero where not used
    signal: FloatArray  #: (n,) record with more noise, in the clock's scale, zero where not used
    slope: FloatArray  #: (n,) derivative of the model by offset, zero where not used
    changes: FloatArray  #: (n, m) what the rig does not know changes, zero where not used
    noise: Noise  #: of the weighted residual
    scale: float  #: of the noise over the residual


class ClockAlignment:
    """A pair prepared for looking up: the slower record's samples, and a cubic through the faster one.

    Where nothing but spans is compared, the clock's record stands for the slower one.

    The record with less noise is the model, which has gain and slopes: noise in those would pass for signal.

    Parameters
    ----------
    pair : AlignmentSignals
        The signals, low-passed.
    spans : tuple
        Spans of the clock's own time [s].
    slowest : float
        What is slower differs between the records and is fitted [Hz]; 0 where nothing but the spans is
        compared: each has a level of its own then.
    cutoff : float
        Upper end of the band [Hz].
    systematic : float
        Timing error that all samples of a span share [s].
    """

    def __init__(
        self,
        pair: AlignmentSignals,
        spans: tuple[Span, ...],
        slowest: float,
        cutoff: float,
        systematic: float,
    ) -> None:
        # spans of the clock's time hold the same samples of the clock at every offset
        self.swapped = slowest > 0.0 and pair.reference.step > pair.clock.step
        self.slow, self.fast = (pair.reference, pair.clock) if self.swapped else (pair.clock, pair.reference)
        self.noisy_slow = _floor(self.slow, cutoff) > _floor(self.fast, cutoff)
        self.spans, self.only, self.systematic = spans, slowest == 0.0, systematic
        self.time = self.slow.time
        self._fast = spline(self.fast.time, self.fast.values)
        self._slope = self._fast.slope()
        self._own_slope = spline(self.time, self.slow.values)(self.time, 1)
        self._changes = (
            np.column_stack(pair.changes) if pair.changes else np.zeros((pair.clock.values.size, 0))
        )
        self._between = spline(pair.clock.time, self._changes) if pair.changes else None
        self.levels = np.zeros((self.time.size, 0)) if self.only else levels(self.time, slowest)

    def look(self, offset: float, drift: float) -> Looked:
        """Return both records at the slower one's samples, for one offset and drift."""
        stretch = 1.0 + drift
        other = offset + stretch * self.time if self.swapped else (self.time - offset) / stretch
        at = other if self.swapped else self.time
        reference = self.time if self.swapped else other
        use = self.slow.usable & self.fast.usable_at(other)
        if self.only:
            use &= self.numbers(at) >= 0
        inside = np.clip(other, self.fast.start, self.fast.stop)
        there = self._fast(inside)
        # a later offset looks the faster record up later where it is the clock's, else earlier
        moved = 1.0 if self.swapped else -1.0 / stretch
        if self.noisy_slow:
            values, model = self.slow.values, there
            slope, other_slope = moved * self._slope(inside), moved * self._own_slope
        else:
            values, model = there, self.slow.values
            slope, other_slope = -moved * self._own_slope, -moved * self._slope(inside)
        if self.swapped:
            changes = np.zeros((self.time.size, 0)) if self._between is None else self._between(inside)
        else:
            changes = self._changes
        slopes = np.column_stack((slope, slope * reference))
        others = np.column_stack((other_slope, other_slope * reference))
        return Looked(use, values, model, slopes, others, changes, at)

    def numbers(self, at: FloatArray) -> IntegerArray:
        """Return the number of the span that each time on the clock lies in, -1 for none."""
        number = np.full(at.size, -1, dtype=np.int64)
        for index, (start, stop) in enumerate(self.spans):
            number[(at >= start) & (at <= stop)] = index
        return number

    def nuisance(self, looked: Looked) -> FloatArray:
        """Return the columns that a fit is free in: the model and what is slow or level."""
        if not self.only:
            return np.column_stack((looked.model, self.levels))
        number = self.numbers(looked.at)
        own = number[:, None] == np.unique(number[looked.use])
        return np.column_stack((looked.model, own.astype(np.float64)))

    def weights(self, fits: Sequence[Fit], unusual: float = UNUSUAL) -> FloatArray:
        """Return a weight per sample: spans in which no fit comes near the usual one are weighted down.

        Something else shakes the rig there. A span that only one of the fits leaves unexplained keeps its
        weight: it tells the fits apart.
        """
        spans = len(self.spans)
        least = np.full(spans, np.inf)
        for fit in fits:
            number = self.numbers(fit.at)
            inside = fit.use & (number >= 0)
            count = np.bincount(number[inside], minlength=spans)
            scatter = np.bincount(number[inside], fit.residual[inside] ** 2, spans)
            least = np.where(count > 0, np.minimum(least, scatter / np.maximum(count, 1)), least)
        known = np.isfinite(least)
        if not known.any():
            return np.ones(self.time.size)
        usual = max(unusual * float(np.median(least[known])), np.finfo(float).tiny)
        weight = 1.0 / np.sqrt(np.where(known, np.maximum(least / usual, 1.0), 1.0))
        number = self.numbers(fits[0].at)
        return np.where(number >= 0, weight[np.maximum(number, 0)], 1.0)


def _floor(signal: Signal, cutoff: float) -> float:
    """Return the usual power in the upper half of the band, where noise is most of it."""
    values = np.where(signal.usable, signal.values, 0.0)
    power = np.abs(np.fft.rfft(values - np.mean(values))) ** 2 * signal.step / values.size
    frequency = np.fft.rfftfreq(values.size, signal.step)
    return float(np.median(power[(frequency >= 0.5 * cutoff) & (frequency <= cutoff)]))


def levels(time: FloatArray, slowest: float) -> FloatArray:
    """Return a straight line, a parabola and cosines up to a frequency."""
    share = (time - time[0]) / (time[-1] - time[0])
    count = int(2.0 * slowest * (time[-1] - time[0]))
    cosines = [np.cos(np.pi * number * share) for number in range(1, count + 1)]
    return np.column_stack((np.ones(time.size), share - 0.5, (share - 0.5) ** 2, *cosines))


def fitted(
    comparison: ClockAlignment,
    start: tuple[float, float],
    prior: float,
    cutoff: float,
    weight: FloatArray | None = None,
    passes: int = PASSES,
) -> Fit | None:
    """Fit offset and drift so that two records agree.

    Parameters
    ----------
    comparison : ClockAlignment
        The records.
    start : tuple of float
        Offset [s] and drift to start from.
    prior : float
        Standard deviation of the drift beforehand [1]; it matters only where the record cannot tell.
    cutoff : float
        Upper end of the band [Hz].
    weight : ndarray, optional
        (n,) weight of each sample of the slower record.
    passes : int
        Linearised steps at most.

    Returns
    -------
    Fit or None
        None where the records share no samples that carry a delay.

    Notes
    -----
    With the columns Z (the model's slopes by offset and drift) and Y (the values' own) cleared of gain and
    level, the sums ``b = Z'y`` have the mean ``Z'Y x`` and the covariance ``Z'RZ``, R being the
    autocovariance of what is left: noise of the slopes of both is independent, in Z'Z it would pass for
    information. What the rig does not know of itself moves x by ``inv(Z'Y) Z'c`` for each of its changes c,
    and adds the square of that.
    """
    longest = LARGEST_STEP / cutoff
    fit: Fit | None = None
    noise: Noise | None = None
    offset, drift = start
    weight = np.ones(comparison.time.size) if weight is None else weight
    for _ in range(passes):
        taken = _step(comparison, offset, drift, prior, weight, noise)
        if taken is None:
            return None
        fit, step = taken
        settled = noise is not None and abs(step[0]) < CONVERGED
        noise = fit.noise
        if settled:
            break
        shrink = min(1.0, longest / max(abs(step[0]), np.finfo(float).tiny))
        offset, drift = offset + shrink * step[0], drift + shrink * step[1]
    return fit


def _step(
    comparison: ClockAlignment,
    offset: float,
    drift: float,
    prior: float,
    weights: FloatArray,
    noise: Noise | None,
) -> tuple[Fit, FloatArray] | None:
    """Return the fit about an offset and a drift, and what to add to both."""
    looked = comparison.look(offset, drift)
    use = looked.use
    count = int(np.count_nonzero(use))
    free = comparison.nuisance(looked)[use]
    if count < FEWEST + free.shape[1]:
        return None
    weight = weights[use]
    free = weight[:, None] * free
    values = weight * looked.values[use]
    scale = np.linalg.norm(free, axis=0)
    if np.any(scale == 0.0):
        return None
    free = free / scale
    normal = free.T @ free + RIDGE * np.eye(scale.size)
    columns = weight[:, None] * np.column_stack((looked.slopes, looked.others, looked.changes))[use]
    together = np.linalg.solve(normal, free.T @ np.column_stack((values, columns)))
    gain = float(together[0, 0] / scale[0])
    if gain <= 0.0:
        return None
    cleared = np.column_stack((values, columns)) - free @ together
    left, wanted, changes = cleared[:, 0], gain * cleared[:, 1:3], cleared[:, 5:]
    size = np.linalg.norm(wanted, axis=0)
    if size[0] == 0.0:
        return None
    wanted = wanted / size
    spread = np.zeros((use.size, 2))
    spread[use] = wanted
    shared = wanted.T @ (cleared[:, 3:5] / size)
    # the columns have unit length: this is the noise's density where the columns have their power
    level = float(left @ left) / count if noise is None else float(np.max(np.diag(noise.covariance(spread))))
    # each span's own timing error adds up to this much in the sums
    number = comparison.numbers(looked.at)[use]
    apart = (number[:, None] == np.arange(len(comparison.spans))) * (
        comparison.systematic * size[0] * wanted[:, :1]
    )
    changes = np.column_stack((changes, apart))
    known = np.diag([RIDGE / level, 1.0 / (prior * size[1]) ** 2])
    own = wanted.T @ wanted + RIDGE * np.eye(2)
    if np.any(np.diag(shared) < LEAST_SHARED):
        shared = LEAST_SHARED * own
    reach = shared.T @ np.linalg.inv(level * own)
    covariance = np.linalg.inv(reach @ shared + known)
    # noise in the slopes makes this step too short, never too long
    right = wanted.T @ left / level - known @ np.array([0.0, drift * size[1]])
    solution = np.linalg.solve(own / level + known, right)
    moved = covariance @ reach @ (wanted.T @ changes)
    covariance = covariance + moved @ moved.T
    weighted = np.zeros(use.size)
    weighted[use] = left - wanted @ solution
    shortest = min((stop - start for start, stop in comparison.spans), default=np.inf)
    noise = noise_of(
        weighted, count, scale.size + 2, comparison.slow.step, shortest if comparison.only else np.inf
    )
    centred = values - np.mean(values)
    clock_is_model = comparison.swapped == comparison.noisy_slow
    scaled = gain if clock_is_model else 1.0
    kept = np.zeros((use.size, looked.changes.shape[1]))
    kept[use] = cleared[:, 5:] / weight[:, None] / scaled
    slope, signal = np.zeros(use.size), np.zeros(use.size)
    signal[use] = (looked.values[use] - np.mean(looked.values[use])) / scaled
    slope[use] = gain * looked.slopes[use, 0] / scaled
    return Fit(
        offset,
        drift,
        covariance / np.outer(size, size),
        gain if clock_is_model else 1.0 / gain,
        1.0 - float(weighted @ weighted) / max(float(centred @ centred), np.finfo(float).tiny),
        use,
        looked.at,
        weighted / weights / scaled,
        signal,
        slope,
        kept,
        noise,
        scaled,
    ), solution / size
