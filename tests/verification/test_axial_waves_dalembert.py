"""The exact axial waves under a fixed top against d'Alembert's series, written out here on its own."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from tethertest.errors import DataError
from tethertest.records.arrays import FloatArray
from tethertest.records.cable import Cable
from tethertest.records.scene import Bottom, Geometry, MeasuredMotion, Output, Scene, Top
from tethertest.solver.linear import axial_ends
from tethertest.solver.linear.axial_waves import run_axial_waves

GAUGES = (0.0, 0.3, 1.0)
LENGTH, MASS, STIFFNESS = 150.0, 0.0333, 120.17
SPEED, IMPEDANCE = math.sqrt(STIFFNESS / MASS), math.sqrt(STIFFNESS * MASS)
AMPLITUDE, ANGULAR = 2.0, 2.0 * math.pi * 0.1


def taut(**changes: object) -> Scene:
    """The vertical cable whose bottom starts with a jump of velocity."""
    scene = Scene(
        name="taut",
        cable=Cable(LENGTH, "unstretched", MASS, axial_stiffness=STIFFNESS, diameter=0.003),
        geometry=Geometry("vertical", tension=80.0),
        bottom=Bottom("harmonic", "vertical", amplitude=AMPLITUDE, frequency=0.1),
        top=Top("fixed"),
        output=Output(68.0, 200.0, GAUGES),
    )
    return replace(scene, **changes)  # type: ignore[arg-type]


def straight() -> Scene:
    return Scene(
        name="straight",
        cable=Cable(100.0, "equilibrium", 0.05, axial_stiffness=20e3),
        geometry=Geometry("straight", tension=100.0),
        bottom=Bottom("step", velocity=0.01),
        top=Top("fixed"),
        output=Output(2.0, 2000.0, (0.0, 0.5, 1.0)),
        gravity=0.0,
    )


def series(
    motion: Callable[[FloatArray], FloatArray], time: FloatArray, gauge: float, late: float = 1e-9
) -> FloatArray:
    """Dynamic tension over Z: every passage of the velocity v0, up (s) and down (2 - s), turns it around."""
    total = np.zeros(time.size)
    traverse = LENGTH / SPEED
    for trip in range(40):
        for delay in (2 * trip + gauge, 2 * trip + 2 - gauge):
            since = time - delay * traverse
            total -= np.where(since >= -late, motion(since), 0.0)
    return total


def cosine(time: FloatArray) -> FloatArray:
    return AMPLITUDE * ANGULAR * np.cos(ANGULAR * time)


def relative(found: FloatArray, exact: FloatArray) -> float:
    return float(np.sqrt(np.mean((found - exact) ** 2) / np.mean(exact**2)))


@pytest.mark.parametrize("native", [True, False])
def test_tension_after_a_velocity_jump_is_the_series_at_any_time(native: bool) -> None:
    solution = run_axial_waves(taut(), 50, native_times=native)
    step = LENGTH / SPEED / 50 if native else 1.0 / 200.0
    np.testing.assert_allclose(solution.time, np.arange(solution.time.size) * step, rtol=1e-13)
    assert 68.0 - step < solution.time[-1] <= 68.0 + 1e-9
    for g, gauge in enumerate(GAUGES):
        exact = IMPEDANCE * series(cosine, solution.time, gauge)
        still = 80.0 + gauge * LENGTH * MASS * 9.80665
        assert relative(solution.tension[:, g] - still, exact) < 1e-12
        assert relative(solution.strain[:, g] * STIFFNESS, exact) < 1e-12


def test_the_number_of_cells_changes_nothing_under_a_fixed_top() -> None:
    coarse, fine = (run_axial_waves(taut(), cells).tension for cells in (1, 37))
    np.testing.assert_allclose(coarse, fine, rtol=0.0, atol=1e-10)


def test_a_crank_is_the_series_of_its_own_velocity() -> None:
    """Differentiated by hand, a from the dead centre: -r w (sin a + (q/2) sin 2a/sqrt(1 - q^2 sin^2 a))."""
    crank = Bottom("crank-slider", radius=1.5, rod_ratio=0.3, frequency=0.12, start="jump")

    def motion(time: FloatArray) -> FloatArray:
        angle = 2.0 * np.pi * 0.12 * time - 0.5 * np.pi
        root = np.sqrt(1.0 - 0.09 * np.sin(angle) ** 2)
        return -1.5 * 2.0 * np.pi * 0.12 * (np.sin(angle) + 0.15 * np.sin(2.0 * angle) / root)

    solution = run_axial_waves(taut(bottom=crank), 10)
    for g, gauge in enumerate(GAUGES):
        exact = IMPEDANCE * series(motion, solution.time, gauge)
        assert relative(solution.strain[:, g] * STIFFNESS, exact) < 1e-12


def test_measured_motion_is_the_series_of_its_splines_velocity() -> None:
    axis = np.linspace(0.0, 70.0, 1401)
    data = MeasuredMotion(axis, 0.4 + np.sin(0.7 * axis))  # a start away from 0 is where the cable rests
    solution = run_axial_waves(taut(bottom=Bottom("measured")), 20, measured=data)
    exact = IMPEDANCE * series(lambda time: 0.7 * np.cos(0.7 * time), solution.time, 1.0)
    assert relative(solution.strain[:, 2] * STIFFNESS, exact) < 1e-4


def test_very_many_round_trips_under_a_fixed_top_stay_on_the_series(monkeypatch: pytest.MonkeyPatch) -> None:
    exact = run_axial_waves(taut(), 20)
    monkeypatch.setattr(axial_ends, "_SERIES_TRIPS", 3.0)
    stepped = run_axial_waves(taut(), 20)
    assert relative(stepped.strain, exact.strain) < 1e-8
    np.testing.assert_allclose(stepped.field.maximum, exact.field.maximum, rtol=0.0, atol=1e-5)
    np.testing.assert_allclose(stepped.platform_position, 0.0, atol=1e-20)


def test_the_first_front_is_amplitude_times_angular_frequency_over_wave_speed() -> None:
    """Oracle 1: an upward start slackens the cable by Ae w/c, and by twice that at the fixed end."""
    solution = run_axial_waves(taut(), 50, native_times=True)
    jump = AMPLITUDE * ANGULAR / SPEED
    assert solution.strain[0, 0] == pytest.approx(-jump, rel=1e-12)
    assert solution.strain[49, 2] == 0.0
    assert solution.strain[50, 2] == pytest.approx(-2.0 * jump, rel=1e-12)


def test_a_straight_cable_steps_by_velocity_over_wave_speed_of_the_stretched_cable() -> None:
    solution = run_axial_waves(straight(), 25, native_times=True)
    stretch = 1.0 + 100.0 / 20e3
    speed = math.sqrt((20e3 + 100.0) / 0.05)
    per_front = 0.01 / speed * stretch  # the strain of the unstretched cable
    fronts = np.array([[1, 0, 0], [1, 1, 0], [1, 1, 2], [1, 2, 2], [3, 2, 2], [3, 3, 2], [3, 3, 4]])
    rows = [0, 13, 25, 38, 50, 63, 75]
    np.testing.assert_allclose(solution.strain[rows], -per_front * fronts, rtol=1e-9, atol=1e-15)
    np.testing.assert_allclose(solution.tension - 100.0, 20e3 * solution.strain, rtol=0.0, atol=1e-9)


def test_at_resonance_each_round_trip_adds_twice_the_front() -> None:
    """Oracle 1: at c/2L the strain grows by 2 Ae w/c per 2L/c."""
    frequency = SPEED / (2.0 * LENGTH)
    bottom = Bottom("harmonic", "tangent", amplitude=AMPLITUDE, frequency=frequency)
    solution = run_axial_waves(taut(bottom=bottom), 40, native_times=True)
    trips = (solution.time.size - 41) // 80
    peaks = np.max(solution.strain[40 : 40 + 80 * trips, 2].reshape(trips, 80), axis=1)
    growth = 2.0 * AMPLITUDE * 2.0 * math.pi * frequency / SPEED
    assert trips > 10
    np.testing.assert_allclose(np.diff(peaks), growth, rtol=1e-9)


def test_field_holds_the_tension_on_both_sides_of_every_front() -> None:
    cells = 8
    scene = taut(output=Output(20.0, 50.0, GAUGES))
    solution = run_axial_waves(scene, cells)
    field = solution.field
    np.testing.assert_allclose(field.position, [0.0, *((np.arange(cells) + 0.5) / cells), 1.0])
    assert np.diff(field.time) == pytest.approx(LENGTH / SPEED / cells)  # short enough for a level per bin
    for place, station in enumerate(field.position):
        sides = [IMPEDANCE * series(cosine, field.time, float(station), late) for late in (1e-9, -1e-9)]
        still = 80.0 + station * LENGTH * MASS * 9.80665
        np.testing.assert_allclose(field.maximum[:, place], still + np.maximum(*sides), atol=1e-10)
        np.testing.assert_allclose(field.minimum[:, place], still + np.minimum(*sides), atol=1e-10)


def test_position_and_velocity_between_the_ends_are_those_of_the_two_waves() -> None:
    output = Output(40.0, 200.0, (0.0, 0.3, 1.0), ("position", "velocity", "curvature"))
    solution = run_axial_waves(taut(output=output), 10)
    place, moving = solution.fields["position"], solution.fields["velocity"]
    assert not np.any(place[..., :2])
    assert not np.any(moving[..., :2])
    assert solution.fields["curvature"].shape == (8001, 3)
    assert not np.any(solution.fields["curvature"])
    np.testing.assert_allclose(place[:, 0, 2], AMPLITUDE * np.sin(ANGULAR * solution.time), atol=1e-11)
    np.testing.assert_allclose(moving[:, 0, 2], cosine(solution.time), atol=1e-11)
    rest_height = 150.0 + (80.0 * 150.0 + 0.5 * MASS * 9.80665 * 150.0**2) / STIFFNESS
    np.testing.assert_allclose(place[:, 2, 2], rest_height, rtol=1e-13)
    np.testing.assert_allclose(moving[:, 2, 2], 0.0, atol=1e-12)
    traverse = LENGTH / SPEED
    early = solution.time < 1.69 * traverse  # only the wave up has passed: u = u0(t - s/c)
    since = np.maximum(solution.time[early] - 0.3 * traverse, 0.0)
    height = place[early, 1, 2] - place[0, 1, 2]
    np.testing.assert_allclose(height, AMPLITUDE * np.sin(ANGULAR * since), atol=1e-11)
    np.testing.assert_allclose(moving[early, 1, 2], np.where(since > 0.0, cosine(since), 0.0), atol=1e-11)


@pytest.mark.parametrize(
    ("changes", "word"),
    [
        ({"geometry": Geometry("shallow", tension=80.0)}, "geometry"),
        ({"bottom": Bottom("step", "horizontal", velocity=1.0)}, "not along the cable"),
        ({"bottom": Bottom("step", (0.0, 1.0, 1.0), velocity=1.0)}, "not along the cable"),
        (
            {"cable": Cable(150.0, "unstretched", 0.03, axial_stiffness=120.0, axial_damping_time=1e-3)},
            "damp",
        ),
    ],
)
def test_what_axial_waves_leave_out_is_refused_with_a_remedy(changes: dict[str, object], word: str) -> None:
    with pytest.raises(DataError, match=word) as caught:
        run_axial_waves(taut(**changes), 10)
    assert caught.value.remedy


def test_a_direction_down_the_cable_turns_the_sign() -> None:
    up = run_axial_waves(taut(), 10).strain
    down = run_axial_waves(taut(bottom=replace(taut().bottom, direction=(0.0, 0.0, -2.0))), 10).strain
    np.testing.assert_array_equal(down, -up)
