from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import pytest

from tethertest.compare import compare
from tethertest.records.arrays import FloatArray
from tethertest.records.channel import Channel, ConditionedRun, Finding, Window
from tethertest.records.comparison import Comparison
from tethertest.records.lines import ChannelLines, Expectation
from tethertest.records.rig import Limits
from tethertest.spectra import find_lines, fit_drive

RATE = 200.0
WINDOW = Window(5.0, 45.0)
STATIC = {"tension_top": 5.0, "tension_bottom": 3.6}
LIMITS = Limits(
    peak_tension=0.1,
    order_amplitude={"1": 0.05, "2": 0.15},
    order_phase={"1": 0.17},
    sprague_geers=0.15,
)


def tension(time: FloatArray, static: float, scale: float = 1.0, lag: float = 0.0) -> FloatArray:
    """Two orders of a 0.5 Hz drive about the static tension."""
    angle = 2.0 * np.pi * 0.5 * (time - lag)
    return static + scale * (2.0 * np.cos(angle + 0.4) + 0.3 * np.cos(2.0 * angle - 1.0))


def channels(
    scale: float = 1.0, lag: float = 0.0, noise: float = 0.0, seed: int = 1, **fields: float
) -> tuple[Channel, ...]:
    time = np.arange(0.0, 50.0, 1.0 / RATE)
    random = np.random.default_rng(seed)
    return tuple(
        Channel(
            name=name,
            kind="tension",
            unit="N",
            time=time,
            values=tension(time, static, scale, lag) + noise * random.standard_normal(time.size),
            flags=np.zeros(time.size, dtype=np.uint16),
            noise=noise,
            **fields,
        )
        for name, static in STATIC.items()
    )


@dataclass(frozen=True)
class Case:
    """A measured run and what is held against it."""

    measured: ConditionedRun
    limits: Limits = LIMITS

    def against(
        self, replayed: Sequence[Channel], variations: Sequence[Sequence[Channel]] = ()
    ) -> Comparison:
        drive = fit_drive(self.measured.channels, WINDOW, 0.5)

        def lines(side: Sequence[Channel]) -> tuple[ChannelLines, ...]:
            return tuple(find_lines(channel, WINDOW, drive, Expectation()) for channel in side)

        return compare(
            self.measured,
            replayed,
            lines(self.measured.channels),
            lines(replayed),
            self.limits,
            variations,
            STATIC,
        )

    def having(self, *findings: Finding) -> Case:
        return replace(self, measured=replace(self.measured, findings=findings))


@pytest.fixture
def case() -> Case:
    measured = channels(noise=0.01, uncertainty=0.001)
    return Case(ConditionedRun(measured, (), (), None, None, WINDOW))
