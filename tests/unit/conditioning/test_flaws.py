"""Every flaw put into a clean run is named, on its own channel, at its own place, and nothing else is."""

from __future__ import annotations

import datetime as dt
from dataclasses import replace

import numpy as np
import pytest

from tethertest.conditioning import condition
from tethertest.records.channel import Flag
from tethertest.records.run import Exclude

NEWTON = 2.0 / 100.0  #: [mV/V per N] of the bench's load cells


def problems(conditioned):
    return {(item.subject, item.kind) for item in conditioned.findings if item.severity != "note"}


def flagged(conditioned, channel, flag):
    return np.flatnonzero(conditioned.channel(channel).flags & np.uint16(flag))


def test_spikes_and_no_snap(bench):
    top = bench.columns["F_top"]
    places = [6000, 9001, 14_300]
    top[places] += np.array([6.0, -9.0, 20.0]) * NEWTON
    # a snap: one half wave of 40 ms on both ends, the top one a wave's delay later
    snap = 15.0 * np.sin(np.pi * np.arange(20) / 19.0) * NEWTON
    bench.columns["F_bottom"][11_000:11_020] += snap
    top[11_003:11_023] += snap
    conditioned = condition(bench.run, bench.logs(), bench.priors)
    assert problems(conditioned) == {("tension_top", "spike")}
    assert flagged(conditioned, "tension_top", Flag.SPIKE).tolist() == places
    assert np.isfinite(conditioned.channel("tension_top").values).all()


def test_stuck_load_cell(bench):
    bench.columns["F_bottom"][8000:11_000] = bench.columns["F_bottom"][8000]
    conditioned = condition(bench.run, bench.logs(), bench.priors)
    assert problems(conditioned) == {("tension_bottom", "stuck")}
    found = flagged(conditioned, "tension_bottom", Flag.STUCK)
    assert (found[0], found[-1], found.size) == (8000, 10_999, 3000)


def test_encoder_that_freezes_in_motion_but_not_at_rest(bench):
    bench.columns["heave"][:1000] = np.round(bench.columns["heave"][:1000], 1)
    bench.columns["heave"][3000:3300] = bench.columns["heave"][3000]
    conditioned = condition(bench.run, bench.logs(), bench.priors)
    assert flagged(conditioned, "heave", Flag.STUCK)[[0, -1]].tolist() == [3000, 3299]


def test_saturated_amplifier(bench):
    limit = float(np.round(np.quantile(bench.columns["F_top"], 0.97), 6))
    above = bench.columns["F_top"] >= limit
    bench.columns["F_top"] = np.minimum(bench.columns["F_top"], limit)
    conditioned = condition(bench.run, bench.logs(), bench.priors)
    assert problems(conditioned) == {("tension_top", "saturated")}
    found = flagged(conditioned, "tension_top", Flag.SATURATED)
    assert found.size == pytest.approx(np.count_nonzero(above), rel=0.1)
    assert np.all(above[found])


def test_lost_grating_blanks_itself_and_moves_no_other(bench):
    clean = condition(bench.run, bench.logs(), bench.priors)
    part = slice(1500, 1700)
    columns = bench.columns
    columns["fbg1"][part], columns["fbg2"][part] = columns["fbg2"][part].copy(), columns["temp1"][part].copy()
    columns["temp1"][part] = np.nan
    conditioned = condition(bench.run, bench.logs(), bench.priors)
    assert problems(conditioned) == {("fbg1", "lost"), ("fbg2", "slipped"), ("temp1", "slipped")}
    assert flagged(conditioned, "fbg1", Flag.LOST).size == 200
    assert np.isnan(conditioned.channel("fbg1").values[part]).all()
    np.testing.assert_allclose(conditioned.channel("fbg2").values, clean.channel("fbg2").values, atol=2e-7)


def test_peaks_by_number_find_their_gratings(bench):
    clean = condition(bench.run, bench.logs(), bench.priors)
    logs = bench.logs()
    log = logs["fbg.txt"]
    numbered = tuple(replace(item, name=f"CH1.{n}") for n, item in enumerate(log.channels, 1))
    logs["fbg.txt"] = replace(log, channels=numbered)
    conditioned = condition(bench.run, logs, bench.priors)
    for name in ("fbg1", "fbg2", "temp1"):
        np.testing.assert_array_equal(conditioned.channel(name).values, clean.channel(name).values)


def test_hum(bench):
    time = bench.stamps["daq"]
    bench.columns["F_top"] += 0.03 * np.sin(2 * np.pi * 50.0 * time) * NEWTON
    bench.columns["F_bottom"] += 0.002 * np.sin(2 * np.pi * 50.0 * time) * NEWTON
    conditioned = condition(bench.run, bench.logs(), bench.priors)
    assert problems(conditioned) == {("tension_top", "hum")}
    assert conditioned.channel("tension_top").usable.all()
    text = next(item.text for item in conditioned.findings if item.kind == "hum")
    assert float(text.split()[2]) == pytest.approx(0.03, rel=0.05)


def test_dropped_rows_are_a_gap_and_a_jump_is_not(bench):
    kept = np.ones(bench.stamps["interrogator"].size, dtype=bool)
    kept[1500:1525] = False
    for name in ("fbg1", "fbg2", "temp1"):
        bench.columns[name] = bench.columns[name][kept]
    bench.stamps["interrogator"] = bench.stamps["interrogator"][kept]
    jumped = bench.stamps["encoder"].copy()
    jumped[3500:] += 1.3
    bench.stamps["encoder"] = jumped
    conditioned = condition(bench.run, bench.logs(), bench.priors)
    assert problems(conditioned) == {("interrogator", "gap"), ("encoder", "clock_jump")}
    gap = next(item for item in conditioned.findings if item.kind == "gap")
    assert gap.samples == 25
    jump = next(item for item in conditioned.findings if item.kind == "clock_jump")
    assert "+1.3 s" in jump.text
    fit = next(item for item in conditioned.clocks if item.clock == "encoder")
    assert abs(fit.offset - bench.relative("encoder")[0]) < 3 * fit.offset_error


def test_range_missing_and_drift(bench):
    bench.columns["heave"][4000:4010] = np.nan
    bench.columns["F_top"] += np.linspace(0.0, 0.3, bench.columns["F_top"].size) * NEWTON
    bench.columns["F_bottom"][12_000:12_400] += 150.0 * NEWTON
    conditioned = condition(bench.run, bench.logs(), bench.priors)
    assert problems(conditioned) == {
        ("heave", "missing"), ("tension_top", "drift"), ("tension_bottom", "out_of_range")
    }  # fmt: skip
    assert flagged(conditioned, "tension_bottom", Flag.OUT_OF_RANGE).size == 400
    top = conditioned.channel("tension_top")
    after = top.between(conditioned.rest_after.start, conditioned.rest_after.stop)
    assert np.median(after.values) == pytest.approx(5.0, abs=0.01)


def test_excluded_by_hand(bench):
    run = bench.with_file(exclude=(Exclude("tension_top", (14.0, 15.0), "rig was touched"),))
    conditioned = condition(run, bench.logs(), bench.priors)
    assert problems(conditioned) == set()
    assert flagged(conditioned, "tension_top", Flag.EXCLUDED).size == pytest.approx(500, abs=1)
    assert any("rig was touched" in item.text for item in conditioned.findings)


def test_calibration_that_was_due_is_a_note(bench):
    sensors = tuple(
        replace(item, due=dt.date(2026, 8, 1)) if item.name == "tension_top" else item
        for item in bench.run.rig.sensor
    )
    run = replace(bench.run, rig=replace(bench.run.rig, sensor=sensors))
    conditioned = condition(run, bench.logs(), bench.priors)
    assert [(i.subject, i.severity) for i in conditioned.findings if i.kind == "calibration_due"] == [
        ("tension_top", "note")
    ]
