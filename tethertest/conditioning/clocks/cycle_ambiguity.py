"""Whether the data choose one offset among those that fit: likelihoods of the rivals in coloured noise."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tethertest.conditioning.clocks.alignment import UNUSUAL_ONCE_CHOSEN, ClockAlignment, Fit, fitted
from tethertest.conditioning.clocks.correlation import APART, LARGEST_GAIN, SMALLEST_GAIN
from tethertest.records.arrays import FloatArray

#: a rival is out when its misfit exceeds the best one's by this many standard deviations of the difference
DECISIVE = 5.0
#: and when, where the two differ, it leaves at least this many times as much: the model's own errors are no
#: noise, and do not average out over a ramp
DISTINCT = 1.5
#: and this share of the signal's root mean square there: a ramp or a knock in the wrong place leaves much of
#: itself; less may be ringing that a slow record folds into the band, and tells no cycle
LEAST_SHARE = 0.07
#: the two differ where their difference holds this share of its energy
WHERE_SHARE = 0.9
#: passes of the fit at a candidate
PASSES = 2


@dataclass(frozen=True, slots=True)
class OffsetCandidate:
    """Another offset."""

    offset: float  #: [s]
    sigmas: float  #: how many standard deviations its misfit lies above the best one's


def chosen(
    comparison: ClockAlignment, starts: list[tuple[float, float]], prior: float, cutoff: float
) -> tuple[Fit, tuple[OffsetCandidate, ...]] | None:
    """Return the best fit among candidates, and the rivals that the data do not exclude.

    Parameters
    ----------
    comparison : ClockAlignment
        The records.
    starts : list of tuple
        Offset [s] and drift of every candidate, the best first.
    prior : float
        Standard deviation of the drift beforehand [1].
    cutoff : float
        Upper end of the band [Hz].

    Notes
    -----
    The difference of two sums of squares over the same samples scatters for two reasons: the noise meets the
    difference of the two models (variance ``4 d' R d``), and at either offset another stretch of the
    interpolated record's noise is subtracted (at most ``4 n sum R^2``). R is the autocovariance of what the
    best fit leaves, so what neither model explains counts as noise.
    """
    found: list[Fit] = []
    for start in starts:
        plain = fitted(comparison, start, prior, cutoff, passes=PASSES)
        if plain is not None and SMALLEST_GAIN < plain.gain < LARGEST_GAIN:
            weight = comparison.weights([plain])
            own = fitted(comparison, (plain.offset, plain.drift), prior, cutoff, weight, PASSES)
            found.extend([] if own is None else [own])
    if not found:
        return None
    best = min(found, key=lambda fit: _unlikely(comparison, fit))
    weight = comparison.weights([best], UNUSUAL_ONCE_CHOSEN)
    line = fitted(comparison, (best.offset, best.drift), prior, cutoff, weight)
    if line is None:
        return None
    rivals = []
    for other in found:
        if other is best or abs(other.offset - line.offset) < APART:
            continue
        sigmas, ratio, share = _worse(line, other, comparison.weights([line, other]))
        if sigmas < DECISIVE or ratio < DISTINCT or share < LEAST_SHARE:
            rivals.append(OffsetCandidate(other.offset, sigmas))
    return line, tuple(sorted(rivals, key=lambda item: item.sigmas))


def _unlikely(comparison: ClockAlignment, fit: Fit) -> float:
    """Return minus the logarithm of the likelihood per sample, each span with a variance of its own."""
    number = comparison.numbers(fit.at)
    inside = fit.use & (number >= 0)
    count = np.bincount(number[inside], minlength=len(comparison.spans))
    scatter = np.bincount(number[inside], fit.residual[inside] ** 2, len(comparison.spans))
    kept = count > 0
    variance = np.maximum(scatter[kept] / count[kept], np.finfo(float).tiny)
    return float(np.sum(count[kept] * np.log(variance)) / max(int(np.sum(count)), 1))


def _worse(best: Fit, other: Fit, weight: FloatArray) -> tuple[float, float, float]:
    """Return by how many standard deviations the other fits worse, and what it leaves where they differ.

    That is over what the best one leaves there, as energies, and over the signal, as root mean squares.
    """
    both = best.use & other.use
    left = np.where(both, weight * best.residual, 0.0)
    rest = np.where(both, weight * other.residual, 0.0)
    apart: FloatArray = rest - left
    difference = float(np.sum(rest**2) - np.sum(left**2))
    count = int(np.count_nonzero(both))
    variance = float(best.noise.covariance(apart[:, None] / best.scale)[0, 0])
    variance += count * best.noise.squared_correlation / best.scale**4
    order = np.argsort(apart**2)[::-1]
    energy = np.cumsum(apart[order] ** 2)
    where = order[: int(np.searchsorted(energy, WHERE_SHARE * energy[-1])) + 1]
    tiny = np.finfo(float).tiny
    ratio = float(np.sum(rest[where] ** 2) / max(float(np.sum(left[where] ** 2)), tiny))
    signal = float(np.mean((weight * best.signal)[where] ** 2))
    share = float(np.sqrt(np.mean(rest[where] ** 2) / max(signal, tiny)))
    return difference / (2.0 * np.sqrt(max(variance, tiny))), ratio, share
