"""Runs of identical values: a saturated amplifier or a stuck channel.

Noise moves a value from sample to sample. So in a record whose noise exceeds half a digit, a run that is too
long for chance is a fault: at the extremes of the record an amplifier at its limit, elsewhere a channel that
stuck. Where digits are coarser than that, and on an encoder, the value may stand still rightly: at rest,
where the cable is slack, and where a slow motion turns. There a channel was stuck only if it leaves its value
by a leap or came to it too fast, and was at its limit only if the values next to the limit are passed too
quickly for a motion that turns by itself. In between, where a value often repeats but noise is seen, the
noise may be quieter at times: there a run without a leap must be much longer than all that are the channel's
own. A slack cable rests: at the lowest value of coarse digits, and at a tension of exactly zero. Calculated
records, which have no noise, are taken like coarse digits.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from tethertest.records.arrays import BoolArray, FlagArray, FloatArray
from tethertest.records.channel import Channel, Flag
from tethertest.signal.noise import quantum, white_noise
from tethertest.signal.passes import BLOCK, blocks_of

IntArray = npt.NDArray[np.int64]
#: time [s] and values, both (n,), of the samples from first to last + 1
Reader = Callable[[int, int], tuple[FloatArray, FloatArray]]

#: a stuck channel repeats its value at least this long [s]
SHORTEST_STUCK = 0.5
#: a saturated one repeats its extreme at least this many times in a row
SHORTEST_PLATEAU = 4
#: and no sample goes beyond the plateau by more than this fraction of the record's range
PLATEAU_WIDTH = 1e-6
#: runs that noise makes this improbable in the whole record are none of its doing
IMPROBABLE = 1e-6
#: noise of half a digit turns a slow value back in three of ten samples or more, noise of a tenth in one;
#: where fewer turn, the value may stand still. A fast value seldom turns either, but cannot stop so
COARSE = 0.15
#: where more than this share of the values repeats the one before, a run must be so many times longer than
#: the longest that does not look stuck
OFTEN, LONGER = 0.1, 5.0
#: a leap, or motion as fast just before, that shows that a value which may stand still was stuck: in usual
#: steps, of an encoder and of any other channel
ENCODER_LEAP, LEAP = 20.0, 5.0
#: motion before the run is measured over this time [s]
APPROACH = 0.1
#: a parabola that just fills its last digit spends 0.41 of that time in the next digit, one that was cut off
#: a digit and a half below its top 0.29; values closer than so many digits are in the next one
TURN, NEXT_DIGIT = 0.3, 1.5
#: noise and digits are measured in so many places, on so many samples in each
PLACES, SAMPLES = 40, 4096


@dataclass(frozen=True, slots=True, eq=False)
class Plateaus:
    """Which samples of a channel stand still and should not."""

    saturated: IntArray  #: (n, 2) first and last sample
    limits: FloatArray  #: values of the saturated runs: shorter touches are saturated too
    stuck: IntArray  #: (n, 2)

    def flags(self, values: FloatArray, start: int) -> FlagArray:
        """Return the flags of some values of the channel, from sample `start` on."""
        flags = np.zeros(values.size, dtype=np.uint16)
        saturated = _inside(self.saturated, start, values.size) | np.isin(values, self.limits)
        flags[saturated] = np.uint16(Flag.SATURATED)
        flags[_inside(self.stuck, start, values.size)] |= np.uint16(Flag.STUCK)
        return flags


def with_plateaus_flagged(channel: Channel) -> Channel:
    """Return the channel with `Flag.SATURATED` at repeated extremes and `Flag.STUCK` in other long runs.

    Parameters
    ----------
    channel : Channel
        As logged, before any filter.
    """

    def read(start: int, stop: int) -> tuple[FloatArray, FloatArray]:
        return channel.time[start:stop], channel.values[start:stop]

    size = channel.time.size
    if size < 2:
        return channel
    found = plateaus_of(read, size, BLOCK, channel.kind)
    if not (found.saturated.size or found.stuck.size):
        return channel
    flags = channel.flags.copy()
    for start, stop in blocks_of(size):
        flags[start:stop] |= found.flags(channel.values[start:stop], start)
    return replace(channel, flags=flags)


def plateaus_of(read: Reader, size: int, block: int, kind: str) -> Plateaus:
    """Return where a channel is saturated or stuck.

    Parameters
    ----------
    read : callable
        The channel, as logged, on its own clock.
    size, block : int
        Its samples, and samples at once.
    kind : str
        Of the channel; a displacement (an encoder's counts) may stand still.
    """
    runs = repeats_of(read, size, block, lasting=SHORTEST_STUCK, samples=SHORTEST_PLATEAU)
    encoder = kind == "displacement"
    if not np.any(runs.long) and encoder:
        return Plateaus(runs.pairs[:0], runs.level[:0], runs.pairs[:0])
    digit, step, turning = _resolution(read, size, runs)
    coarse = turning < COARSE
    width = PLATEAU_WIDTH * (runs.high - runs.low)
    highest, lowest = runs.level >= runs.high - width, runs.level <= runs.low + width
    repeated = runs.share(highest | lowest)
    improbable = size * max(repeated, 1.0 / size) ** (runs.length - 1.0) < IMPROBABLE
    slack = (runs.level == 0.0) & (kind == "tension")
    if coarse:
        slack |= runs.level <= runs.low + NEXT_DIGIT * digit
    saturated = improbable & (highest | lowest) & (runs.length >= SHORTEST_PLATEAU) & ~slack & (not encoder)
    if coarse:
        for number in np.flatnonzero(saturated):
            saturated[number] = not _turns(read, size, runs, int(number), digit)
    limits = np.unique(runs.level[saturated])
    stuck = runs.long & ~np.isin(runs.level, limits) & ~slack & (improbable | encoder)
    if coarse or encoder or repeated > OFTEN:
        leap = (ENCODER_LEAP if encoder else LEAP) * step
        own = float(np.max(runs.length[~stuck], initial=1.0))
        believed = np.inf if coarse or encoder else LONGER * own
        for number in np.flatnonzero(stuck & (runs.length <= believed)):
            stuck[number] = _leaps(read, size, runs.pairs[number], leap)
    return Plateaus(runs.pairs[saturated], limits, runs.pairs[stuck])


def _resolution(read: Reader, size: int, runs: Repeats) -> tuple[float, float, float]:
    """Return digit, usual step and share of turns of a channel where it does not stand still for long.

    A usual step is the digit, the white noise or the middle one of the steps between samples that differ,
    whichever is largest. A channel that never moves is judged like one with noise.
    """
    count = min(PLACES, -(-size // SAMPLES))
    standing = runs.pairs[runs.long]
    parts = []
    for start in np.linspace(0, max(size - SAMPLES, 0), count).astype(int).tolist():
        values = read(start, min(start + SAMPLES, size))[1]
        parts.append(values[np.isfinite(values) & ~_inside(standing, start, values.size)])
    moving = np.concatenate(parts)
    steps = np.diff(moving)
    steps = steps[steps != 0.0]
    turns = np.count_nonzero(steps[1:] * steps[:-1] < 0.0)
    digit = quantum(moving)
    usual = float(np.median(np.abs(steps))) if steps.size else 0.0
    turning = turns / moving.size if steps.size else 1.0
    return digit, max(digit, white_noise(moving), usual), turning


def _turns(read: Reader, size: int, runs: Repeats, number: int, digit: float) -> bool:
    """Return whether the values beside a run are those of a motion that turns by itself."""
    first, last = runs.pairs[number].tolist()
    length = last - first + 1
    values = read(max(first - length, 0), min(last + 1 + length, size))[1]
    away = np.abs(values - runs.level[number])
    beside = (away > 0.0) & (away <= NEXT_DIGIT * digit)
    return bool(np.count_nonzero(beside) >= TURN * length)


def _leaps(read: Reader, size: int, pair: IntArray, leap: float) -> bool:
    """Return whether a run ends with a leap, or follows motion too fast to have stopped by itself."""
    first, last = pair.tolist()
    _, end = read(last, min(last + 2, size))
    if abs(end[-1] - end[0]) > leap:
        return True
    time, _ = read(max(first - 64, 0), min(first + 64, size))
    rate = (time.size - 1) / (time[-1] - time[0])
    reach = max(round(APPROACH * rate), 1)
    _, before = read(max(first - reach, 0), first + 1)
    return bool(abs(before[-1] - before[0]) > leap)


def _inside(pairs: IntArray, start: int, size: int) -> BoolArray:
    """Return which of some samples, from `start` on, lie in any of the runs."""
    near = pairs[(pairs[:, 1] >= start) & (pairs[:, 0] < start + size)] - start
    marks: npt.NDArray[np.int64] = np.zeros(size + 1, dtype=np.int64)
    np.add.at(marks, np.maximum(near[:, 0], 0), 1)
    np.add.at(marks, np.minimum(near[:, 1] + 1, size), -1)
    return np.asarray(np.cumsum(marks)[:-1] > 0, dtype=bool)


@dataclass(frozen=True, slots=True, eq=False)
class Repeats:
    """Runs of identical finite values that last long or have many samples, and what the others amount to."""

    pairs: IntArray  #: (n, 2) first and last sample
    level: FloatArray  #: (n,) the value
    duration: FloatArray  #: (n,) [s]
    long: BoolArray  #: (n,) lasts at least the time asked for
    repeats: float  #: samples of runs that do not last so long and repeat the one before
    samples: float  #: samples of runs that do not last so long
    low: float  #: smallest finite value
    high: float

    @property
    def length(self) -> FloatArray:
        """Samples of each run, (n,)."""
        return (self.pairs[:, 1] - self.pairs[:, 0] + 1).astype(np.float64)

    def share(self, apart: BoolArray) -> float:
        """Return which share of the samples repeats the one before, long runs and some others set apart.

        Parameters
        ----------
        apart : (n,) bool
            Runs that do not count.
        """
        left_out = self.length[apart & ~self.long]
        samples = self.samples - float(np.sum(left_out))
        return (self.repeats - float(np.sum(left_out - 1.0))) / max(samples, 1.0)


def repeats_of(read: Reader, size: int, block: int, *, lasting: float, samples: int) -> Repeats:
    """Gather the runs of identical finite values; a run may reach across blocks.

    Parameters
    ----------
    read : callable
        The record.
    size, block : int
        Its samples, and samples at once.
    lasting : float
        Runs that last so long are kept [s].
    samples : int
        And runs of so many samples.
    """
    parts: list[tuple[IntArray, FloatArray, FloatArray]] = []
    repeats = counted = 0.0
    low, high = np.inf, -np.inf
    carried: tuple[int, float, float] | None = None  # first sample, its time and value, of the open run
    ended_at = 0.0
    for start in range(0, size, block):
        time, values = read(start, min(start + block, size))
        stop = start + values.size
        finite = values[np.isfinite(values)]
        if finite.size:
            low, high = min(low, float(finite.min())), max(high, float(finite.max()))
        new = np.flatnonzero(np.concatenate(([True], np.diff(values) != 0.0)))
        first, begun, level = start + new, time[new], values[new]
        last, ended = np.append(start + new[1:] - 1, stop - 1), np.append(time[new[1:] - 1], time[-1])
        if carried is not None and values[0] == carried[2]:
            first[0], begun[0] = carried[0], carried[1]
        elif carried is not None:
            first, begun = np.append(carried[0], first), np.append(carried[1], begun)
            level = np.append(carried[2], level)
            last, ended = np.append(start - 1, last), np.append(ended_at, ended)
        carried, ended_at = (int(first[-1]), float(begun[-1]), float(level[-1])), float(ended[-1])
        known = np.isfinite(level)
        if stop < size:
            known[-1] = False  # it may go on
        duration, length = (ended - begun)[known], (last - first + 1)[known]
        short = duration < lasting
        repeats += float(np.sum(length[short] - 1))
        counted += float(np.sum(length[short]))
        kept = (length >= samples) | ~short
        pairs = np.column_stack((first[known], last[known]))[kept].astype(np.int64)
        parts.append((pairs, level[known][kept], duration[kept]))
    pairs = np.concatenate([part[0] for part in parts])
    level, duration = (np.concatenate([part[number] for part in parts]) for number in (1, 2))
    return Repeats(pairs, level, duration, duration >= lasting, repeats, counted, low, high)
