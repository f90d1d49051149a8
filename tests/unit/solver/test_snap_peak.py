"""The peak of the 20 ms mean: what it is, that it settles, and when the solver may stop at it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tethertest.records.cable import Air, Cable
from tethertest.records.response import Status
from tethertest.records.scene import Accuracy, Bottom, Geometry, Output, Scene, Top
from tethertest.solver import solve
from tethertest.solver.nonlinear.chain_march import run_chain
from tethertest.solver.nonlinear.snap_peak import (
    march_with_peaks,
    peak_error,
    peaks_apart,
    running_peaks,
    with_close_rows,
)
from tethertest.solver.problem import Problem

SNAP = Scene(
    "snap",
    Cable(3.0, "unstretched", 0.0484, 10.0e3, diameter=0.006, axial_damping_time=1e-3),
    Geometry("ends", top=(1.2, 2.6)),
    Bottom("harmonic", "tangent", amplitude=0.1, frequency=1.0, start="ramp", ramp=1.0),
    Top("fixed"),
    Output(2.0, 50.0, (0.0, 0.5, 1.0)),
    air=Air(1.225, 1.2, 0.01),
    accuracy=Accuracy(0.05),
)


def test_a_pulse_of_half_the_window_has_half_its_height() -> None:
    time = np.arange(1000) * 1e-3
    tension = np.full((1000, 2), 2.0)
    tension[500:510, 1] = 12.0
    assert running_peaks(time, tension) == pytest.approx([2.0, 7.0], rel=1e-12)


def test_a_record_shorter_than_the_window_has_its_mean() -> None:
    assert running_peaks(np.array([0.0, 0.001]), np.array([[1.0], [3.0]])) == pytest.approx([2.0])


def test_close_rows_leave_the_output_rows_where_they_were() -> None:
    _, finer = with_close_rows(SNAP)
    assert finer * SNAP.output.rate * 0.02 >= 8.0
    thinned, _ = march_with_peaks(Problem(SNAP, 0.05), 20)
    plain = run_chain(SNAP, 20)
    assert thinned.time == pytest.approx(plain.time, abs=1e-12)
    assert thinned.tension == pytest.approx(plain.tension, rel=1e-9, abs=1e-9)


def test_differences_count_over_the_largest_rise_above_rest() -> None:
    apart = peaks_apart(np.array([11.0, 30.0]), np.array([10.0, 30.0]), np.array([5.0, 10.0]))
    assert apart == pytest.approx(1.0 / 20.0)


def test_peaks_are_judged_only_where_drag_and_damping_let_them_settle() -> None:
    assert peak_error(SNAP, [0.08, 0.03], along=False) == pytest.approx(1.25 * 0.04)
    assert peak_error(SNAP, [0.04, 0.03], along=True) == pytest.approx(2.0 * 0.03)
    assert peak_error(replace(SNAP, air=None), [0.08, 0.03], along=False) is None
    undamped = replace(SNAP, cable=replace(SNAP.cable, axial_damping_time=None))
    assert peak_error(undamped, [0.08, 0.03], along=False) is None


def test_a_damped_slack_cable_keeps_its_tolerance_in_the_peaks() -> None:
    answer = solve(SNAP, spread=False, finest=160)
    assert answer.status is Status.PEAKS_ONLY
    assert answer.snap is not None
    assert answer.snap.error is not None
    assert answer.snap.error <= 0.05 < answer.error.numerical
    _, finer = march_with_peaks(Problem(SNAP, 0.05), 2 * answer.cells)
    assert peaks_apart(answer.snap.tension, finer, answer.tension[0]) <= answer.snap.error


def test_an_undamped_one_does_not() -> None:
    undamped = replace(SNAP, cable=replace(SNAP.cable, axial_damping_time=None))
    answer = solve(undamped, spread=False, finest=40)
    assert answer.status is Status.NOT_SETTLED
    assert answer.snap is not None
    assert answer.snap.error is None
