from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from tethertest.records.arrays import FloatArray
from tethertest.records.channel import Channel, Window

Maker = Callable[..., Channel]


@pytest.fixture
def channel() -> Maker:
    def make(time: FloatArray, values: FloatArray, **fields: object) -> Channel:
        defaults: dict[str, object] = {"name": "tension_top", "kind": "tension", "unit": "N"}
        flags = np.zeros(time.size, dtype=np.uint16)
        return Channel(**{**defaults, "flags": flags, **fields}, time=time, values=values)  # type: ignore[arg-type]

    return make


@pytest.fixture
def time() -> FloatArray:
    """The source article's record: 68 s at 30 Hz."""
    return np.arange(2048) / 30.0


@pytest.fixture
def window(time: FloatArray) -> Window:
    return Window(0.0, float(time[-1]))


def cosine(time: FloatArray, frequency: float, amplitude: float = 1.0, phase: float = 0.0) -> FloatArray:
    return amplitude * np.cos(2.0 * np.pi * frequency * time + phase)


def autoregressive(random: np.random.Generator, coefficient: float, count: int) -> FloatArray:
    """AR(1) noise of unit innovation variance."""
    from scipy.signal import lfilter

    noise = lfilter([1.0], [1.0, -coefficient], random.standard_normal(count + 500))
    return np.asarray(noise, dtype=np.float64)[500:]
