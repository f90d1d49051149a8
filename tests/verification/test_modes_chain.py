"""Natural frequencies of the chain against Irvine-Caughey, Bessel, the coupled cable, beams and the rig's."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

from tests.verification.closed_forms import hanging_frequencies, irvine_caughey_roots
from tethertest.records.cable import Air, Cable
from tethertest.records.scene import Bottom, Geometry, Output, Scene, Top
from tethertest.solver.linear.coupled import CoupledCable
from tethertest.solver.modal.chain_modes import lowest_frequencies
from tethertest.solver.modal.coupled_modes import (
    in_plane_frequencies,
)
from tethertest.solver.modal.modes import modes
from tethertest.solver.statics.equilibrium import rest_chain

GRAVITY = 9.80665
RIG_CABLE = Cable(3.0, "unstretched", 0.0484, axial_stiffness=10020.0, diameter=0.006)
RIG = Top("platform", mass=0.4, static_tension=5.0)
TETHER = Cable(144.0, "unstretched", 0.048, axial_stiffness=410020.0, diameter=0.006)
AIR = Air(density=1.225, normal_drag=1.2, tangential_drag=0.01)


def scene(cable: Cable, geometry: Geometry, top: Top | None = None, air: Air | None = None) -> Scene:
    end = Top("fixed") if top is None else top
    output = Output(1.0, 10.0, (0.0, 1.0))
    return Scene("modes", cable, geometry, Bottom("fixed"), end, output, air=air)


def named(case: Scene, name: str, count: int = 3) -> list[float]:
    return [mode.frequency for mode in modes(case, count).frequencies if mode.name.startswith(name)]


def level_cable(bend: float, stiffness: float, tension: float = 100.0, length: float = 100.0) -> Scene:
    """Level ends, as far apart as a cable of that level tension, weight ``bend x tension`` and length has."""
    weight = bend * tension / length
    cable = Cable(length, "unstretched", weight / GRAVITY, axial_stiffness=stiffness)
    half = 0.5 * bend
    span = 2.0 * tension / weight * math.asinh(half) + tension * length / stiffness
    return scene(cable, Geometry("ends", top=(span, 0.0)))


@pytest.mark.parametrize(
    ("parameter", "first_root"),
    [(1.0, 1.040200), (10.0, 1.345125), (100.0, 2.597185), (16 * math.pi**2, 2.737486)],
)
def test_level_cable_of_small_sag_against_irvine_and_caughey(parameter: float, first_root: float) -> None:
    bend = 0.02
    case = level_cable(bend, parameter * 100.0 / bend**2)
    string = math.sqrt(100.0 / case.cable.mass_per_length) / 200.0
    symmetric = irvine_caughey_roots(parameter, 2) / math.pi
    assert symmetric[0] == pytest.approx(first_root, rel=1e-6)
    expected = np.sort([*symmetric, 2.0, 4.0])[:3]
    assert np.array(named(case, "in-plane")) / string == pytest.approx(expected, rel=1e-3)
    assert np.array(named(case, "out-of-plane")) / string == pytest.approx(
        [1.0, 2.0, 3.0], rel=3e-4
    )  # strain


@pytest.mark.parametrize("stiffness", [120.0, 1200.0])
def test_level_cable_of_small_sag_against_the_coupled_transfer_matrix(stiffness: float) -> None:
    case = level_cable(0.03, stiffness)
    rest = rest_chain(case, 400)
    tension = float(np.mean(rest.tension))
    stretch = 1.0 + tension / stiffness
    mass = case.cable.mass_per_length / stretch
    coupled = CoupledCable(100.0 * stretch, mass, tension, stiffness, mass * GRAVITY / tension)
    expected = in_plane_frequencies(coupled, 5)
    assert named(case, "in-plane", 5) == pytest.approx(expected, rel=3e-4)


@pytest.mark.parametrize("bottom", [1.0, 10.0, 200.0])
def test_hanging_cable_against_the_roots_of_bessel_functions(bottom: float) -> None:
    cable = Cable(50.0, "unstretched", 0.05, axial_stiffness=1e7)
    expected = hanging_frequencies(bottom, 0.05 * GRAVITY, 50.0, 4)
    found = named(scene(cable, Geometry("vertical", tension=bottom)), "lateral", 4)
    assert found == pytest.approx(expected, rel=1e-4)


def test_rig_with_a_free_platform_swings_at_its_pendulum_frequency() -> None:
    case = scene(RIG_CABLE, Geometry("vertical"), RIG)
    assert named(case, "pendulum") == pytest.approx([0.281], abs=5e-4)
    assert len(named(case, "lateral")) == 2


def test_rig_held_sideways_and_rig_with_a_fixed_top_have_the_published_frequencies() -> None:
    held = scene(RIG_CABLE, Geometry("vertical"), replace(RIG, hover_stiffness=50.0))
    assert named(held, "lateral")[:2] == pytest.approx([1.44, 1.90], abs=5e-3)
    bottom = 5.0 - 3.0 * 0.0484 * GRAVITY
    fixed = scene(RIG_CABLE, Geometry("vertical", tension=bottom))
    assert named(fixed, "lateral")[0] == pytest.approx(1.56, abs=5e-3)
    expected = hanging_frequencies(bottom, 0.0484 * GRAVITY, 3.0, 3)
    assert named(fixed, "lateral") == pytest.approx(expected, rel=6e-4)  # strain of the cable


def test_axial_frequencies_of_a_platform_on_a_cable_against_x_tan_x() -> None:
    case = scene(RIG_CABLE, Geometry("vertical"), RIG)
    ratio = 3.0 * 0.0484 / 0.4
    roots = [
        brentq(lambda x: x * math.sin(x) - ratio * math.cos(x), n * math.pi, (n + 0.5) * math.pi)
        for n in range(3)
    ]
    speed = math.sqrt(10020.0 / 0.0484)
    expected = np.array(roots) * speed / 3.0 / (2.0 * math.pi)
    assert named(case, "axial") == pytest.approx(expected, rel=1e-6)
    assert lowest_frequencies(case)[1] == pytest.approx(expected[0], rel=1e-3)


@pytest.mark.parametrize("rigidity", [0.5, 50.0])
def test_straight_stiff_cable_against_the_beam_in_tension(rigidity: float) -> None:
    cable = Cable(10.0, "unstretched", 0.05, axial_stiffness=1e8, bending_stiffness=rigidity)
    case = scene(cable, Geometry("straight", tension=100.0))
    number = np.arange(1, 4)
    wave = (number * math.pi / 10.0) ** 2
    expected = number / 20.0 * np.sqrt((100.0 + rigidity * wave) / 0.05)
    assert named(case, "lateral") == pytest.approx(expected, rel=2e-6)
    assert lowest_frequencies(case)[0] == pytest.approx(expected[0], rel=1e-3)


@pytest.mark.parametrize("kind", ["ends", "hovering"])
def test_two_ways_to_hold_the_platform_upright_have_the_vertical_cables_frequencies(kind: str) -> None:
    upright = scene(RIG_CABLE, Geometry("vertical"), RIG)
    height = float(rest_chain(upright, 50).nodes[-1, 2])
    geometry = Geometry("hovering") if kind == "hovering" else Geometry("ends", top=(0.0, height))
    case = scene(RIG_CABLE, geometry, RIG)
    lateral = named(upright, "pendulum") + named(upright, "lateral")
    assert named(case, "out-of-plane") == pytest.approx(lateral, rel=1e-5)
    assert named(case, "in-plane")[:3] == pytest.approx(lateral, rel=1e-5)


def test_turning_the_plane_of_the_ends_changes_no_frequency() -> None:
    platform = Top("platform", mass=5.0, hover_stiffness=(100.0, 100.0, 40.0))
    plane = scene(TETHER, Geometry("ends", top=(110.0, 90.0)), platform)
    turned = scene(
        TETHER, Geometry("ends", top=(110.0 * math.cos(0.7), 110.0 * math.sin(0.7), 90.0)), platform
    )
    for name in ("in-plane", "out-of-plane"):
        assert named(turned, name) == pytest.approx(named(plane, name), rel=1e-6)


def test_modes_told_apart_by_energy_are_those_of_the_separate_planes() -> None:
    platform = Top("platform", mass=5.0, hover_stiffness=(100.0, 100.0, 40.0))
    top = (110.0 * math.cos(0.7), 110.0 * math.sin(0.7), 90.0)
    separate = scene(TETHER, Geometry("ends", top=top), platform)
    tied = scene(TETHER, Geometry("ends", top=top), replace(platform, hover_stiffness=(100.0, 100.001, 40.0)))
    for name in ("in-plane", "out-of-plane"):
        assert named(tied, name) == pytest.approx(named(separate, name), rel=1e-5)


def test_wind_that_tightens_a_vertical_cable_raises_its_frequencies_and_names_a_plane() -> None:
    cable = replace(TETHER, axial_stiffness=10020.0)
    still = named(scene(cable, Geometry("vertical", tension=50.0)), "lateral")
    windy = scene(cable, Geometry("vertical", tension=50.0), air=replace(AIR, wind=10.0))
    ratio = math.sqrt(float(np.mean(rest_chain(windy, 100).tension)) / (50.0 + 0.5 * 144.0 * 0.048 * GRAVITY))
    assert np.array(named(windy, "out-of-plane")) / still == pytest.approx(ratio, rel=0.02)


def test_estimate_for_choosing_a_model_is_the_strings_first_frequency_in_wind_and_space() -> None:
    air = replace(AIR, wind=(3.0, -8.0, 1.0))
    platform = Top("platform", mass=5.0)
    case = scene(TETHER, Geometry("ends", top=(110.0, 20.0, 90.0)), platform, air)
    rest = rest_chain(case, 400)
    slowness = np.sqrt(rest.mass / rest.tension)
    transverse, axial = lowest_frequencies(case)
    assert transverse == pytest.approx(0.5 / float(rest.cell * np.sum(slowness)), rel=0.01)
    assert axial == pytest.approx(
        math.sqrt(410020.0 / 144.0 / (5.0 + 144.0 * 0.048 / 3)) / 2 / math.pi, rel=0.03
    )
