"""What stands still rightly and what does not, over digits and noise from none to five digits."""

from __future__ import annotations

import numpy as np
import pytest

from tethertest.conditioning.flags.stuck_saturated import plateaus_of, with_plateaus_flagged
from tethertest.records.channel import Channel, Flag

NOISE = (0.0, 0.05, 0.1, 0.2, 0.3, 0.5, 1.0, 5.0)  #: [digits]
#: rate [Hz], drive [Hz] and amplitude [digits]
DRIVES = (
    (100.0, 0.25, 20.0),
    (500.0, 0.25, 500.0),
    (500.0, 0.1, 50.0),
    (1000.0, 0.05, 100.0),
    (500.0, 1.0, 30.0),
)


def marked(time: np.ndarray, values: np.ndarray, flag: Flag, kind: str = "strain") -> np.ndarray:
    channel = Channel("c", kind, "1", time, values, np.zeros(values.size, dtype=np.uint16))
    flagged = with_plateaus_flagged(channel)
    return np.asarray((flagged.flags & np.uint16(flag)) != 0)


def record(
    rate: float, drive: float, amplitude: float, noise: float, seed: int
) -> tuple[np.ndarray, np.ndarray]:
    """A sine between two rests of ten seconds, with ramps of five, before it is rounded to whole digits."""
    time = np.arange(int(60.0 * rate)) / rate
    moving = np.clip(np.minimum(time - 10.0, 50.0 - time) / 5.0, 0.0, 1.0)
    moving = moving**2 * (3.0 - 2.0 * moving)
    sine = amplitude * np.sin(2.0 * np.pi * drive * (time - 10.0)) * moving
    return time, sine + np.random.default_rng(seed).normal(0.0, noise, time.size)


@pytest.mark.parametrize(("rate", "drive", "amplitude"), DRIVES)
@pytest.mark.parametrize("noise", NOISE)
def test_rest_and_turning_points_are_neither_stuck_nor_at_a_limit(rate, drive, amplitude, noise):
    time, values = record(rate, drive, amplitude, noise, seed=int(rate * drive))
    assert not marked(time, np.round(values + 0.2), Flag.STUCK | Flag.SATURATED).any()


@pytest.mark.parametrize(("rate", "drive", "amplitude"), DRIVES[1:4])
@pytest.mark.parametrize("noise", NOISE)
def test_a_limit_is_seen_in_any_digits(rate, drive, amplitude, noise):
    time, values = record(rate, drive, amplitude, noise, seed=int(rate * drive))
    limit = round(0.9 * amplitude)
    clipped = np.round(np.minimum(values, limit))
    assert np.array_equal(marked(time, clipped, Flag.SATURATED), clipped == limit)


@pytest.mark.parametrize(("rate", "drive", "amplitude"), [*DRIVES[:3], DRIVES[4]])
@pytest.mark.parametrize("noise", NOISE)
def test_a_value_that_stops_in_motion_is_stuck(rate, drive, amplitude, noise):
    time, values = record(rate, drive, amplitude, noise, seed=int(rate * drive))
    values = np.round(values)
    # from near the middle, for a period and a quarter: it leaves from near an extreme
    start = int((10.0 + max(1.05, round(5.0 * drive) + 1.05) / drive) * rate)
    stop = min(start + int(1.25 / drive * rate), int(50.0 * rate))
    values[start:stop] = values[start]
    stuck = marked(time, values, Flag.STUCK)
    assert stuck[start:stop].all()
    beside = 2.0 * rate / (2.0 * np.pi * drive * amplitude * 0.8)  # samples in the digits before and after
    assert np.count_nonzero(stuck) <= stop - start + 4 + beside


def test_a_cable_that_is_slack_in_coarse_digits_is_no_amplifier_at_its_limit():
    time = np.arange(30_000) / 500.0
    tension = np.maximum(np.sin(2.0 * np.pi * 0.25 * time) + 0.4, 0.0) * 10.0 + 0.03
    for noise in (0.0, 0.001):
        rounded = np.round(tension + np.random.default_rng(1).normal(0.0, noise, time.size), 2)
        assert not marked(time, rounded, Flag.STUCK | Flag.SATURATED, "tension").any()


def test_a_calculated_record_may_be_slack_for_long_and_rest():
    time = np.arange(30_000) / 500.0
    moving = np.clip(time - 10.0, 0.0, 31.0)  # it stops where the cable is slack
    tension = np.maximum(np.sin(2.0 * np.pi * 0.25 * moving) + 0.4, 0.0) * 10.0
    for kind in ("tension", "strain"):
        assert not marked(time, tension, Flag.STUCK | Flag.SATURATED, kind).any()
    assert marked(time, np.minimum(tension, 12.0), Flag.SATURATED).sum() == np.count_nonzero(tension >= 12.0)


def test_a_channel_that_never_moves_is_at_a_limit():
    time = np.arange(3000) / 500.0
    assert marked(time, np.full(3000, 4.2), Flag.STUCK | Flag.SATURATED).all()


def test_a_dead_channel_is_stuck_where_its_noise_was_seen():
    time = np.arange(6000) / 200.0
    for noise in (0.5, 1.0, 5.0):
        values = np.round(np.random.default_rng(2).normal(40.0, noise, time.size))
        values[4000:] = 40.0
        assert np.count_nonzero(marked(time, values, Flag.STUCK)) == pytest.approx(2000, abs=4)


def test_runs_that_chance_makes_are_no_fault():
    """Three values at random: the longest run of thousands is at an extreme two times in three."""
    for seed in range(30):
        values = np.random.default_rng(seed).integers(0, 3, 4000).astype(float)
        time = np.arange(4000) / 1000.0
        assert not marked(time, values, Flag.STUCK | Flag.SATURATED).any()


def test_a_limit_is_four_samples_in_a_row_and_every_other_touch_of_it():
    random = np.random.default_rng(3)
    time = np.arange(4000) / 1000.0
    values = 10.0 * np.sin(2.0 * np.pi * time) + 0.5 * random.standard_normal(4000)
    for length, limited in ((4, True), (3, False)):
        clipped = values.copy()
        clipped[1250 : 1250 + length] = clipped[2250] = 14.0
        found = np.flatnonzero(marked(time, clipped, Flag.SATURATED)).tolist()
        assert found == ([*range(1250, 1254), 2250] if limited else [])


def test_a_value_is_stuck_from_half_a_second_on():
    random = np.random.default_rng(4)
    time = np.arange(4000) / 1000.0
    values = 10.0 * np.sin(2.0 * np.pi * time) + 0.5 * random.standard_normal(4000)
    for lasting, stuck in ((501, True), (499, False)):
        held = values.copy()
        held[1000 : 1000 + lasting] = 2.5
        found = np.flatnonzero(marked(time, held, Flag.STUCK))
        assert (found.size == lasting) is stuck


def test_a_slack_cable_may_rest_at_zero_and_an_encoder_has_no_limit():
    random = np.random.default_rng(5)
    time = np.arange(4000) / 1000.0
    values = np.maximum(10.0 * np.sin(2.0 * np.pi * 0.5 * time) + 0.2 * random.standard_normal(4000), 0.0)
    assert not marked(time, values, Flag.STUCK | Flag.SATURATED, kind="tension").any()
    assert marked(time, values, Flag.STUCK | Flag.SATURATED, kind="strain").any()
    clipped = np.minimum(values, 9.0)
    assert marked(time, clipped, Flag.SATURATED, kind="strain")[clipped == 9.0].all()
    assert not marked(time, clipped, Flag.SATURATED, kind="displacement").any()


@pytest.mark.parametrize("block", [700, 1000, 4000])
def test_parts_of_a_record_are_marked_as_the_whole_is(block):
    """Also where a run begins in one part and ends in another, or fills a part."""
    random = np.random.default_rng(6)
    time = np.arange(4000) / 1000.0
    values = 10.0 * np.sin(2.0 * np.pi * time) + 0.5 * random.standard_normal(4000)
    values[600:2100] = 2.5
    values[3248:3256] = 14.0
    channel = Channel("c", "strain", "1", time, values, np.zeros(4000, dtype=np.uint16))
    whole = with_plateaus_flagged(channel)
    assert np.flatnonzero(whole.flags & Flag.STUCK).tolist() == list(range(600, 2100))
    assert np.flatnonzero(whole.flags & Flag.SATURATED).tolist() == list(range(3248, 3256))
    found = plateaus_of(lambda a, b: (time[a:b], values[a:b]), 4000, block, "strain")
    for size in (500, 700, 3300):
        for start in range(0, 4000, size):
            flags = found.flags(values[start : start + size], start)
            np.testing.assert_array_equal(flags, whole.flags[start : start + size])
