"""The drive as it repeats itself, which tells the motion beside the end of a record and across a hole."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tethertest.records.arrays import BoolArray, FloatArray

#: orders of the drive that repeat; a gear error runs at half the speed
ORDERS = (0.5, 1.0, 1.5, 2.0, 3.0, 4.0)
#: periods of the drive that are fitted, and the fewest that can be
PERIODS, FEWEST = 4.0, 3.0
#: a fit that leaves more than this share of the amplitude is none: the drive ramps there
LEFT_OVER = 0.01
#: times that the frequency is corrected
CORRECTIONS = 3
#: a correction of the frequency larger than this share is another drive
FARTHEST = 0.1


@dataclass(frozen=True, slots=True, eq=False)
class Repetition:
    """A sum of orders of the drive."""

    frequency: float  #: [Hz], as fitted
    origin: float  #: [s], where the angles count from
    coefficients: FloatArray  #: mean, then cosine and sine of each of `ORDERS`

    def at(self, time: FloatArray) -> FloatArray:
        """Return the motion [m] at any times [s]."""
        return np.asarray(_columns(time - self.origin, self.frequency) @ self.coefficients)


def fit_repetition(
    time: FloatArray, values: FloatArray, known: BoolArray, frequency: float
) -> Repetition | None:
    """Fit the orders of the drive to a stretch of the motion.

    Parameters
    ----------
    time, values : ndarray
        (n,) [s] and [m].
    known : (n,) bool
        Samples that were measured.
    frequency : float
        Of the drive, to a few per cent [Hz].

    Returns
    -------
    Repetition or None
        None where fewer than `FEWEST` periods are known, or the motion does not repeat itself.
    """
    time, values = time[known], values[known]
    if time.size < 4 * len(ORDERS) or (time[-1] - time[0]) * frequency < FEWEST:
        return None
    origin = 0.5 * float(time[0] + time[-1])
    angle_time, nominal = time - origin, frequency
    for _ in range(CORRECTIONS):
        columns = _columns(angle_time, frequency)
        first = 1 + 2 * ORDERS.index(1.0)
        # a little more frequency turns order 1 in proportion to the time
        turned = angle_time[:, None] * columns[:, [first, first + 1]]
        found = np.linalg.lstsq(np.hstack((columns, turned)), values, rcond=None)[0]
        cosine, sine = found[first : first + 2]
        power = cosine**2 + sine**2
        if power <= 0.0:
            return None
        frequency += float(sine * found[-2] - cosine * found[-1]) / power / (2.0 * np.pi)
        if abs(frequency - nominal) > FARTHEST * nominal:
            return None
    columns = _columns(angle_time, frequency)
    coefficients = np.asarray(np.linalg.lstsq(columns, values, rcond=None)[0], dtype=np.float64)
    left = float(np.sqrt(np.mean((values - columns @ coefficients) ** 2)))
    amplitude = float(np.hypot(*coefficients[first : first + 2]))
    if left > LEFT_OVER * amplitude:
        return None
    return Repetition(frequency, origin, coefficients)


def _columns(time: FloatArray, frequency: float) -> FloatArray:
    angles = 2.0 * np.pi * frequency * np.outer(time, ORDERS)
    pairs = np.stack((np.cos(angles), np.sin(angles)), axis=2).reshape(time.size, -1)
    return np.hstack((np.ones((time.size, 1)), pairs))
