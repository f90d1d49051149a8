"""The Sprague-Geers metric: one number for magnitude, one for phase, one for both.

References
----------
M. A. Sprague, T. L. Geers, A spectral-element method for modelling cavitation in transient fluid-structure
interaction, Int. J. Numer. Meth. Eng. 60 (2004) 2467-2499.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tethertest.errors import DataError
from tethertest.records.arrays import BoolArray, FloatArray


@dataclass(frozen=True, slots=True)
class SpragueGeers:
    """Magnitude, phase and comprehensive error; all zero for equal signals."""

    magnitude: float  #: M = sqrt(Icc / Imm) - 1, positive where the replay is larger
    phase: float  #: P = arccos(Imc / sqrt(Imm Icc)) / pi, between 0 and 1
    combined: float  #: C = hypot(M, P)


def sprague_geers(
    time: FloatArray,
    measured: FloatArray,
    replayed: FloatArray,
    usable: BoolArray | None = None,
    noise_variance: float = 0.0,
) -> SpragueGeers:
    """Compare two signals over the same times.

    Parameters
    ----------
    time : (n,) float64
        Strictly increasing [s]; integrals are by trapezoid.
    measured, replayed : (n,) float64
        In the same unit, static part removed by the caller.
    usable : (n,) bool, optional
        Samples that count; an interval counts where both its ends do.
    noise_variance : float
        Variance of the noise in `measured`, in its unit squared. Its energy is taken off ``int m^2``, which
        otherwise makes a noisy measurement look larger than a right replay, and out of phase with it.

    Returns
    -------
    SpragueGeers
        The three errors.

    Raises
    ------
    DataError
        A signal is zero throughout, or nothing but noise.
    """
    inside = np.ones(time.size, dtype=bool) if usable is None else usable
    steps = np.diff(time) * (inside[1:] & inside[:-1])
    weights = 0.5 * (np.append(steps, 0.0) + np.append(0.0, steps))
    used = weights > 0.0
    weights, measured, replayed = weights[used], measured[used], replayed[used]
    energy_measured = float(weights @ measured**2) - noise_variance * float(weights.sum())
    energy_replayed = float(weights @ replayed**2)
    if energy_measured <= 0.0 or energy_replayed <= 0.0:
        which = (
            "replayed signal is zero"
            if energy_replayed <= 0.0
            else "measured signal is no larger than its noise"
        )
        message = f"the {which}, so that relative errors have no meaning"
        raise DataError(message, "compare a channel that moves")
    cosine = float(weights @ (measured * replayed)) / np.sqrt(energy_measured * energy_replayed)
    magnitude = float(np.sqrt(energy_replayed / energy_measured) - 1.0)
    phase = float(np.arccos(np.clip(cosine, -1.0, 1.0)) / np.pi)
    return SpragueGeers(magnitude, phase, float(np.hypot(magnitude, phase)))
