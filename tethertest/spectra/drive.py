"""The frequency of the drive, fitted jointly over channels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Final

import numpy as np

from tethertest.errors import DataError
from tethertest.records.arrays import FloatArray
from tethertest.records.channel import Channel, Window
from tethertest.records.lines import DriveFit
from tethertest.signal.blocks import Blocks
from tethertest.signal.sinusoid import SinusoidFit
from tethertest.spectra.orders import COMPANIONS, ORDERS
from tethertest.spectra.regression import (
    Amplitude,
    OrderFit,
    channel_blocks,
    local_p_value,
    order_amplitudes,
    order_sinusoids,
    with_noise,
)

#: the drive is looked for this far from its nominal frequency, relative
SEARCH: Final = 0.15
FUNDAMENTAL: Final = Fraction(1)
#: orders whose phases carry the frequency
DRIVE_ORDERS: Final = (Fraction(1), Fraction(2), Fraction(3))
#: points of the search per 1/T: finer than the width of a spectral peak
POINTS_PER_RESOLUTION: Final = 8
#: chance at which a fundamental is believed, over all frequencies searched and all channels
SIGNIFICANCE: Final = 0.01
#: Gauss-Newton steps; the search starts within an eighth of 1/T and the error squares at each step
STEPS: Final = 8
#: passes over the weights of the channels: by what the fit leaves in all, then by the noise next to the line
WEIGHTINGS: Final = 2
#: keeps a channel without any noise from a weight without bound
SMALLEST_VARIANCE: Final = 1e-300
#: a step below this share of the nominal frequency ends the fit
CONVERGED: Final = 1e-9
#: mains frequency whose whole periods make the blocks
MAINS: Final = 50.0


@dataclass(frozen=True, slots=True, eq=False)
class _Tangent:
    """One channel about the current frequency: what is left, and how it would change with frequency."""

    blocks: Blocks
    orders: tuple[Fraction, ...]
    sinusoids: SinusoidFit
    slope: FloatArray  #: (b,) weighted derivative of the model by frequency, free of the other coefficients
    stiffness: float  #: of the weighted squares against a change of frequency
    variance: float  #: noise of one block at the fundamental


@dataclass(frozen=True, slots=True, eq=False)
class _Seen:
    """What a channel shows of the drive once its frequency is fitted."""

    fit: OrderFit
    fundamental: Amplitude
    p_value: float  #: against the smooth density and against the residual next to the line, the larger


def fit_drive(channels: Sequence[Channel], window: Window, nominal: float) -> DriveFit:
    """Fit the fundamental frequency of the drive to several channels at once.

    A search over zero-padded spectra within 15 % of the nominal frequency, then Gauss-Newton on the frequency
    with offset, drift and all orders of every channel projected out (variable projection); the first three
    carry it.

    Parameters
    ----------
    channels : sequence of Channel
        On one clock; those without enough usable samples in the window are passed over.
    window : Window
        The steady part of the run.
    nominal : float
        Frequency as set [Hz].

    Returns
    -------
    DriveFit
        Frequency and standard error under coloured residuals [Hz], and the channels that show the
        fundamental.

    Raises
    ------
    DataError
        No channel shows a fundamental near the nominal frequency, or none has enough samples.

    References
    ----------
    G. Golub, V. Pereyra, SIAM J. Numer. Anal. 10 (1973) 413-432 (variable projection).
    """
    used: list[tuple[str, Blocks]] = []
    refusals: list[DataError] = []
    for channel in channels:
        try:
            used.append((channel.name, channel_blocks(channel, window, nominal, MAINS)))
        except DataError as error:
            refusals.append(error)
    if not used:
        raise refusals[0] if refusals else DataError("no channel to fit the drive to", "name a channel")
    frequency = _strongest([blocks for _, blocks in used], nominal)
    variances: list[float | None] = [None] * len(used)
    tangents: list[_Tangent] = []
    fits: list[OrderFit] = []
    for _ in range(WEIGHTINGS):
        tangents, fits = [], []  # those of a long record are as large as it
        frequency, tangents = _settle(
            [blocks for _, blocks in used], variances, frequency, nominal, window.start
        )
        fits = [with_noise(item.blocks, frequency, item.orders, item.sinusoids) for item in tangents]
        # the noise next to the line, not that of the whole band, says what a channel is worth
        variances = [float(fit.noise.density(frequency)[0]) * fit.blocks.rate / 2.0 for fit in fits]
        if len(used) == 1:
            break
    tangents = [
        replace(item, variance=value) for item, value in zip(tangents, variances, strict=True) if value
    ]
    shown = [_seen(fit) for fit in fits]
    searched = max(1.0, 2.0 * SEARCH * nominal * window.length) * len(used)
    # a fit that ran to the end of the search climbs the skirt of a line beyond it
    at_edge = abs(abs(frequency / nominal - 1.0) - SEARCH) < CONVERGED
    seen = tuple(
        name
        for (name, _), item in zip(used, shown, strict=True)
        if item.p_value * searched < SIGNIFICANCE and not at_edge
    )
    if not seen:
        raise _no_drive(used, shown, frequency, nominal, searched)
    return DriveFit(frequency, _standard_error(tangents, shown), seen)


def _strongest(series: Sequence[Blocks], nominal: float) -> float:
    """Return the frequency near the nominal one where the channels together have most of their power."""
    lowest, highest = (1.0 - SEARCH) * nominal, (1.0 + SEARCH) * nominal
    length = max(blocks.length for blocks in series)
    points = max(3, int(np.ceil((highest - lowest) * length * POINTS_PER_RESOLUTION)))
    grid = np.linspace(lowest, highest, points)
    together = np.zeros(points)
    for blocks in series:
        size = 1 << int(np.ceil(np.log2(POINTS_PER_RESOLUTION * blocks.time.size)))
        inside = blocks.weights > 0.0
        trend = np.polynomial.Polynomial.fit(blocks.time[inside], blocks.values[inside], 1)
        left = np.where(inside, blocks.values - trend(blocks.time), 0.0)
        # a Hann taper keeps a strong start-up or a neighbouring line out of the search
        left = left * np.sin(np.pi * (np.arange(left.size) + 0.5) / left.size) ** 2
        power = np.abs(np.fft.rfft(left, size)) ** 2
        total = float(left @ left)
        if total > 0.0:
            together += np.interp(grid, np.fft.rfftfreq(size, blocks.step), power) / total
    return float(grid[int(np.argmax(together))])


def _settle(
    series: Sequence[Blocks],
    variances: Sequence[float | None],
    frequency: float,
    nominal: float,
    origin: float,
) -> tuple[float, list[_Tangent]]:
    """Return the frequency at which no channel's weighted residual asks for a step, and the last tangents."""
    tangents: list[_Tangent] = []
    for _ in range(STEPS):
        tangents = []  # the old ones go before there are new ones
        tangents = [
            _tangent(blocks, frequency, origin, variance)
            for blocks, variance in zip(series, variances, strict=True)
        ]
        step = _step(tangents)
        if abs(step) < CONVERGED * nominal:
            break
        frequency = float(np.clip(frequency + step, (1.0 - SEARCH) * nominal, (1.0 + SEARCH) * nominal))
    return frequency, tangents


def _tangent(blocks: Blocks, frequency: float, origin: float, variance: float | None) -> _Tangent:
    orders, sinusoids = order_sinusoids(blocks, frequency, (*ORDERS, *COMPANIONS), origin)
    design = sinusoids.design
    slope = np.zeros(blocks.time.size)
    for index, order in enumerate(orders):
        if order not in DRIVE_ORDERS:
            continue
        first = sinusoids.trend + 2 * index
        cosine, sine = design[:, first], design[:, first + 1]
        a, b = sinusoids.pair(index)
        slope += 2.0 * np.pi * float(order) * (blocks.time - origin) * (b * cosine - a * sine)
    slope = sinusoids.without_trace(slope)
    if variance is None:
        variance = float(sinusoids.weights @ sinusoids.residuals**2) / blocks.time.size
    weighted = slope * blocks.weights
    stiffness = float(slope @ weighted)
    return _Tangent(blocks, orders, sinusoids, weighted, stiffness, max(variance, SMALLEST_VARIANCE))


def _seen(fit: OrderFit) -> _Seen:
    if FUNDAMENTAL not in fit.orders:
        return _Seen(fit, Amplitude(0.0, 0.0, 0.0, (0.0, 0.0), 0.0, 1.0), 1.0)
    fundamental = order_amplitudes(fit, (FUNDAMENTAL,))[FUNDAMENTAL]
    return _Seen(fit, fundamental, max(fundamental.p_value, local_p_value(fit, FUNDAMENTAL, fundamental)))


def _step(tangents: Sequence[_Tangent]) -> float:
    """Return the Gauss-Newton step [Hz], channels weighted by their noise."""
    pull = sum(float(item.slope @ item.sinusoids.residuals) / item.variance for item in tangents)
    stiffness = sum(item.stiffness / item.variance for item in tangents)
    return pull / stiffness if stiffness > 0.0 else 0.0


def _standard_error(tangents: Sequence[_Tangent], shown: Sequence[_Seen]) -> float:
    stiffness = sum(item.stiffness / item.variance for item in tangents)
    spread = 0.0
    for item, seen in zip(tangents, shown, strict=True):
        excess = max(1.0, seen.fit.noise.excess(seen.fit.drive)[0])
        spread += seen.fit.noise.variance(item.slope) * excess / item.variance**2
    return float(np.sqrt(spread)) / stiffness


def _no_drive(
    used: Sequence[tuple[str, Blocks]],
    shown: Sequence[_Seen],
    frequency: float,
    nominal: float,
    searched: float,
) -> DataError:
    best = min(range(len(used)), key=lambda index: shown[index].p_value)
    amplitude = shown[best].fundamental
    message = (
        f"no drive found within {SEARCH:.0%} of {nominal:.4g} Hz: the strongest line is at {frequency:.4g} "
        f"Hz in {used[best][0]!r}, amplitude {amplitude.value:.3g} at a standard error of "
        f"{amplitude.standard_error:.3g} "
        f"(chance {min(1.0, shown[best].p_value * searched):.2g}, needed below {SIGNIFICANCE:g})"
    )
    return DataError(
        message, "check the drive's nominal frequency in run.toml and that the drive was running"
    )
