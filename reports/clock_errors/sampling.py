"""When an instrument sampled, and what stamps it wrote."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from tethertest.conditioning.timestamps.stamps import audit_stamps
from tethertest.records.arrays import BoolArray, FloatArray
from tethertest.records.channel import Channel, RawLog
from tethertest.units import Kind

#: how often stamps are what
STAMPS = {"exact": 0.55, "jitter": 0.2, "12.5 ms": 0.15, "1 ms": 0.1}
#: a record has gaps this often, up to `MOST_GAPS` of these lengths [s]
GAPPY, MOST_GAPS, GAP = 0.3, 3, (0.1, 2.0)
#: a record starts late and ends early by up to this [s]
LATE = 1.5


class Sampling:
    """One instrument's samples.

    Parameters
    ----------
    random : numpy.random.Generator
    rate : float
        By its own clock [Hz].
    length : float
        Of the run [s].
    clock : tuple of float
        Offset [s] and drift of its clock against true time.
    stamps : str
        A key of `STAMPS`: what it writes instead of the time.
    """

    def __init__(
        self, random: np.random.Generator, rate: float, length: float, clock: tuple[float, float], stamps: str
    ) -> None:
        offset, drift = clock
        first, last = random.uniform(0.0, LATE), length - random.uniform(0.0, LATE)
        reading = first * (1.0 + drift) + offset + np.arange(int((last - first) * rate)) / rate
        true = (reading - offset) / (1.0 + drift)
        self.gaps = int(random.integers(1, MOST_GAPS + 1)) if random.random() < GAPPY else 0
        self._holes: list[tuple[float, float]] = []
        kept = np.ones(reading.size, dtype=bool)
        for _ in range(self.gaps):
            start = random.uniform(first + 1.0, last - 3.0)
            hole = (start, start + random.uniform(*GAP))
            kept &= (true < hole[0]) | (true > hole[1])
            self._holes.append(hole)
        reading, true = reading[kept], true[kept]
        if stamps == "jitter":
            reading = reading + random.uniform(0.03, 0.4) / rate * random.uniform(-1.0, 1.0, reading.size)
        elif stamps != "exact":
            quantum = 1e-3 * float(stamps.split(maxsplit=1)[0])
            reading = np.floor(reading / quantum) * quantum
        result = audit_stamps(reading, RawLog(Path("log.csv"), "study", None, ()), "clock")
        self.time = result.time
        self.true = true[result.rows]
        self._flags = result.flags

    def channel(self, name: str, kind: Kind, unit: str, values: FloatArray, at: float) -> Channel:
        """Return a channel of this instrument."""
        return Channel(name, kind, unit, self.time, values, self._flags, at)

    def seen(self, time: FloatArray) -> BoolArray:
        """Return where the record has samples, at true times [s]."""
        inside = (time >= self.true[0]) & (time <= self.true[-1])
        for start, stop in self._holes:
            inside &= (time < start) | (time > stop)
        return np.asarray(inside, dtype=bool)


def between(reference: Sampling, clock: Sampling) -> tuple[float, float]:
    """Return offset [s] and drift of one instrument's audited stamps against the other's."""
    slope, base = np.polyfit(reference.true, reference.time, 1)
    rate, first = np.polyfit(clock.true, clock.time, 1)
    ratio = rate / slope
    return float(first - ratio * base), float(ratio - 1.0)
