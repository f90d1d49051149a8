"""What the run file states and the logs contradict is said beside the verdict, or leaves none."""

from __future__ import annotations

from dataclasses import replace

import pytest

from tethertest.conditioning import condition, stated_findings
from tethertest.records.lines import DriveFit
from tethertest.records.run import Drive

RAN = DriveFit(0.5, 1e-5, ("heave",))


@pytest.mark.parametrize(
    ("drive", "kinds"),
    [
        (Drive("crank-slider", 0.5, 0.05), []),
        (Drive("crank-slider", 0.54, 0.05), ["drive_frequency"]),
        (Drive("crank-slider", 0.5, 0.1), ["drive_amplitude"]),
        (Drive("harmonic", 0.5, None, 0.00005), ["drive_amplitude"]),
    ],
)
def test_a_slip_of_the_pen_is_a_warning(bench, drive, kinds):
    conditioned = condition(bench.run, bench.logs(), bench.priors)
    found = stated_findings(bench.with_file(drive=drive), conditioned, RAN)
    assert [(item.kind, item.severity) for item in found] == [(kind, "warning") for kind in kinds]


def test_a_driven_run_that_says_it_is_none_decides_nothing(bench, maker):
    run = bench.with_file(drive=Drive("none"))
    conditioned = condition(run, bench.logs(), bench.priors)
    assert [item.severity for item in stated_findings(run, conditioned, None)] == ["fatal"]
    quiet = maker(drive="none")
    conditioned = condition(quiet.run, quiet.logs(), quiet.priors)
    assert stated_findings(quiet.run, conditioned, None) == ()


def test_a_calibration_run_validates_nothing(bench):
    conditioned = condition(bench.run, bench.logs(), bench.priors)
    run = replace(bench.run, file=replace(bench.run.file, purpose="calibration"))
    assert [(item.kind, item.severity) for item in stated_findings(run, conditioned, RAN)] == [
        ("calibration_run", "fatal")
    ]
