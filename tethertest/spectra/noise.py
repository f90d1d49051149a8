"""The colour of the residuals: a smooth spectral density fitted to their periodogram.

The density is ``exp(polynomial in log f)``, fitted by maximum likelihood of exponentially distributed
ordinates (Whittle's likelihood, a gamma regression with logarithmic link). Ordinates that no such density
explains, left-over lines, are set aside, so that a line does not hide itself by raising its own background.

References
----------
P. Whittle, Estimation and information in stationary time series, Arkiv foer Matematik 2 (1953) 423-434.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from tethertest.records.arrays import FloatArray

IndexArray = npt.NDArray[np.intp]

#: degree of the polynomial in log f: follows white, AR(1) and 1/f noise and their sums
DEGREE = 3
#: the ordinates below this one have gone with the drift
FIRST_ORDINATE = 3
#: an ordinate above this multiple of the density (chance 6e-6) is a line, not noise
OUTLIER = 12.0
#: ordinates of a Hann-tapered periodogram overlap: this many count as one (1 + 2 (4/9 + 1/36))
HANN_OVERLAP = 1.944
#: passes of the fit; each is one weighted least squares step
PASSES = 25
#: a step of the polynomial below this ends the fit: a ten-thousandth of the density
CONVERGED = 1e-4
#: ordinates on either side of a line that make its local background
NEIGHBOURS = 8
#: chance that noise alone shows a left-over line next to an order
PEAK_CHANCE = 0.005
#: a term of the polynomial needs this many ordinates
ORDINATES_PER_TERM = 10
#: keeps the normal matrix regular where every ordinate but a few is a line
SMALLEST_PIVOT = 1e-9
#: twice the log-likelihood that a term must gain: chance passes this once in 22, Akaike's 2 once in 6, and
#: a density bent by chance calls false lines
TERM_PRICE = 4.0
#: an ordinate of which fitted lines leave less than this is not used
LEAST_SHARE = 0.5
#: density that double precision leaves of a series with unit variance at unit rate
ROUND_OFF = 1e-22


@dataclass(frozen=True, slots=True, eq=False)
class NoiseSpectrum:
    """One-sided density of the noise of a block series."""

    frequency: FloatArray  #: (m,) [Hz], ordinates used
    plain: FloatArray  #: (m,) [unit^2/Hz], without taper: sees what happens at the edges, as least squares do
    plain_share: FloatArray  #: (m,) share that fitting the lines has left in `plain`
    polynomial: FloatArray  #: (d,) of the scaled logarithm of frequency
    inverse: FloatArray  #: (d, d) covariance of `polynomial` over `HANN_OVERLAP`
    band: tuple[float, float]  #: [Hz] from the lowest to the highest ordinate it rests on; constant outside
    rate: float  #: [Hz]
    floor: float  #: smallest density that means anything [unit^2/Hz]
    white: float  #: density of the sensor's own white noise, below which no residual falls but by chance
    ceiling: float  #: largest density that the residuals show anywhere [unit^2/Hz]

    def density(self, frequency: FloatArray | float) -> FloatArray:
        """Return the smooth one-sided density [unit^2/Hz] at frequencies [Hz]."""
        points = np.clip(np.atleast_1d(np.asarray(frequency, dtype=np.float64)), *self.band)
        basis = _basis(points, self.frequency, self.polynomial.size)
        # a replay's residuals span many decades: the polynomial must not overshoot what they show
        logarithm = np.minimum(basis @ self.polynomial, np.log(self.ceiling))
        smooth: FloatArray = np.maximum(np.exp(logarithm), max(self.floor, self.white))
        return smooth

    def freedom(self, frequency: float) -> float:
        """Return the degrees of freedom of the density there: 2 / variance of its logarithm."""
        point = np.clip(np.array([frequency]), *self.band)
        basis = _basis(point, self.frequency, self.polynomial.size)[0]
        if self.white > 0.0 and float(basis @ self.polynomial) <= np.log(self.white):
            return 2.0 * self.frequency.size / HANN_OVERLAP  # no longer an estimate from a few ordinates
        return 2.0 / (HANN_OVERLAP * float(basis @ self.inverse @ basis))

    def covariances(self, influence: FloatArray) -> FloatArray:
        """Return the covariance (k, 2, 2) of each pair of rows of ``influence (2k, b) @ noise``."""
        count = influence.shape[1]
        size = 1 << int(np.ceil(np.log2(2 * count)))  # without wrap-around
        power = self.density(_axis(size, self.rate)) * (self.rate / size)
        power[[0, -1]] *= 0.5
        scaled = np.fft.rfft(np.ascontiguousarray(influence), size) * np.sqrt(power)
        pairs = scaled.view(np.float64).reshape(influence.shape[0] // 2, 2, -1)
        # sums of squares and products of real and imaginary parts; einsum wakes no threads
        product: FloatArray = np.einsum("kif,kjf->kij", pairs, pairs)
        return product

    def variance(self, row: FloatArray) -> float:
        """Return the variance of ``row (b,) @ noise``."""
        return float(self.covariances(np.stack([row, row]))[0, 0, 0])

    def excess(self, frequency: float) -> tuple[float, float]:
        """Return the local background over the smooth density, and its degrees of freedom.

        From ordinates without taper: a start-up that reaches into the window spreads over them as it does
        over the fitted lines, while a taper would hide it.
        """
        near = self._nearest(frequency, 2 * NEIGHBOURS)
        if near.size < NEIGHBOURS:
            return 1.0, float(2 * NEIGHBOURS)
        expected = self.density(self.frequency[near]) * self.plain_share[near]
        return float(np.mean(self.plain[near] / expected)), 2.0 * near.size

    def nearby_peak(self, frequency: float) -> float:
        """Return the amplitude of the strongest left-over line next to a frequency, zero where there is none.

        An ordinate that the background explains is no line: one in `PEAK_CHANCE` of records has one there by
        chance.
        """
        near = self._nearest(frequency, NEIGHBOURS)
        if near.size == 0:
            return 0.0
        power = self.plain[near] / self.plain_share[near]
        strongest = int(np.argmax(power))
        least = float(self.density(self.frequency[near[strongest]])[0]) * np.log(near.size / PEAK_CHANCE)
        if power[strongest] < least:
            return 0.0
        # an ordinate of a cosine A in a record T is A^2 T / 2, and the ordinates stand 1/T apart
        resolution = float(self.frequency[1] - self.frequency[0])
        return float(np.sqrt(2.0 * resolution * power[strongest]))

    def _nearest(self, frequency: float, count: int) -> IndexArray:
        """Return the ordinates next to a frequency of which fitted lines have left enough."""
        clear = np.flatnonzero(self.plain_share > LEAST_SHARE)
        middle = int(np.searchsorted(self.frequency[clear], frequency))
        some = clear[max(middle - count, 0) : middle + count]
        return some[np.argsort(np.abs(self.frequency[some] - frequency))[:count]]


def noise_spectrum(
    residuals: FloatArray,
    weights: FloatArray,
    rate: float,
    lines: FloatArray,
    scale: float,
    white: float = 0.0,
) -> NoiseSpectrum:
    """Fit the density of residuals.

    Parameters
    ----------
    residuals, weights : (b,) float64
        On a uniform grid; weight zero marks an empty block.
    rate : float
        Blocks per second [Hz].
    lines : (k,) float64
        Fitted frequencies [Hz], where the residuals have lost power.
    scale : float
        Root mean square of the series itself; sets what round-off leaves.
    white : float
        Density of the sensor's own white noise [unit^2/Hz]. The few ordinates that the lowest orders leave
        can show less by chance, but no sensor does; taken where the residuals' median does not contradict.

    Returns
    -------
    NoiseSpectrum
        The smooth density with what is needed for local checks.
    """
    count = residuals.size
    taper = np.sin(np.pi * (np.arange(count) + 0.5) / count) ** 2 * (weights > 0.0)
    frequency = np.asarray(np.arange(FIRST_ORDINATE, count // 2) * (rate / count), dtype=np.float64)
    tapered, plain = (
        2.0
        * np.abs(np.fft.rfft(window * residuals)[FIRST_ORDINATE : count // 2]) ** 2
        / (rate * float(window @ window))
        for window in (taper, np.asarray(weights > 0.0, dtype=np.float64))
    )
    # an exponential variable's median is ln 2 of its mean
    white = min(white, float(np.median(plain)) / np.log(2.0)) if plain.size else 0.0
    floor = ROUND_OFF * max(scale, 1e-150) ** 2 / rate
    share, plain_share = _shares_left(frequency, lines, count / rate)
    taken = (share > LEAST_SHARE).astype(np.float64)
    periodogram = np.maximum(tapered / np.maximum(share, LEAST_SHARE), floor)
    polynomial, inverse = _choose_density(frequency, periodogram, taken)
    rests_on = frequency[
        (taken > 0.0)
        & (periodogram < OUTLIER * np.exp(_basis(frequency, frequency, polynomial.size) @ polynomial))
    ]
    band = (float(rests_on[0]), float(rests_on[-1])) if rests_on.size else (frequency[0], frequency[-1])
    ceiling = float(np.max(periodogram[taken > 0.0], initial=floor))
    return NoiseSpectrum(
        frequency, plain, plain_share, polynomial, inverse, band, rate, floor, white, ceiling
    )


def _shares_left(frequency: FloatArray, lines: FloatArray, length: float) -> tuple[FloatArray, FloatArray]:
    """Return the share of the noise that fitting the lines has left in each ordinate, tapered and plain.

    A fitted line takes ``8/3 (sinc(d) / 2 / (1 - d^2))^2`` from a Hann-tapered ordinate d bins away: two
    thirds of the nearest, a sixth of the next, nothing that matters from two bins on; and ``sinc(d)^2`` from
    a plain one.
    """
    tapered, plain = np.ones(frequency.size), np.ones(frequency.size)
    for line in lines:
        first, after = np.searchsorted(frequency, (line - 2.0 / length, line + 2.0 / length))
        bins = (frequency[first:after] - line) * length
        bins = np.where(np.abs(np.abs(bins) - 1.0) < 1e-6, 1.0 + 1e-6, bins)
        kernel = np.sinc(bins)
        tapered[first:after] -= 8.0 / 3.0 * (0.5 * kernel / (1.0 - bins**2)) ** 2
        plain[first:after] -= kernel**2
    return tapered, plain


def _axis(size: int, rate: float) -> FloatArray:
    """Return the frequencies [Hz] of a real transform of `size` points."""
    axis: FloatArray = np.arange(size // 2 + 1, dtype=np.float64) * (rate / size)
    return axis


def _basis(points: FloatArray, band: FloatArray, terms: int) -> FloatArray:
    """Return powers of the logarithm of frequency, from -1 to 1 over the band, constant outside."""
    lowest, highest = np.log(band[0]), np.log(band[-1])
    logarithm = np.log(np.clip(points, band[0], band[-1]))
    scaled = (2.0 * logarithm - lowest - highest) / max(float(highest - lowest), 1e-9)
    powers: FloatArray = np.vander(scaled, terms, increasing=True)
    return powers


def _choose_density(
    frequency: FloatArray, periodogram: FloatArray, taken: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the polynomial of the degree that Akaike's criterion prefers, with its unscaled covariance.

    A degree that is not needed costs degrees of freedom at the lowest frequencies, where ordinates are few.
    """
    most = min(DEGREE + 1, max(1, int(np.count_nonzero(taken)) // ORDINATES_PER_TERM))
    best = np.inf, np.zeros(1), np.eye(1)
    powers = _basis(frequency, frequency, most)
    # mean of the logarithm of an exponential variable is -gamma
    polynomial = np.array([np.log(periodogram)[taken > 0.0].mean() + np.euler_gamma])
    for terms in range(1, most + 1):
        basis = powers[:, :terms]
        start = np.append(polynomial, np.zeros(terms - polynomial.size))
        polynomial, inverse = _gamma_regression(basis, periodogram, taken, start)
        logarithm = basis @ polynomial
        # an ordinate that is a line counts as a bad fit, but not without bound
        misfit = logarithm + np.minimum(periodogram / np.exp(logarithm), OUTLIER)
        criterion = 2.0 * float(taken @ misfit) / HANN_OVERLAP + TERM_PRICE * terms
        if criterion < best[0]:
            best = criterion, polynomial, inverse
    return best[1], best[2]


def _gamma_regression(
    basis: FloatArray, ordinates: FloatArray, taken: FloatArray, start: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Maximise Whittle's likelihood by Fisher scoring, setting lines aside."""
    polynomial = start
    inverse = np.eye(basis.shape[1])
    for _ in range(PASSES):
        ratio = ordinates * np.exp(-(basis @ polynomial))
        use = taken * (ratio < OUTLIER)
        normal = np.einsum("bi,bj,b->ij", basis, basis, use)
        inverse = np.asarray(np.linalg.inv(normal + SMALLEST_PIVOT * np.eye(start.size)), dtype=np.float64)
        step = inverse @ np.einsum("bi,b->i", basis, use * (ratio - 1.0))
        polynomial = polynomial + np.clip(step, -1.0, 1.0)
        if float(np.max(np.abs(step))) < CONVERGED:
            break
    return polynomial, inverse
