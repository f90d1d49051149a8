"""The share of locked lines found, against the F test's own; bias and coverage."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from reports.line_calibration.rates import HALF, analysed
from reports.line_calibration.records import (
    COUNT,
    NOISE,
    STANDARD_ERROR,
    TIME,
    Noise,
    Record,
    autoregressive,
    cosine,
    driven,
    noisy,
    one_over_f,
    some_drive,
    tension,
    white,
    with_half,
)
from tethertest.records.lines import Expectation, LineVerdict
from tethertest.spectra.lines import SIGNIFICANCE
from tethertest.spectra.orders import ORDERS

#: amplitudes tried, in standard errors
AMPLITUDES: Final = (1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 10.0, 30.0)
#: share of the F test's power that the other six conditions may cost
PRICE: Final = 0.15
#: and at this many standard errors this share is found
SURE, SURE_POWER = 7.0, 0.9
#: orders 1, 2 and 3 are always found, and Holm's rule then no longer counts them
ALWAYS_FOUND: Final = 3
#: coefficients besides noise: offset, drift and the orders
FITTED: Final = 38
#: blocks of three samples
BLOCKS: Final = COUNT // 3
#: largest bias of a de-biased amplitude, relative, and share of records with a line left undetermined
BIAS, UNDETERMINED = 0.01, 0.05
#: orders whose intervals are watched, with amplitudes in white standard errors
COVERED: Final = ("1/2", "2/3", "3/2", "5/2", "4", "5")
COVERED_AMPLITUDE: Final = 50.0
NOISES: Final[tuple[tuple[str, Noise, float], ...]] = (
    ("white", white, 0.01),
    ("AR(1) 0.9", autoregressive, 0.03),
    ("1/f", one_over_f, 0.03),
)


@dataclass(frozen=True, slots=True)
class Found:
    """Locked lines of one amplitude."""

    amplitude: float  #: in standard errors
    records: int
    found: int  #: called subharmonic
    significant: int  #: called anything at all
    undetermined: int
    theory: float  #: power of the F test
    bias: float  #: of the de-biased amplitude, relative
    raw_bias: float  #: of the raw one

    @property
    def power(self) -> float:
        """Share found."""
        return self.found / self.records

    @property
    def interval(self) -> tuple[float, float]:
        """Shares that hold the true power with a chance of 95 % at least."""
        return binomial_interval(self.found, self.records)


@dataclass(frozen=True, slots=True)
class Coverage:
    """How often 95 % intervals hold the true amplitude."""

    noise: str
    intervals: int
    inside: int
    allowed: float  #: departure from 0.95

    @property
    def share(self) -> float:
        """Share of the intervals that hold it."""
        return self.inside / self.intervals


def binomial_interval(count: int, records: int) -> tuple[float, float]:
    """Return the 95 % interval of a share; it holds the true one 95 times in 100 or more.

    References
    ----------
    C. J. Clopper, E. S. Pearson, Biometrika 26 (1934) 404-413.
    """
    from scipy.stats import beta

    low = float(beta.ppf(0.025, count, records - count + 1)) if count else 0.0
    high = float(beta.ppf(0.975, count + 1, records - count)) if count < records else 1.0
    return low, high


def theoretical_power(amplitude: float) -> float:
    """Return the chance that the F test alone finds a line at Holm's level for the weakest of those left.

    Parameters
    ----------
    amplitude : float
        In standard errors.
    """
    from scipy.stats import f, ncf

    freedom = BLOCKS - FITTED
    critical = f.isf(SIGNIFICANCE / (len(ORDERS) - ALWAYS_FOUND), 2, freedom)
    return float(ncf.sf(critical, 2, freedom, amplitude**2))


def found_at(amplitude: float, records: int, seed: int = 2) -> Found:
    """Return what became of locked lines of one amplitude in white noise."""
    random = np.random.default_rng(seed)
    make = noisy(white)
    found = significant = undetermined = 0
    values, raw = [], []
    for _ in range(records):
        record = with_half(make(random), random, amplitude * STANDARD_ERROR)
        lines = analysed(record)
        half = lines.line(HALF)
        if half is None:
            continue
        found += half.verdict is LineVerdict.SUBHARMONIC
        significant += half.verdict is not LineVerdict.NONE
        undetermined += half.verdict is LineVerdict.UNDETERMINED
        values.append(half.amplitude)
        # what was taken off by the de-biasing is one variance
        raw.append(np.hypot(half.amplitude, half.standard_error))
    true = amplitude * STANDARD_ERROR
    return Found(
        amplitude,
        records,
        found,
        significant,
        undetermined,
        theoretical_power(amplitude),
        float(np.mean(values)) / true - 1.0,
        float(np.mean(raw)) / true - 1.0,
    )


def coverage(name: str, noise: Noise, allowed: float, records: int, seed: int = 3) -> Coverage:
    """Return how often the intervals of lines at known amplitudes hold them."""
    random = np.random.default_rng(seed)
    inside = total = 0
    true = COVERED_AMPLITUDE * STANDARD_ERROR
    for _ in range(records):
        frequency = some_drive(random)
        values = driven(random, frequency) + NOISE * noise(random)
        for order in COVERED:
            numerator, _, denominator = order.partition("/")
            own = frequency * float(numerator) / float(denominator or 1)
            values = values + cosine(TIME, own, true, random.uniform(0.0, 2.0 * np.pi))
        lines = analysed(Record(tension(values), None, frequency, Expectation()))
        for order in COVERED:
            line = lines.line(order)
            if line is not None:
                total += 1
                inside += line.interval[0] <= true <= line.interval[1]
    return Coverage(name, total, inside, allowed)
