"""What the cable's inertia adds between its ends, against the rig in closed form."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tethertest.conditioning.inertia import cable_inertia
from tethertest.conditioning.rig_priors import RigPriors
from tethertest.records.channel import Channel, Flag, Window
from tethertest.records.run import Drive
from tethertest.replay.mechanics import tension_response

FREQUENCY, AMPLITUDE = 0.5, 0.05
WINDOW = Window(0.0, 20.0)


def sine(name: str, kind: str, unit: str, amplitude: float, at: float) -> Channel:
    time = np.arange(0.0, 20.0, 0.005)
    values = amplitude * np.sin(2.0 * np.pi * FREQUENCY * time)
    return Channel(name, kind, unit, time, values, np.zeros(time.size, np.uint16), at=at)


def at_frequency(priors: RigPriors) -> RigPriors:
    return replace(priors, drive_frequency=FREQUENCY)


@pytest.fixture
def rig(bench):
    """Return run, channels and the standard deviation of the difference between the ends' tensions."""
    frequency = np.array([FREQUENCY])
    bottom, top = (tension_response(bench.run.rig, "free", frequency, place)[0] for place in (0.0, 1.0))
    channels = (
        sine("tension_top", "tension", "N", AMPLITUDE * abs(top), 1.0),
        sine("tension_bottom", "tension", "N", AMPLITUDE * abs(bottom), 0.0),
        sine("heave", "displacement", "m", AMPLITUDE, 0.0),
    )
    return bench, channels, AMPLITUDE * abs(top - bottom) / np.sqrt(2.0)


def test_a_measured_motion_gives_the_difference_between_the_ends(rig):
    bench, channels, difference = rig
    found = cable_inertia(bench.run, channels, WINDOW, at_frequency(bench.priors))
    assert found.force == pytest.approx(difference, rel=0.02)
    assert found.doubt == ""


def test_a_stated_motion_stands_in_and_is_believed_less(rig):
    bench, channels, difference = rig
    lost = channels[2].with_flags(np.ones(channels[2].time.size, dtype=bool), Flag.LOST)
    for others in (channels[:2], (*channels[:2], lost)):
        found = cable_inertia(bench.run, others, WINDOW, at_frequency(bench.priors))
        assert found.force == pytest.approx(1.1 * difference, rel=0.02)
        assert "no bottom motion was measured" in found.doubt


def test_the_tension_tells_a_motion_that_is_neither_measured_nor_stated(rig):
    bench, channels, difference = rig
    run = bench.with_file(drive=Drive("harmonic", FREQUENCY))
    found = cable_inertia(run, channels[:2], WINDOW, at_frequency(bench.priors))
    assert found.force == pytest.approx(difference, rel=0.05)
    assert "what the tension asks" in found.doubt


@pytest.mark.parametrize(("stated", "larger"), [(0.1, 2.0), (0.025, 1.0), (0.054, 1.0)])
def test_the_larger_of_two_motions_counts_where_they_disagree(rig, stated, larger):
    bench, channels, difference = rig
    run = bench.with_file(drive=replace(bench.run.file.drive, radius=stated))
    found = cable_inertia(run, channels, WINDOW, at_frequency(bench.priors))
    assert found.force == pytest.approx(larger * difference, rel=0.02)
    assert ("[drive] radius" in found.doubt) == (stated != 0.054)


def test_without_a_frequency_nothing_is_allowed_and_that_is_said(rig):
    bench, channels, _ = rig
    run = bench.with_file(drive=replace(bench.run.file.drive, frequency=None))
    found = cable_inertia(run, channels, WINDOW, bench.priors)
    assert found.force == 0.0
    assert "frequency" in found.doubt
