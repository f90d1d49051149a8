from __future__ import annotations

import numpy as np
import pytest

from tethertest.conditioning.strain import strain_of, temperature_of
from tethertest.conditioning.tare import Level, rest_level, zeroed
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
