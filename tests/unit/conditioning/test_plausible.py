"""What no sensor writes, and windows and spans by hand that do not fit: refused or fatal, never compared."""

from __future__ import annotations

import numpy as np
import pytest

from tethertest.conditioning import condition
from tethertest.errors import DataError
from tethertest.records.run import ClockOffset, Exclude, Override, Windows


def refused(bench, run=None) -> DataError:
    with pytest.raises(DataError) as caught:
        condition(bench.run if run is None else run, bench.logs(), bench.priors)
    assert caught.value.remedy
    return caught.value


def fatal(bench, run=None) -> dict[str, str]:
    conditioned = condition(bench.run if run is None else run, bench.logs(), bench.priors)
    return {item.kind: item.text for item in conditioned.findings if item.severity == "fatal"}


@pytest.mark.parametrize("unit", ["m", "cm"])
def test_an_encoder_in_a_unit_too_large_is_beyond_its_range(bench, unit):
    bench.columns["heave"] *= 8.0 if unit == "cm" else 1.0
    bench.units["heave"] = unit
    error = refused(bench)
    assert "'heave', logged as " + unit in error.problem
    assert error.path == "crank.csv"


def test_milliseconds_read_as_seconds_are_no_rate_of_the_instrument(bench):
    bench.stamps["daq"] = bench.stamps["daq"][0] + 1000.0 * (bench.stamps["daq"] - bench.stamps["daq"][0])
    assert "0.5 samples per second" in refused(bench).problem


@pytest.mark.parametrize(
    ("name", "value", "why"),
    [("F_top", np.nan, "missing"), ("F_bottom", 0.1, "satur"), ("heave", np.nan, "m")],
)
def test_a_dead_channel_is_named_with_what_is_wrong(bench, name, value, why):
    bench.columns[name] = np.full_like(bench.columns[name], value)
    error = refused(bench)
    assert {"F_top": "tension_top", "F_bottom": "tension_bottom", "heave": "heave"}[name] in error.problem
    assert why in error.problem


def test_a_flat_encoder_shows_no_drive(bench):
    bench.columns["heave"] = np.zeros_like(bench.columns["heave"])
    assert "no drive found" in refused(bench).problem


def test_a_log_of_a_moment_is_no_run(bench):
    for column in ("F_top", "F_bottom"):
        bench.columns[column] = bench.columns[column][:20]
    bench.stamps["daq"] = bench.stamps["daq"][:20]
    # 19 steps of 2 ms
    assert "the log is 0.038 s long, expected a run" in refused(bench).problem


def test_a_dead_grating_is_told_and_decides_nothing(bench):
    bench.columns["fbg1"] = np.full_like(bench.columns["fbg1"], np.nan)
    conditioned = condition(bench.run, bench.logs(), bench.priors)
    assert "lost" in {item.kind for item in conditioned.findings if item.subject == "fbg1"}
    assert not [item for item in conditioned.findings if item.severity == "fatal"]


def test_a_hole_in_the_motion_decides_nothing_unless_the_window_leaves_it_out(bench):
    hole = (Exclude("heave", (20.0, 20.6), "touched"),)
    across = bench.with_file(exclude=hole, windows=Windows(steady=(14.0, 26.0)))
    assert "from 19.995 s to 20.600 s" in fatal(bench, across)["motion_hole"]
    assert not fatal(bench, bench.with_file(exclude=hole, windows=Windows(steady=(21.0, 27.0))))
    sample = (Exclude("heave", (20.0, 20.004), "spike"),)
    assert not fatal(bench, bench.with_file(exclude=sample))


def test_a_window_by_hand_beside_the_record_is_refused(bench):
    assert (
        "rest_before" in refused(bench, bench.with_file(windows=Windows(rest_before=(-90.0, -80.0)))).problem
    )
    assert "steady" in refused(bench, bench.with_file(windows=Windows(steady=(20.0, 200.0)))).problem


def test_a_rest_window_by_hand_in_which_the_base_moves_decides_nothing(bench):
    found = fatal(bench, bench.with_file(windows=Windows(rest_before=(16.0, 20.0))))
    assert "heave moves by +/-0.05" in found["no_rest"]


@pytest.mark.parametrize("span", [(300.0, 310.0), (-10.0, 100.0)])
def test_an_exclusion_of_nothing_or_of_everything_is_refused(bench, span):
    error = refused(bench, bench.with_file(exclude=(Exclude("tension_top", span, "why"),)))
    assert "tension_top" in error.problem


def test_the_reference_clock_has_no_offset_by_hand(bench):
    override = Override({"daq": ClockOffset(1.0, "marker tap")})
    assert "'daq'" in refused(bench, bench.with_file(override=override)).problem
