"""Slack intervals and snaps."""

from __future__ import annotations

import numpy as np
import pytest

from tethertest.errors import DataError
from tethertest.records.channel import Flag, Window
from tethertest.spectra import find_events, slack_intervals, spectrum

from .conftest import Maker, cosine

RATE = 1000.0


def bouncing(time: np.ndarray) -> np.ndarray:
    """Tension ``3 + 5 cos(2 pi 0.5 t)`` N without its negative part: slack while the cosine is below -0.6."""
    return np.maximum(3.0 + 5.0 * np.cos(2 * np.pi * 0.5 * time), 0.0)


def test_slack_edges_are_where_the_tension_meets_zero(channel: Maker) -> None:
    time = np.arange(10_000) / RATE
    noise = 0.015 * np.random.default_rng(1).standard_normal(time.size)
    events = find_events(channel(time, bouncing(time) + noise, noise=0.015), 0.02)
    intervals = slack_intervals(events, "tension_top")
    half = np.arccos(0.6) / np.pi  # half a slack interval [s], about t = 1, 3, 5, ...
    assert len(intervals) == 5
    for number, (start, stop) in enumerate(intervals):
        assert start == pytest.approx(2 * number + 1 - half, abs=0.012)
        assert stop == pytest.approx(2 * number + 1 + half, abs=0.012)


def test_noise_does_not_chop_an_interval_and_touching_zero_makes_none(channel: Maker) -> None:
    time = np.arange(10_000) / RATE
    noise = 0.2 * np.random.default_rng(2).standard_normal(time.size)
    intervals = slack_intervals(
        find_events(channel(time, bouncing(time) + noise, noise=0.2), 0.02), "tension_top"
    )
    assert len(intervals) == 5
    touching = 1.0 + np.cos(2 * np.pi * 5.0 * time)
    assert find_events(channel(time, touching), 1e-4) == ()
    assert find_events(channel(time, 1.0 + 0.5 * touching), 0.03) == ()


def test_a_snap_is_the_peak_after_retightening(channel: Maker) -> None:
    time = np.arange(3_000) / RATE
    tension = np.where((time > 1.0) & (time < 1.5), 0.0, 4.0)
    tension += 9.0 * np.exp(-(((time - 1.53) / 0.006) ** 2))
    events = find_events(channel(time, tension), 0.02)
    assert [event.kind for event in events] == ["slack", "snap"]
    slack, snap = events
    assert (slack.start, slack.stop) == pytest.approx((1.0, 1.5), abs=0.015)
    assert snap.start == slack.stop
    assert snap.stop == pytest.approx(1.53, abs=0.002)
    assert snap.value == pytest.approx(13.0, abs=0.05)


def test_a_rise_that_outlasts_the_span_is_followed_to_its_top(channel: Maker) -> None:
    time = np.arange(4_000) / RATE
    since = time - 1.5
    # half a sine of 0.6 s: at 0.25 s it still rises, its top is at 0.3 s
    pulse = 8.0 * np.sin(np.pi * since / 0.6)
    tension = np.where((since > 0.0) & (since < 0.6), pulse, np.where(time < 1.0, 4.0, 0.0))
    # later it grows again, to more; that is not this snap
    tension += np.where(time > 2.5, 12.0 * np.sin(np.pi * (time - 2.5)), 0.0) * (time < 3.5)
    noise = 0.02 * np.random.default_rng(5).standard_normal(time.size)
    events = find_events(channel(time, tension + noise, noise=0.02), 0.02)
    first = next(event for event in events if event.kind == "snap")
    assert first.stop == pytest.approx(1.8, abs=0.03)
    assert first.value == pytest.approx(8.0, abs=0.08)


def test_bouncing_after_the_span_is_another_top(channel: Maker) -> None:
    time = np.arange(4_000) / RATE
    since = np.maximum(time - 1.5, 0.0)
    # a mean that grows for a second, and a bounce of 80 ms on it that falls by more than a tenth
    tension = np.where(time < 1.0, 4.0, 8.0 * since * (1.0 - 0.5 * np.cos(2.0 * np.pi * since / 0.08)))
    (snap,) = [event for event in find_events(channel(time, tension), 0.02) if event.kind == "snap"]
    # tops near 40, 120, 200 and 280 ms: the last is where the rise at 250 ms leads to
    assert snap.stop == pytest.approx(1.5 + 0.2815, abs=0.004)


def test_a_flagged_spike_is_no_snap(channel: Maker) -> None:
    time = np.arange(3_000) / RATE
    tension = np.where((time > 1.0) & (time < 1.5), 0.0, 4.0)
    tension[1600] = 90.0
    spike = np.zeros(time.size, dtype=bool)
    spike[1600] = True
    events = find_events(channel(time, tension).with_flags(spike, Flag.SPIKE), 0.02)
    assert events[-1].kind == "snap"
    assert events[-1].value == pytest.approx(4.0)


def test_slack_is_looked_for_in_tension_only(channel: Maker) -> None:
    time = np.arange(100) / RATE
    with pytest.raises(DataError, match="holds strain, expected tension"):
        find_events(channel(time, np.zeros(100), kind="strain"), 0.02)


def test_the_spectrum_shows_the_peak_of_a_cosine_and_no_offset(channel: Maker) -> None:
    time = np.arange(6000) / 100.0
    record = channel(time, 5.0 + cosine(time, 0.5, 2.0))
    found = spectrum(record, Window(0.0, 60.0))
    assert found.frequency[int(np.argmax(found.amplitude))] == pytest.approx(0.5)
    assert found.amplitude.max() == pytest.approx(2.0, rel=1e-6)
    assert found.amplitude[0] < 1e-3
    between = spectrum(channel(time, cosine(time, 0.5 + 0.5 / 60.0, 2.0)), Window(0.0, 60.0))
    assert between.amplitude.max() == pytest.approx(2.0 * 0.849, rel=0.01)
