"""A drive near a natural frequency, or near one that it can pump."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from tethertest.records.response import NaturalFrequency

#: a drive this close to a natural frequency, relative, is called near it
NEAR: Final = 0.1
#: half width of a tongue of instability where the modulation is not known, relative
TONGUE: Final = 0.05


def resonance_notes(
    drive: float, naturals: Sequence[NaturalFrequency], modulation: float | None = None
) -> tuple[str, ...]:
    """Say which natural frequencies the drive is near, or may pump.

    A stiffness that the drive modulates, ``x'' + 2 z w x' + w^2 (1 + h cos 2 pi f t) x = 0``, is unstable
    about ``f = 2 f_n`` within ``h/4``, relative, where h exceeds ``4 z``; the second, narrower tongue lies
    about ``f = f_n``. The lateral stiffness of a tether is its tension, so h is dynamic over static tension.

    Parameters
    ----------
    drive : float
        Drive frequency [Hz].
    naturals : sequence of NaturalFrequency
        Known beforehand.
    modulation : float, optional
        Amplitude of the tension at the drive's frequency over its mean; None where not known.

    Returns
    -------
    tuple of str
        One sentence per natural frequency concerned.

    References
    ----------
    A. H. Nayfeh, D. T. Mook, Nonlinear Oscillations (1979), section 5.7.
    """
    notes = []
    for natural in naturals:
        ratio = drive / natural.frequency
        twice = drive / (2.0 * natural.frequency)
        width = TONGUE if modulation is None else max(TONGUE, 0.25 * modulation)
        if abs(twice - 1.0) <= width:
            how = (
                "the modulation of the tension is not known"
                if modulation is None
                else f"the tension is modulated by {modulation:.2g}, which needs a damping ratio below "
                f"{0.25 * modulation:.2g}"
            )
            notes.append(
                f"possible parametric resonance: the drive, {drive:.4g} Hz, is {2.0 * twice:.3g} times "
                f"{natural.name} ({natural.frequency:.4g} Hz); {how}. It shows at order 1/2"
            )
        elif abs(ratio - 1.0) <= NEAR:
            notes.append(f"the drive, {drive:.4g} Hz, is near {natural.name} ({natural.frequency:.4g} Hz)")
    return tuple(notes)
