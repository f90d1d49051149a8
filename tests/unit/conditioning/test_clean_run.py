from __future__ import annotations

import numpy as np
import pytest

from tethertest.conditioning import condition


def test_clean_run_warns_of_nothing_and_reads_the_rest_tension(bench):
    conditioned = condition(bench.run, bench.logs(), bench.priors)
    assert [item for item in conditioned.findings if item.severity != "note"] == []
    assert [channel.name for channel in conditioned.channels] == [s.name for s in bench.run.rig.sensor]
    top = conditioned.channel("tension_top")
    for window in (conditioned.rest_before, conditioned.rest_after):
        part = top.between(window.start, window.stop)
        assert np.median(part.values) == pytest.approx(5.0, abs=0.005)
    assert top.noise == pytest.approx(0.015, rel=0.1)
    assert top.uncertainty == pytest.approx(1e-3)


def test_windows_leave_the_ramps_out(bench):
    conditioned = condition(bench.run, bench.logs(), bench.priors)
    offset, drift = bench.clocks["daq"]
    true = [(edge - offset) / (1 + drift) for edge in (conditioned.steady.start, conditioned.steady.stop)]
    assert true[0] > 9.0
    assert true[1] < 29.0
    cycles = conditioned.steady.length * 0.5
    assert cycles == pytest.approx(round(cycles), abs=0.01)
    assert round(cycles) >= 8
    assert (conditioned.rest_before.stop - offset) < 6.5
    assert (conditioned.rest_after.start - offset) > 31.0


def test_strain_times_stiffness_is_the_tension(bench):
    conditioned = condition(bench.run, bench.logs(), bench.priors)
    top, strain = conditioned.channel("tension_top"), conditioned.channel("fbg2")
    inside = (strain.time > conditioned.steady.start) & (strain.time < conditioned.steady.stop)
    tension = np.interp(strain.time[inside], top.time, top.values) - 5.0
    slope = np.polyfit(tension, 10_020.0 * strain.values[inside], 1)
    assert slope[0] == pytest.approx(1.0, abs=0.005)
    assert slope[1] == pytest.approx(0.0, abs=0.02)


def test_every_step_is_on_record(bench):
    conditioned = condition(bench.run, bench.logs(), bench.priors)
    steps = " | ".join(conditioned.channel("fbg1").source.steps)
    for word in (
        "factor 1e-09",
        "peaks within 5.5 nm",
        "clock interrogator -> daq",
        "eps = ln",
        "zero offset",
    ):
        assert word in steps
    assert "100 N at 2 mV/V" in " | ".join(conditioned.channel("tension_top").source.steps)


def test_quiet_run_has_rest_and_no_steady_window(maker):
    bench = maker(drive="none")
    run = bench.run
    conditioned = condition(run, bench.logs(), bench.priors)
    assert conditioned.steady is None
    assert conditioned.rest_before is not None
    assert conditioned.rest_after is not None
    kinds = {item.kind for item in conditioned.findings if item.severity == "fatal"}
    assert kinds == {"clock_not_aligned"}  # nothing moves: nothing can align the clocks
