"""The closed form of the rig that sizes what its uncertainties do to a clock."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tethertest.readers import load_run
from tethertest.records.cable import PlatformMode
from tethertest.replay.mechanics import (
    standard_uncertainties,
    tension_changes,
    tension_over_motion,
    tension_response,
)

ROOT = Path(__file__).parents[3]
RUN = load_run(ROOT / "datasets" / "rig3m" / "run02", ROOT / "rigs")
MODE = RUN.file.platform.mode


def test_slow_motion_is_answered_by_loop_and_inertia():
    """Well below the bounce the tension is ``-(k - (M + m L) w^2 + i w c)``: the cable moves as one."""
    rig = RUN.rig
    loop = rig.platform.modes[MODE]
    omega = 2.0 * np.pi * np.array([0.1, 0.3, 0.6])
    mass = rig.platform.mass + rig.cable.mass_per_length * rig.cable.length
    slow = -(loop.hover_stiffness - mass * omega**2 + 1j * omega * loop.hover_damping)
    found = tension_response(rig, MODE, omega / (2.0 * np.pi), 0.0)
    np.testing.assert_allclose(found, slow, rtol=0.03)
    over = tension_over_motion(RUN)
    assert over is not None
    assert over(0.3, 0.0) == pytest.approx(abs(slow[1]), rel=0.03)


def test_changes_are_what_the_tension_changes_by():
    """More damping of the loop adds ``-c' dh/dt`` to slow motion, less what the cable gives way twice."""
    time = np.arange(0.0, 40.0, 4e-3)
    height = 0.05 * np.sin(np.pi * time / 40.0) ** 2 * np.sin(2.0 * np.pi * 0.4 * time)
    sigma = 0.1
    certain = dict.fromkeys(
        (f"platform.modes.{MODE}.hover_stiffness", *standard_uncertainties(RUN.rig, MODE)), 0.0
    )
    rig = replace(RUN.rig, uncertainty={**certain, f"platform.modes.{MODE}.hover_damping": sigma})
    (change,) = tension_changes(replace(RUN, rig=rig))(height, 4e-3)
    stiffness = rig.cable.axial_stiffness / rig.cable.length
    firm = (stiffness / (stiffness + rig.platform.modes[MODE].hover_stiffness)) ** 2
    np.testing.assert_allclose(change, -sigma * firm * np.gradient(height, 4e-3), atol=1.5e-4)


def test_uncertainties_are_the_rigs_and_never_nothing():
    rig = replace(RUN.rig, uncertainty={"platform.modes.soft.hover_damping": 0.1, "cable.length": 0.0})
    modes = {"soft": PlatformMode(50.0, 5.0), "free": PlatformMode()}
    rig = replace(rig, platform=replace(rig.platform, modes=modes))
    found = standard_uncertainties(rig, "soft")
    assert found["hover_damping"] == 0.1
    assert found["hover_stiffness"] == pytest.approx(0.05 * 50.0)
    assert found["cable.axial_damping_time"] == 5e-4
    assert "cable.length" not in found
    assert "hover_damping" not in standard_uncertainties(rig, "free")


def test_a_cable_of_unknown_stiffness_or_that_hangs_slack_answers_nothing():
    for rig in (
        replace(RUN.rig, cable=replace(RUN.rig.cable, axial_stiffness=None)),
        replace(RUN.rig, platform=replace(RUN.rig.platform, static_tension=1e-3)),
    ):
        run = replace(RUN, rig=rig)
        assert tension_over_motion(run) is None
        assert tension_changes(run)(np.zeros(10), 0.1) == ()
