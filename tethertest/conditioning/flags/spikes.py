"""Spikes: one to three samples far from their neighbours; a snap is none."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from tethertest.records.arrays import BoolArray, FloatArray
from tethertest.records.channel import Channel, Flag
from tethertest.signal.filters import bridged_reader
from tethertest.signal.noise import white_noise_of
from tethertest.signal.passes import blocks_of

#: longest spike [s]; a snap takes about 10 ms to rise
LONGEST = 0.003
#: and in samples, at any rate
LONGEST_SAMPLES = 3
#: height above the line between the neighbours, in standard deviations of one sample
HEIGHT_SIGMAS = 12.0
#: both its edges are steeper by this factor than any step around it: a snap rises over many samples
ISOLATION = 3.0
#: samples on either side that are looked at for that
AROUND = 10
#: and it is higher by this factor than such heights are farther around, the highest few left out: waves of
#: a snap come in numbers
FAR_AROUND, FAR_QUANTILE = 400, 0.985
#: the neighbours of a spike differ from each other by less than this fraction of its height; at a step they
#: do not
NEIGHBOURS_AGREE = 0.4
#: the same value so many times, each time alone, is a logger's word for a lost sample
FEWEST_DROPOUTS = 3
#: and so far beyond all other values, in their range
APART = 0.3
#: an axial wave needs this long from end to end: what another channel shows so close is no spike [s]
WAVE_DELAY = 0.008
#: height of the other channel's answer, in standard deviations of one of its samples
ANSWER_SIGMAS = 6.0
#: rows on either side of a part that decide about its own samples: a delay at 100 kHz, and what is far around
CONTEXT = 1 << 12


@dataclass(frozen=True, slots=True, eq=False)
class SpikeRule:
    """What the whole record says of its spikes: looked for in a part of it with `CONTEXT` rows around."""

    sigma: float  #: standard deviation of one sample
    dropouts: FloatArray  #: values that a logger writes for a lost sample

    @classmethod
    def of(cls, read: Callable[[int, int], FloatArray], size: int, rate: float) -> SpikeRule:
        """Return the rule of a record.

        Parameters
        ----------
        read : callable
            Its values (n,) from first to last + 1, straight across holes.
        size : int
            Its samples.
        rate : float
            Its rate [Hz].
        """
        sigma = white_noise_of(read, size)
        longest = _longest(rate)
        if size < _shortest(longest) or sigma == 0.0:
            return cls(sigma, np.zeros(0))
        return cls(sigma, _dropouts(read, size, HEIGHT_SIGMAS * sigma, longest))

    def spikes(self, part: Channel, others: Iterable[tuple[Channel, float]]) -> BoolArray:
        """Return which samples of a part stand alone.

        Parameters
        ----------
        part : Channel
            Some samples of the record.
        others : iterable of (Channel, float)
            Channels of the same kind on the same clock over the same time, each with its own sigma: what
            they show too is no spike.
        """
        values = _without_holes(part)
        spike = _standing_alone(part, values, self.sigma)
        if self.dropouts.size:
            spike |= np.isin(values, self.dropouts)
        if spike.any():
            spike &= ~_beside(~part.usable)
        for other, sigma in others:
            if spike.any():
                spike &= ~_answered(part, values, spike, other, sigma)
        return spike


def with_spikes_flagged(channels: Sequence[Channel]) -> tuple[Channel, ...]:
    """Return the channels of one clock with `Flag.SPIKE` where a sample stands alone.

    Parameters
    ----------
    channels : sequence of Channel
        Channels that see the same cable; what more than one of them shows within a wave's delay is kept.

    Returns
    -------
    tuple of Channel
        The same channels, in the same order.
    """
    rules = [_rule(channel) for channel in channels]
    result: list[Channel] = []
    for channel, rule in zip(channels, rules, strict=True):
        others = [
            (other, its_rule.sigma)
            for other, its_rule in zip(channels, rules, strict=True)
            if other is not channel and other.kind == channel.kind
        ]
        spikes = np.zeros(channel.time.size, dtype=bool)
        for start, stop in blocks_of(channel.time.size):
            first = max(start - CONTEXT, 0)
            part = channel.rows(first, stop + CONTEXT)
            near = ((_around(other, part), sigma) for other, sigma in others)
            spikes[start:stop] = rule.spikes(part, near)[start - first : stop - first]
        result.append(channel.with_flags(spikes, Flag.SPIKE))
    return tuple(result)


def _rule(channel: Channel) -> SpikeRule:
    known = np.isfinite(channel.values)
    if not known.any():
        return SpikeRule(0.0, np.zeros(0))
    return SpikeRule.of(bridged_reader(channel.time, channel.values, known), channel.time.size, channel.rate)


def _around(other: Channel, part: Channel) -> Channel:
    """Return what another channel shows while a part lasts, and a little longer."""
    first, last = np.searchsorted(other.time, part.time[[0, -1]])
    return other.rows(max(int(first) - CONTEXT, 0), int(last) + CONTEXT)


def _longest(rate: float) -> int:
    return min(max(int(LONGEST * rate + 1e-9), 1), LONGEST_SAMPLES)


def _shortest(longest: int) -> int:
    """Return the samples below which a record has too few neighbours."""
    return 2 * (AROUND + longest)


def _height(values: FloatArray, width: int) -> FloatArray:
    """Return how far the mean of `width` samples from each index on lies from the mean of its neighbours."""
    height = np.zeros(values.size)
    stop = values.size - width
    if stop > 1:
        block = sum(values[1 + place : stop + place] for place in range(width)) / width
        height[1:stop] = block - 0.5 * (values[: stop - 1] + values[width + 1 : stop + width])
    return height


def _standing_alone(part: Channel, values: FloatArray, sigma: float) -> BoolArray:
    spike = np.zeros(values.size, dtype=bool)
    longest = _longest(part.rate)
    if values.size < _shortest(longest) or sigma == 0.0:
        return spike
    for width in range(1, longest + 1):
        height = _height(values, width)
        for start in np.flatnonzero(_likely(values, height, HEIGHT_SIGMAS * sigma, width)):
            block = slice(int(start), int(start) + width)
            if not spike[block].any() and _stands_alone(values, height, int(start), width):
                spike[block] = True
    return spike


def _dropouts(read: Callable[[int, int], FloatArray], size: int, least: float, longest: int) -> FloatArray:
    """Return the values that stand apart again and again, beyond all that the signal reaches.

    A logger that loses samples now and then writes the same number for each, often zero. Many of them hide
    one another from a look at how high such heights are around.
    """

    def blocks() -> Iterator[tuple[FloatArray, BoolArray]]:
        for start, stop in blocks_of(size):
            first = max(start - CONTEXT, 0)
            values = read(first, min(stop + CONTEXT, size))
            inside = slice(start - first, stop - first)
            yield values[inside], _repeated_alone(values, least, longest)[inside]

    alone = [values[dropout] for values, dropout in blocks()]
    numbers, counts = np.unique(np.concatenate(alone), return_counts=True)
    numbers = numbers[counts >= FEWEST_DROPOUTS]
    if not numbers.size:
        return np.zeros(0)
    low, high = np.inf, -np.inf
    for values, dropout in blocks():
        rest = values[~dropout & ~np.isin(values, numbers)]
        if rest.size:
            low, high = min(low, float(np.min(rest))), max(high, float(np.max(rest)))
    if low > high:
        return np.zeros(0)
    margin = APART * (high - low)
    beyond: FloatArray = numbers[(numbers < low - margin) | (numbers > high + margin)]
    return beyond


def _repeated_alone(values: FloatArray, least: float, longest: int) -> BoolArray:
    """Return the samples of high blocks of one value."""
    dropout = np.zeros(values.size, dtype=bool)
    for width in range(1, longest + 1):
        for start in np.flatnonzero(_likely(values, _height(values, width), least, width)).tolist():
            block = values[start : start + width]
            dropout[start : start + width] |= bool(np.all(block == block[0]))
    return dropout


def _likely(values: FloatArray, height: FloatArray, least: float, width: int) -> BoolArray:
    """Return where a block is high and its own edges are steeper than the steps next to them."""
    step = np.abs(np.diff(values))
    likely = np.abs(height) > least
    start = np.flatnonzero(likely)
    start = start[(start >= 2) & (start + width + 1 < values.size)]
    edges = np.minimum(step[start - 1], step[start + width - 1])
    beside = np.maximum(step[start - 2], step[start + width])
    likely[:] = False
    likely[start[edges > ISOLATION * beside]] = True
    return likely


def _without_holes(channel: Channel) -> FloatArray:
    """Return the values as logged, straight across holes; plateaus stay, for their edges are no spikes."""
    known = np.isfinite(channel.values)
    if known.all() or not known.any():
        return channel.values
    return np.interp(channel.time, channel.time[known], channel.values[known])


def _beside(marked: BoolArray) -> BoolArray:
    """Return marked samples and those as close to them as a spike is long."""
    reach = LONGEST_SAMPLES
    total = np.concatenate(([0], np.cumsum(marked)))
    index = np.arange(marked.size)
    first, last = np.maximum(index - reach, 0), np.minimum(index + reach + 1, marked.size)
    return np.asarray(total[last] > total[first], dtype=bool)


def _stands_alone(values: FloatArray, height: FloatArray, start: int, width: int) -> bool:
    own = abs(height[start])
    left, right = values[start - 1], values[start + width]
    block = values[start : start + width] - 0.5 * (left + right)
    if abs(right - left) > NEIGHBOURS_AGREE * own or np.min(np.abs(block)) < 0.5 * own:
        return False
    if not (np.all(block > 0) or np.all(block < 0)):
        return False
    edge = min(abs(values[start] - left), abs(values[start + width - 1] - right))
    steps_before = np.diff(values[max(start - 1 - AROUND, 0) : start])
    steps_after = np.diff(values[start + width : start + width + 1 + AROUND])
    around = np.sort(np.abs(np.concatenate((steps_before, steps_after))))
    # a second spike close by is allowed: its two edges are not the surroundings
    if edge <= ISOLATION * around[: max(around.size - 2, 1)][-1]:
        return False
    wide = np.abs(height[max(start - FAR_AROUND, 0) : start + FAR_AROUND])
    return bool(own > ISOLATION * float(np.quantile(wide, FAR_QUANTILE)))


def _answered(part: Channel, values: FloatArray, spike: BoolArray, other: Channel, sigma: float) -> BoolArray:
    """Return which spikes another channel shows as well, within a wave's delay and to the same side."""
    reach = max(WAVE_DELAY, 1.5 / part.rate)
    height, its_height = _height(values, 1), _height(_without_holes(other), 1)
    out = (np.abs(its_height) > ANSWER_SIGMAS * sigma) & other.usable
    answered = np.zeros(spike.size, dtype=bool)
    for row in np.flatnonzero(spike):
        first, last = np.searchsorted(other.time, (part.time[row] - reach, part.time[row] + reach))
        same = np.sign(its_height[first:last]) == np.sign(height[row])
        answered[row] = bool(np.any(same & out[first:last]))
    return answered
