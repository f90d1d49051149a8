"""One march on a line, in a plane and in space: upright, turned, mirrored, inclined and resting scenes."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from tethertest.errors import DataError
from tethertest.records.cable import Air, Cable
from tethertest.records.scene import Bottom, Geometry, Output, Scene, Top
from tethertest.solver.nonlinear.chain_march import chain_case, run_chain
from tethertest.solver.solution import Solution
from tethertest.solver.statics.catenary_shape import ElasticCatenary

CABLE = Cable(3.0, "unstretched", 0.0484, axial_stiffness=10020.0, diameter=0.006)
RIG = Scene(
    name="3 m rig",
    cable=CABLE,
    geometry=Geometry("vertical"),
    bottom=Bottom("harmonic", amplitude=0.2, frequency=0.3, start="ramp", ramp=4.0),
    top=Top("platform", mass=0.4, static_tension=5.0, hover_stiffness=50.0, hover_damping=5.0),
    output=Output(8.0, 500.0, (0.0, 0.1, 0.5, 1.0)),
)
LONG = Scene(
    name="150 m tether",
    cable=Cable(150.0, "unstretched", 0.0484, axial_stiffness=10020.0, diameter=0.006),
    geometry=Geometry("vertical", tension=50.0),
    bottom=Bottom("harmonic", amplitude=2.0, frequency=0.2, start="ramp", ramp=10.0),
    top=Top("fixed"),
    output=Output(40.0, 100.0, (0.0, 1.0)),
    air=Air(1.225, 1.2, 0.01),
    gravity=9.81,
)

#: bottom motions that are upright but for less than rounding: the march follows a line, a plane, space
UPRIGHT = {1: "tangent", 2: (1e-300, 1.0), 3: (0.0, 1e-300, 1.0)}


def marched(scene: Scene, cells: int, *, viscous: bool = True) -> list[Solution]:
    """The same upright scene in one, two and three dimensions."""
    solutions = []
    for dimension, direction in UPRIGHT.items():
        same = replace(scene, bottom=replace(scene.bottom, direction=direction))
        assert len(chain_case(same, cells, viscous=viscous).axes) == dimension
        solutions.append(run_chain(same, cells, viscous=viscous))
    return solutions


@pytest.mark.parametrize("viscous", [False, True])
def test_taut_vertical_rig_is_the_same_on_a_line_in_a_plane_and_in_space(viscous: bool) -> None:
    scene = replace(RIG, bottom=replace(RIG.bottom, amplitude=0.02))
    line, *others = marched(scene, 20, viscous=viscous)
    assert np.min(line.field.minimum) > 0.0
    for other in others:
        np.testing.assert_allclose(other.tension, line.tension, atol=1e-8)
        np.testing.assert_allclose(other.strain, line.strain, atol=1e-11)
        np.testing.assert_allclose(other.platform_position, line.platform_position, atol=1e-11)
        np.testing.assert_allclose(other.field.maximum, line.field.maximum, atol=1e-8)
        np.testing.assert_allclose(other.field.minimum, line.field.minimum, atol=1e-8)


def test_snapping_vertical_rig_with_damping_is_the_same_in_every_dimension() -> None:
    line, *others = marched(replace(RIG, cable=replace(CABLE, axial_damping_time=1e-3)), 10)
    assert np.min(line.tension) == 0.0  # slack, and exactly so
    for other in others:
        assert np.min(other.tension) == 0.0
        np.testing.assert_allclose(other.tension, line.tension, atol=1e-6)


def test_tangential_drag_is_the_same_in_every_dimension() -> None:
    scene = replace(RIG, top=Top("fixed"), geometry=Geometry("vertical", tension=50.0))
    scene = replace(scene, bottom=replace(RIG.bottom, amplitude=0.004, frequency=3.0))
    scene = replace(scene, air=Air(1.225, 1.2, 20.0))
    line, *others = marched(scene, 20)
    for other in others:
        np.testing.assert_allclose(other.tension, line.tension, atol=1e-8)
    without = run_chain(replace(scene, air=None), 20)
    assert np.max(np.abs(without.tension - line.tension)) > 1e-4


def turned(vector: tuple[float, float], angle: float) -> tuple[float, float, float]:
    """A vector [x, z] turned about the vertical."""
    return math.cos(angle) * vector[0], math.sin(angle) * vector[0], vector[1]


@pytest.mark.parametrize("motion", [(0.3, 0.95), (1.0, 0.0)])
def test_a_scene_turned_about_the_vertical_pulls_the_same(motion: tuple[float, float]) -> None:
    """Taut, with wind, damping, bending and a position loop alike along both horizontal axes."""
    cable = replace(CABLE, axial_damping_time=1e-3, bending_stiffness=0.01)
    scene = replace(
        RIG,
        cable=cable,
        geometry=Geometry("ends", top=(1.8, 2.3925)),
        bottom=replace(RIG.bottom, direction=motion, amplitude=0.01),
        top=Top("platform", mass=0.4, hover_stiffness=(50.0, 80.0), hover_damping=(5.0, 2.0)),
        air=Air(1.225, 1.2, 0.01, wind=(3.0, 0.5)),
        output=Output(6.0, 100.0, (0.0, 0.3, 1.0), ("position", "velocity", "curvature")),
    )
    plane = run_chain(scene, 20)
    assert np.min(plane.field.minimum) > 0.0
    angle = 0.7
    matrix = np.array(
        [[math.cos(angle), math.sin(angle), 0], [-math.sin(angle), math.cos(angle), 0], [0, 0, 1]]
    )
    other = replace(
        scene,
        geometry=Geometry("ends", top=turned((1.8, 2.3925), angle)),
        bottom=replace(scene.bottom, direction=turned(motion, angle)),
        air=Air(1.225, 1.2, 0.01, wind=turned((3.0, 0.5), angle)),
    )
    space = run_chain(other, 20)
    np.testing.assert_allclose(space.tension, plane.tension, atol=1e-9)
    np.testing.assert_allclose(space.platform_position, plane.platform_position, atol=1e-10)
    for name in ("position", "velocity"):
        np.testing.assert_allclose(space.fields[name], plane.fields[name] @ matrix, atol=1e-9)
    np.testing.assert_allclose(space.fields["curvature"], plane.fields["curvature"], atol=1e-9)


@pytest.mark.parametrize("wind", [0.0, 8.0])
def test_a_cable_without_motion_stays_at_rest(wind: float) -> None:
    scene = replace(
        RIG,
        geometry=Geometry("ends", top=(1.8, 2.2)),
        bottom=Bottom("fixed"),
        top=Top("platform", mass=0.4, hover_stiffness=50.0, hover_damping=5.0),
        air=Air(1.225, 1.2, 0.01, wind=wind),
    )
    solution = run_chain(scene, 20)
    rest = chain_case(scene, 20).rest
    expected = [float(np.linalg.norm(force)) for force in (rest.start_force, rest.end_force)]
    np.testing.assert_allclose(
        solution.tension[:, [0, 3]], np.tile(expected, (solution.time.size, 1)), atol=1e-7
    )
    np.testing.assert_allclose(solution.strain, 0.0, atol=1e-11)
    np.testing.assert_allclose(solution.platform_position, 0.0, atol=1e-9)


def test_damped_vertical_snap_peaks_at_305_newtons() -> None:
    scene = replace(LONG, cable=replace(LONG.cable, axial_damping_time=1e-3), air=None)
    solution = run_chain(scene, 160)
    assert np.max(solution.field.maximum[:, -1]) == pytest.approx(305.0, abs=1.5)


def prototype(degrees: float) -> Scene:
    """The 150 m tether with 50 N at mid-length, its upper end at an angle above the level."""
    weight, angle = 0.0484 * 9.81, math.radians(degrees)

    def chord(pull: float) -> np.ndarray:
        force = 50.0 * np.array([math.cos(pull), math.sin(pull)]) + [0.0, -0.5 * weight * 150.0]
        shape = ElasticCatenary(150.0, 10020.0, np.array([0.0, -weight]), force)
        return np.asarray(shape.position(np.array([150.0]))[0])

    low, high = -1.4, 1.5
    for _ in range(60):
        middle = 0.5 * (low + high)
        end = chord(middle)
        low, high = (middle, high) if math.atan2(end[1], end[0]) < angle else (low, middle)
    end = chord(low)
    return replace(LONG, geometry=Geometry("ends", top=(float(end[0]), float(end[1]))))


@pytest.mark.parametrize("cells", [80, 320])
def test_inclined_prototype_with_drag_snaps_to_124_6_newtons(cells: int) -> None:
    """Without drag 600-1300 N: the air is worth more than any scheme."""
    solution = run_chain(prototype(45.0), cells)
    assert np.min(solution.field.minimum) == 0.0
    assert np.max(solution.field.maximum[:, -1]) == pytest.approx(124.6, abs=0.8)


def test_level_prototype_with_drag_reaches_78_2_newtons() -> None:
    solution = run_chain(prototype(0.0), 80)
    assert np.max(solution.field.maximum[:, -1]) == pytest.approx(78.2, abs=0.1)


def test_a_mirrored_scene_gives_the_mirrored_motion() -> None:
    scene = replace(
        prototype(45.0), air=Air(1.225, 1.2, 0.01, wind=(4.0, 0.5)), output=Output(20.0, 50.0, (0.0, 1.0))
    )
    assert scene.geometry.top is not None
    assert scene.air is not None
    mirrored = replace(
        scene,
        geometry=Geometry("ends", top=(-scene.geometry.top[0], scene.geometry.top[1])),
        air=replace(scene.air, wind=(-4.0, 0.5)),
    )
    left, right = run_chain(mirrored, 40), run_chain(scene, 40)
    np.testing.assert_allclose(left.tension, right.tension, rtol=1e-6, atol=1e-6)


@pytest.mark.parametrize("along", [(1.0, 0.0), (0.6, 0.8), (-0.8, -0.6)])
def test_without_gravity_a_turned_rig_is_the_same_rig(along: tuple[float, float]) -> None:
    """Body, position loop, air and end balance act alike in every direction of the plane."""

    def along_axis(x: float, z: float) -> Solution:
        scene = replace(
            RIG,
            geometry=Geometry("ends", top=(3.004 * x, 3.004 * z)),
            bottom=replace(RIG.bottom, direction=(x + 0.5 * z, z - 0.5 * x), frequency=0.8),
            top=Top("platform", mass=0.4, hover_stiffness=50.0, hover_damping=5.0),
            air=Air(1.225, 1.2, 0.01),
            gravity=0.0,
        )
        return run_chain(scene, 12)

    upright, other = along_axis(0.0, 1.0), along_axis(*along)
    assert np.ptp(upright.platform_position) > 0.05
    np.testing.assert_allclose(other.tension, upright.tension, atol=1e-5)
    np.testing.assert_allclose(other.strain, upright.strain, atol=1e-9)


def test_a_step_above_the_limit_is_refused() -> None:
    with pytest.raises(DataError, match="stability limit"):
        run_chain(RIG, 10, courant=1.0)


def test_what_has_no_rest_is_an_error_with_a_remedy() -> None:
    for scene in (
        replace(RIG, geometry=Geometry("ends")),
        replace(RIG, geometry=Geometry("shallow")),
        replace(RIG, geometry=Geometry("ends", top=(2.0, 2.3))),  # its top tension is not 5 N
        replace(RIG, geometry=Geometry("ends", top=(1.0, 1.0, 2.0))),  # nor is this
    ):
        with pytest.raises(DataError) as caught:
            run_chain(scene, 10)
        assert caught.value.remedy
