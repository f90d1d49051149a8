"""Random records with known content: the source article's 68 s at 30 Hz, in every kind of trouble."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np

from tethertest.records.arrays import FloatArray
from tethertest.records.channel import Channel, Flag, Window
from tethertest.records.lines import Expectation
from tethertest.records.response import NaturalFrequency
from tethertest.units import Kind

COUNT: Final = 2048
RATE: Final = 30.0  #: [Hz]
TIME: Final = np.arange(COUNT) / RATE
LENGTH: Final = COUNT / RATE  #: [s]
WINDOW: Final = Window(0.0, float(TIME[-1]))
#: standard deviation of the noise; the drive's amplitude is one, its second and third order those below
NOISE: Final = 0.05
SECOND, THIRD = 0.1, 0.05
#: one standard error of an amplitude in white noise
STANDARD_ERROR: Final = NOISE * float(np.sqrt(2.0 / COUNT))
#: relative difference of a logger's clock
CLOCK_DRIFT: Final = 80e-6
#: relative, root mean square; and the time over which the speed forgets itself [s]
WANDER, WANDER_TIME = 0.01, 8.0
#: relative amplitude of a swing of the speed, and its period [s]
SWING, SWING_PERIOD = (0.02, 0.03), (10.0, 40.0)
#: the motion is measured this well: its amplitude over its noise
MOTION_CLEARNESS: Final = 1000.0

Random = np.random.Generator
Noise = Callable[[Random], FloatArray]


@dataclass(frozen=True, slots=True, eq=False)
class Record:
    """One channel with what is known about it."""

    tension: Channel
    motion: Channel | None  #: measured bottom motion, where there is one
    drive: float  #: true frequency of the drive [Hz]
    expectation: Expectation


def white(random: Random) -> FloatArray:
    """Return white noise of unit variance (n,)."""
    return random.standard_normal(COUNT)


def autoregressive(random: Random) -> FloatArray:
    """Return AR(1) noise of unit variance with coefficient 0.9 (n,)."""
    from scipy.signal import lfilter

    noise = np.asarray(lfilter([1.0], [1.0, -0.9], random.standard_normal(COUNT + 300)), dtype=np.float64)
    return noise[300:] * float(np.sqrt(1.0 - 0.9**2))


def one_over_f(random: Random) -> FloatArray:
    """Return noise whose density falls as 1/f, of unit variance (n,)."""
    spectrum = np.fft.rfft(random.standard_normal(4 * COUNT))
    spectrum[1:] /= np.sqrt(np.arange(1, spectrum.size))
    spectrum[0] = 0.0
    noise = np.fft.irfft(spectrum)
    return np.asarray(noise[:COUNT] / noise.std(), dtype=np.float64)


def cosine(time: FloatArray, frequency: float, amplitude: float, phase: float) -> FloatArray:
    """Return a cosine (n,)."""
    return amplitude * np.cos(2.0 * np.pi * frequency * time + phase)


def driven(random: Random, frequency: float, turned: FloatArray = TIME) -> FloatArray:
    """Return the drive with its second and third order (n,), phases at random, over a crank's own time."""
    parts = ((1.0, 1.0), (2.0, SECOND), (3.0, THIRD))
    response = np.zeros(turned.size)
    for order, amplitude in parts:
        response += cosine(turned, order * frequency, amplitude, random.uniform(0.0, 2.0 * np.pi))
    return response


def tension(values: FloatArray, flags: FloatArray | None = None) -> Channel:
    """Return a channel of the record's times."""
    marks = np.zeros(COUNT, dtype=np.uint16)
    if flags is not None:
        marks[flags > 0.0] = Flag.MISSING
    return Channel("tension", Kind.TENSION, "N", TIME, values, marks)


def motion(random: Random, frequency: float, turned: FloatArray = TIME) -> Channel:
    """Return the measured bottom motion of a crank without harmonics."""
    values = cosine(turned, frequency, 0.1, random.uniform(0.0, 2.0 * np.pi))
    values = values + 0.1 / MOTION_CLEARNESS * random.standard_normal(COUNT)
    return Channel("heave", Kind.DISPLACEMENT, "m", TIME, values, np.zeros(COUNT, dtype=np.uint16), at=0.0)


def some_drive(random: Random) -> float:
    """Return a drive frequency about the article's 0.25 Hz."""
    return float(random.uniform(0.23, 0.27))


def noisy(noise: Noise) -> Callable[[Random], Record]:
    """Return the maker of records with nothing but the drive in that noise."""

    def make(random: Random) -> Record:
        frequency = some_drive(random)
        values = driven(random, frequency) + NOISE * noise(random)
        return Record(tension(values), None, frequency, Expectation())

    return make


def ramps_left_in(random: Random) -> Record:
    """Return a drive started and stopped within the record over 4 to 10 s."""
    frequency = some_drive(random)
    up, down = random.uniform(4.0, 10.0, 2)
    envelope = np.clip(TIME / up, 0.0, 1.0) * np.clip((LENGTH - TIME) / down, 0.0, 1.0)
    values = envelope * driven(random, frequency) + NOISE * white(random)
    return Record(tension(values), None, frequency, Expectation())


def clock_drift(random: Random) -> Record:
    """Return a drive whose frequency is known from a motion on another clock, 80 ppm off."""
    frequency = some_drive(random)
    own = TIME * (1.0 + CLOCK_DRIFT * random.choice([-1.0, 1.0]))
    values = driven(random, frequency, own) + NOISE * white(random)
    return Record(tension(values), motion(random, frequency), frequency, Expectation())


def missing(random: Random) -> Record:
    """Return a record with 5 % of its samples missing, half of them in bursts of ten."""
    frequency = some_drive(random)
    lost = random.random(COUNT) < 0.025
    for start in random.integers(0, COUNT - 10, 5):
        lost[start : start + 10] = True
    values = driven(random, frequency) + NOISE * white(random)
    return Record(tension(np.where(lost, np.nan, values), lost.astype(float)), None, frequency, Expectation())


def hum(random: Random) -> Record:
    """Return 50 Hz that sampling at 30 Hz folds to 10 Hz, up to half the drive's amplitude."""
    frequency = some_drive(random)
    mains = 50.0 * (1.0 + random.uniform(-0.002, 0.002))
    values = driven(random, frequency) + NOISE * white(random)
    values += cosine(TIME, mains, random.uniform(0.02, 0.5), random.uniform(0.0, 2.0 * np.pi))
    return Record(tension(values), None, frequency, Expectation())


def free(*, decays: bool, stated: bool) -> Callable[[Random], Record]:
    """Return the maker of records with a free oscillation within 10 % of half the drive frequency."""

    def make(random: Random) -> Record:
        frequency = some_drive(random)
        natural = 0.5 * frequency * (1.0 + random.uniform(-0.1, 0.1))
        envelope = np.exp(-TIME / random.uniform(8.0, 30.0)) if decays else 1.0
        values = driven(random, frequency) + NOISE * white(random)
        oscillation = cosine(TIME, natural, random.uniform(0.02, 0.4), random.uniform(0.0, 2.0 * np.pi))
        known = (NaturalFrequency("lateral 1", natural),) if stated else ()
        return Record(tension(values + envelope * oscillation), None, frequency, Expectation(known))

    return make


def wandering(*, measured: bool) -> Callable[[Random], Record]:
    """Return the maker of records whose drive's speed wanders by 1 %, with or without the motion measured."""

    def make(random: Random) -> Record:
        from scipy.signal import lfilter

        frequency = some_drive(random)
        memory = float(np.exp(-1.0 / (WANDER_TIME * RATE)))
        noise = np.asarray(lfilter([1.0], [1.0, -memory], random.standard_normal(COUNT + 5000)))
        speed = WANDER * noise[5000:] * float(np.sqrt(1.0 - memory**2))
        turned = np.asarray(np.cumsum(1.0 + speed) / RATE, dtype=np.float64)
        values = driven(random, frequency, turned) + NOISE * white(random)
        seen = motion(random, frequency, turned) if measured else None
        return Record(tension(values), seen, frequency, Expectation())

    return make


def swinging(random: Random) -> Record:
    """Return a drive whose speed swings by 2 to 3 % with a period of 10 to 40 s, the motion not measured."""
    frequency = some_drive(random)
    depth, period = random.uniform(*SWING), random.uniform(*SWING_PERIOD)
    phase = random.uniform(0.0, 2.0 * np.pi)
    swing = np.sin(2.0 * np.pi * TIME / period + phase)
    turned = TIME + depth * period / (2.0 * np.pi) * (swing - swing[0])
    values = driven(random, frequency, turned) + NOISE * white(random)
    return Record(tension(values), None, frequency, Expectation())


def with_half(record: Record, random: Random, amplitude: float) -> Record:
    """Return a record of white noise with a locked line at half the drive frequency."""
    half = cosine(TIME, 0.5 * record.drive, amplitude, random.uniform(0.0, 2.0 * np.pi))
    return Record(tension(record.tension.values + half), record.motion, record.drive, record.expectation)
