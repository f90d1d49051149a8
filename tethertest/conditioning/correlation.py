"""Coarse alignment: which offsets between two clocks make one signal fit the other."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from tethertest.records.arrays import BoolArray, FloatArray

IntegerArray: TypeAlias = npt.NDArray[np.int64]

#: offsets are tried on this grid [s]: a tenth of a hertz of 15 Hz ringing turns by 0.05 rad in it
GRID = 1e-3
#: clocks of one run are believed to differ by at most this [s]
SEARCH = 8.0
#: the gain between the two signals lies between these, else they are not the same thing
SMALLEST_GAIN, LARGEST_GAIN = 0.4, 2.5
#: at least this share of the samples must have a partner in the reference's record
OVERLAP = 0.6
#: another offset at least this far from the best is another candidate [s]
APART = 0.02
#: once with all spans alike, once with spans weighted by how well they fit
PASSES = 2
#: a mean square below this is rounding [N^2]
SHARPEST = 1e-12
#: a candidate is out when its misfit exceeds the best by this much, in units of the residual's variance (5
#: sigma)
DECISIVE = 25.0
#: but never when it explains as much of the signal but for this share: filters' ends and drift weigh that
#: much
SAME_SHARE = 0.01


@dataclass(frozen=True, slots=True, eq=False)
class Scan:
    """The fit at every offset tried."""

    lag: FloatArray  #: offsets [s]
    gain: FloatArray  #: of the reference; at offsets where it is not believable the misfit is infinite
    explained: FloatArray  #: fraction of the signal's energy
    misfit: FloatArray  #: mean square of what is left


@dataclass(frozen=True, slots=True)
class Coarse:
    """The best offset of a coarse search, and what else would fit."""

    offset: float  #: [s], clock minus reference
    explained: float  #: fraction of the signal's energy that the reference explains
    rivals: tuple[float, ...]  #: other offsets that the data do not exclude [s]


def best_offset(
    reference_time: FloatArray,
    reference: FloatArray,
    time: FloatArray,
    values: FloatArray,
    use: BoolArray,
    group: IntegerArray,
) -> Coarse | None:
    """Return the offset at which a clock's signal fits the reference best, with a free gain.

    Parameters
    ----------
    reference_time, reference : ndarray
        (n,) stamps of the reference clock [s] and its high-passed signal.
    time, values : ndarray
        (m,) stamps of the other clock [s] and its high-passed signal.
    use : ndarray
        (m,) True for the samples that are compared.
    group : ndarray
        (m,) Number of the span that a sample belongs to: a span that fits badly at the best offset, because
        something else shakes the rig there, counts less when the offsets are compared once more.

    Returns
    -------
    Coarse or None
        None where no offset within `SEARCH` gives a believable gain.
    """
    weight = use.astype(np.float64)
    for _ in range(PASSES):
        scan = _scan(reference_time, reference, time, values, weight)
        best = int(np.argmin(scan.misfit))
        if not np.isfinite(scan.misfit[best]):
            return None
        offset = float(scan.lag[best])
        paired = use & (time - offset >= reference_time[0]) & (time - offset <= reference_time[-1])
        there = np.interp(time[paired] - offset, reference_time, reference)
        residual = values[paired] - scan.gain[best] * there
        previous, weight = weight, np.zeros(time.size)
        weight[paired] = _span_weights(group[paired], values[paired], there)
    white = residual * np.sqrt(previous[paired])
    excess = (scan.misfit / max(float(scan.misfit[best]), SHARPEST) - 1.0) * effective_count(white)
    misfit = scan.misfit
    peak = np.concatenate(([False], (misfit[1:-1] < misfit[:-2]) & (misfit[1:-1] <= misfit[2:]), [False]))
    as_good = (excess < DECISIVE) | (scan.explained > scan.explained[best] - SAME_SHARE)
    rival = peak & as_good & (np.abs(scan.lag - offset) > APART)
    return Coarse(offset, float(scan.explained[best]), tuple(float(item) for item in scan.lag[rival]))


def _span_weights(group: IntegerArray, values: FloatArray, there: FloatArray) -> FloatArray:
    """Return a weight per sample: the inverse variance of its span's misfit, each span with its own gain."""
    count = np.maximum(np.bincount(group), 1)
    energy = np.maximum(np.bincount(group, there**2), SHARPEST)
    product = np.bincount(group, values * there)
    scatter = (np.bincount(group, values**2) - product**2 / energy) / count
    scatter = np.maximum(scatter, SHARPEST)
    return np.asarray(np.median(scatter[np.unique(group)]) / scatter[group], dtype=np.float64)


def _scan(
    reference_time: FloatArray,
    reference: FloatArray,
    time: FloatArray,
    values: FloatArray,
    weight: FloatArray,
) -> Scan:
    """Fit the gain at every offset of the grid, by correlation."""
    start = min(float(reference_time[0]), float(time[0])) - SEARCH
    stop = max(float(reference_time[-1]), float(time[-1])) + SEARCH
    count = int((stop - start) / GRID) + 2
    size = 1 << (count + round(SEARCH / GRID)).bit_length()
    grid = start + GRID * np.arange(count)
    signal = np.interp(grid, reference_time, reference, left=0.0, right=0.0)
    inside = ((grid >= reference_time[0]) & (grid <= reference_time[-1])).astype(np.float64)
    place = np.rint((time - start) / GRID).astype(int)
    lag = np.arange(-round(SEARCH / GRID), round(SEARCH / GRID) + 1)

    def correlated(samples: FloatArray, series: FloatArray) -> FloatArray:
        comb = np.fft.rfft(np.bincount(place, samples, count), size)
        return np.asarray(np.fft.irfft(comb * np.conj(np.fft.rfft(series, size)), size)[lag])

    product = correlated(weight * values, signal)
    energy = correlated(weight, signal**2)
    total = np.maximum(correlated(weight * values**2, inside), SHARPEST)
    compared = correlated(weight, inside)
    gain = product / np.maximum(energy, SHARPEST)
    believed = (gain > SMALLEST_GAIN) & (gain < LARGEST_GAIN) & (compared > OVERLAP * np.sum(weight))
    explained = np.where(believed, product * gain / total, 0.0)
    # per compared sample, so that an offset is not favoured for the samples it leaves without a partner
    misfit = np.where(believed, (1.0 - explained) * total / np.maximum(compared, SHARPEST), np.inf)
    return Scan(np.asarray(lag * GRID, dtype=np.float64), gain, explained, misfit)


def effective_count(residual: FloatArray) -> float:
    """Return how many independent samples a coloured residual amounts to (first-order autoregression).

    Parameters
    ----------
    residual : ndarray
        (n,)
    """
    if residual.size < 3:
        return float(residual.size)
    power = float(np.dot(residual, residual))
    correlation = float(np.dot(residual[1:], residual[:-1])) / power if power > 0.0 else 0.0
    correlation = min(max(correlation, 0.0), 0.999)
    return residual.size * (1.0 - correlation) / (1.0 + correlation)
