"""How one line behaves within the record: whether it keeps the drive's pace, decays or drifts."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Final

import numpy as np

from tethertest.records.arrays import FloatArray
from tethertest.signal.blocks import Blocks
from tethertest.spectra.regression import OrderFit, believed_excess

#: each check lets 0.5 % of true locked lines fall: 2.8 standard deviations
GATE: Final = 2.8
#: a free frequency is looked for this many 1/T to either side of the order: beyond 2/T, from where on a
#: natural frequency counts as told apart
REACH: Final = 3.0
#: points per 1/T of the first search; the peak of a line is 2/T wide
POINTS_PER_RESOLUTION: Final = 4
#: points of the second search, between the neighbours of the best point of the first
SECOND_POINTS: Final = 9
#: cycles over the whole record that a line may be off and still count as locked in practice: a thirtieth of a
#: cycle is what clocks and slow changes of the rig leave in strong lines
LOOSE_CYCLES: Final = 0.03
#: relative change of amplitude over the record that is no decay in practice
LOOSE_CHANGE: Final = 0.2
#: chi-squared with four degrees of freedom that three equal thirds exceed with a chance of 0.5 %
THIRDS_GATE: Final = 14.86
#: relative departure of a third from the whole that a strong line may have, settling while the window begins
LOOSE_THIRDS: Final = 0.6


@dataclass(frozen=True, slots=True)
class Tracking:
    """One line let loose in frequency, then in amplitude and phase."""

    frequency: float  #: that fits best near the order [Hz]
    frequency_error: float  #: standard error, the drive's own included [Hz]
    gain: float  #: chi-squared gained by freeing the frequency
    penalty: float  #: what the gain must exceed: the gate, or less by the Bayesian information criterion
    cycles: float  #: that the free frequency is off the order, over the record
    growth: float  #: relative change of amplitude over the record
    growth_error: float  #: standard error
    drift: float  #: change of phase over the record [rad]
    drift_error: float  #: standard error [rad]
    thirds: float  #: chi-squared of the record's thirds having one amplitude and phase
    departure: float  #: largest relative departure of a third from the whole

    @property
    def locked(self) -> bool:
        """The order fits as well as any frequency near it."""
        return self.gain <= self.penalty or abs(self.cycles) <= LOOSE_CYCLES

    @property
    def decays(self) -> bool:
        """The amplitude falls over the record."""
        return self.growth < -max(GATE * self.growth_error, LOOSE_CHANGE)

    @property
    def uneven(self) -> bool:
        """One third of the record has a line that another lacks."""
        return self.thirds > THIRDS_GATE and self.departure > LOOSE_THIRDS

    @property
    def drifts(self) -> bool:
        """The phase against the drive moves over the record."""
        return abs(self.drift) > max(GATE * self.drift_error, 2.0 * np.pi * LOOSE_CYCLES)


@dataclass(frozen=True, slots=True, eq=False)
class _Others:
    """All fitted columns except one pair, to project out."""

    design: FloatArray
    inverse: FloatArray
    weights: FloatArray

    def without(self, columns: FloatArray) -> FloatArray:
        weighted = columns * self.weights[:, None]
        left: FloatArray = columns - self.design @ (self.inverse @ (self.design.T @ weighted))
        return left


def track(fit: OrderFit, order: Fraction, drive_error: float) -> Tracking:
    """Let one order's frequency, amplitude and phase loose and see what the record prefers.

    Parameters
    ----------
    fit : OrderFit
        All orders of a channel.
    order : Fraction
        A fitted order.
    drive_error : float
        Standard error of the drive frequency [Hz].

    Returns
    -------
    Tracking
        The free frequency by search with the other orders refitted at each trial; growth and drift from a
        linear change of the two coefficients over the record.
    """
    blocks, own = fit.blocks, float(order) * fit.drive
    others = _others(fit, order)
    variance = float(fit.noise.density(own)[0]) * blocks.rate / 2.0 * believed_excess(fit.noise, own)

    frequency, power = _free_frequency(fit, others, own)
    at_order = float(_explained(fit, others, np.array([own]))[0])
    # the Cramer-Rao bound of a frequency: sqrt(3) / (pi T) per relative error of the amplitude
    relative = np.sqrt(variance / max(at_order, 1e-300))
    bound = float(np.sqrt(3.0) / (np.pi * blocks.length) * relative)
    pace_error = float(order) * drive_error
    gain = (power - at_order) / variance
    if bound > 0.0:  # an uncertain drive frequency excuses part of the gain
        gain /= 1.0 + (pace_error / bound) ** 2
    growth, growth_error, drift, drift_error = _slopes(fit, others, own, variance)
    thirds, departure = _thirds(fit, others, own, variance)
    return Tracking(
        frequency=frequency,
        frequency_error=float(np.hypot(bound, pace_error)),
        gain=float(gain),
        penalty=float(min(GATE**2, np.log(blocks.time.size))),
        cycles=(frequency - own) * blocks.length,
        growth=growth,
        growth_error=growth_error,
        drift=drift,
        drift_error=float(np.hypot(drift_error, 2.0 * np.pi * pace_error * blocks.length)),
        thirds=thirds,
        departure=departure,
    )


def unsteadiness(fit: OrderFit, order: Fraction) -> float:
    """Return the relative change of an order's complex amplitude over the record, growth and drift."""
    growth, _, drift, _ = _slopes(fit, _others(fit, order), float(order) * fit.drive, 1.0)
    return float(np.hypot(growth, drift))


def _others(fit: OrderFit, order: Fraction) -> _Others:
    first = fit.sinusoids.trend + 2 * fit.orders.index(order)
    design = np.delete(fit.sinusoids.design, [first, first + 1], axis=1)
    normal = design.T @ (design * fit.sinusoids.weights[:, None])
    inverse = np.asarray(np.linalg.inv(normal), dtype=np.float64)
    return _Others(design, inverse, fit.sinusoids.weights)


def _explained(fit: OrderFit, others: _Others, frequencies: FloatArray) -> FloatArray:
    """Return the sum of squares that a line at each frequency takes from the series, the others refitted."""
    pairs = []
    for frequency in frequencies:
        rotating = fit.blocks.phasor(float(frequency), fit.sinusoids.origin)
        pairs += [rotating.real, rotating.imag]
    columns = others.without(np.column_stack(pairs))
    weighted = columns * others.weights[:, None]
    pulls = (weighted.T @ fit.blocks.values).reshape(-1, 2)
    trios = columns.reshape(-1, frequencies.size, 2)
    normal = np.einsum("bki,bkj->kij", trios, weighted.reshape(trios.shape))
    solved = np.linalg.solve(normal, pulls[:, :, None])[:, :, 0]
    explained: FloatArray = np.sum(pulls * solved, axis=1)
    return explained


def _free_frequency(fit: OrderFit, others: _Others, own: float) -> tuple[float, float]:
    """Return the best frequency near the order and what a line there explains."""
    length = fit.blocks.length
    rest = [frequency for frequency in fit.sinusoids.frequencies if abs(frequency - own) > 1e-9 * own]
    below = max([0.0, *(frequency for frequency in rest if frequency < own)])
    above = min([own + 2.0 * REACH / length, *(frequency for frequency in rest if frequency > own)])
    lowest = max(own - REACH / length, 0.5 * (own + below))
    highest = min(own + REACH / length, 0.5 * (own + above))
    grid = np.linspace(lowest, highest, max(5, int((highest - lowest) * length * POINTS_PER_RESOLUTION) + 1))
    explained = _explained(fit, others, grid)
    best = int(np.argmax(explained))
    fine = np.linspace(grid[max(best - 1, 0)], grid[min(best + 1, grid.size - 1)], SECOND_POINTS)
    explained = _explained(fit, others, fine)
    best = int(np.clip(np.argmax(explained), 1, SECOND_POINTS - 2))
    left, middle, right = explained[best - 1 : best + 2]
    bend = left - 2.0 * middle + right
    shift = float(np.clip(0.5 * (left - right) / bend, -1.0, 1.0)) if bend < 0.0 else 0.0
    frequency = float(fine[best] + shift * (fine[1] - fine[0]))
    return frequency, float(max(_explained(fit, others, np.array([frequency]))[0], explained.max()))


def _slopes(fit: OrderFit, others: _Others, own: float, variance: float) -> tuple[float, float, float, float]:
    """Return relative growth and phase drift over the record, each with its standard error."""
    rotating = fit.blocks.phasor(own, fit.sinusoids.origin)
    ramp = _ramp(fit.blocks)
    columns = others.without(
        np.column_stack([rotating.real, rotating.imag, ramp * rotating.real, ramp * rotating.imag])
    )
    weighted = columns * others.weights[:, None]
    inverse = np.linalg.inv(columns.T @ weighted)
    coefficients = inverse @ (weighted.T @ fit.blocks.values)
    pair, slope, covariance = coefficients[:2], coefficients[2:], variance * inverse[2:, 2:]
    raw = max(float(np.hypot(*pair)), 1e-300)
    along = pair / raw
    across = np.array([along[1], -along[0]])  # phase grows as the sine coefficient falls
    return (
        float(along @ slope) / raw,
        float(np.sqrt(along @ covariance @ along)) / raw,
        float(across @ slope) / raw,
        float(np.sqrt(across @ covariance @ across)) / raw,
    )


def _thirds(fit: OrderFit, others: _Others, own: float, variance: float) -> tuple[float, float]:
    """Return chi-squared of equal thirds, and the largest relative departure of one from the whole."""
    rotating = fit.blocks.phasor(own, fit.sinusoids.origin)
    number = np.minimum((3.0 * (_ramp(fit.blocks) + 0.5)).astype(np.intp), 2)
    parts = [rotating * (number == third) for third in range(3)]
    columns = others.without(np.column_stack([side for part in parts for side in (part.real, part.imag)]))
    weighted = columns * others.weights[:, None]
    normal = columns.T @ weighted
    pull = weighted.T @ fit.blocks.values
    separate = np.linalg.solve(normal, pull)
    joint = np.tile(np.eye(2), (3, 1))
    whole = np.linalg.solve(joint.T @ normal @ joint, joint.T @ pull)
    gain = float(separate @ pull - whole @ (joint.T @ pull)) / variance
    departures = np.hypot(*(separate.reshape(3, 2) - whole).T)
    return gain, float(departures.max() / max(np.hypot(*whole), 1e-300))


def _ramp(blocks: Blocks) -> FloatArray:
    """Return time from -1/2 to 1/2 over the record."""
    middle = 0.5 * (blocks.time[0] + blocks.time[-1])
    ramp: FloatArray = (blocks.time - middle) / blocks.length
    return ramp
