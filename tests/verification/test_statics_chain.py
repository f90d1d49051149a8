"""The discrete equilibrium against elastic catenary, force balance, tilted planes and a beam in tension."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from tethertest.records.arrays import FloatArray
from tethertest.records.cable import Air, Cable
from tethertest.records.scene import Bottom, Geometry, Output, Scene, Top
from tethertest.solver.statics.equilibrium import RestChain, rest_chain

GRAVITY = 9.80665
AIR = Air(density=1.225, normal_drag=1.2, tangential_drag=0.01)
#: reading B of the paper's table 4, at full scale
TETHER = Cable(144.0, "unstretched", 0.048, axial_stiffness=410020.0, diameter=0.006)
UAV = Top("platform", mass=5.0, static_tension=100.0, drag_area=(0.1, 0.2), tilt=0.2)


def scene(
    cable: Cable,
    geometry: Geometry,
    top: Top | None = None,
    wind: tuple[float, ...] | None = None,
    gravity: float = GRAVITY,
) -> Scene:
    return Scene(
        "statics",
        cable,
        geometry,
        Bottom("fixed"),
        Top("fixed") if top is None else top,
        Output(1.0, 10.0, (0.0, 1.0)),
        air=None if wind is None else replace(AIR, wind=wind),
        gravity=gravity,
    )


SCENES = {
    "ends": scene(TETHER, Geometry("ends", top=(110.0, 20.0, 85.0)), Top("platform", mass=5.0)),
    "ends in wind": scene(TETHER, Geometry("ends", top=(110.0, 20.0, 85.0)), wind=(3.0, -8.0, 1.0)),
    "equilibrium ends in wind": scene(
        replace(TETHER, length_state="equilibrium"), Geometry("ends", top=(110.0, 85.0)), wind=(10.0, 0.0)
    ),
    "bending in wind": scene(
        replace(TETHER, bending_stiffness=2.0, length_state="equilibrium"),
        Geometry("ends", top=(110.0, 20.0, 85.0)),
        wind=(3.0, -8.0, 1.0),
    ),
    "hovering": scene(TETHER, Geometry("hovering"), UAV, wind=(8.0, 4.0, 1.0)),
    "equilibrium hovering": scene(
        replace(TETHER, length_state="equilibrium"), Geometry("hovering"), UAV, wind=(8.0, 4.0, 1.0)
    ),
    "bending hovering": scene(
        replace(TETHER, bending_stiffness=2.0), Geometry("hovering"), UAV, wind=(8.0, 4.0, 1.0)
    ),
    "bending upright": scene(
        replace(TETHER, bending_stiffness=2.0, axial_stiffness=500.0), Geometry("vertical", tension=50.0)
    ),
    "vertical in wind": scene(
        replace(TETHER, axial_stiffness=10020.0), Geometry("vertical", tension=50.0), wind=(10.0, 2.0, 0.0)
    ),
    "slack upright in wind": scene(TETHER, Geometry("ends", top=(0.0, 100.0)), wind=(10.0, 0.0)),
    "shallow": scene(
        Cable(250.0, "equilibrium", 0.02, youngs_modulus=1.7e7, diameter=0.003),
        Geometry("shallow", tension=80.0),
        gravity=9.81,
    ),
    "straight": scene(
        Cable(100.0, "equilibrium", 0.05, axial_stiffness=2e4), Geometry("straight", tension=100.0)
    ),
}


def irvine(start: FloatArray, weight: float, cable: Cable, arc: FloatArray) -> FloatArray:
    """Positions (m, 2) of a cable pulled back with (-H, -V) at its lower end, as printed, z upwards."""
    level, climb = float(start[0]), float(start[1])
    stiffness, length, total = float(cable.axial_stiffness or 0.0), cable.length, weight * cable.length
    high, low = (climb + weight * arc) / level, climb / level
    x = level * arc / stiffness + level * length / total * (np.arcsinh(high) - np.arcsinh(low))
    z = (climb * arc + 0.5 * weight * arc**2) / stiffness
    return np.column_stack([x, z + level * length / total * (np.hypot(1.0, high) - np.hypot(1.0, low))])


def morison(along: FloatArray, wind: FloatArray, diameter: float) -> FloatArray:
    """The air's force on a node between cells (or at the end of one) along unit vectors (k, 3)."""
    tangent = along.sum(axis=0) / np.linalg.norm(along.sum(axis=0))
    past = (wind @ tangent) * tangent
    across = wind - past
    pressure = 0.5 * AIR.density * diameter
    normal = pressure * AIR.normal_drag * np.linalg.norm(across) * across
    return np.asarray(normal + pressure * math.pi * AIR.tangential_drag * np.linalg.norm(past) * past)


def unbalanced(case: Scene, rest: RestChain) -> FloatArray:
    """Force (n + 1, 3) left on each node, from the nodes' places alone; the ends' forces included."""
    steps = np.diff(rest.nodes, axis=0)
    size = np.linalg.norm(steps, axis=1)
    along = steps / size[:, None]
    pull = (rest.stiffness * (size / rest.cell - 1.0))[:, None] * along
    gravity = 0.0 if case.geometry.kind == "straight" else case.gravity
    load = np.tile(rest.mass * rest.cell * gravity * np.array([0.0, 0.0, -1.0]), (size.size + 1, 1))
    if case.air is not None:
        blow = case.air.wind
        wind = np.array([blow[0], blow[1] if len(blow) == 3 else 0.0, blow[-1]])
        around = [along[:1], *(along[i : i + 2] for i in range(size.size - 1)), along[-1:]]
        load += rest.cell * np.array([morison(cells, wind, case.cable.diameter or 0.0) for cells in around])
    load[[0, -1]] *= 0.5
    bend = np.zeros_like(rest.nodes)
    bend[1:-1] = np.diff(steps, axis=0)
    padded = np.concatenate([np.zeros((1, 3)), bend, np.zeros((1, 3))])
    load -= case.cable.bending_stiffness / rest.cell**3 * np.diff(padded, n=2, axis=0)
    load[:-1] += pull
    load[1:] -= pull
    load[0] -= rest.start_force
    load[-1] += rest.end_force
    return load


@pytest.mark.parametrize("name", SCENES)
def test_every_node_balances_under_pull_weight_air_and_bending(name: str) -> None:
    rest = rest_chain(SCENES[name], 60)
    largest = float(np.max(rest.tension))
    assert np.max(np.abs(unbalanced(SCENES[name], rest))) <= 1e-10 * largest
    assert not np.any(rest.nodes[0])


@pytest.mark.parametrize("start", [(50.0, -35.0), (50.0, 60.0), (0.8, 40.0), (80.0, 0.0), (3.0, -30.0)])
@pytest.mark.parametrize("stiffness", [120.17, 10020.0, 410020.0])
def test_chain_approaches_irvines_catenary_with_the_square_of_the_cell(
    start: tuple[float, float], stiffness: float
) -> None:
    cable = Cable(150.0, "unstretched", 0.0484, axial_stiffness=stiffness)
    force = np.array(start)
    top = irvine(force, 0.0484 * GRAVITY, cable, np.array([150.0]))[0]
    case = scene(cable, Geometry("ends", top=(float(top[0]), float(top[1]))))
    shape_errors, force_errors = [], []
    for cells in (200, 400):
        rest = rest_chain(case, cells)
        exact = irvine(force, 0.0484 * GRAVITY, cable, np.linspace(0.0, 150.0, cells + 1))
        shape_errors.append(np.max(np.abs(rest.nodes[:, [0, 2]] - exact)))
        force_errors.append(np.max(np.abs(rest.start_force[[0, 2]] - force)))
    assert shape_errors[1] < 2e-3
    assert force_errors[1] < 2e-3 * np.linalg.norm(force)
    assert math.log2(shape_errors[0] / shape_errors[1]) == pytest.approx(2.0, abs=0.15)
    assert math.log2(force_errors[0] / force_errors[1]) == pytest.approx(2.0, abs=0.15)


def test_rubber_cable_of_the_paper_is_stretched_by_two_thirds() -> None:
    rest = rest_chain(SCENES["shallow"], 400)
    assert np.mean(rest.tension) / rest.stiffness == pytest.approx(0.676, abs=0.001)
    assert rest.force[200, 0] == pytest.approx(80.0, abs=1e-3)
    assert rest.nodes[-1, 2] == pytest.approx(0.0, abs=1e-9)
    assert rest.start_force[2] == pytest.approx(-0.5 * 250.0 * 0.02 * 9.81, rel=1e-9)


@pytest.mark.parametrize(
    "name", [name for name in SCENES if SCENES[name].cable.length_state == "equilibrium"]
)
def test_cable_given_at_equilibrium_is_that_long_and_that_heavy_at_rest(name: str) -> None:
    cable = SCENES[name].cable
    rest = rest_chain(SCENES[name], 100)
    stretched = np.linalg.norm(np.diff(rest.nodes, axis=0), axis=1).sum()
    assert stretched == pytest.approx(cable.length, rel=2e-6 if name == "shallow" else 1e-12)
    assert rest.mass * rest.cell * 100 == pytest.approx(cable.length * cable.mass_per_length, rel=1e-12)


def test_weak_side_wind_turns_the_plane_of_a_level_catenary() -> None:
    case = scene(TETHER, Geometry("ends", top=(140.0, 0.0)))
    still = rest_chain(case, 50)
    blown = rest_chain(replace(case, air=replace(AIR, wind=(0.0, 0.2, 0.0))), 50)
    drag = 0.5 * AIR.density * 0.006 * AIR.normal_drag * 0.2**2
    slope = drag / (0.048 * GRAVITY)
    inner = slice(1, -1)
    assert blown.nodes[inner, 1] / -blown.nodes[inner, 2] == pytest.approx(slope, rel=1e-5)
    np.testing.assert_allclose(np.hypot(blown.nodes[:, 1], blown.nodes[:, 2]), -still.nodes[:, 2], atol=1e-5)
    assert blown.force[:, 0] == pytest.approx(still.force[:, 0], rel=1e-5)


def test_turned_ends_turn_the_whole_chain_about_the_vertical() -> None:
    plane = rest_chain(scene(TETHER, Geometry("ends", top=(110.0, 85.0)), wind=(9.0, 2.0)), 40)
    cosine, sine = math.cos(0.7), math.sin(0.7)
    turn = np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])
    top = (110.0 * cosine, 110.0 * sine, 85.0)
    space = rest_chain(scene(TETHER, Geometry("ends", top=top), wind=(9.0 * cosine, 9.0 * sine, 2.0)), 40)
    np.testing.assert_allclose(space.nodes, plane.nodes @ turn.T, atol=1e-9)
    np.testing.assert_allclose(space.force, plane.force @ turn.T, atol=1e-8)


def test_hovering_platform_with_wind_on_its_body_alone_hangs_on_irvines_catenary() -> None:
    top = replace(UAV, tilt=0.0, static_tension=120.0)
    still_cable = replace(AIR, normal_drag=0.0, tangential_drag=0.0, wind=(12.0, 0.0, 0.0))
    case = replace(scene(TETHER, Geometry("hovering"), top), air=still_cable)
    push = 0.5 * 1.225 * 0.1 * 12.0**2
    rest = rest_chain(case, 400)
    upwards = math.sqrt(120.0**2 - push**2)
    assert rest.end_force == pytest.approx([push, 0.0, upwards], rel=1e-12)
    assert rest.lift == pytest.approx([0.0, 0.0, upwards + 5.0 * GRAVITY], rel=1e-12)
    weight = 0.048 * GRAVITY
    start = np.array([push, upwards - weight * 144.0])
    exact = irvine(start, weight, TETHER, np.linspace(0.0, 144.0, 401))
    np.testing.assert_allclose(rest.nodes[:, [0, 2]], exact, atol=2e-4)


@pytest.mark.parametrize("lift", [150.0, (40.0, -20.0, 160.0)])
def test_lift_weight_and_air_on_cable_and_body_balance_the_bottom_force(
    lift: float | tuple[float, ...],
) -> None:
    top = replace(UAV, static_tension=None, lift=lift)
    wind = np.array([8.0, 4.0, 1.0])
    case = scene(TETHER, Geometry("hovering"), top, wind=(8.0, 4.0, 1.0))
    rest = rest_chain(case, 80)
    along = rest.force / rest.tension[:, None]
    around = [along[:1], *(along[i : i + 2] for i in range(79)), along[-1:]]
    air = rest.cell * np.array([morison(cells, wind, 0.006) for cells in around])
    air[[0, -1]] *= 0.5
    forward = 8.0 * math.cos(0.2) - 1.0 * math.sin(0.2)
    upward = 8.0 * math.sin(0.2) + 1.0 * math.cos(0.2)
    across = np.hypot(forward, 4.0)
    on_body = 0.5 * 1.225 * np.array([0.1 * forward * across, 0.1 * 4.0 * across, 0.2 * upward**2])
    body = np.array(
        [
            on_body[0] * math.cos(0.2) + on_body[2] * math.sin(0.2),
            on_body[1],
            on_body[2] * math.cos(0.2) - on_body[0] * math.sin(0.2),
        ]
    )
    lifting = np.array([0.0, 0.0, lift]) if isinstance(lift, float) else np.array(lift)
    weight = np.array([0.0, 0.0, -(5.0 + 144.0 * 0.048) * GRAVITY])
    np.testing.assert_allclose(rest.start_force, lifting + weight + body + air.sum(axis=0), rtol=1e-11)
    np.testing.assert_allclose(rest.lift, lifting, atol=1e-11)


def test_lift_that_holds_a_hovering_platform_holds_it_between_ends_too() -> None:
    hovering = rest_chain(SCENES["hovering"], 60)
    place = tuple(float(value) for value in hovering.nodes[-1])
    top = replace(UAV, static_tension=None)
    held = rest_chain(scene(TETHER, Geometry("ends", top=place), top, wind=(8.0, 4.0, 1.0)), 60)
    np.testing.assert_allclose(held.nodes, hovering.nodes, atol=1e-9)
    np.testing.assert_allclose(held.lift, hovering.lift, rtol=1e-6, atol=1e-6)
    stated = replace(top, lift=tuple(float(value) for value in held.lift))
    agreed = rest_chain(scene(TETHER, Geometry("ends", top=place), stated, wind=(8.0, 4.0, 1.0)), 60)
    np.testing.assert_allclose(agreed.lift, held.lift)


def test_vertical_platform_under_lift_or_static_tension_or_bottom_tension_is_one_rest() -> None:
    cable = Cable(3.0, "unstretched", 0.0484, axial_stiffness=10020.0, diameter=0.006)
    bottom = 5.0 - 3.0 * 0.0484 * GRAVITY
    tops = [
        Top("platform", mass=0.4, static_tension=5.0),
        Top("platform", mass=0.4, lift=5.0 + 0.4 * GRAVITY),
        Top("platform", mass=0.4, lift=(0.0, 0.0, 5.0 + 0.4 * GRAVITY)),
    ]
    rests = [rest_chain(scene(cable, Geometry("vertical"), top), 20) for top in tops]
    rests.append(
        rest_chain(scene(cable, Geometry("vertical", tension=bottom), Top("platform", mass=0.4)), 20)
    )
    for rest in rests:
        assert rest.end_force == pytest.approx([0.0, 0.0, 5.0], abs=1e-12)
        assert rest.start_force == pytest.approx([0.0, 0.0, bottom], abs=1e-12)
        assert rest.lift == pytest.approx([0.0, 0.0, 5.0 + 0.4 * GRAVITY], abs=1e-12)
        assert rest.nodes[-1, 2] == pytest.approx(3.0 * (1.0 + 0.5 * (bottom + 5.0) / 10020.0), abs=1e-13)


@pytest.mark.parametrize("name", ["bending upright", "straight"])
def test_upright_cable_in_still_air_has_nothing_sideways_at_all(name: str) -> None:
    rest = rest_chain(SCENES[name], 40)
    assert not np.any(rest.nodes[:, :2])
    assert not np.any(rest.force[:, :2])
    assert not np.any(rest.lift[:2])


def test_vertical_cable_bows_in_wind_between_ends_that_stay() -> None:
    cable = replace(TETHER, axial_stiffness=10020.0)
    platform = Top("platform", mass=5.0, static_tension=120.0)
    still = rest_chain(scene(cable, Geometry("vertical"), platform), 60)
    blown = rest_chain(scene(cable, Geometry("vertical"), platform, wind=(10.0, 0.0)), 60)
    np.testing.assert_allclose(blown.nodes[-1], still.nodes[-1], atol=1e-10)
    assert np.max(blown.nodes[:, 0]) > 1.0
    assert blown.lift[0] < -1.0
    assert still.lift == pytest.approx([0.0, 0.0, 120.0 + 5.0 * GRAVITY], rel=1e-12)


@pytest.mark.parametrize("rigidity", [3.0, 10.0, 50.0])
def test_deflection_of_a_stiff_cable_in_weak_wind_approaches_the_beam_in_tension(rigidity: float) -> None:
    pull, length, wind = 100.0, 10.0, 0.05
    cable = Cable(
        length, "unstretched", 0.05, axial_stiffness=1e6, diameter=0.006, bending_stiffness=rigidity
    )
    case = scene(cable, Geometry("straight", tension=pull), wind=(wind, 0.0))
    load = 0.5 * AIR.density * 0.006 * AIR.normal_drag * wind**2
    tension = pull / (1.0 + pull / 1e6)  # per slope in the unstretched arc
    decay = math.sqrt(tension / rigidity)

    def error(cells: int) -> float:
        rest = rest_chain(case, cells)
        arc = np.linspace(0.0, length, cells + 1)
        edge = 1.0 - np.cosh(decay * (arc - 0.5 * length)) / math.cosh(0.5 * decay * length)
        exact = load / tension * (0.5 * arc * (length - arc) - rigidity / tension * edge)
        return float(np.max(np.abs(rest.nodes[:, 0] - exact)) / np.max(exact))

    coarse, fine = error(80), error(160)
    assert fine < 6e-6
    assert math.log2(coarse / fine) == pytest.approx(2.0, abs=0.15)
