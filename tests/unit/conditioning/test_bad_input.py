"""What only a person can mend is one error with its remedy."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tethertest.conditioning import condition
from tethertest.errors import DataError
from tethertest.records.run import Exclude, Log


def refused(run, logs, priors) -> DataError:
    with pytest.raises(DataError) as caught:
        condition(run, logs, priors)
    assert caught.value.remedy
    return caught.value


def with_channels(bench, channels):
    entry = replace(bench.run.file.log[0], channels=channels)
    return bench.with_file(log=(entry, *bench.run.file.log[1:]))


def test_mapped_name_that_the_log_lacks(bench):
    error = refused(with_channels(bench, {"Force": "tension_top"}), bench.logs(), bench.priors)
    assert "'Force'" in error.problem
    assert "'F_top', 'F_bottom'" in error.problem


def test_sensor_that_the_rig_lacks(bench):
    error = refused(with_channels(bench, {"F_top": "tension_middle"}), bench.logs(), bench.priors)
    assert "tension_middle" in error.problem
    assert "tension_bottom" in error.remedy


def test_two_columns_for_one_sensor(bench):
    channels = {"F_top": "tension_top", "F_bottom": "tension_top"}
    assert "both claim" in refused(with_channels(bench, channels), bench.logs(), bench.priors).problem


@pytest.mark.parametrize("unit", ["mm", "furlongs", ""])
def test_wrong_unknown_or_absent_unit_of_a_load_cell(bench, unit):
    bench.units["F_top"] = unit
    error = refused(bench.run, bench.logs(), bench.priors)
    assert error.path == "tension.lvm"
    assert "F_top" in error.problem
    assert "mV/V" in error.remedy


@pytest.mark.parametrize(("unit", "factor"), [("N", 50.0), ("kN", 0.05), ("counts", 1e-3 / 2e-9)])
def test_tension_in_other_units_is_the_same_tension(bench, unit, factor):
    clean = condition(bench.run, bench.logs(), bench.priors).channel("tension_top")
    bench.columns["F_top"] *= factor
    bench.units["F_top"] = unit
    other = condition(bench.run, bench.logs(), bench.priors).channel("tension_top")
    np.testing.assert_allclose(other.values, clean.values, atol=1e-9)


def test_columns_without_a_sensor_are_noted(bench):
    logs = bench.logs()
    log = logs["crank.csv"]
    extra = replace(log.channels[0], name="motor current", unit="A")
    logs["crank.csv"] = replace(log, channels=(*log.channels, extra))
    conditioned = condition(bench.run, logs, bench.priors)
    assert [item.text for item in conditioned.findings if item.kind == "ignored"] == [
        "motor current: no sensor of the rig, not used"
    ]


def test_no_rest_window(maker):
    bench = maker(taps=False, ramps=False)
    error = refused(bench.run, bench.logs(), bench.priors)
    assert "no rest window" in error.problem
    assert "rest_before" in error.remedy


def test_no_drive_found(bench):
    drive = replace(bench.run.file.drive, frequency=4.0)
    error = refused(bench.with_file(drive=drive), bench.logs(), bench.priors)
    assert "no drive found" in error.problem
    assert "4 Hz" in error.problem


def test_excluded_channel_that_the_run_lacks(bench):
    run = bench.with_file(exclude=(Exclude("fbg9", (1.0, 2.0), "why"),))
    assert "fbg9" in refused(run, bench.logs(), bench.priors).problem


def test_sensor_in_two_logs(bench):
    logs = {**bench.logs(), "again.csv": replace(bench.logs()["crank.csv"])}
    run = bench.with_file(log=(*bench.run.file.log, Log("again.csv", "daq")))
    assert "'heave'" in refused(run, logs, bench.priors).problem
