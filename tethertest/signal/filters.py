"""Zero-phase filters and resampling that never invent data across a hole without being asked."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from tethertest.errors import DataError
from tethertest.signal.passes import overlapped
from tethertest.signal.series import Booleans, Floats, Series

Number = TypeVar("Number", np.float64, np.complex128)

#: order of the Butterworth low-pass; run forwards and backwards it counts twice
ORDER = 2
#: a low-pass at this fraction of the sampling rate or above would pass everything: it is left out
NYQUIST_FRACTION = 0.45
#: a hole in the samples longer than this many sampling intervals is a hole in the resampled series too
HOLE_INTERVALS = 1.5
#: periods of its cut-off after which a low-pass has forgotten a sample, to 1e-15 of it
REACH = 12.0


def filled(series: Series) -> Floats:
    """Return the values with straight lines across the samples that may not be used.

    Parameters
    ----------
    series : Series
        A channel; its ends are continued with the nearest usable value.

    Returns
    -------
    ndarray
        (n,) values without NaN.

    Raises
    ------
    DataError
        No sample is usable.
    """
    usable = series.usable
    if usable.all():
        return series.values
    if not usable.any():
        raise _nothing_usable()
    return np.interp(series.time, series.time[usable], series.values[usable])


def _nothing_usable() -> DataError:
    message = "a channel has no usable sample"
    return DataError(message, "leave the channel out of run.toml or export the log again")


def filled_reader(series: Series) -> Callable[[int, int], Floats]:
    """Return a function that gives what `filled` makes of some rows, without a copy of the others.

    Parameters
    ----------
    series : Series
        A channel.

    Returns
    -------
    callable
        First row, and last + 1 -> their values (n,).

    Raises
    ------
    DataError
        No sample is usable.
    """
    usable = series.usable
    if not usable.any():
        raise _nothing_usable()
    return bridged_reader(series.time, series.values, usable)


def bridged_reader(time: Floats, values: Floats, known: Booleans) -> Callable[[int, int], Floats]:
    """Return a function that gives some rows of a record, with straight lines across what is not known.

    Parameters
    ----------
    time, values : ndarray
        (n,)
    known : (n,) bool
        At least one is.
    """

    def read(start: int, stop: int) -> Floats:
        if known[start:stop].all():
            return values[start:stop]
        before, after = known[:start][::-1], known[stop:]
        first = start - 1 - int(np.argmax(before)) if before.any() else start
        last = stop + 1 + int(np.argmax(after)) if after.any() else stop
        rows = first + np.flatnonzero(known[first:last])
        return np.interp(time[start:stop], time[rows], values[rows])

    return read


def low_passed(values: Floats, rate: float, cutoff: float) -> Floats:
    """Return uniformly sampled values without what lies above a frequency, without delay.

    Parameters
    ----------
    values : ndarray
        (n,) without NaN; see `filled`.
    rate, cutoff : float
        Sampling rate and the frequency of half power [Hz]; from `NYQUIST_FRACTION` of the rate upwards the
        values are returned as they are.

    Returns
    -------
    ndarray
        (n,)

    Raises
    ------
    DataError
        The cut-off is not above zero.
    """
    if not cutoff > 0.0:
        message = f"low-pass at {cutoff:g} Hz, expected a frequency above zero"
        raise DataError(message, "give a positive cut-off frequency")
    if cutoff >= NYQUIST_FRACTION * rate or values.size == 0:
        return values
    # forwards and backwards the power halves twice: this keeps half power at the frequency asked for
    single = cutoff / (np.sqrt(2.0) - 1.0) ** (0.5 / ORDER)
    numerator, denominator = _butterworth(min(single, NYQUIST_FRACTION * rate) / (0.5 * rate))
    padding = min(values.size - 1, round(3.0 * rate / cutoff))

    def filtered(start: int, stop: int) -> Floats:
        part = values[start:stop]
        before = 2.0 * part[0] - part[padding:0:-1]
        after = 2.0 * part[-1] - part[-2 : -padding - 2 : -1]
        padded = np.concatenate((before, part, after))
        backwards = _run(numerator, denominator, padded)[::-1]
        both = _run(numerator, denominator, backwards)[::-1]
        return both[padding : padding + part.size]

    return overlapped(filtered, values.size, round(REACH * rate / cutoff))


def _butterworth(cutoff: float) -> tuple[Floats, Floats]:
    """Return numerator and denominator of order 2; half power lies at this share of half the rate."""
    warped = 4.0 * np.tan(np.pi * cutoff / 2.0)
    poles = -np.exp(1j * np.pi * np.array([-1.0, 1.0]) / 4.0) * warped
    gain = warped**2 * (1.0 / np.prod(4.0 - poles)).real
    inside = (4.0 + poles) / (4.0 - poles)  # the bilinear transform
    return gain * np.array([1.0, 2.0, 1.0]), np.asarray(np.poly(inside).real, dtype=np.float64)


def _run(numerator: Floats, denominator: Floats, values: Floats) -> Floats:
    """Return what a section makes of samples before which the first value has stood for ever."""
    from tethertest.kernels.samples import filter_section

    rest = np.array([[1.0 + denominator[1], -1.0], [denominator[2], 1.0]])
    state = np.linalg.solve(rest, numerator[1:] - denominator[1:] * numerator[0]) * values[0]
    filtered = np.array(values, dtype=np.float64)
    filter_section(numerator, denominator, state, filtered)
    return filtered


def moving_mean(values: npt.NDArray[Number], length: float) -> npt.NDArray[Number]:
    """Return centred means over `length` samples, over fewer at the ends.

    Parameters
    ----------
    values : ndarray
        (n,) without NaN, real or complex.
    length : float
        Samples per mean, at least 1; a part of a sample counts by its part, so that a mean over whole
        cycles is one.
    """
    half = 0.5 * max(length, 1.0)
    edges = np.arange(values.size + 1, dtype=np.float64)
    total = np.concatenate((np.zeros(1, values.dtype), np.cumsum(values)))
    centre = edges[:-1] + 0.5
    first, last = np.maximum(centre - half, 0.0), np.minimum(centre + half, float(values.size))
    means = (np.interp(last, edges, total) - np.interp(first, edges, total)) / (last - first)
    return np.asarray(means, dtype=values.dtype)


def without_line(time: Floats, values: Floats, frequency: float, span: float) -> Floats:
    """Return values without a line whose amplitude changes slowly, and without delay.

    Parameters
    ----------
    time, values : ndarray
        (n,) uniform times [s] and values without NaN.
    frequency : float
        Of the line [Hz].
    span : float
        Time over which its amplitude is measured [s]; what is farther than ``1/span`` [Hz] from the line
        stays.
    """
    samples = span * (time.size - 1) / (time[-1] - time[0])

    def cleared(start: int, stop: int) -> Floats:
        carrier = np.exp(2j * np.pi * frequency * time[start:stop])
        amplitude = 2.0 * moving_mean(values[start:stop] * np.conj(carrier), samples)
        return np.asarray(values[start:stop] - (amplitude * carrier).real, dtype=np.float64)

    return overlapped(cleared, values.size, int(samples) + 1)


def resampled(series: Series, times: Floats) -> Floats:
    """Return values at other times by straight lines between usable samples.

    Parameters
    ----------
    series : Series
        A channel.
    times : ndarray
        (m,) [s] on the channel's clock.

    Returns
    -------
    ndarray
        (m,) values; NaN outside the record and inside holes longer than `HOLE_INTERVALS` sampling intervals.
    """
    usable = series.usable
    time, values = series.time[usable], series.values[usable]
    if time.size == 0:
        return np.full(len(times), np.nan)
    result = np.interp(times, time, values, left=np.nan, right=np.nan)
    if time.size > 1:
        after = np.clip(np.searchsorted(time, times, "left"), 1, time.size - 1)
        hole = time[after] - time[after - 1] > HOLE_INTERVALS / series.rate
        exact = (times == time[after]) | (times == time[after - 1])
        result[hole & ~exact] = np.nan
    return result
