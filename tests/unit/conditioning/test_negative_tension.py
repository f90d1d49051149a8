"""A cable cannot push with more than its weight: what says so rests at a wrong tension."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tethertest.conditioning.flags.negative_tension import negative_tension_findings
from tethertest.records.channel import Channel, Finding

from .conftest import RIG

WEIGHT = RIG.cable.mass_per_length * RIG.cable.length * RIG.gravity


def found(lowest: float, at: float, lasting: float = 0.2, **changes: float) -> tuple[Finding, ...]:
    """Return what is found of a tension that falls to a value for a while, between snaps."""
    time = np.arange(5000) / 500.0
    values = np.where((time > 4.0) & (time < 4.0 + lasting), lowest, 5.0)
    values[np.abs(time - 4.0 - lasting - 0.02) < 0.01] = 60.0
    values += np.random.default_rng(1).normal(0.0, 0.015, time.size)
    channel = Channel("cell", "tension", "N", time, values, np.zeros(time.size, np.uint16), at)
    return negative_tension_findings((replace(channel, **changes),), RIG)


@pytest.mark.parametrize(("at", "lightest"), [(1.0, 0.0), (0.0, -WEIGHT)])
def test_a_cell_that_rests_too_low_is_found(at: float, lightest: float) -> None:
    (finding,) = found(lightest - 0.4, at)
    assert (finding.kind, finding.severity) == ("negative_tension", "fatal")
    assert "off by 0.4" in finding.text
    ((start, stop),) = finding.spans
    assert (start, stop) == pytest.approx((4.0, 4.2), abs=0.01)


@pytest.mark.parametrize(("at", "lightest"), [(1.0, 0.0), (0.0, -WEIGHT)])
def test_a_slack_cable_is_right(at: float, lightest: float) -> None:
    assert found(lightest - 0.05, at) == ()


def test_a_short_swing_is_none() -> None:
    assert found(-2.0, 1.0, lasting=0.02) == ()


def test_a_zero_that_is_not_known_excuses_it() -> None:
    assert found(-0.4, 1.0, offset_uncertainty=0.1) == ()
