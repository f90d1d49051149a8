"""The clock study's runs and bound, on a few of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from reports.clock_errors.bound import Bound, Waveform, bound
from reports.clock_errors.judge import Judged, judged
from reports.clock_errors.random_runs import random_run
from reports.clock_errors.rig import KNOWN_RIG
from reports.clock_errors.table import clock_table, demands

TIME = np.arange(0.0, 100.0, 4e-3)
SIGNAL = 2.0 * np.sin(2.0 * np.pi * 0.5 * TIME)


def _everywhere(time: np.ndarray) -> np.ndarray:
    return (time > 1.0) & (time < 99.0)


def test_bound_of_a_steady_drive_is_its_closed_form():
    """``sqrt(2 n / T) / (2 pi f A)`` in the middle, twice that at the start; drift ``sqrt(12)/T`` of it."""
    wave = Waveform(TIME, SIGNAL, (0.03, 0.02), (100.0, 50.0), None, (), 0.0)
    found = bound(wave, _everywhere, _everywhere, (), 1.0)
    density = 0.03**2 / 100.0 + 0.02**2 / 50.0
    middle = np.sqrt(2.0 * density / 98.0) / (2.0 * np.pi * 0.5 * 2.0)
    assert found.drift == pytest.approx(middle * np.sqrt(12.0) / 98.0, rel=0.02)
    assert found.offset == pytest.approx(np.hypot(middle, 50.0 * found.drift), rel=0.02)
    assert found.offset_with_rig == found.offset


def test_a_rig_that_delays_as_a_clock_does_bounds_the_offset_by_its_uncertainty():
    late = -3e-3 * np.gradient(SIGNAL, 4e-3)
    wave = Waveform(TIME, SIGNAL, (0.03, 0.02), (100.0, 50.0), None, (late,), 4e-3)
    found = bound(wave, _everywhere, _everywhere, (), 1.0)
    assert found.offset_with_rig == pytest.approx(5e-3, rel=0.01)
    assert found.drift_with_rig == pytest.approx(found.drift, rel=0.01)


def test_a_number_is_a_run():
    one, other = random_run(7), random_run(7)
    np.testing.assert_array_equal(one.channels[0].values, other.channels[0].values)
    assert (one.offset, one.drift) == (other.offset, other.drift)
    assert random_run(8).offset != one.offset


def test_a_run_is_judged_by_its_own_offset():
    found = judged(2)
    assert found.outcome == "fitted"
    assert abs(found.offset_error) < 5.0 * found.offset_stated
    assert found.bound.offset <= found.bound.offset_with_rig


def test_a_known_rig_adds_nothing_to_the_bound():
    for number in (0, 1):  # a strain and a motion
        run = random_run(number, KNOWN_RIG)
        assert run.bound.offset_with_rig == pytest.approx(run.bound.offset, rel=1e-9)
        assert run.bound.drift_with_rig == pytest.approx(run.bound.drift, rel=1e-9)


def test_coverage_may_be_short_by_chance_and_no_more():
    """Of 100 intervals of 95 %, 91 to 99 hold the true value in 19 of 20 samples."""
    run = Judged(
        0, "strain", "start", "exact", 0, 100.0, 1.0, (100.0, 100.0), "fitted", (), 1e-4, 1e-4, 0.0, 1e-6,
        Bound(1e-4, 1e-6, 1e-4, 1e-6, 50.0),
    )  # fmt: skip
    off = replace(run, offset_error=3e-4)
    assert demands([run] * 91 + [off] * 9)[0].met
    assert not demands([run] * 90 + [off] * 10)[0].met


def test_the_table_tells_a_missed_demand():
    run = Judged(
        0, "strain", "start", "exact", 0, 100.0, 1.0, (100.0, 100.0), "fitted", (), 1e-4, 1e-4, 0.0, 1e-6,
        Bound(1e-4, 1e-6, 1e-4, 1e-6, 50.0),
    )  # fmt: skip
    assert all(demand.met for demand in demands([run]))
    assert "| 1.00 |" in clock_table({"a rig": [run]}, "a command")
    wrong = replace(run, outcome="wrong cycle", offset_error=1.0)
    missed = [demand.text for demand in demands([run, wrong]) if not demand.met]
    assert "wrong cycles accepted" in missed
    assert "true offsets inside the stated interval of 95 %" in missed
    refused = replace(run, outcome="refused", reasons=("clock_ambiguous: no",))
    assert not demands([run, refused])[-1].met
