"""How the gratings of a fibre move together: the pattern of their wavelengths, learnt from whole rows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tethertest.records.arrays import BoolArray, FloatArray
from tethertest.signal.noise import MAD_TO_SIGMA

#: fewer rows than this share, or this number, with all gratings teach nothing
FULL_FRACTION, FEWEST_FULL = 0.05, 20
#: a learnt tolerance is so many standard deviations of the residual by its median: nearly half of the whole
#: rows may hold a ghost in the place of a lost peak
TOLERANCE_SIGMAS = 8.0
#: and at least this [m]: interrogators repeat within a picometre or a few
LEAST_TOLERANCE = 4e-12
#: gratings may part from the common motion by this share of what it does from row to row: a wave needs its
#: time along the cable
MOTION_SHARE = 0.3
#: without a learnt pattern, gratings part by this share of the distance to the nearest neighbour
COARSE_SHARE = 0.25
#: the common motion changes from row to row by at most so many times what rows with as many peaks show
RATE_MARGIN = 1.5
#: gratings that follow the common motion by less than this do not tell it
LEAST_GAIN = 0.3
#: whole rows tell the gains where the spread of their motion is this share of the tolerance (8 deviations)
TELLING = 0.5
#: outside the motion that whole rows show, gratings may part by this share of what is beyond it
GAIN_SPREAD = 0.25
#: passes of the fit of common motion and gains, and the residuals that count in it, in standard deviations
PASSES, TRIMMED = 6, 3.0


@dataclass(frozen=True, slots=True, eq=False)
class Pattern:
    """Wavelengths of all gratings for a common relative shift c: ``expected (1 + offset + gain c)``."""

    expected: FloatArray  #: (g,) [m]
    capture: FloatArray  #: (g,) [m]
    offset: FloatArray  #: (g,) relative, at c = 0
    gain: FloatArray  #: (g,) 1 for a grating that moves with the others, about 0 for a free one
    tolerance: FloatArray  #: (g,) relative: largest distance from the pattern in calm rows
    rate: float  #: largest believable change of c [1/s]
    reach: float  #: largest believable c, by the capture ranges
    low: float  #: smallest and largest c of the rows that taught the pattern
    high: float
    slack: float  #: c of one row is known no better than this
    strained: BoolArray  #: (g,) False for gratings that are free of strain

    def wavelength(self, shift: FloatArray) -> FloatArray:
        """Return the wavelengths (..., g) [m] for common shifts (...)."""
        return np.asarray(self.expected * (1.0 + self.offset + self.gain * shift[..., None]))

    def shift_of(self, peaks: FloatArray) -> FloatArray:
        """Return the common shift (..., g) that each grating's peak asks for, NaN where it tells nothing."""
        gain = np.where(np.abs(self.gain) >= LEAST_GAIN, self.gain, np.nan)
        return np.asarray((peaks / self.expected - 1.0 - self.offset) / gain)


def coarse(
    expected: FloatArray, capture: FloatArray, strained: BoolArray, peaks: FloatArray, time: FloatArray
) -> Pattern:
    """Return the pattern of a rig file alone: what its expected wavelengths and capture ranges allow.

    Parameters
    ----------
    expected, capture : ndarray
        (g,) expected wavelengths and largest believable distances from them [m].
    strained : ndarray
        (g,) False for gratings that are free of strain.
    peaks : ndarray
        (n, p) all peaks [m], for the rate at which they move.
    time : ndarray
        (n,) [s].
    """
    distance = np.abs(expected[:, None] - expected) + np.where(np.eye(expected.size, dtype=bool), np.inf, 0.0)
    nearest = np.minimum(np.min(distance, axis=1, initial=np.inf), 4.0 * capture)
    reach = float(np.max(capture / expected)) / LEAST_GAIN
    return Pattern(
        expected,
        capture,
        np.zeros(expected.size),
        strained.astype(np.float64),
        COARSE_SHARE * nearest / expected,
        _rate(peaks, time) / float(np.mean(expected)),
        reach,
        -reach,
        reach,
        2.0 * float(np.max(COARSE_SHARE * nearest / expected)),
        strained,
    )


def learnt(
    base: Pattern, whole: FloatArray, rows: np.ndarray, total: int
) -> tuple[Pattern, FloatArray, BoolArray] | None:
    """Return the pattern that whole rows show.

    Parameters
    ----------
    base : Pattern
        The coarse one.
    whole : ndarray
        (m, g) peaks of the rows in which every grating of the log was seen [m]; NaN for gratings that the
        log never shows.
    rows : ndarray
        (m,) their numbers.
    total : int
        Rows of the log.

    Returns
    -------
    tuple or None
        Pattern, common shift of each row, and which rows keep to the pattern; None for too few rows.
    """
    if rows.size < max(FEWEST_FULL, FULL_FRACTION * total):
        return None
    seen = np.asarray(np.isfinite(whole).all(axis=0))
    relative = whole / base.expected - 1.0
    gain = np.where(seen, base.gain, 0.0)
    if not np.any(gain >= LEAST_GAIN):
        gain = seen.astype(np.float64)
    offset = np.where(seen, np.median(np.where(seen, relative, 0.0), axis=0), 0.0)
    shift = np.zeros(rows.size)
    for _ in range(PASSES):
        telling = np.flatnonzero(gain >= LEAST_GAIN)
        asked = (relative[:, telling] - offset[telling]) / gain[telling]
        shift = np.asarray(np.median(asked, axis=1), dtype=np.float64)
        for grating in np.flatnonzero(seen):
            gain[grating], offset[grating] = _line(shift, relative[:, grating], gain[grating])
        # only the product of gain and shift is seen: gratings that move together have gains about 1
        gain = np.asarray(gain / float(np.median(gain[telling])))
    if float(np.std(shift)) < TELLING * _calm(relative - offset - gain * shift[:, None], seen).max():
        gain = np.where(seen, base.gain, 0.0)
        shift = np.zeros(rows.size)
        offset = np.where(seen, np.median(np.where(seen, relative, 0.0), axis=0), 0.0)
    residual = np.where(seen, relative - offset - gain * shift[:, None], 0.0)
    spread = np.abs(residual)
    calm = _calm(residual, seen)
    tolerance = np.minimum(np.maximum(calm, LEAST_TOLERANCE / base.expected), base.tolerance)
    unseen_offset = float(np.median(offset[seen]))
    tolerance = np.where(seen, tolerance, base.tolerance)
    speed = _speed(shift, rows)
    keeps = np.all(spread <= tolerance + MOTION_SHARE * speed[:, None], axis=1)
    if np.count_nonzero(keeps) < FEWEST_FULL:
        return None
    pattern = Pattern(
        base.expected,
        base.capture,
        np.where(seen, offset, unseen_offset),
        np.where(seen, gain, base.gain),
        tolerance,
        base.rate,
        base.reach,
        float(shift[keeps].min()),
        float(shift[keeps].max()),
        2.0 * float(np.max(tolerance[seen])),
        base.strained,
    )
    return pattern, shift, keeps


def _calm(residual: FloatArray, seen: BoolArray) -> FloatArray:
    spread = np.median(np.abs(np.where(seen, residual, 0.0)), axis=0)
    return np.asarray(TOLERANCE_SIGMAS * MAD_TO_SIGMA * spread, dtype=np.float64)


def _line(shift: FloatArray, values: FloatArray, gain: float) -> tuple[float, float]:
    """Return slope and offset of values against the shift, rows far off left out."""
    centred = values - gain * shift
    middle = float(np.median(centred))
    spread = np.abs(centred - middle)
    inside = spread <= TRIMMED * MAD_TO_SIGMA * float(np.median(spread))
    x, y = shift[inside], values[inside]
    variance = float(np.var(x))
    if variance == 0.0:
        return gain, middle
    slope = float(np.mean((x - x.mean()) * (y - y.mean()))) / variance
    return slope, float(y.mean() - slope * x.mean())


def _speed(shift: FloatArray, rows: np.ndarray) -> FloatArray:
    """Return the larger change of the shift to the whole rows before and after."""
    step = np.abs(np.diff(shift))
    return np.asarray(np.maximum(np.concatenate((step[:1], step)), np.concatenate((step, step[-1:]))))


def _rate(peaks: FloatArray, time: FloatArray) -> float:
    """Return the fastest believable common motion [m/s]: between rows that show as many peaks.

    A peak that goes while another comes makes it too large, which only leaves more in doubt.
    """
    ordered = np.sort(peaks, axis=1)
    count = np.sum(np.isfinite(peaks), axis=1)
    step = np.diff(time)
    near = (np.diff(count) == 0) & (count[1:] > 0) & (step <= 2.0 * float(np.median(step)))
    if np.count_nonzero(near) < FEWEST_FULL:
        return np.inf
    moved = np.nanmedian(np.diff(ordered, axis=0)[near], axis=1)
    return RATE_MARGIN * float(np.max(np.abs(moved) / step[near]))
