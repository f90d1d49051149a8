"""A load cell's newtons and their uncertainty, against known lines and against Monte Carlo."""

from __future__ import annotations

import datetime as dt

import numpy as np
import pytest

from tethertest.conditioning.load_cells.calibration import calibrated
from tethertest.conditioning.load_cells.calibration_curves import curve_of
from tethertest.errors import DataError
from tethertest.records.cable import Cable, Platform
from tethertest.records.calibration import Calibration, CalibrationData, CalibrationPoint
from tethertest.records.channel import Channel, Flag, Source
from tethertest.records.rig import Instrument, Limits, Rig, Sensor

DAY = dt.date(2026, 9, 5)
LINE = Calibration(log="c.csv", order=1)
LOADS = np.array([0.0, 20.0, 40.0, 60.0, 80.0, 100.0])


def data(output, force, spread=None, kind="ratio"):
    points = tuple(
        CalibrationPoint(float(x), float(y), spread, f"line {number}")
        for number, (x, y) in enumerate(zip(output, force, strict=True), 2)
    )
    return CalibrationData(kind, points, "c.csv")


def rig_with(sensor, pairs=None, count=None, **uncertainty):
    return Rig(
        "bench", Cable(3.0, "unstretched", 0.05), Platform(0.4, 5.0), (sensor,),
        (Instrument("daq", 1000.0, count=count),), Limits(),
        uncertainty={key.replace("__", "."): value for key, value in uncertainty.items()},
        calibrations={} if pairs is None else {sensor.name: pairs},
    )  # fmt: skip


def logged(values, kind, unit):
    values = np.asarray(values, dtype=float)
    source = Source("t.lvm", "0" * 64, "lvm", unit, "daq")
    return Channel("top", kind, unit, np.arange(values.size) * 1e-3, values,
                   np.zeros(values.size, np.uint16), source=source)  # fmt: skip


def kinds(curve):
    return {kind for kind, _, _ in curve.problems}


def test_two_points_are_the_line_through_them():
    curve = curve_of(data([0.1e-3, 2.1e-3], [0.0, 100.0], 0.03), LINE)
    np.testing.assert_allclose(curve.force(np.array([0.1e-3, 1.1e-3, 2.1e-3])), [0, 50, 100], atol=1e-9)
    # a difference of both ends: 0.03 sqrt(2) of 100 N
    assert curve.relative == pytest.approx(0.03 * np.sqrt(2) / 100.0, rel=1e-9)
    assert not curve.problems
    assert kinds(curve_of(data([0.0, 2e-3], [0.0, 100.0]), LINE)) == {"calibration_uncertainty"}


@pytest.mark.parametrize(("order", "spread"), [(1, None), (1, 0.1), (2, 0.1)])
def test_intervals_of_the_scale_cover_the_truth_in_95_percent(order, spread):
    random = np.random.default_rng(7)
    loads = np.tile(LOADS, 2)
    outside = 0
    for _ in range(600):
        force = loads + random.normal(0.0, 0.1, loads.size)
        curve = curve_of(data(2e-5 * loads, force, spread), Calibration(log="c", order=order))
        span = np.diff(curve.force(np.array([0.0, 2e-3])))[0]
        outside += abs(span / 100.0 - 1.0) > 1.96 * curve.relative
    # inflated for misfit half of the time when stated, so coverage is 95 % or slightly more
    assert 0.015 < outside / 600 < 0.075


def test_four_pairs_know_their_own_scatter_badly_and_the_interval_says_so():
    random = np.random.default_rng(8)
    outside = 0
    for _ in range(600):
        force = [*LOADS[::2].tolist(), 100.0]
        noisy = np.array(force) + random.normal(0.0, 0.1, 4)
        curve = curve_of(data(2e-5 * np.array(force), noisy), LINE)
        span = np.diff(curve.force(np.array([0.0, 2e-3])))[0]
        outside += abs(span / 100.0 - 1.0) > 1.96 * curve.relative
    assert 0.03 < outside / 600 < 0.07  # 19 % without Student's t


def test_hysteresis_and_repeatability_are_what_was_put_in():
    way = np.concatenate((LOADS, LOADS[-2::-1]))
    loop = np.where(np.arange(way.size) < LOADS.size, 0.0, 0.4 * np.sin(np.pi * way / 100.0))
    curve = curve_of(data(2e-5 * way, way + loop), LINE)
    assert curve.hysteresis == pytest.approx(np.max(loop), rel=1e-2)
    # a rectangle of half-width h/2 has the standard deviation h/sqrt(12)
    beyond = np.sqrt(curve.offset_uncertainty**2 - curve.scatter**2)
    assert beyond == pytest.approx(np.max(loop) / np.sqrt(12.0), rel=1e-2)
    random = np.random.default_rng(3)
    many = np.tile(LOADS, 60)
    spread = curve_of(data(2e-5 * (many + random.normal(0, 0.2, many.size)), many), LINE)
    assert spread.repeatability == pytest.approx(0.2, rel=0.1)
    assert curve_of(data(2e-5 * LOADS, LOADS), LINE).hysteresis == 0.0


def test_an_outlier_is_named_by_its_line_and_a_curve_is_told():
    random = np.random.default_rng(5)
    force = LOADS.repeat(2) + random.normal(0.0, 0.02, 12)
    assert not kinds(curve_of(data(2e-5 * LOADS.repeat(2), force), LINE))
    wrong = force.copy()
    wrong[7] += 1.0
    curve = curve_of(data(2e-5 * LOADS.repeat(2), wrong), LINE)
    assert "calibration_outlier" in kinds(curve)
    assert "line 9 " in next(text for kind, text, _ in curve.problems if kind == "calibration_outlier")
    bent = force + 0.5 * (LOADS.repeat(2) / 100.0) ** 2
    assert kinds(curve_of(data(2e-5 * LOADS.repeat(2), bent), LINE)) == {"calibration_misfit"}
    assert not kinds(curve_of(data(2e-5 * LOADS.repeat(2), bent), Calibration(log="c", order=2)))
    assert "calibration_residuals" in kinds(curve_of(data(2e-5 * LOADS.repeat(2), bent, 0.02), LINE))


def test_false_alarms_of_a_good_calibration_are_rare():
    random = np.random.default_rng(11)
    alarms = sum(
        bool(kinds(curve_of(data(2e-5 * LOADS, LOADS + random.normal(0, 0.05, 6)), LINE))) for _ in range(500)
    )
    assert alarms / 500 < 0.05


def test_a_table_is_straight_between_its_pairs_and_ends_with_them():
    curve = curve_of(data([0.0, 1e-3, 2e-3], [0.0, 40.0, 100.0], 0.05), Calibration(log="c"))
    np.testing.assert_allclose(curve.force(np.array([0.5e-3, 1.5e-3, 2.05e-3])), [20.0, 70.0, 103.0])
    assert curve.beyond(np.array([-0.11e-3, -0.09e-3, 2.09e-3, 2.11e-3])).tolist() == [1, 0, 0, 1]
    with pytest.raises(DataError, match="no table"):
        curve_of(data([0.0, 1e-3, 2e-3], [0.0, 110.0, 100.0]), Calibration(log="c"))


def test_a_polynomial_that_turns_back_is_refused():
    with pytest.raises(DataError, match="turns back"):
        curve_of(data([0.0, 1e-3, 2e-3, 3e-3], [0.0, 100.0, 110.0, 60.0]), Calibration(log="c", order=2))
    with pytest.raises(DataError, match="needed 3"):
        curve_of(data([0.0, 0.0, 1e-3], [0.0, 1.0, 100.0]), Calibration(log="c", order=2))


def test_channel_takes_scale_offset_and_steps_and_is_cut_at_the_calibrated_span():
    sensor = Sensor("top", "tension", at=1.0, calibration=LINE, excitation=5.0)
    pairs = data(2e-5 * LOADS, LOADS, 0.05)
    rig = rig_with(sensor, pairs, sensor__top__excitation=0.01)
    volts = 5.0 * 2e-5 * np.array([10.0, 50.0, 104.0, 112.0, np.nan])
    channel, findings = calibrated(logged(volts, "voltage", "V"), sensor, rig, DAY)
    np.testing.assert_allclose(channel.values[:3], [10.0, 50.0, 104.0])
    assert (channel.flags == [0, 0, 0, Flag.OUT_OF_RANGE, 0]).all()
    assert [item.kind for item in findings] == ["not_calibrated"]
    curve = curve_of(pairs, LINE)
    assert channel.uncertainty == pytest.approx(np.hypot(curve.relative, 0.002))
    assert "excitation 5 V" in channel.source.steps[-1]
    assert "c.csv" in channel.source.steps[-1]


def test_counts_and_volts_without_a_way_to_newton_are_refused():
    sensor = Sensor("top", "tension", at=1.0, sensitivity=2e-3, rated=100.0)
    with pytest.raises(DataError, match="logged as a voltage") as caught:
        calibrated(logged([1e-3, 2e-3], "voltage", "V"), sensor, rig_with(sensor), DAY)
    assert "excitation" in caught.value.remedy
    counted = Sensor("top", "tension", at=1.0, calibration=LINE)
    rig = rig_with(counted, data(LOADS * 1e4, LOADS, kind="count"))
    assert calibrated(logged([5e5], "count", "count"), counted, rig, DAY)[0].values[0] == pytest.approx(50.0)
    with pytest.raises(DataError, match="logged as a ratio, and its calibration is for a count"):
        calibrated(logged([1e-3], "ratio", "1"), counted, rig, DAY)


def test_a_log_in_newton_keeps_the_loggers_own_calibration():
    sensor = Sensor("top", "tension", at=1.0, calibration=LINE)
    rig = rig_with(sensor, data(2e-5 * LOADS, LOADS, 0.05))
    channel, findings = calibrated(logged([7.0], "tension", "N"), sensor, rig, DAY)
    assert channel.values[0] == 7.0
    assert channel.uncertainty > 0.0
    assert [(item.kind, item.severity) for item in findings] == [("calibration_by_logger", "note")]
