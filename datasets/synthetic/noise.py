"""Random draws of a run: clocks, offsets, sensitivities, noise, all from the run's number."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

CAMPAIGN_SEED = 20260905


def generator(number: int, purpose: str) -> np.random.Generator:
    """Return the random stream of one purpose in one run."""
    return np.random.default_rng([CAMPAIGN_SEED, number, *purpose.encode()])


@dataclass(frozen=True)
class Clock:
    """An instrument's clock: reading = true time (1 + drift 1e-6) + offset.

    Parameters
    ----------
    drift : float
        Parts per million.
    offset : float
        Seconds.
    start, end : float
        True time of the log's first sample, and before which its last one falls.
    """

    drift: float
    offset: float
    start: float
    end: float

    @property
    def rate(self) -> float:
        """Readings per true second."""
        return 1.0 + self.drift * 1e-6

    def reading(self, true_time: float) -> float:
        """Return what the clock shows at a true time."""
        return true_time * self.rate + self.offset

    def samples(self, frequency: float) -> tuple[Floats, Floats]:
        """Return the readings and true times of samples taken at a rate by this clock."""
        count = int((self.end - self.start) * self.rate * frequency)
        first = round(self.reading(self.start), 5)
        readings = first + np.arange(count) / frequency
        return readings, (readings - self.offset) / self.rate


def draw_clocks(number: int, duration: float) -> dict[str, Clock]:
    """Return the run's three clocks.

    Their offsets differ pairwise by 0.3 s to 3 s and their drifts by 20 ppm to 80 ppm.
    """
    random = generator(number, "clocks")
    daq = random.uniform(-0.4, 0.4)
    near = random.uniform(0.35, 1.4) * random.choice((-1.0, 1.0))
    far = -np.sign(near) * random.uniform(0.35, 1.4)
    offsets = {"daq": daq, "interrogator": daq + near, "encoder": daq + far}
    base = random.uniform(-8.0, 8.0)
    step = random.uniform(21.0, 38.0) * random.choice((-1.0, 1.0))
    other = -np.sign(step) * random.uniform(21.0, 38.0)
    drifts = {"daq": base, "interrogator": base + step, "encoder": base + other}
    return {
        name: Clock(
            drift=round(float(drifts[name]), 2),
            offset=round(float(offsets[name]), 5),
            start=round(float(random.uniform(0.0, 0.4)), 4),
            end=round(duration - float(random.uniform(0.0, 0.4)), 4),
        )
        for name in ("daq", "interrogator", "encoder")
    }


def slow_drift(random: np.random.Generator, progress: Floats, size: float) -> Floats:
    """Return a smooth drift over the run that starts at zero and reaches at most `size`."""
    line = random.uniform(0.5, 1.0) * random.choice((-1.0, 1.0))
    bend = random.uniform(-0.4, 0.4)
    curve = line * progress + bend * progress * (1.0 - progress)
    return np.asarray(size * curve / max(1.0, float(np.max(np.abs(curve)))))
