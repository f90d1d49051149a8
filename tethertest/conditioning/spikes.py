"""Spikes: one to three samples far from their neighbours; a snap is none."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from tethertest.records.arrays import BoolArray, FloatArray
from tethertest.records.channel import Channel, Flag
from tethertest.signal.noise import white_noise

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


def with_spikes_flagged(
    channels: Sequence[Channel], sigmas: Sequence[float] | None = None
) -> tuple[Channel, ...]:
    """Return the channels of one clock with `Flag.SPIKE` where a sample stands alone.

    Parameters
    ----------
    channels : sequence of Channel
        Channels that see the same cable; what more than one of them shows within a wave's delay is kept.
    sigmas : sequence of float, optional
        Standard deviation of one sample of each, where the channels are only a part of the record.

    Returns
    -------
    tuple of Channel
        The same channels, in the same order.
    """
    values = [_without_holes(channel) for channel in channels]
    sigmas = [white_noise(item) for item in values] if sigmas is None else sigmas
    answers = [
        _answers(channel, item, sigma) for channel, item, sigma in zip(channels, values, sigmas, strict=True)
    ]
    result: list[Channel] = []
    for number, channel in enumerate(channels):
        spike = _spikes(channel, values[number], sigmas[number])
        for other, (times, signs) in enumerate(answers):
            if other != number and channels[other].kind == channel.kind and spike.any():
                spike &= ~_answered(channel, values[number], spike, times, signs)
        result.append(channel.with_flags(spike, Flag.SPIKE))
    return tuple(result)


def _height(values: FloatArray, width: int) -> FloatArray:
    """Return how far the mean of `width` samples from each index on lies from the mean of its neighbours."""
    total = np.concatenate(([0.0], np.cumsum(values - values[0])))
    block = (total[width:] - total[:-width]) / width + values[0]
    height = np.zeros(values.size)
    stop = values.size - width
    height[1:stop] = block[1:stop] - 0.5 * (values[: stop - 1] + values[width + 1 : stop + width])
    return height


def _spikes(channel: Channel, values: FloatArray, sigma: float) -> BoolArray:
    spike = np.zeros(values.size, dtype=bool)
    longest = min(max(int(LONGEST * channel.rate + 1e-9), 1), LONGEST_SAMPLES)
    if values.size < 2 * (AROUND + longest) or sigma == 0.0:
        return spike
    for width in range(1, longest + 1):
        height = _height(values, width)
        for start in np.flatnonzero(_likely(values, height, HEIGHT_SIGMAS * sigma, width)):
            block = slice(int(start), int(start) + width)
            if not spike[block].any() and _stands_alone(values, height, int(start), width):
                spike[block] = True
    return (spike | _dropouts(values, HEIGHT_SIGMAS * sigma, longest)) & ~_beside(~channel.usable)


def _dropouts(values: FloatArray, least: float, longest: int) -> BoolArray:
    """Return the samples of one value that stands apart again and again, beyond all that the signal reaches.

    A logger that loses samples now and then writes the same number for each, often zero. Many of them hide
    one another from a look at how high such heights are around.
    """
    dropout = np.zeros(values.size, dtype=bool)
    for width in range(1, longest + 1):
        for start in np.flatnonzero(_likely(values, _height(values, width), least, width)).tolist():
            block = values[start : start + width]
            dropout[start : start + width] |= bool(np.all(block == block[0]))
    numbers, counts = np.unique(values[dropout], return_counts=True)
    numbers = numbers[counts >= FEWEST_DROPOUTS]
    rest = values[~dropout & ~np.isin(values, numbers)]
    if not numbers.size or not rest.size:
        return np.zeros(values.size, dtype=bool)
    margin = APART * float(np.max(rest) - np.min(rest))
    beyond = (numbers < np.min(rest) - margin) | (numbers > np.max(rest) + margin)
    return np.asarray(np.isin(values, numbers[beyond]), dtype=bool)


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


def _answers(channel: Channel, values: FloatArray, sigma: float) -> tuple[FloatArray, FloatArray]:
    """Return times and signs of all samples that stand out, spike or not."""
    height = _height(values, 1)
    out = np.flatnonzero((np.abs(height) > ANSWER_SIGMAS * sigma) & channel.usable)
    return channel.time[out], np.sign(height[out])


def _answered(
    channel: Channel, values: FloatArray, spike: BoolArray, times: FloatArray, signs: FloatArray
) -> BoolArray:
    height = _height(values, 1)
    reach = max(WAVE_DELAY, 1.5 / channel.rate)
    answered = np.zeros(spike.size, dtype=bool)
    for row in np.flatnonzero(spike):
        first, last = np.searchsorted(times, (channel.time[row] - reach, channel.time[row] + reach))
        answered[row] = bool(np.any(signs[first:last] == np.sign(height[row])))
    return answered
