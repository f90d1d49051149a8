"""The closed form of the rig that sizes what its uncertainties do to a clock."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from reports.clock_errors.bar import (
    Bar,
    bottom_tension_over_motion,
    standard_uncertainties,
    tension_changes,
)
from tethertest.records.cable import Cable, Platform, PlatformMode
from tethertest.records.rig import Limits, Rig

BAR = Bar(3.0, 0.0484, 10_020.0, 1e-4, 0.4, 50.0, 5.0)
RIG = Rig(
    "bar",
    Cable(3.0, "unstretched", 0.0484, 10_020.0, axial_damping_time=1e-4),
    Platform(0.4, 5.0, {"hold": PlatformMode(50.0, 5.0), "free": PlatformMode()}),
    (),
    (),
    Limits(),
    uncertainty={"platform.modes.hold.hover_damping": 0.1, "cable.length": 0.0},
)


def test_slow_motion_is_answered_by_loop_and_inertia():
    """Well below the bounce the tension is ``-(k - (M + m L) w^2 + i w c)``: the cable moves as one."""
    frequency = np.array([0.1, 0.3, 0.6])
    omega = 2.0 * np.pi * frequency
    slow = -(50.0 - (0.4 + 3.0 * 0.0484) * omega**2 + 5.0j * omega)
    np.testing.assert_allclose(bottom_tension_over_motion(BAR, frequency), slow, rtol=0.02)


def test_a_massless_cable_is_a_spring_below_a_mass():
    omega = 2.0 * np.pi * np.array([1.0, 5.0, 12.0, 20.0])
    light = replace(BAR, mass_per_length=1e-9)
    spring = 10_020.0 / 3.0 * (1.0 + 1j * omega * 1e-4)
    end = 50.0 - 0.4 * omega**2 + 5.0j * omega
    expected = -spring * end / (spring + end)
    np.testing.assert_allclose(bottom_tension_over_motion(light, omega / (2.0 * np.pi)), expected, rtol=1e-5)


def test_changes_are_what_the_tension_changes_by():
    """More damping of the loop adds ``-c' dh/dt`` to slow motion, less what the cable gives way twice."""
    time = np.arange(0.0, 40.0, 4e-3)
    fade = np.sin(np.pi * time / 40.0) ** 2
    height = 0.05 * fade * np.sin(2.0 * np.pi * 0.4 * time)
    (change,) = tension_changes(BAR, {"hover_damping": 0.1}, height, 4e-3)
    stiffness = 10_020.0 / 3.0
    firm = (stiffness / (stiffness + 50.0)) ** 2
    np.testing.assert_allclose(change, -0.1 * firm * np.gradient(height, 4e-3), atol=1.2e-4)


def test_uncertainties_are_the_rigs_and_never_nothing():
    found = standard_uncertainties(RIG, "hold", BAR)
    assert found["hover_damping"] == 0.1
    assert found["hover_stiffness"] == pytest.approx(0.05 * 50.0)
    assert found["axial_damping_time"] == 5e-4
    assert "length" not in found
    free = Bar.of(RIG, "free")
    assert free is not None
    assert "hover_damping" not in standard_uncertainties(RIG, "free", free)
