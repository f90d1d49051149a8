"""All orders of one channel at once, with the noise they stand on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np

from tethertest.errors import DataError
from tethertest.records.channel import Channel, Window
from tethertest.signal.blocks import Blocks, block_means
from tethertest.signal.sinusoid import SinusoidFit, fit_sinusoids
from tethertest.spectra.noise import NoiseSpectrum, noise_spectrum
from tethertest.spectra.orders import resolvable_orders

#: blocks per period of the drive: the fifth order then has eight blocks per period of its own
BLOCKS_PER_PERIOD = 40.0
#: degree of the drift fitted along: temperature bends a record more than a straight line follows, and what is
#: left would leak into the lowest orders
TREND_DEGREE = 3
#: share of the block rate up to which orders are fitted
HIGHEST_SHARE = 0.45
#: a record must hold this many periods of the drive
FEWEST_PERIODS = 2.5
#: a local background this many standard deviations above the smooth density is believed
EXCESS_GATE = 2.8
#: a line has this many times the power of the strongest ordinate left next to it: one of 7 standard errors
#: fails that once in 500 records of white noise, the side line of a response without a period nearly always
PEAK_RATIO = 3.0
#: median of chi-squared with two degrees of freedom: the squared ratio that noise alone shows
MEDIAN_OF_NOISE = 2.0 * np.log(2.0)
#: 97.5 % point of the normal distribution
NORMAL_QUANTILE = 1.959964


@dataclass(frozen=True, slots=True, eq=False)
class Amplitude:
    """One fitted cosine: raw and de-biased amplitude, its error and its significance."""

    value: float  #: de-biased
    phase: float  #: [rad]
    standard_error: float
    interval: tuple[float, float]  #: 95 %
    f_value: float
    p_value: float
    freedom: float = 1.0  #: degrees of freedom of the noise that F refers to
    at_unit_f: float = 0.0  #: raw amplitude of this phase that has F = 1
    calibration_error: float = 0.0  #: by the channel's scale; in the interval, not in `standard_error`

    def calibrated(self, uncertainty: float) -> Amplitude:
        """Return the amplitude whose interval also holds a relative standard uncertainty of the scale.

        The two are independent, so that the interval's arms and the scale's add as squares.
        """
        low, high = self.interval
        scale = uncertainty * self.value
        lower = self.value - float(np.hypot(self.value - low, NORMAL_QUANTILE * scale))
        upper = self.value + float(np.hypot(high - self.value, NORMAL_QUANTILE * scale))
        return replace(self, interval=(max(0.0, lower), upper), calibration_error=scale)

    def significant_at(self, chance: float) -> float:
        """Return the raw amplitude of this phase whose p-value is that chance.

        It is infinite where the noise has so few degrees of freedom that none has.
        """
        with np.errstate(over="ignore"):
            f_value = np.expm1(-2.0 / self.freedom * np.log(chance)) * 0.5 * self.freedom
        return float(np.sqrt(f_value)) * self.at_unit_f


@dataclass(frozen=True, slots=True, eq=False)
class OrderFit:
    """Orders of one channel, fitted together."""

    blocks: Blocks
    drive: float  #: [Hz]
    orders: tuple[Fraction, ...]
    sinusoids: SinusoidFit
    noise: NoiseSpectrum


def amplitude_interval(raw: float, variance: float, freedom: float = np.inf) -> tuple[float, float]:
    """Return the 95 % interval of an amplitude whose cosine and sine parts each have this variance.

    The square of the raw amplitude over the variance follows a non-central chi-squared distribution with two
    degrees of freedom; the interval holds the amplitudes under which the one found is not in the outer 2.5 %.
    An estimated variance widens it as Student's t does, by the degrees of freedom of the estimate. A record
    that shows less than noise usually does bounds the amplitude no better than one that shows the median.

    References
    ----------
    G. Cowan, K. Cranmer, E. Gross, O. Vitells, arXiv:1105.3166 (2011) (power-constrained limits).
    """
    from scipy.special import chndtrinc, stdtrit

    if variance <= 0.0:
        return raw, raw
    if np.isfinite(freedom):
        variance *= (float(stdtrit(max(freedom, 1.0), 0.975)) / NORMAL_QUANTILE) ** 2
    ratio = raw**2 / variance
    if ratio > 400.0:  # 20 standard errors: normal to four digits
        half = NORMAL_QUANTILE * float(np.sqrt(variance))
        middle = float(np.sqrt(raw**2 - variance))
        return middle - half, middle + half
    lower = 0.0 if 1.0 - np.exp(-0.5 * ratio) < 0.975 else float(chndtrinc(ratio, 2.0, 0.975))
    upper = float(chndtrinc(max(ratio, MEDIAN_OF_NOISE), 2.0, 0.025))
    scale = float(np.sqrt(variance))
    return scale * float(np.sqrt(lower)), scale * float(np.sqrt(upper))


def channel_blocks(channel: Channel, window: Window, frequency: float, mains: float) -> Blocks:
    """Return block means of a channel's window, fine enough for every order.

    Blocks hold whole periods of the mains where they are long enough, so that hum averages out.

    Raises
    ------
    DataError
        The window holds too few periods or too few usable samples.
    """
    part = channel.between(window.start, window.stop)
    usable = part.usable
    if np.count_nonzero(usable) < 2:
        message = (
            f"channel {channel.name!r} has no usable samples from {window.start:g} s to {window.stop:g} s"
        )
        raise DataError(message, "choose another window or take the channel out")
    wanted = BLOCKS_PER_PERIOD * frequency
    if mains > wanted:
        wanted = mains / np.floor(mains / wanted)
    blocks = block_means(part.time, part.values, usable, float(wanted))
    if blocks.length * frequency < FEWEST_PERIODS:
        message = (
            f"channel {channel.name!r}: {blocks.length:.3g} s hold {blocks.length * frequency:.3g} periods "
            f"of {frequency:.4g} Hz, expected at least {FEWEST_PERIODS:g}"
        )
        raise DataError(message, "choose a longer window")
    if not np.any(blocks.values):
        message = f"channel {channel.name!r} is zero from {window.start:g} s to {window.stop:g} s"
        raise DataError(message, "check that the sensor was connected, or take the channel out")
    return blocks


def fit_orders(
    blocks: Blocks,
    drive: float,
    orders: Sequence[Fraction],
    origin: float,
    free: Sequence[float] = (),
    white: float = 0.0,
) -> OrderFit:
    """Fit the orders a record can tell apart, and the density of what is left.

    Parameters
    ----------
    blocks : Blocks
        The channel's window.
    drive : float
        Frequency of the drive [Hz].
    orders : sequence of Fraction
        Those wanted; what is not resolvable is left out.
    origin : float
        Time to which phases refer [s].
    free : sequence of float
        Frequencies of further lines [Hz], fitted along.
    white : float
        Density of the sensor's own white noise [unit^2/Hz].

    Returns
    -------
    OrderFit
        With the orders that were fitted.
    """
    fitted, sinusoids = order_sinusoids(blocks, drive, orders, origin, free)
    return with_noise(blocks, drive, fitted, sinusoids, white)


def order_sinusoids(
    blocks: Blocks, drive: float, orders: Sequence[Fraction], origin: float, free: Sequence[float] = ()
) -> tuple[tuple[Fraction, ...], SinusoidFit]:
    """Fit offset, drift and orders alone; arguments as for `fit_orders`. Returns the orders fitted too."""
    fitted = resolvable_orders(orders, drive, blocks.length, HIGHEST_SHARE * blocks.rate)
    frequencies = np.array([*(float(order) * drive for order in fitted), *free])
    filled, needed = np.count_nonzero(blocks.weights), 2 * frequencies.size + TREND_DEGREE + 1
    if filled <= needed:
        message = (
            f"the usable samples fill {filled} blocks of {blocks.step:.3g} s, too few for {needed} numbers"
        )
        raise DataError(message, "choose another window, or mend the channel that lacks its samples")
    try:
        return fitted, fit_sinusoids(blocks, frequencies, origin, TREND_DEGREE)
    except ValueError as error:
        remedy = "export the channel that lacks its samples by itself, at its own rate"
        raise DataError(str(error), remedy) from error


def with_noise(
    blocks: Blocks,
    drive: float,
    orders: tuple[Fraction, ...],
    sinusoids: SinusoidFit,
    white: float = 0.0,
) -> OrderFit:
    """Return fitted orders with the density of what they leave, at least that of the sensor's white noise."""
    scale = float(np.sqrt(np.mean(blocks.values**2)))
    noise = noise_spectrum(
        sinusoids.residuals, blocks.weights, blocks.rate, sinusoids.frequencies, scale, white
    )
    return OrderFit(blocks, drive, orders, sinusoids, noise)


def order_amplitudes(fit: OrderFit, orders: Sequence[Fraction]) -> dict[Fraction, Amplitude]:
    """Return amplitude, error and p-value of fitted orders.

    The p-value is that of the nested F test, with the residual variance replaced by what noise of the fitted
    density does to the two coefficients, leakage from strong low frequencies and holes included. The standard
    error also grows with the background next to the line, where that stands clearly above the smooth density.

    Parameters
    ----------
    fit : OrderFit
        All orders of a channel.
    orders : sequence of Fraction
        Those wanted; all must have been fitted.

    Returns
    -------
    dict
        order -> `Amplitude`.
    """
    indices = [fit.orders.index(order) for order in orders]
    covariances = fit.noise.covariances(fit.sinusoids.pair_influence(indices))
    amplitudes = {}
    for order, index, covariance in zip(orders, indices, covariances, strict=True):
        frequency = float(order) * fit.drive
        pair = fit.sinusoids.pair(index)
        f_value = float(pair @ np.linalg.solve(covariance, pair)) / 2.0
        freedom = fit.noise.freedom(frequency)
        raw = float(np.hypot(*pair))
        direction = pair / raw if raw > 0.0 else np.array([1.0, 0.0])
        variance = float(direction @ covariance @ direction) * believed_excess(fit.noise, frequency)
        amplitudes[order] = Amplitude(
            value=float(np.sqrt(max(0.0, raw**2 - variance))),
            phase=fit.sinusoids.phase(index),
            standard_error=float(np.sqrt(variance)),
            interval=amplitude_interval(raw, variance, freedom),
            f_value=f_value,
            p_value=float((1.0 + 2.0 * f_value / freedom) ** (-0.5 * freedom)),
            freedom=freedom,
            at_unit_f=float(np.sqrt(2.0 / (direction @ np.linalg.solve(covariance, direction)))),
        )
    return amplitudes


def local_p_value(fit: OrderFit, order: Fraction, amplitude: Amplitude, *, always: bool = False) -> float:
    """Return the p-value of the F test against the residual next to the line.

    Where that is not clearly higher than the smooth density, the density with its many more degrees of
    freedom is the better reference and stands, unless the residual is asked for `always`: as where the drive
    wanders, whose skirts no smooth density follows.
    """
    frequency = float(order) * fit.drive
    ratio, freedom = fit.noise.excess(frequency)
    if not always and believed_excess(fit.noise, frequency) == 1.0:
        ratio, freedom = 1.0, fit.noise.freedom(frequency)
    return float((1.0 + 2.0 * amplitude.f_value / ratio / freedom) ** (-0.5 * freedom))


def stands_out(amplitude: float, nearby_peak: float) -> bool:
    """Say whether a line is clearly larger than what is left next to it."""
    return amplitude**2 >= PEAK_RATIO * nearby_peak**2


def believed_excess(noise: NoiseSpectrum, frequency: float) -> float:
    """Return the local background over the smooth density where that is clearly above one, else one."""
    ratio, freedom = noise.excess(frequency)
    return ratio if ratio > 1.0 + EXCESS_GATE * np.sqrt(2.0 / freedom) else 1.0
