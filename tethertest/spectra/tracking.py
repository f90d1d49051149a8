"""How one line behaves within the record: whether it keeps the drive's pace, decays or drifts."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Final

import numpy as np

from tethertest.records.lines import OrderTrack
from tethertest.spectra.multitaper import MultitaperTest, multitaper_test
from tethertest.spectra.order_demodulation import DemodulatedOrder, demodulate
from tethertest.spectra.order_track import track_order
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
    track: OrderTrack  #: amplitude and phase, window by window
    second_opinion: MultitaperTest

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
    loose = demodulate(fit, order)
    length, own = loose.length, loose.frequency
    variance = float(fit.noise.density(own)[0]) * fit.blocks.rate / 2.0 * believed_excess(fit.noise, own)
    offset, power = _free_offset(fit, loose)
    at_order = float(loose.explained(np.zeros(1))[0])
    # the Cramer-Rao bound of a frequency: sqrt(3) / (pi T) per relative error of the amplitude
    relative = np.sqrt(variance / max(at_order, 1e-300))
    bound = float(np.sqrt(3.0) / (np.pi * length) * relative)
    pace_error = float(order) * drive_error
    gain = (power - at_order) / variance
    if bound > 0.0:  # an uncertain drive frequency excuses part of the gain
        gain /= 1.0 + (pace_error / bound) ** 2
    growth, growth_error, drift, drift_error = slopes(loose, variance)
    thirds, departure = _thirds(loose, variance)
    return Tracking(
        frequency=own + offset,
        frequency_error=float(np.hypot(bound, pace_error)),
        gain=float(gain),
        penalty=float(min(GATE**2, np.log(fit.blocks.time.size))),
        cycles=offset * length,
        growth=growth,
        growth_error=growth_error,
        drift=drift,
        drift_error=float(np.hypot(drift_error, 2.0 * np.pi * pace_error * length)),
        thirds=thirds,
        departure=departure,
        track=track_order(loose, variance, fit.sinusoids.origin),
        second_opinion=multitaper_test(loose),
    )


def unsteadiness(fit: OrderFit, order: Fraction) -> float:
    """Return the relative change of an order's complex amplitude over the record, growth and drift."""
    growth, _, drift, _ = slopes(demodulate(fit, order), 1.0)
    return float(np.hypot(growth, drift))


def slopes(loose: DemodulatedOrder, variance: float) -> tuple[float, float, float, float]:
    """Return relative growth and phase drift over the record, each with its standard error."""
    pulls, normal = loose.modulated(np.stack((np.ones(loose.time.size), loose.ramp)))
    inverse = np.linalg.inv(normal)
    coefficients = inverse @ pulls
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


def _free_offset(fit: OrderFit, loose: DemodulatedOrder) -> tuple[float, float]:
    """Return how far the best frequency is from the order [Hz], and what a line there explains."""
    length, own = loose.length, loose.frequency
    rest = [frequency for frequency in fit.sinusoids.frequencies if abs(frequency - own) > 1e-9 * own]
    below = max([0.0, *(frequency for frequency in rest if frequency < own)])
    above = min([own + 2.0 * REACH / length, *(frequency for frequency in rest if frequency > own)])
    lowest = max(-REACH / length, 0.5 * (below - own))
    highest = min(REACH / length, 0.5 * (above - own))
    grid = np.linspace(lowest, highest, max(5, int((highest - lowest) * length * POINTS_PER_RESOLUTION) + 1))
    best = int(np.argmax(loose.explained(grid)))
    fine = np.linspace(grid[max(best - 1, 0)], grid[min(best + 1, grid.size - 1)], SECOND_POINTS)
    explained = loose.explained(fine)
    best = int(np.clip(np.argmax(explained), 1, SECOND_POINTS - 2))
    left, middle, right = explained[best - 1 : best + 2]
    bend = left - 2.0 * middle + right
    shift = float(np.clip(0.5 * (left - right) / bend, -1.0, 1.0)) if bend < 0.0 else 0.0
    offset = float(fine[best] + shift * (fine[1] - fine[0]))
    return offset, float(max(loose.explained(np.array([offset]))[0], explained.max()))


def _thirds(loose: DemodulatedOrder, variance: float) -> tuple[float, float]:
    """Return chi-squared of equal thirds, and the largest relative departure of one from the whole."""
    number = np.minimum((3.0 * (loose.ramp + 0.5)).astype(np.intp), 2)
    pull, normal = loose.modulated(np.stack([(number == third).astype(np.float64) for third in range(3)]))
    separate = np.linalg.solve(normal, pull)
    joint = np.tile(np.eye(2), (3, 1))
    whole = np.linalg.solve(joint.T @ normal @ joint, joint.T @ pull)
    gain = float(separate @ pull - whole @ (joint.T @ pull)) / variance
    departures = np.hypot(*(separate.reshape(3, 2) - whole).T)
    return gain, float(departures.max() / max(np.hypot(*whole), 1e-300))
