"""The quasi-static model's predicted error against closed forms and against marches."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from reports.quasi_static.measure import measure
from tethertest.records.cable import Air, Cable
from tethertest.records.scene import Bottom, Geometry, Output, Scene, Top
from tethertest.solver.quasi_static.catenary_run import run_catenary
from tethertest.solver.quasi_static.validity import MARGIN, quasi_static_allowed, quasi_static_error

CABLE = Cable(3.0, "unstretched", 0.0484, axial_stiffness=10020.0, diameter=0.006)
INCLINED = Scene(
    name="3 m, inclined",
    cable=CABLE,
    geometry=Geometry("ends", top=(1.8, 2.375)),
    bottom=Bottom("harmonic", direction="vertical", amplitude=0.01, frequency=0.1, start="ramp", ramp=20.0),
    top=Top("fixed"),
    output=Output(60.0, 10.0, (0.0, 1.0)),
)
RIG = replace(
    INCLINED,
    name="3 m rig",
    geometry=Geometry("vertical"),
    bottom=Bottom("harmonic", amplitude=0.1, frequency=0.1, start="ramp", ramp=20.0),
    top=Top("platform", mass=0.4, static_tension=5.0),
)
SNAPPING = replace(
    RIG,
    bottom=Bottom("harmonic", amplitude=0.2, frequency=0.3, start="ramp", ramp=4.0),
    top=Top("platform", mass=0.4, static_tension=5.0, hover_stiffness=50.0, hover_damping=5.0),
)


def at(scene: Scene, frequency: float, periods: float = 6.0) -> Scene:
    motion = replace(scene.bottom, frequency=frequency, ramp=2.0 / frequency)
    return replace(scene, bottom=motion, output=Output(periods / frequency, 20.0 * frequency, (0.0, 1.0)))


def test_vertical_platform_is_predicted_to_miss_half_the_cable() -> None:
    """At either end the model misses (m/2) a of tension; the largest dynamic part is (M + m) a."""
    mass = 3.0 * 0.0484
    assert quasi_static_error(RIG).error == pytest.approx(0.5 * mass / (0.4 + mass), rel=2e-3)


@pytest.mark.parametrize("seed", [2, 5, 6, 23, 25, 39, 41, 52])
def test_predicted_error_is_near_that_against_the_march(seed: int) -> None:
    """Seed by seed: fixed and hovering tops, slow and near resonance, tension swinging twofold (41)."""
    result = measure(seed)
    assert result is not None
    assert not result.slack
    assert result.estimate.error == pytest.approx(result.true, rel=0.35)
    assert MARGIN * result.estimate.error > result.true


def test_predicted_error_falls_with_the_square_of_the_frequency() -> None:
    errors = [quasi_static_error(at(INCLINED, frequency)).error for frequency in (0.1, 0.05, 0.025)]
    orders = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    np.testing.assert_allclose(orders, 2.0, atol=0.05)


def test_predicted_error_does_not_depend_on_the_output_rate() -> None:
    coarse, fine = (
        quasi_static_error(replace(INCLINED, output=Output(60.0, rate, (0.0, 1.0)))).error
        for rate in (1.0, 25.0)
    )
    assert coarse == pytest.approx(fine, rel=0.01)


def test_long_record_is_judged_by_a_stretch_as_a_short_one() -> None:
    steady = replace(INCLINED, air=Air(1.225, 1.2, 0.01))
    short, long = (quasi_static_error(at(steady, 0.3, periods)).error for periods in (40.0, 400.0))
    assert long == pytest.approx(short, rel=0.1)


def test_slow_motion_is_allowed_and_fast_motion_is_not() -> None:
    slow, fast = (quasi_static_allowed(at(INCLINED, frequency), tolerance=0.02) for frequency in (0.05, 0.6))
    assert slow.allowed
    assert not fast.allowed
    assert "nonlinear" in fast.reason
    assert quasi_static_allowed(at(INCLINED, 0.6), tolerance=1.0).estimate == fast.estimate


def test_sudden_start_is_not_allowed() -> None:
    """A velocity jump sends fronts that a cable without inertia does not know."""
    jump = replace(INCLINED, bottom=replace(INCLINED.bottom, frequency=0.3, start="jump"))
    assert quasi_static_error(jump).error > 10.0 * quasi_static_error(at(INCLINED, 0.05)).error
    assert not quasi_static_allowed(jump, tolerance=0.1).allowed


def test_snapping_rig_is_never_allowed() -> None:
    permission = quasi_static_allowed(SNAPPING, tolerance=1.0)
    assert not permission.allowed
    assert "slack" in permission.reason
    assert math.isinf(permission.estimate.error)


@pytest.mark.parametrize(("frequency", "reason"), [(1.27, "swings"), (1.3, "slack")])
def test_cable_that_its_own_inertia_slackens_is_not_allowed(frequency: float, reason: str) -> None:
    """The model's tension stays above 0.4 N; the cable's other half, which it leaves out, takes that away."""
    scene = replace(RIG, bottom=replace(RIG.bottom, amplitude=0.1, frequency=frequency, ramp=2.0))
    scene = replace(scene, output=Output(10.0, 100.0, (0.0, 1.0)))
    assert np.min(run_catenary(scene).field.minimum) > 0.3
    permission = quasi_static_allowed(scene, tolerance=1.0)
    assert not permission.allowed
    assert reason in permission.reason
