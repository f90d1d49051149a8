from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tethertest.conditioning import condition
from tethertest.conditioning.gratings.strain import strain_of, temperature_of
from tethertest.conditioning.load_cells.tare import Level, rest_level, zeroed
from tethertest.errors import DataError
from tethertest.records.cable import Cable, Platform
from tethertest.records.channel import Channel, Flag, Window
from tethertest.records.rig import Limits, Rig, Sensor

GRATING = Sensor("fbg1", "wavelength", gauge_factor=0.78, thermo_optic=6.5e-6, expansion=12e-6)
RIG = Rig("r", Cable(3.0, "unstretched", 0.05), Platform(0.4, 5.0), (GRATING,), (), Limits(),
          uncertainty={"sensor.fbg1.gauge_factor": 0.0039})  # fmt: skip
TIME = np.arange(6000) * 0.01


def channel(values, kind="wavelength", unit="m"):
    return Channel("fbg1", kind, unit, TIME, values, np.zeros(TIME.size, np.uint16))


def test_one_microstrain_is_about_1_2_picometres_at_1550_nm():
    strain = strain_of(channel(np.full(TIME.size, 1550.0e-9 + 1.209e-12)), GRATING, 1550.0e-9, None, RIG)
    assert strain.values[0] == pytest.approx(1e-6, rel=2e-3)
    assert strain.uncertainty == pytest.approx(0.005)


def test_heating_a_free_cable_is_no_mechanical_strain():
    warming = 3.0 * np.sin(2 * np.pi * TIME / 120.0)
    expanded = 1550e-9 * np.exp(0.78 * 12e-6 * warming + 6.5e-6 * warming)
    beside = 1570e-9 * np.exp(6.5e-6 * warming)
    temperature = temperature_of(channel(beside), GRATING, 1570e-9)
    inner = slice(500, 5500)
    np.testing.assert_allclose(temperature.values[inner], warming[inner], atol=0.01)
    strain = strain_of(channel(expanded), GRATING, 1550e-9, temperature, RIG)
    assert np.max(np.abs(strain.values[inner])) < 0.5e-6
    assert np.max(np.abs(strain_of(channel(expanded), GRATING, 1550e-9, None, RIG).values)) > 30e-6


def test_handbook_numbers_of_a_1550_nm_grating():
    # by hand: 1550 nm * 0.78 * 1e-6 = 1.209 pm; ln(1 + 1e-3) = 9.995003e-4, over 0.78 = 1.281411e-3
    rise = channel(np.full(TIME.size, 1550.0e-9 * 1.001))
    assert strain_of(rise, GRATING, 1550.0e-9, None, RIG).values[0] == pytest.approx(1.281411e-3, rel=1e-6)
    linear = replace(GRATING, form="linear")
    assert strain_of(rise, linear, 1550.0e-9, None, RIG).values[0] == pytest.approx(1.282051e-3, rel=1e-6)
    # 10 pm per kelvin at 1550 nm: S1 = 10e-12/1550e-9 = 6.4516e-6
    free = Sensor("t", "temperature", thermo_optic=6.4516e-6)
    warmer = channel(np.full(TIME.size, 1550.0e-9 + 25e-12))
    assert temperature_of(warmer, free, 1550.0e-9).values[3000] == pytest.approx(2.5, abs=1e-3)


def test_quadratic_thermo_optic_term_both_ways():
    change = np.linspace(0.0, 40.0, TIME.size)
    first, second = 6.35e-6, 7.1e-9
    free = Sensor("t", "temperature", thermo_optic=first, thermo_optic_squared=second)
    beside = channel(1570e-9 * np.exp(first * change + second * change**2))
    temperature = temperature_of(beside, free, 1570e-9)
    inner = slice(1000, 5000)
    np.testing.assert_allclose(temperature.values[inner], change[inner], atol=0.02)
    # by hand at 40 K without S2: 40 + 7.1e-9*1600/6.35e-6 = 41.79 K
    straight = temperature_of(beside, replace(free, thermo_optic_squared=None), 1570e-9)
    assert straight.values[5990] - temperature.values[5990] == pytest.approx(1.78, abs=0.05)
    bonded = replace(GRATING, thermo_optic=first, thermo_optic_squared=second)
    log = 0.78 * (2e-4 + 12e-6 * change) + first * change + second * change**2
    strain = strain_of(channel(1550e-9 * np.exp(log)), bonded, 1550e-9, temperature, RIG)
    np.testing.assert_allclose(strain.values[inner], 2e-4, atol=0.6e-6)


def test_uncertainty_of_what_temperature_leaves_open():
    known = replace(RIG, sensor=(GRATING,), uncertainty={
        "sensor.fbg1.thermo_optic": 0.5e-6, "sensor.fbg1.expansion": 2e-6})  # fmt: skip
    temperature = replace(channel(np.full(TIME.size, 3.0), "temperature", "K"), name="elsewhere")
    strain = strain_of(channel(np.full(TIME.size, 1550e-9)), GRATING, 1550e-9, temperature, known)
    # by hand: 3 K * hypot(0.5e-6/0.78, 2e-6) = 3 * 2.100e-6
    assert strain.offset_uncertainty == pytest.approx(6.30e-6, rel=2e-3)
    assumed = replace(GRATING, temperature_change=2.0)
    strain = strain_of(channel(np.full(TIME.size, 1550e-9)), assumed, 1550e-9, None, RIG)
    # by hand: (6.5e-6/0.78 + 12e-6) * 2/sqrt(3) = 23.48e-6
    assert strain.offset_uncertainty == pytest.approx(23.48e-6, rel=1e-3)


def test_grating_without_gauge_factor_is_refused():
    with pytest.raises(DataError, match="gauge factor"):
        strain_of(channel(np.full(TIME.size, 1e-6)), Sensor("fbg1", "wavelength"), 1e-6, None, RIG)


def test_rest_level_ignores_taps_and_ringing():
    values = 5.0 + np.random.default_rng(1).normal(0, 0.015, TIME.size)
    values[300:306] += 4.0
    ring = np.arange(300)
    values[306:606] += 2.0 * np.exp(-ring / 100.0) * np.sin(2 * np.pi * 13.7 * ring * 0.01)
    level = rest_level(channel(values, "tension", "N"), Window(0.0, 10.0))
    assert level.value == pytest.approx(5.0, abs=0.006)
    assert level.error < 0.005


def test_zero_follows_a_straight_drift_and_flags_a_large_one():
    drifting = channel(0.4 + 0.002 * TIME, "tension", "N")
    levels = [rest_level(drifting, Window(*span)) for span in ((0.0, 5.0), (50.0, 59.0))]
    changed, findings = zeroed(drifting, *levels, expected=5.0, allowed_drift=0.2)
    np.testing.assert_allclose(changed.values, 5.0, atol=1e-4)
    assert findings == ()
    flagged, findings = zeroed(drifting, *levels, expected=5.0, allowed_drift=0.05)
    assert [item.kind for item in findings] == ["drift"]
    assert np.all(flagged.flags & np.uint16(Flag.DRIFT))


def test_without_rest_the_zero_is_unknown():
    _, findings = zeroed(channel(np.ones(TIME.size)), None, None, 5.0, 1.0)
    assert [(item.kind, item.severity) for item in findings] == [("no_tare", "fatal")]
    only_after = zeroed(channel(np.ones(TIME.size)), None, Level(50.0, 1.0, 0.0), 5.0, 1.0)[0]
    np.testing.assert_allclose(only_after.values, 5.0)


def test_thermometer_in_degrees_compensates_as_a_grating_does(bench):
    """The same warming read by a thermometer gives the same strain, and its level does not enter."""
    clean = condition(bench.run, bench.logs(), bench.priors)
    truth = np.log(bench.columns.pop("temp1") / 1569.9934) / 6.5e-6
    bench.columns["thermo"] = 21.7 + truth
    bench.units["thermo"] = "degC"
    sensors = tuple(
        Sensor("thermo", "temperature") if item.name == "temp1"
        else replace(item, compensation="thermo" if item.compensation else None)
        for item in bench.run.rig.sensor
    )  # fmt: skip
    run = replace(bench.run, rig=replace(bench.run.rig, sensor=sensors))
    logs = bench.logs()
    log = logs["fbg.txt"]
    thermo = replace(log.channels[0], name="thermo", unit="degC", values=bench.columns["thermo"])
    logs["fbg.txt"] = replace(log, channels=(*log.channels, thermo))
    found = condition(run, logs, bench.priors)
    difference = found.channel("fbg1").values - clean.channel("fbg1").values
    assert np.nanmax(np.abs(difference)) < 0.2e-6
    assert found.channel("thermo").values.mean() == pytest.approx(273.15 + 21.7, abs=0.5)


@pytest.mark.parametrize(("change", "severity"), [(None, "warning"), (2.0, "note")])
def test_without_compensation_the_uncertainty_is_stated_or_it_is_a_finding(bench, change, severity):
    sensors = tuple(
        replace(item, compensation=None, temperature_change=change) if item.name == "fbg1" else item
        for item in bench.run.rig.sensor
    )
    run = replace(bench.run, rig=replace(bench.run.rig, sensor=sensors))
    found = condition(run, bench.logs(), bench.priors)
    finding = next(item for item in found.findings if item.kind == "not_compensated")
    assert (finding.subject, finding.severity) == ("fbg1", severity)
    assert ("23.5 microstrain" if change else "20.3 microstrain") in finding.text
    assert found.channel("fbg1").offset_uncertainty > (2.3e-5 if change else 0.0)
