"""Numbers of a calibration curve against closed forms of least squares and of straight lines."""

from __future__ import annotations

import datetime as dt

import numpy as np
import pytest
from scipy.stats import t

from tethertest.conditioning.load_cells.calibration import calibrated
from tethertest.conditioning.load_cells.calibration_curves import Curve, curve_of
from tethertest.errors import DataError
from tethertest.records.calibration import Calibration
from tethertest.records.rig import Sensor

from .test_calibration import DAY, LOADS, data, kinds, logged, rig_with

LINE = Calibration(log="c.csv", order=1)
TABLE = Calibration(log="c.csv")


def test_straight_lines_pass_through_their_pairs_and_go_on_beyond_the_ends() -> None:
    curve = curve_of(data([1.0, 2.0, 4.0], [10.0, 30.0, 40.0], 0.3), TABLE)
    found = curve.force(np.array([0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 5.0]))
    assert found == pytest.approx([0.0, 10.0, 20.0, 30.0, 35.0, 40.0, 45.0])
    assert (curve.middle, curve.half) == (2.5, 1.5)
    # both ends of 30 N by 0.3 N
    assert curve.relative == pytest.approx(0.3 * np.sqrt(2.0) / 30.0)
    assert (curve.scatter, curve.hysteresis, curve.repeatability) == (0.3, 0.0, 0.0)
    weights = Calibration(log="c", reference=0.01)
    curve = curve_of(data([1.0, 2.0, 4.0], [10.0, 30.0, 40.0], 0.3), weights)
    assert curve.relative == pytest.approx(np.hypot(0.3 * np.sqrt(2.0) / 30.0, 0.01))


def test_pairs_in_any_order_make_one_table_and_falling_ones_too() -> None:
    curve = curve_of(data([4.0, 1.0, 2.0], [10.0, 40.0, 30.0], 0.3), TABLE)
    assert curve.force(np.array([1.5, 3.0])) == pytest.approx([35.0, 20.0])
    with pytest.raises(DataError, match="do not rise"):
        curve_of(data([1.0, 2.0, 3.0], [10.0, 30.0, 20.0]), TABLE)
    with pytest.raises(DataError, match="do not rise"):
        curve_of(data([1.0, 2.0, 2.0], [10.0, 20.0, 30.0]), TABLE)
    with pytest.raises(DataError, match="do not rise"):
        curve_of(data([1.0, 2.0, 3.0], [10.0, 20.0, 20.0]), TABLE)


def test_a_tenth_of_the_half_span_beyond_either_end_may_be_continued() -> None:
    curve = curve_of(data([1.0, 3.0], [0.0, 100.0], 0.1), LINE)
    # middle 2, half 1: up to 1.1 halves
    assert curve.beyond(np.array([0.89, 0.91, 2.0, 3.09, 3.11])).tolist() == [True, False, False, False, True]


def test_a_parabola_goes_on_straight_beyond_its_span() -> None:
    outputs = np.linspace(0.0, 2.0, 9)
    curve = curve_of(data(outputs, 10.0 * outputs + 3.0 * outputs**2, 0.1), Calibration(log="c", order=2))
    inside = np.array([0.3, 1.7])
    assert curve.force(inside) == pytest.approx(10.0 * inside + 3.0 * inside**2)
    # at 2 the slope is 22, at 0 it is 10
    assert curve.force(np.array([2.5, -0.5])) == pytest.approx([32.0 + 11.0, -5.0])


def test_stated_uncertainties_give_the_lines_by_least_squares() -> None:
    spread = 0.2
    curve = curve_of(data(2e-5 * LOADS, LOADS, spread), LINE)
    z = np.linspace(-1.0, 1.0, 6)
    # a difference over the whole span is 2 slopes in z
    slope_error = spread / np.sqrt(np.sum(z**2))
    assert curve.relative == pytest.approx(2.0 * slope_error / 100.0, rel=1e-9)
    assert curve.covariance[0, 0] == pytest.approx(spread**2 / 6.0)
    assert not curve.problems
    referred = curve_of(data(2e-5 * LOADS, LOADS, spread), Calibration(log="c", order=1, reference=0.003))
    assert referred.relative == pytest.approx(np.hypot(2.0 * slope_error / 100.0, 0.003), rel=1e-9)


def test_residuals_twice_as_large_as_stated_widen_the_uncertainty_by_their_ratio() -> None:
    off = np.array([1.0, -1.0, -1.0, 1.0, 1.0, -1.0])
    z = np.linspace(-1.0, 1.0, 6)
    fitted = np.polynomial.polynomial.polyfit(z, off, 1)
    left = off - fitted[0] - fitted[1] * z
    squares = float(left @ left)
    spread = np.sqrt(squares / 4.0) / 2.0  # chi-squared is four times its four degrees of freedom
    curve = curve_of(data(2e-5 * LOADS, LOADS + off, spread), LINE)
    widened = 2.0 * (2.0 * spread / np.sqrt(np.sum(z**2))) / (2.0 * curve.coefficients[1])
    assert curve.relative == pytest.approx(2.0 * widened / 2.0, rel=1e-6)
    assert curve.scatter == pytest.approx(2.0 * spread)
    assert "calibration_residuals" in kinds(curve)
    # smaller residuals than stated are chance and narrow nothing
    calm = curve_of(data(2e-5 * LOADS, LOADS + 0.01 * off, spread), LINE)
    assert calm.relative == pytest.approx(2.0 * spread / np.sqrt(np.sum(z**2)) / 100.0, rel=1e-3)
    assert "calibration_residuals" not in kinds(calm)


def test_without_stated_uncertainty_the_scatter_and_students_t_make_it() -> None:
    off = np.array([0.1, -0.1, -0.1, 0.1, 0.1, -0.1])
    curve = curve_of(data(2e-5 * LOADS, LOADS + off), LINE)
    z = np.linspace(-1.0, 1.0, 6)
    fitted = np.polynomial.polynomial.polyfit(z, LOADS + off, 1)
    left = LOADS + off - fitted[0] - fitted[1] * z
    scatter = np.sqrt(left @ left / 4.0)
    assert curve.scatter == pytest.approx(scatter)
    student = t.ppf(0.975, 4) / 1.96
    slope_error = student * scatter / np.sqrt(np.sum(z**2))
    assert curve.relative == pytest.approx(slope_error / fitted[1], rel=1e-9)


def test_as_many_coefficients_as_pairs_leave_no_scatter() -> None:
    curve = curve_of(data([0.0, 2e-3], [0.0, 100.0]), LINE)
    assert (curve.scatter, curve.relative) == (0.0, 0.0)
    assert (
        curve_of(data([0.0, 2e-3], [0.0, 100.0]), Calibration(log="c", order=1, reference=0.01)).problems
        == ()
    )


def test_hysteresis_is_the_largest_gap_between_unloading_and_loading() -> None:
    up = np.array([0.0, 20.0, 40.0, 60.0, 80.0, 100.0])
    force = np.concatenate((up, up[-2::-1]))
    gap = np.array([0, 0, 0, 0, 0, 0, 0.1, 0.2, 0.4, 0.3, 0.0])
    # the cell reads more while unloading: the curve gives `gap` newtons too much
    curve = curve_of(data(2e-5 * (force + gap), force), LINE)
    assert curve.hysteresis == pytest.approx(0.4, rel=0.01)
    assert curve.offset_uncertainty == pytest.approx(
        np.hypot(curve.scatter, curve.hysteresis / np.sqrt(12.0))
    )
    assert curve_of(data(2e-5 * up, up), LINE).hysteresis == 0.0


def test_repeatability_is_pooled_over_loads_taken_the_same_way() -> None:
    force = np.array([0.0, 50.0, 100.0, 0.0, 50.0, 100.0])
    off = np.array([0.0, 0.1, 0.0, 0.0, -0.1, 0.0])
    curve = curve_of(data(2e-5 * (force + off), force), LINE)
    # 50 N twice, 0.2 N apart: squares 2 x 0.01; 0 N once at the start and once coming down; 100 N twice
    assert curve.repeatability == pytest.approx(np.sqrt(0.02 / 2.0), rel=1e-3)


def test_one_pair_far_off_is_named_and_a_bent_row_asks_for_an_order_more() -> None:
    random = np.random.default_rng(5)
    loads = np.tile(LOADS, 2)
    force = loads + random.normal(0.0, 0.02, 12)
    force[7] += 1.0
    curve = curve_of(data(2e-5 * loads, force), LINE)
    (problem,) = [text for kind, text, _ in curve.problems if kind == "calibration_outlier"]
    assert problem.startswith("line 9 of its calibration")
    force[7] -= 1.0
    assert "calibration_outlier" not in kinds(curve_of(data(2e-5 * loads, force), LINE))
    bent = force + 0.5 * (loads / 50.0 - 1.0) ** 2
    assert "calibration_misfit" in kinds(curve_of(data(2e-5 * loads, bent), LINE))
    assert "calibration_misfit" not in kinds(curve_of(data(2e-5 * loads, force), LINE))


def test_too_few_outputs_or_a_curve_that_turns_are_refused() -> None:
    with pytest.raises(DataError, match="has 2 different outputs, needed 3"):
        curve_of(data([1.0, 2.0, 2.0], [1.0, 2.0, 2.1]), Calibration(log="c", order=2))
    with pytest.raises(DataError, match="has 1 different outputs, needed 2"):
        curve_of(data([1.0, 1.0], [1.0, 2.0]), LINE)
    with pytest.raises(DataError, match="turns back"):
        curve_of(data([0.0, 1.0, 2.0, 3.0], [0.0, 2.0, 2.2, 0.5]), Calibration(log="c", order=2))


def test_the_scatter_and_the_hysteresis_of_a_reading_add_in_square() -> None:
    nothing = (np.zeros(0), np.zeros(0))
    curve = Curve(
        "ratio", 0.0, 1.0, np.zeros(2), np.zeros((2, 2)), nothing, 0.0, 0.3, 0.8 * np.sqrt(3.0), 0.0, ""
    )
    assert curve.offset_uncertainty == pytest.approx(0.5)


# from what was logged to newtons

CELL = Sensor("top", "tension", at=1.0, sensitivity=2.0e-3, rated=100.0, excitation=10.0)


def test_ratios_volts_and_counts_become_newtons_with_their_uncertainties() -> None:
    doubts = {
        "sensor__top__sensitivity": 2e-6,  # 0.1 %
        "sensor__top__excitation": 0.05,  # 0.5 %
        "instrument__daq__count": 1e-12,  # 0.05 %
    }
    rig = rig_with(CELL, count=2e-9, **doubts)
    ratio, _ = calibrated(logged([1e-3], "ratio", "mV/V"), CELL, rig, DAY)
    assert (ratio.values[0], ratio.unit, ratio.kind) == (pytest.approx(50.0), "N", "tension")
    assert ratio.uncertainty == pytest.approx(0.001)
    volts, _ = calibrated(logged([0.01], "voltage", "V"), CELL, rig, DAY)
    assert volts.values[0] == pytest.approx(50.0)
    assert volts.uncertainty == pytest.approx(np.hypot(0.001, 0.005))
    counts, _ = calibrated(logged([500_000.0], "count", ""), CELL, rig, DAY)
    assert counts.values[0] == pytest.approx(50.0)
    assert counts.uncertainty == pytest.approx(np.hypot(0.001, 0.0005))
    known, _ = calibrated(logged([50.0], "tension", "N"), CELL, rig, DAY)
    assert (known.values[0], known.uncertainty) == (50.0, pytest.approx(0.001))


def test_a_curve_of_ratios_takes_volts_and_the_other_way_round() -> None:
    pairs = data([0.0, 2e-3], [0.0, 100.0], 0.1)
    sensor = Sensor("top", "tension", at=1.0, excitation=10.0, calibration=LINE)
    rig = rig_with(sensor, pairs, sensor__top__excitation=0.05)
    found, _ = calibrated(logged([0.01, 0.03], "voltage", "V"), sensor, rig, DAY)
    assert found.values[0] == pytest.approx(50.0)
    scale = 0.1 * np.sqrt(2.0) / 100.0
    assert found.uncertainty == pytest.approx(np.hypot(scale, 0.005), rel=1e-6)
    # 30 mV are 3 mV/V: beyond 2 mV/V and what may be continued
    assert found.usable.tolist() == [True, False]
    volts = data([0.0, 0.02], [0.0, 100.0], 0.1, kind="voltage")
    other, _ = calibrated(logged([1e-3], "ratio", "mV/V"), sensor, rig_with(sensor, volts), DAY)
    assert other.values[0] == pytest.approx(50.0)


def test_a_calibration_is_due_the_day_after() -> None:
    for due, noted in ((DAY, False), (DAY - dt.timedelta(days=1), True), (DAY + dt.timedelta(days=1), False)):
        sensor = Sensor("top", "tension", at=1.0, sensitivity=2e-3, rated=100.0, due=due)
        findings = calibrated(logged([1e-3], "ratio", "mV/V"), sensor, rig_with(sensor), DAY)[1]
        assert bool(findings) is noted
