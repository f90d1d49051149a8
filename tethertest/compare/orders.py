"""Amplitude ratio and phase difference per order of the drive, both with a standard uncertainty."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from tethertest.records.channel import Channel, Window
from tethertest.records.lines import Line
from tethertest.signal.blocks import block_means
from tethertest.signal.sinusoid import fit_sinusoids

#: blocks per period of the highest order when moved replays are fitted: 0.4 % of a cosine is lost and put
#: back
BLOCKS_PER_PERIOD: Final = 20.0


@dataclass(frozen=True, slots=True)
class OrderError:
    """One order of the replay against the measurement."""

    amplitude: float  #: ratio - 1
    amplitude_uncertainty: float  #: standard, from the measured line and the scale of the cell
    phase: float  #: replayed - measured, between -pi and pi [rad]
    phase_uncertainty: float  #: standard, from the measured line [rad]


def order_error(measured: Line, replayed: Line, scale: float = 0.0) -> OrderError:
    """Compare one order.

    Parameters
    ----------
    measured, replayed : Line
        Of the same order, phases referred to the same time.
    scale : float
        Standard uncertainty of the measured scale, relative.

    Returns
    -------
    OrderError
        First-order propagation; infinite uncertainty where the measured amplitude is zero.
    """
    if measured.amplitude <= 0.0:
        return OrderError(np.inf, np.inf, 0.0, np.inf)
    ratio = replayed.amplitude / measured.amplitude
    relative = measured.standard_error / measured.amplitude
    return OrderError(
        ratio - 1.0,
        float(ratio * np.hypot(relative, scale)),
        wrapped(replayed.phase - measured.phase),
        float(relative),
    )


def wrapped(angle: float) -> float:
    """Return an angle between -pi and pi [rad]."""
    return float(np.angle(np.exp(1j * angle)))


def phasors(channel: Channel, window: Window, frequencies: Sequence[float]) -> dict[float, complex]:
    """Return ``A exp(i phase)`` at each frequency [Hz] by least squares, phases from the window's start."""
    part = channel.between(window.start, window.stop)
    blocks = block_means(part.time, part.values, part.usable, BLOCKS_PER_PERIOD * max(frequencies))
    fit = fit_sinusoids(blocks, frequencies, window.start)
    return {
        frequency: fit.amplitude(index) * complex(np.exp(1j * fit.phase(index)))
        for index, frequency in enumerate(frequencies)
    }
