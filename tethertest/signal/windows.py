"""Where a record is at rest and where the drive is steady, found from the motion itself."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from tethertest.signal.filters import filled_reader, moving_mean
from tethertest.signal.noise import white_noise, white_noise_of
from tethertest.signal.passes import blocks_of
from tethertest.signal.series import Booleans, Floats, Series
from tethertest.signal.thinning import evenly, means_of

Span = tuple[float, float]

#: the record is thinned to means over this time: a tap keeps its length, the rest goes faster [s]
BLOCK = 0.02
#: and motion is looked for in medians over this time: taps and the ringing after them (above 10 Hz) drop
#: out [s]
LEVEL_LENGTH = 0.5
#: the level of rest is the median of this much record at its start or end [s]
LEVEL_SPAN = 2.0
#: deviation from the level, in standard deviations of such a median, that is motion
MOTION_SIGMAS = 8.0
#: standard deviation of a median over that of a mean, for normal noise
MEDIAN_TO_MEAN = 1.25
#: or this fraction of the whole motion's amplitude, whichever is more
MOTION_FRACTION = 0.002
#: deviations shorter than this are several taps in a row, not the start of the drive [s]
TAP_SPAN = 0.8
#: kept away from the motion on the side where it starts or stops [s]
MARGIN = 0.75
#: a shorter stretch is no rest window [s]
SHORTEST_REST = 1.5
#: cycles over which amplitude and speed are averaged: two, so that a line at half the drive drops out
CYCLES_AVERAGED = 2
#: amplitude and speed are settled within these fractions of their medians, speed also within its usual wander
AMPLITUDE_SETTLED = 0.02
SPEED_SETTLED = 0.002
#: the window reaches as far as the motion repeats itself within this fraction of its amplitude
REPEATS = 0.01
#: and stays away from where it stops doing so by this share of `CYCLES_AVERAGED` cycles, or this time [s] if
#: that is longer: ramps set in smoothly
KEPT_AWAY, SHORTEST_AWAY = 0.125, 1.0
#: noise and wander may unsettle them by this many of their usual deviations
SETTLED_SIGMAS = 4.0
#: a drive whose amplitude is below this many standard deviations of its estimate is none
DETECTABLE = 8.0
#: the frequency is first fitted to the strong part of the record, then to the settled one
PASSES = 3
#: medians that are taken at once: each needs the values around it side by side
SPREAD = 1 << 13
#: what is shorter than this many cycles is no steady window
FEWEST_CYCLES = 3
#: where means over two cycles never settle, cycles repeat each other within these shares of the amplitude,
#: the tightest that finds enough of them: the tighter, the less of a ramp that sets in smoothly
REPEATS_WITHIN = (0.003, 0.01, 0.03)
#: the period of cycles that repeat themselves is looked for this far around the strongest line, coarse to
#: fine, at so many places
PERIOD_SEARCH, PERIODS_TRIED = (0.1, 0.004, 0.0002), 51
#: a cycle is part of the motion when its amplitude is above this share of the largest: ramps climb in steps
STRONG_SHARE = 0.5
#: share of a cycle that a whole number of cycles may lack: the edges are found to within a few samples
EDGE = 0.05
#: the drive as found may differ from the nominal one by this fraction
SPEED_SEARCH = 0.2


@dataclass(frozen=True, slots=True)
class Rest:
    """Quiet stretches of a record."""

    before: Span | None  #: [s]
    after: Span | None  #: [s]
    amplitude: float  #: half the range of the motion, in the series' unit
    threshold: float  #: deviation from rest that counted as motion


@dataclass(frozen=True, slots=True)
class Steady:
    """The stretch where the drive is steady."""

    span: Span  #: [s], a whole number of cycles
    frequency: float  #: [Hz], as found
    amplitude: float  #: of the drive's order 1, in the series' unit
    cycles: int


def find_rest(series: Series) -> Rest:
    """Return the quiet stretches before and after the motion.

    Parameters
    ----------
    series : Series
        The bottom displacement, or a tension where there is none. Taps shorter than `TAP_SPAN` do not end a
        window.

    Returns
    -------
    Rest
        ``before`` and ``after`` are None where the record starts or ends in motion; in a record without
        motion they are its first and its last third.
    """
    time, means, sigma = _thinned(series)
    count = max(round(LEVEL_LENGTH / BLOCK), 1)
    levels = _moving_median(means, count)
    low, high = np.quantile(levels, (0.01, 0.99))
    amplitude = 0.5 * float(high - low)
    threshold = max(MOTION_SIGMAS * MEDIAN_TO_MEAN * sigma / np.sqrt(count), MOTION_FRACTION * amplitude)
    span = max(round(LEVEL_SPAN / BLOCK), 1)
    moving_first = _moving(time, np.abs(levels - np.median(levels[:span])) > threshold)
    moving_last = _moving(time, np.abs(levels - np.median(levels[-span:])) > threshold)
    if not moving_first.any() and not moving_last.any():
        third = (time[-1] - time[0]) / 3.0
        return Rest(
            (float(time[0]), float(time[0] + third)),
            (float(time[-1] - third), float(time[-1])),
            amplitude,
            threshold,
        )
    before = (
        _window(float(time[0]), float(time[np.argmax(moving_first)]) - MARGIN) if moving_first.any() else None
    )
    last = time.size - 1 - int(np.argmax(moving_last[::-1]))
    after = _window(float(time[last]) + MARGIN, float(time[-1])) if moving_last.any() else None
    return Rest(before, after, amplitude, threshold)


def find_steady(series: Series, frequency: float) -> Steady | None:
    """Return the longest stretch of steady drive, a whole number of cycles long.

    Amplitude and speed are means over two cycles. Where those never settle, as in a few cycles between long
    ramps, the stretch is the longest in which each cycle repeats the one before.

    Parameters
    ----------
    series : Series
        The bottom displacement, or a tension where there is none.
    frequency : float
        Nominal drive frequency [Hz]; the one found may differ by `SPEED_SEARCH`.

    Returns
    -------
    Steady or None
        None where no stretch of `FEWEST_CYCLES` cycles has settled amplitude and speed.
    """
    span = (float(series.time[0]), float(series.time[-1]))
    if (span[1] - span[0]) * frequency < FEWEST_CYCLES:
        return None
    time, values, rate = evenly(series, span, frequency)
    noise = white_noise(values)
    found = _peak_frequency(values - values.mean(), rate, frequency)
    return _settled_stretch(time, values, rate, frequency, found, noise) or _repeating_stretch(
        time, values, rate, frequency, found, noise
    )


def _settled_stretch(
    time: Floats, values: Floats, rate: float, frequency: float, found: float, noise_level: float
) -> Steady | None:
    noise = noise_level * np.sqrt(2.0 * frequency / (CYCLES_AVERAGED * rate))
    strong: Booleans | None = None
    for _ in range(PASSES):
        vector = _demodulated(time, values, rate, found)
        size, phase = np.abs(vector), np.unwrap(np.angle(vector))
        strong = size > 0.5 * np.max(size) if strong is None else strong
        if not strong.any():
            return None
        amplitude = float(np.median(size[strong]))
        if amplitude < DETECTABLE * noise:
            return None
        found += float(np.polyfit(time[strong], phase[strong], 1)[0]) / (2.0 * np.pi)
        if abs(found - frequency) > SPEED_SEARCH * frequency:
            return None
        settled = _settled(phase, size, strong, amplitude, noise, found / rate)
        first, last = _longest(settled)
        if last <= first:
            return None
        strong = np.zeros_like(settled)
        strong[first : last + 1] = True
    first, last = _extended(values, first, last, CYCLES_AVERAGED / found * rate, amplitude, noise_level, rate)
    start, stop = time[first], time[last]
    cycles = int((stop - start) * found)
    if cycles < FEWEST_CYCLES:
        return None
    # what is left of a cycle goes at the start, where the transients are
    return Steady((float(stop - cycles / found), float(stop)), found, amplitude, cycles)


def _repeating_stretch(
    time: Floats, values: Floats, rate: float, frequency: float, found: float, noise: float
) -> Steady | None:
    """Return the longest stretch whose cycles repeat themselves, by the tightest tolerance that finds one."""
    if abs(found - frequency) > SPEED_SEARCH * frequency:
        return None
    vector = _demodulated(time, values, rate, found, cycles=1)
    size = np.abs(vector)
    amplitude = float(np.max(size))
    if amplitude < DETECTABLE * noise * np.sqrt(2.0 * found / rate) or amplitude <= 0.0:
        return None
    found = _repeating_frequency(values, rate, found, size > STRONG_SHARE * amplitude)
    period = rate / found
    shift = int(np.ceil(period))
    change = _change_over(values, period)
    # both cycles belong to the strong part: a record at rest repeats itself too
    strong = (size > STRONG_SHARE * amplitude)[shift // 2 :][: change.size - shift // 2]
    for tolerance in REPEATS_WITHIN:
        same = change[: strong.size] <= max(tolerance * amplitude, 2.0 * SETTLED_SIGMAS * noise)
        first, last = _longest(np.asarray(same & strong))
        cycles = int((last - first) / period + 1.0 + EDGE)
        if last > first and cycles >= FEWEST_CYCLES:
            # what is left of a cycle is shared by both ends: either may reach into a ramp
            middle = 0.5 * (time[first] + time[last] + 1.0 / found)
            half = 0.5 * cycles / found
            span = (float(max(middle - half, time[0])), float(min(middle + half, time[-1])))
            return Steady(span, found, float(np.median(size[first:last])), cycles)
    return None


def _repeating_frequency(values: Floats, rate: float, found: float, strong: Booleans) -> float:
    """Return the frequency at which the steadiest quarter of the strong part repeats itself best.

    The largest line of a record that is half ramps lies several per cent beside the steady drive.
    """
    for width in PERIOD_SEARCH:
        tried = found * (1.0 + np.linspace(-width, width, PERIODS_TRIED))
        changes = []
        for frequency in tried:
            change = _change_over(values, rate / frequency)
            among = strong[: change.size]
            changes.append(float(np.quantile(change[among], 0.25)) if among.any() else np.inf)
        found = float(tried[np.argmin(changes)])
    return found


def _change_over(values: Floats, period: float) -> Floats:
    """Return how far each value is from the one a period [samples] later."""
    shift = int(np.ceil(period))
    index = np.arange(values.size, dtype=np.float64)
    return np.asarray(np.abs(np.interp(index[:-shift] + period, index, values) - values[:-shift]))


def _extended(
    values: Floats, first: int, last: int, period: float, amplitude: float, noise: float, rate: float
) -> tuple[int, int]:
    """Return the run of samples that repeat themselves after `period`, around one known to be settled."""
    shift = int(np.ceil(period))
    index = np.arange(values.size, dtype=np.float64)
    later = np.interp(index[:-shift] + period, index, values)
    differs = np.abs(later - values[:-shift]) > max(REPEATS * amplitude, 2.0 * SETTLED_SIGMAS * noise)
    before = np.flatnonzero(differs[:first])
    after = np.flatnonzero(differs[max(last - shift, 0) :])
    away = round(max(KEPT_AWAY * period, SHORTEST_AWAY * rate))
    start = int(before[-1]) + 1 + away if before.size else 0
    stop = max(last - shift, 0) + int(after[0]) + shift - 1 - away if after.size else values.size - 1
    return start, max(stop, last)


def _settled(
    phase: Floats,
    size: Floats,
    strong: Booleans,
    amplitude: float,
    noise: float,
    cycles_per_sample: float,
) -> Booleans:
    """Return where amplitude and speed of the demodulate drive are settled."""
    cycle = 1.0 / cycles_per_sample
    stray = np.abs(_centred_difference(phase, int(0.5 * cycle))) / (2.0 * np.pi)
    settled = np.abs(size - amplitude) < max(AMPLITUDE_SETTLED * amplitude, SETTLED_SIGMAS * noise)
    usual = SETTLED_SIGMAS * max(float(np.median(stray[strong])), noise / (2.0 * np.pi * amplitude))
    settled &= stray < max(SPEED_SETTLED, usual)
    inside = int(0.5 * CYCLES_AVERAGED * cycle)
    settled[:inside] = False
    settled[settled.size - inside :] = False
    return np.asarray(settled, dtype=bool)


def _thinned(series: Series) -> tuple[Floats, Floats, float]:
    """Return times and means of blocks of `BLOCK` seconds, and the standard deviation of such a mean."""
    read = filled_reader(series)
    size = max(round(BLOCK * series.rate), 1)
    centres, means = means_of(series.time, read, size)
    return centres, means, white_noise_of(read, series.time.size) / np.sqrt(size)


def _moving_median(values: Floats, length: int) -> Floats:
    """Return centred medians over about `length` values, the ends continued with the nearest value."""
    half = length // 2
    padded = np.pad(values, half, mode="edge")
    spread = np.lib.stride_tricks.sliding_window_view(padded, 2 * half + 1)
    rows = blocks_of(values.size, SPREAD)
    return np.concatenate([np.median(spread[start:stop], axis=1) for start, stop in rows])


def _moving(time: Floats, away: Booleans) -> Booleans:
    """Return the mask without excursions too short to be the drive."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], away, [False])).astype(np.int8)))
    moving = np.zeros_like(away)
    for first, last in zip(edges[::2], edges[1::2] - 1, strict=True):
        if time[last] - time[first] > TAP_SPAN:
            moving[first : last + 1] = True
    return moving


def _window(start: float, stop: float) -> Span | None:
    return (start, stop) if stop - start >= SHORTEST_REST else None


def _peak_frequency(values: Floats, rate: float, nominal: float) -> float:
    """Return the frequency of the largest line near the nominal one."""
    spectrum = np.abs(np.fft.rfft(values * np.hanning(values.size), 4 * values.size))
    frequencies = np.fft.rfftfreq(4 * values.size, 1.0 / rate)
    near = np.abs(frequencies - nominal) < SPEED_SEARCH * nominal
    return float(frequencies[near][np.argmax(spectrum[near])]) if near.any() else nominal


def _demodulated(
    time: Floats, values: Floats, rate: float, frequency: float, cycles: int = CYCLES_AVERAGED
) -> npt.NDArray[np.complex128]:
    """Return the complex amplitude at a frequency over so many cycles."""
    carrier = np.exp(-2j * np.pi * frequency * time)
    length = cycles / frequency * rate
    centred = values - moving_mean(values, length)
    return np.asarray(2.0 * moving_mean(centred * carrier, length), dtype=np.complex128)


def _centred_difference(values: Floats, half: int) -> Floats:
    """Return ``values[i + half] - values[i - half]``, with the ends repeated."""
    index = np.arange(values.size)
    return values[np.minimum(index + half, values.size - 1)] - values[np.maximum(index - half, 0)]


def _longest(mask: Booleans) -> tuple[int, int]:
    """Return first and last index of the longest run of True, or (0, 0)."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], mask, [False])).astype(np.int8)))
    if not edges.size:
        return 0, 0
    lengths = edges[1::2] - edges[::2]
    longest = int(np.argmax(lengths))
    return int(edges[2 * longest]), int(edges[2 * longest + 1]) - 1
