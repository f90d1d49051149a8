"""The quasi-static catenary against closed forms, against itself turned, and against slow marches."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from tethertest.errors import DataError
from tethertest.records.arrays import FloatArray
from tethertest.records.cable import Air, Cable
from tethertest.records.scene import Bottom, Geometry, Output, Scene, Top
from tethertest.solver.nonlinear.chain_march import chain_case, run_chain
from tethertest.solver.quasi_static.catenary_run import run_catenary
from tethertest.solver.quasi_static.hanging import HangingCable

WEIGHT = 0.0484 * 9.80665
CABLE = Cable(3.0, "unstretched", 0.0484, axial_stiffness=10020.0, diameter=0.006)
INCLINED = Scene(
    name="3 m, inclined",
    cable=CABLE,
    geometry=Geometry("ends", top=(1.8, 2.375)),
    bottom=Bottom("harmonic", direction="vertical", amplitude=0.02, frequency=0.1, start="ramp", ramp=20.0),
    top=Top("fixed"),
    output=Output(40.0, 20.0, (0.0, 0.25, 0.5, 0.75, 1.0), fields=("position", "velocity", "curvature")),
)
RIG = replace(
    INCLINED,
    name="3 m rig",
    geometry=Geometry("vertical"),
    bottom=Bottom("harmonic", amplitude=0.1, frequency=0.1, start="ramp", ramp=10.0),
    top=Top("platform", mass=0.4, static_tension=5.0),
    output=Output(30.0, 50.0, (0.0, 1.0)),
)
LEVEL = replace(
    INCLINED,
    name="level ends",
    geometry=Geometry("shallow", tension=3.0),
    bottom=replace(INCLINED.bottom, direction="horizontal", amplitude=0.01),
)
STRAIGHT = replace(
    INCLINED,
    name="straight",
    geometry=Geometry("straight", tension=5.0),
    bottom=Bottom("harmonic", amplitude=0.003, frequency=0.1),
)
HOVERING = replace(
    INCLINED,
    name="hovering",
    geometry=Geometry("hovering"),
    top=Top("platform", mass=0.4, lift=(1.0, 0.3, 8.0), hover_stiffness=50.0, hover_damping=5.0),
)


def catenary_chord(level: float, low: float, length: float, stiffness: float) -> tuple[float, float]:
    """Reach and rise of oracle 7, from the forces at the lower end (z upwards)."""
    high = low + WEIGHT * length
    pull, dive = math.hypot(level, high), math.hypot(level, low)
    reach = level * length / stiffness + level / WEIGHT * (math.asinh(high / level) - math.asinh(low / level))
    return reach, (high**2 - low**2) / (2.0 * WEIGHT * stiffness) + (pull - dive) / WEIGHT


def turned(vector: tuple[float, ...], angle: float) -> tuple[float, float, float]:
    x, y, z = vector[0], vector[1] if len(vector) == 3 else 0.0, vector[-1]
    cosine, sine = math.cos(angle), math.sin(angle)
    return cosine * x - sine * y, sine * x + cosine * y, z


def size(values: FloatArray) -> FloatArray:
    return np.asarray(np.sqrt(np.mean(values**2, axis=0)))


@pytest.mark.parametrize("stiffness", [100.0, 10020.0, 4e5])
def test_displaced_ends_are_those_of_the_closed_form(stiffness: float) -> None:
    scene = replace(INCLINED, cable=replace(CABLE, axial_stiffness=stiffness))
    solution = run_catenary(scene)
    bottom, top = solution.fields["position"][:, 0], solution.fields["position"][:, -1]
    cable = HangingCable(3.0, stiffness, np.array([0.0, 0.0, -WEIGHT]))
    for row in (0, 250, 777):
        chord = top[row] - bottom[row]
        level, _, low = cable.between(chord[None])[0]
        np.testing.assert_allclose(catenary_chord(level, low, 3.0, stiffness), chord[[0, 2]], rtol=1e-11)
        assert solution.tension[row, 0] == pytest.approx(math.hypot(level, low), rel=1e-12)
        assert solution.tension[row, -1] == pytest.approx(math.hypot(level, low + WEIGHT * 3.0), rel=1e-12)
    np.testing.assert_allclose(top, np.broadcast_to([1.8, 0.0, 2.375], top.shape), atol=1e-11)


def test_chords_beyond_reach_and_folded_ones_close_too() -> None:
    cable = HangingCable(3.0, 4e5, np.array([0.0, 0.0, -WEIGHT]))
    chords = np.array(
        [[3.1, 0.0, 0.0], [1e-9, 0.0, 2.0], [0.0, 0.0, 3.0001], [1e-3, 2e-3, -1.0], [2.0, 2.2, 0.3]]
    )
    ends = cable.position(cable.between(chords), np.ones(1))[:, 0]
    np.testing.assert_allclose(ends, chords, atol=1e-9)


def test_flexibility_is_the_derivative_of_the_upper_end() -> None:
    cable = HangingCable(3.0, 900.0, np.array([0.05, -0.03, -WEIGHT]))
    force = np.array([[2.0, 0.7, 1.5]])
    step = 1e-5 * np.eye(3)
    ends = [cable.position(force + sign * step, np.ones(1))[:, 0] for sign in (1.0, -1.0)]
    np.testing.assert_allclose(
        cable.flexibility(force)[0], (ends[0] - ends[1]).T / 2e-5, rtol=1e-6, atol=1e-9
    )


def test_error_against_the_march_falls_with_the_square_of_the_frequency() -> None:
    errors = []
    for frequency in (0.4, 0.2, 0.1):
        motion = replace(INCLINED.bottom, amplitude=0.01, frequency=frequency, ramp=2.0 / frequency)
        scene = replace(INCLINED, bottom=motion, output=Output(5.0 / frequency, 40.0 * frequency, (0.0, 1.0)))
        march, model = run_chain(scene, 40, viscous=False, courant=0.9), run_catenary(scene)
        change = (model.tension - model.tension[0]) - (march.tension - march.tension[0])
        errors.append(float(np.max(size(change))))
    orders = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    assert orders[-1] == pytest.approx(2.0, abs=0.15)


def test_vertical_platform_misses_half_the_cable_at_either_end() -> None:
    """The model's tension is static + (M + m/2) a; the march's (M + m) a at the bottom, M a at the top."""
    march, model = run_chain(RIG, 20, viscous=False, courant=0.9), run_catenary(RIG)
    missed = size(model.tension - march.tension) / size(march.tension - march.tension[0])
    half = 0.5 * 3.0 * 0.0484
    np.testing.assert_allclose(missed, [half / (0.4 + 2.0 * half), half / 0.4], rtol=0.01)  # .133, .18


def test_level_ends_pull_alike() -> None:
    tension = run_catenary(LEVEL).tension
    np.testing.assert_allclose(tension[:, 0], tension[:, -1], rtol=1e-11)
    np.testing.assert_allclose(tension[:, 1], tension[:, 3], rtol=1e-11)
    assert np.all(tension[:, 2] < tension[:, 1])


@pytest.mark.parametrize("top", [Top("fixed"), Top("platform", mass=0.4, hover_stiffness=50.0)])
def test_scene_turned_about_the_vertical_has_the_same_tension(top: Top) -> None:
    scene = replace(INCLINED, top=top, air=Air(1.225, 1.2, 0.01, wind=(3.0, 0.5, 0.0)))
    scene = replace(scene, bottom=replace(INCLINED.bottom, direction=(0.3, 0.1, 0.9)))
    angle = 0.7
    other = replace(
        scene,
        geometry=Geometry("ends", top=turned((1.8, 2.375), angle)),
        bottom=replace(scene.bottom, direction=turned((0.3, 0.1, 0.9), angle)),
        air=Air(1.225, 1.2, 0.01, wind=turned((3.0, 0.5, 0.0), angle)),
    )
    first, second = run_catenary(scene), run_catenary(other)
    np.testing.assert_allclose(second.tension, first.tension, rtol=1e-9)
    np.testing.assert_allclose(second.platform_position, first.platform_position, atol=1e-10)
    matrix = np.array([turned(tuple(axis), angle) for axis in np.eye(3)])
    np.testing.assert_allclose(second.fields["position"], first.fields["position"] @ matrix, atol=1e-9)


def test_rest_in_wind_is_near_that_of_the_blown_chain() -> None:
    scene = replace(INCLINED, air=Air(1.225, 1.2, 0.01, wind=6.0))
    chain = chain_case(scene, 80, viscous=False).rest
    ends = [float(np.linalg.norm(force)) for force in (chain.start_force, chain.end_force)]
    np.testing.assert_allclose(run_catenary(scene).tension[0, [0, -1]], ends, rtol=0.03)


def test_straight_cable_is_a_spring_that_cannot_push() -> None:
    solution = run_catenary(STRAIGHT)
    moved = 0.003 * np.sin(2.0 * np.pi * 0.1 * solution.time)
    expected = np.maximum(5.0 - 10020.0 * moved / 3.0, 0.0)
    np.testing.assert_allclose(solution.tension, np.repeat(expected[:, None], 5, axis=1), atol=1e-9)
    assert np.min(solution.tension) == 0.0


def test_slack_vertical_cable_hangs_from_both_ends() -> None:
    scene = replace(RIG, geometry=Geometry("vertical", tension=0.5), top=Top("fixed"))
    scene = replace(scene, cable=replace(CABLE, axial_stiffness=4e6))
    solution = run_catenary(replace(scene, bottom=replace(RIG.bottom, amplitude=0.3)))
    rise = 3.0 - 0.3  # bottom end 0.3 m up
    row = int(np.argmin(np.abs(solution.time - 22.5)))  # sin = 1
    np.testing.assert_allclose(
        solution.tension[row], [0.5 * WEIGHT * (3.0 - rise), 0.5 * WEIGHT * (3.0 + rise)], rtol=1e-5
    )


@pytest.mark.parametrize("scene", [INCLINED, RIG, LEVEL, STRAIGHT, HOVERING], ids=lambda scene: scene.name)
def test_first_row_is_the_rest(scene: Scene) -> None:
    still = run_catenary(replace(scene, bottom=Bottom("fixed", direction=scene.bottom.direction)))
    solution = run_catenary(scene)
    assert solution.time.size == math.floor(scene.output.duration * scene.output.rate + 1e-9) + 1
    np.testing.assert_allclose(
        still.tension, np.broadcast_to(solution.tension[0], still.tension.shape), rtol=1e-9
    )
    np.testing.assert_allclose(solution.strain[0], 0.0, atol=1e-13)
    assert solution.platform_position[0] == pytest.approx(0.0, abs=1e-10)
    np.testing.assert_allclose(solution.field.minimum[0, 0], np.min(solution.tension[:1, 0]), rtol=0.2)


def test_hovering_platform_stands_where_its_forces_balance() -> None:
    solution = run_catenary(replace(HOVERING, output=replace(HOVERING.output, rate=50.0)))
    place = solution.fields["position"][:, -1]
    away = place - place[0]
    velocity = np.gradient(away, 0.02, axis=0)
    inertia = 0.4 + 0.5 * 3.0 * 0.0484
    held = np.array([1.0, 0.3, 8.0 - 0.4 * 9.80665])
    balance = held - 50.0 * away - 5.0 * velocity - inertia * np.gradient(velocity, 0.02, axis=0)
    np.testing.assert_allclose(solution.tension[:, -1], np.linalg.norm(balance, axis=1), rtol=2e-3)
    assert np.max(np.linalg.norm(away, axis=1)) > 1e-3


def test_curvature_and_velocity_are_those_of_the_positions() -> None:
    gauges = tuple(np.linspace(0.0, 1.0, 201))
    solution = run_catenary(replace(INCLINED, output=replace(INCLINED.output, gauges=gauges)))
    place = solution.fields["position"]
    along = np.diff(place[400], axis=0)
    length = np.linalg.norm(along, axis=1)
    turn = np.arctan2(along[:, 2], along[:, 0])
    np.testing.assert_allclose(
        solution.fields["curvature"][400, 1:-1], np.diff(turn) / (0.5 * (length[1:] + length[:-1])), rtol=1e-3
    )
    np.testing.assert_allclose(
        solution.fields["velocity"][1:-1, 100], (place[2:, 100] - place[:-2, 100]) / 0.1, atol=1e-4
    )


def test_native_times_are_fine_enough_for_the_drive() -> None:
    scene = replace(INCLINED, output=Output(40.0, 1.0, (0.0, 1.0)))
    coarse, fine = run_catenary(scene), run_catenary(scene, native_times=True)
    assert fine.time_step <= 1.0 / (64.0 * 0.1)
    np.testing.assert_array_equal(coarse.tension, fine.tension[:: round(1.0 / fine.time_step)])


@pytest.mark.parametrize(
    ("scene", "remedy"),
    [
        (replace(INCLINED, cable=replace(CABLE, bending_stiffness=0.1)), "leave out"),
        (replace(INCLINED, air=Air(1.225, wind_file="wind.csv")), "wind"),
        (replace(HOVERING, top=replace(HOVERING.top, drag_area=(0.1, 0.1))), "drag_area"),
        (replace(INCLINED, top=Top("platform", mass=0.4, lift=9.0)), "hovering"),
        (replace(HOVERING, top=Top("fixed")), "platform"),
        (replace(HOVERING, top=Top("platform", mass=0.4)), "lift"),
        (replace(HOVERING, top=Top("platform", mass=0.4, lift=4.0)), "raise"),
        (replace(HOVERING, cable=replace(CABLE, length_state="equilibrium")), "unstretched"),
        (replace(STRAIGHT, bottom=replace(STRAIGHT.bottom, direction="vertical")), "tangent"),
        (replace(INCLINED, geometry=Geometry("ends")), "top"),
        (replace(LEVEL, geometry=Geometry("shallow")), "tension"),
        (replace(INCLINED, top=Top("platform", mass=0.4, static_tension=9.0)), "static_tension"),
    ],
)
def test_what_the_model_leaves_out_is_refused_with_a_remedy(scene: Scene, remedy: str) -> None:
    with pytest.raises(DataError) as caught:
        run_catenary(scene)
    assert remedy in caught.value.remedy
