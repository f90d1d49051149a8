"""A replay that cannot be is refused, never compared."""

from __future__ import annotations

import datetime as dt
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tethertest.errors import DataError
from tethertest.records.cable import Cable, Platform, PlatformMode
from tethertest.records.response import Status
from tethertest.records.rig import Limits, Rig
from tethertest.records.run import Drive, Run, RunFile, RunPlatform
from tethertest.records.scene import MeasuredMotion
from tethertest.replay import BottomMotion, replayed_channels, run_scene
from tethertest.replay.variations import moved
from tethertest.solver import solve

CABLE = Cable(3.0, "unstretched", 0.0484, axial_stiffness=10_020.0, axial_damping_time=1e-4)
RIG = Rig("bench", CABLE, Platform(0.4, 5.0, {"hold": PlatformMode(50.0, 5.0)}), (), (), Limits())
FILE = RunFile(
    "bench-1", "bench", dt.datetime.now(dt.UTC), Drive("crank-slider", 0.3, 0.1), (), RunPlatform("hold")
)
RUN = Run(Path("bench"), FILE, RIG, Path("bench.toml"))


def test_a_solve_that_left_the_range_of_numbers_is_no_replay() -> None:
    still = MeasuredMotion(np.linspace(0.0, 2.0, 401), np.zeros(401))
    motion = BottomMotion(0.0, still, cutoff=2.0, wide_cutoff=40.0)
    response = solve(run_scene(RUN, 2.0), measured=still, finest=20)
    assert replayed_channels(response, motion, ()) == ()
    with pytest.raises(DataError, match="broke off"):
        replayed_channels(replace(response, status=Status.NOT_FINITE), motion, ())


@pytest.mark.parametrize(("key", "value"), [("length", 0.003), ("axial_stiffness", 1e12)])
def test_a_cable_whose_waves_no_machine_can_follow_is_refused(key: str, value: float) -> None:
    wrong = replace(RIG, cable=replace(CABLE, **{key: value}))
    with pytest.raises(DataError, match="steps") as caught:
        run_scene(RUN, 60.0, rig=wrong)
    assert "axial_stiffness" in caught.value.remedy


def test_any_damping_can_be_followed() -> None:
    damped = replace(RIG, cable=replace(CABLE, axial_damping_time=10.0))
    assert run_scene(RUN, 60.0, rig=damped).cable.axial_damping_time == 10.0


def test_one_number_of_several_and_any_name_of_a_mode_can_be_moved() -> None:
    platform = replace(RIG.platform, drag_area=(0.1, 0.2), modes={"soft.v2": PlatformMode(50.0, 5.0)})
    uncertain = {"platform.drag_area[2]": 0.05, "platform.modes.soft.v2.hover_stiffness": 7.0}
    rig = replace(RIG, platform=platform, uncertainty=uncertain)
    assert moved(rig, "platform.drag_area[2]").platform.drag_area == (0.1, 0.25)
    stiffer = moved(rig, "platform.modes.soft.v2.hover_stiffness").platform.modes["soft.v2"]
    assert stiffer == PlatformMode(57.0, 5.0)
