"""The Cramer-Rao bound of offset and drift between two records of one waveform."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from reports.clock_errors.bar import Bar, bottom_tension_over_motion
from tethertest.records.arrays import BoolArray, FloatArray

#: what lies above this fraction of the slower instrument's sampling rate is aliased and does not count
USABLE_BAND = 0.4
#: the waveform fades out within this at both ends, before its spectrum is taken; no record reaches there [s]
MARGIN = 0.9
#: a density below this is none [N^2/Hz]
SMALLEST_NOISE = 1e-30


@dataclass(frozen=True, slots=True, eq=False)
class Waveform:
    """What both instruments saw, and their noises."""

    time: FloatArray  #: (n,) uniform [s]
    values: FloatArray  #: (n,) tension [N]
    noises: tuple[float, float]  #: of one sample of the reference [N] and of the clock [N, or m with a bar]
    rates: tuple[float, float]  #: [Hz]
    bar: Bar | None  #: turns the clock's displacement into tension; None where it is a tension
    changes: tuple[FloatArray, ...]  #: (n,) each: one standard uncertainty of what the rig does not know [N]
    lag: float  #: standard uncertainty of a lag that the rig makes of itself [s]


@dataclass(frozen=True, slots=True)
class Bound:
    """Smallest standard errors that any unbiased estimate can have."""

    offset: float  #: at reference time zero, of noise alone [s]
    drift: float  #: of noise alone [1]
    offset_with_rig: float  #: with the rig known no better than its file states [s]
    drift_with_rig: float
    signal_to_noise: float  #: root mean square of the signal over that of both noises in the band used


def bound(
    wave: Waveform,
    reference_seen: Callable[[FloatArray], BoolArray],
    clock_seen: Callable[[FloatArray], BoolArray],
    only: tuple[tuple[float, float], ...],
    drift_prior: float,
) -> Bound:
    """Return the bound.

    The reference reads ``s(t)`` and the clock ``g s(t - offset - drift t) + level``, each in white noise of
    its own, with the waveform s known (ramps, phase and knocks together) and g and level free. Offset and
    drift enter through ``s'`` and ``t s'``; both noises together are ``n(f) = sigma1^2/rate1 + |H(f)|^2
    sigma2^2/rate2`` per hertz, two-sided, H being the tension over the clock's quantity. The Fisher
    information is that of ``s'`` and ``t s'`` whitened by n, less their projections on ``s`` and on a
    constant, plus the prior of the drift that the alignment is given too. With the rig, the changes of ``s``
    by each of its parameters are further unknowns, each with the standard uncertainty that the rig's file
    states as its prior.

    Parameters
    ----------
    wave : Waveform
        Signal and noises.
    reference_seen, clock_seen : callable
        Times [s] -> where that record has samples.
    only : tuple
        Spans [s] that may be compared; empty for the whole record.
    drift_prior : float
        Standard deviation of the drift beforehand [1].

    References
    ----------
    S. M. Kay, Fundamentals of Statistical Signal Processing: Estimation Theory, Prentice Hall 1993, sections
    3.7 and 3.11 (delay of a known waveform; a vector of parameters); with priors the bound of van Trees.
    """
    step = float(wave.time[1] - wave.time[0])
    frequency = np.asarray(np.fft.rfftfreq(wave.time.size, step), dtype=np.float64)
    densities = [noise**2 / rate for noise, rate in zip(wave.noises, wave.rates, strict=True)]
    gain = 1.0 if wave.bar is None else np.abs(bottom_tension_over_motion(wave.bar, frequency)) ** 2
    noise = np.maximum(densities[0] + gain * densities[1], SMALLEST_NOISE)
    band = frequency <= USABLE_BAND * min(wave.rates)
    margin = np.clip(np.minimum(wave.time - wave.time[0], wave.time[-1] - wave.time) / MARGIN, 0.0, 1.0)
    fade = np.sin(0.5 * np.pi * margin) ** 2
    white = band / np.sqrt(noise)

    def whitened(values: FloatArray) -> FloatArray:
        return np.asarray(np.fft.irfft(white * np.fft.rfft(fade * (values - np.mean(values))), values.size))

    signal = whitened(wave.values)
    spectrum = np.fft.rfft(signal)
    slope = np.fft.irfft(2j * np.pi * frequency * spectrum, wave.time.size)
    use = reference_seen(wave.time) & clock_seen(wave.time)
    if only:
        use &= np.any([(wave.time >= start) & (wave.time <= stop) for start, stop in only], axis=0)
    time = wave.time[use]
    columns = (slope[use], time * slope[use], *(whitened(change)[use] for change in wave.changes))
    nuisance = np.linalg.qr(np.column_stack((signal[use], np.ones(time.size))))[0]
    wanted = np.column_stack(columns)
    wanted -= nuisance @ (nuisance.T @ wanted)
    information = step * (wanted.T @ wanted)
    information[1, 1] += 1.0 / drift_prior**2
    alone = np.linalg.inv(information[:2, :2])
    information[2:, 2:] += np.eye(len(wave.changes))
    rig = np.linalg.inv(information)
    ratio = float(np.sqrt(np.var(signal[use]) / (2.0 * np.max(frequency[band]))))
    return Bound(
        float(np.sqrt(alone[0, 0])),
        float(np.sqrt(alone[1, 1])),
        float(np.hypot(np.sqrt(rig[0, 0]), wave.lag)),
        float(np.sqrt(rig[1, 1])),
        ratio,
    )
