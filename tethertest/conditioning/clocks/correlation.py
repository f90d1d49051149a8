"""Coarse alignment: which offsets between two clocks make one signal fit the other."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import reduce
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from tethertest.conditioning.clocks.alignment import AlignmentSignals, ClockAlignment, IntegerArray, levels
from tethertest.conditioning.clocks.uniform import Signal
from tethertest.records.arrays import FloatArray

ComplexArray: TypeAlias = npt.NDArray[np.complex128]

#: offsets are tried this fraction of the shortest period apart, but no finer and no coarser than this [s]
GRID_SHARE, FINEST, COARSEST = 0.06, 2e-3, 2e-2
#: clocks of one run are believed to differ by at most this [s]
SEARCH = 8.0
#: and offsets are tried this much farther, as rivals: a cycle of the slowest drive [s]
RIVALS = 10.0
#: the gain between the two signals lies between these, else they are not the same thing
SMALLEST_GAIN, LARGEST_GAIN = 0.4, 2.5
#: at least this share of the samples must have a partner in the other record
OVERLAP = 0.6
#: another offset at least this far from the best is another candidate [s]
APART = 0.02
#: a mean square below this is rounding [N^2]
SHARPEST = 1e-12


@dataclass(frozen=True, slots=True, eq=False)
class Scan:
    """The fit at every offset tried, each with the best of the drifts tried."""

    lag: FloatArray  #: offsets [s]
    misfit: FloatArray  #: mean square of what is left; infinite where the gain is not believable
    explained: FloatArray  #: fraction of the signal's energy
    drift: FloatArray

    def or_better(self, other: Scan) -> Scan:
        """Return whichever fits better, offset by offset."""
        better = other.misfit < self.misfit
        return Scan(
            np.where(better, other.lag, self.lag),
            np.where(better, other.misfit, self.misfit),
            np.where(better, other.explained, self.explained),
            np.where(better, other.drift, self.drift),
        )

    def candidates(self, most: int) -> list[tuple[float, float]]:
        """Return offset and drift of the best local minima of the misfit, the best first."""
        padded = np.concatenate(([np.inf], self.misfit, [np.inf]))
        least = (padded[1:-1] <= padded[:-2]) & (padded[1:-1] < padded[2:]) & np.isfinite(self.misfit)
        places = np.flatnonzero(least)
        places = places[np.argsort(self.misfit[places], kind="stable")]
        chosen: list[int] = []
        for place in places:
            if all(abs(self.lag[place] - self.lag[other]) > APART for other in chosen):
                chosen.append(int(place))
            if len(chosen) == most:
                break
        return [(float(self.lag[place]), float(self.drift[place])) for place in chosen]


def scanned(
    comparison: ClockAlignment, pair: AlignmentSignals, believable_drift: float, slowest: float, cutoff: float
) -> Scan:
    """Fit the gain at every offset of a grid, by correlation.

    Parameters
    ----------
    comparison : ClockAlignment
        For its spans.
    pair : AlignmentSignals
        Both records in the band that is compared.
    believable_drift : float
        Largest drift [1]: over a long record it moves the ends apart.
    slowest, cutoff : float
        The band [Hz]; a `slowest` of 0 says that the signals are level as they are.
    """
    from scipy.fft import irfft, next_fast_len, rfft

    clock, reference = pair.clock, pair.reference
    if slowest > 0.0:
        clock, reference = _level(clock, slowest), _level(reference, slowest)
    use = clock.usable.copy()
    if comparison.only:
        use &= comparison.numbers(clock.time) >= 0
    grid = float(np.clip(GRID_SHARE / cutoff, FINEST, COARSEST))
    length = max(clock.stop - clock.start, reference.stop - reference.start)
    most = int(np.ceil(0.5 * believable_drift * length / grid))
    drifts = believable_drift * np.linspace(-1.0, 1.0, 2 * most + 1)
    time, values = clock.time[use], clock.values[use]
    reach = SEARCH + RIVALS
    first = min(reference.start, clock.start * (1.0 - believable_drift)) - reach - 1.0
    last = max(reference.stop, clock.stop * (1.0 + believable_drift)) + reach + 1.0
    count = int((last - first) / grid) + 2
    size = int(next_fast_len(count + round(reach / grid), real=True))
    instants = np.asarray(first + grid * np.arange(count), dtype=np.float64)
    seen = reference.usable_at(instants)
    signal = np.where(seen, np.interp(instants, reference.time, reference.values), 0.0)
    spectra = [np.conj(rfft(series, size)) for series in (signal, signal**2, seen.astype(np.float64))]
    steps = np.arange(-round(reach / grid), round(reach / grid) + 1)

    def correlated(comb: ComplexArray, spectrum: ComplexArray) -> FloatArray:
        return np.asarray(irfft(comb * spectrum, size)[steps], dtype=np.float64)

    scans: list[Scan] = []
    for drift in drifts:
        place = (time / (1.0 + drift) - first) / grid
        below = place.astype(np.int64)
        share = place - below

        def comb(samples: FloatArray, below: IntegerArray = below, share: FloatArray = share) -> ComplexArray:
            spread = np.bincount(below, samples * (1.0 - share), count)
            spread += np.bincount(below + 1, samples * share, count)
            return np.asarray(rfft(spread, size), dtype=np.complex128)

        there = comb(np.ones(time.size))
        product = correlated(comb(values), spectra[0])
        energy = np.maximum(correlated(there, spectra[1]), SHARPEST)
        compared = correlated(there, spectra[2])
        total = np.maximum(correlated(comb(values**2), spectra[2]), SHARPEST)
        gain = product / energy
        shared = OVERLAP * min(time.size, np.count_nonzero(seen) * grid / clock.step)
        believed = (gain > SMALLEST_GAIN) & (gain < LARGEST_GAIN) & (compared > shared)
        explained = np.where(believed, product * gain / total, 0.0)
        # per compared sample: no offset is favoured for the samples it leaves without a partner
        misfit = np.where(believed, (1.0 - explained) * total / np.maximum(compared, 1.0), np.inf)
        scan = Scan(grid * steps * (1.0 + drift), misfit, explained, np.full(steps.size, drift))
        scans.append(scan)
    return reduce(Scan.or_better, scans)


def _level(signal: Signal, slowest: float) -> Signal:
    """Return the signal without what its levels explain."""
    columns = levels(signal.time, slowest)
    use = signal.usable
    found = np.linalg.solve(
        columns[use].T @ columns[use] + SHARPEST * np.eye(columns.shape[1]),
        columns[use].T @ signal.values[use],
    )
    return replace(signal, values=signal.values - columns @ found)
