"""Statics against the closed form of the elastic catenary (Irvine 1981) and against equilibrium itself."""

from __future__ import annotations

import math

import numpy as np
import pytest

from tethertest.errors import DataError
from tethertest.records.cable import Air, Cable
from tethertest.records.scene import Bottom, Geometry, Output, Scene, Top
from tethertest.solver.statics.catenary_shape import (
    catenary_between,
    catenary_of_rest_length,
    shallow_catenary,
)
from tethertest.solver.statics.equilibrium import rest_chain

WEIGHT = np.array([0.0, -0.4747])


def irvine(
    level: float, climb: float, arc: float, length: float, stiffness: float, weight: float
) -> np.ndarray:
    """Position of a cable whose lower end is pulled back with (-level, -climb), as printed, z upwards."""
    total, passed = weight * length, weight * arc
    high, low = (climb + passed) / level, climb / level
    x = level * arc / stiffness + level * length / total * (math.asinh(high) - math.asinh(low))
    z = (climb * arc + 0.5 * passed * arc) / stiffness
    z += level * length / total * (math.sqrt(1.0 + high**2) - math.sqrt(1.0 + low**2))
    return np.array([x, z])


@pytest.mark.parametrize(("level", "climb"), [(50.0, -35.0), (50.0, 40.0), (0.5, -60.0), (80.0, 0.0)])
@pytest.mark.parametrize("stiffness", [120.17, 10020.0, 410020.0])
def test_ends_of_irvines_catenary_give_back_its_end_force(
    level: float, climb: float, stiffness: float
) -> None:
    chord = irvine(level, climb, 150.0, 150.0, stiffness, 0.4747)
    shape = catenary_between(chord, 150.0, stiffness, WEIGHT)
    assert shape.start_force == pytest.approx([level, climb], rel=1e-7)
    np.testing.assert_allclose(
        shape.position(np.array([60.0]))[0], irvine(level, climb, 60.0, 150.0, stiffness, 0.4747), atol=1e-8
    )


def test_random_cables_from_taut_to_slack_and_level_to_upright_close() -> None:
    random = np.random.default_rng(3)
    for _ in range(300):
        length, stiffness = 10.0 ** random.uniform(0, 3), 10.0 ** random.uniform(1.5, 6)
        span = length * random.choice([random.uniform(0.05, 1), 1 - 10.0 ** random.uniform(-7, -2), 1.3])
        angle = random.choice([0.0, 0.5 * math.pi, -0.5 * math.pi, random.uniform(-math.pi, math.pi)])
        chord = span * np.array([math.cos(angle), math.sin(angle)])
        load = 10.0 ** random.uniform(-4, 1) * np.array([random.choice([0.0, 0.7]), -1.0])
        shape = catenary_between(chord, length, stiffness, load)
        np.testing.assert_allclose(shape.position(np.array([length]))[0], chord, atol=1e-9 * length)


def test_mirrored_and_turned_cables_are_the_same_cable() -> None:
    shape = catenary_between(np.array([100.0, 60.0]), 130.0, 1e4, WEIGHT)
    mirrored = catenary_between(np.array([-100.0, 60.0]), 130.0, 1e4, WEIGHT)
    assert mirrored.start_force == pytest.approx(shape.start_force * [-1.0, 1.0], rel=1e-10)
    turned = catenary_between(np.array([-60.0, 100.0]), 130.0, 1e4, np.array([0.4747, 0.0]))
    assert turned.start_force == pytest.approx([-shape.start_force[1], shape.start_force[0]], rel=1e-10)


def test_upright_cable_carries_its_weight_and_a_folded_one_hangs() -> None:
    taut = catenary_between(np.array([0.0, 152.0]), 150.0, 10020.0, WEIGHT)
    assert taut.tension(np.array([0.0, 150.0])) @ [-1.0, 1.0] == pytest.approx(0.4747 * 150.0, rel=1e-12)
    folded = catenary_between(np.array([0.0, 50.0]), 150.0, 1e7, WEIGHT)
    assert folded.start_force == pytest.approx(
        [0.0, -0.4747 * 50.0], rel=1e-4
    )  # 50 m hang from the lower end


def test_condition_1_1_at_rest() -> None:
    """250 m and 5 kg at rest under 80 N: 149.16 m and 0.03352 kg/m unstretched, a mean strain of 0.676."""
    shape = shallow_catenary(250.0, "equilibrium", 0.02, 120.17, 80.0, 9.81)
    assert shape.length == pytest.approx(149.16, abs=5e-3)
    assert -shape.load[1] / 9.81 == pytest.approx(0.03352, abs=5e-6)
    assert shape.stretched_length == pytest.approx(250.0, rel=1e-12)
    end = shape.position(np.array([shape.length]))[0]
    assert end[1] == pytest.approx(0.0, abs=1e-10)
    again = catenary_of_rest_length(end, 250.0, 120.17, shape.load * shape.length)
    assert again.length == pytest.approx(shape.length, rel=1e-10)
    assert again.start_force == pytest.approx([80.0, -0.5 * 250 * 0.02 * 9.81], rel=1e-9)
    direct = catenary_between(end, shape.length, 120.17, shape.load)
    assert direct.start_force == pytest.approx(shape.start_force, rel=1e-9)


@pytest.mark.parametrize(
    ("chord", "load", "words"),
    [([500.0, 0.0], WEIGHT, "apart"), ([90.0, 0.0], np.zeros(2), "without load")],
)
def test_ends_without_rest_are_an_error_with_a_remedy(
    chord: list[float], load: np.ndarray, words: str
) -> None:
    with pytest.raises(DataError, match=words) as caught:
        catenary_between(np.array(chord), 150.0, 1e4, load)
    assert caught.value.remedy


def test_a_length_at_rest_below_the_distance_of_the_ends_is_an_error() -> None:
    with pytest.raises(DataError, match="at rest"):
        catenary_of_rest_length(np.array([100.0, 0.0]), 99.0, 1e4, np.array([0.0, -10.0]))


def ends(top: tuple[float, float], wind: float = 0.0) -> Scene:
    return Scene(
        name="144 m between ends",
        cable=Cable(144.0, "unstretched", 0.048, axial_stiffness=410020.0, diameter=0.006),
        geometry=Geometry("ends", top=top),
        bottom=Bottom("fixed"),
        top=Top("fixed"),
        output=Output(1.0, 1.0, (0.0, 1.0)),
        air=Air(1.225, 1.2, 0.0, wind=wind),
        gravity=9.80665,
    )


def test_chain_tends_to_the_catenary_with_the_square_of_the_cell() -> None:
    chord = np.array([110.0, 90.0])
    shape = catenary_between(chord, 144.0, 410020.0, np.array([0.0, -0.048 * 9.80665]))
    errors = []
    for cells in (20, 40, 80):
        rest = rest_chain(ends((110.0, 90.0)), cells)
        assert np.hypot(rest.nodes[-1, 0] - 110.0, rest.nodes[-1, 2] - 90.0) < 1e-9
        loads = np.diff(rest.force, axis=0)
        assert loads == pytest.approx(
            np.tile([0.0, 0.0, 0.048 * 9.80665 * 144.0 / cells], (cells - 1, 1)), abs=1e-9
        )
        errors.append(float(np.linalg.norm(rest.start_force[[0, 2]] - shape.start_force)))
    assert np.log2(np.array(errors[:-1]) / errors[1:]) == pytest.approx(2.0, abs=0.1)


def test_wind_bows_a_taut_level_cable_like_a_side_load() -> None:
    """A vertical taut cable in a side wind: the drag of a nearly straight cable is uniform."""
    drag, wind = 0.5 * 1.225 * 1.2 * 0.006, 3.0
    rest = rest_chain(ends((0.0, 144.4), wind), 40)
    blown = catenary_between(
        np.array([0.0, 144.4]), 144.0, 410020.0, np.array([drag * wind**2, -0.048 * 9.80665])
    )
    assert rest.start_force[[0, 2]] == pytest.approx(blown.start_force, rel=2e-3)
    assert rest.nodes[20, 0] == pytest.approx(blown.position(np.array([72.0]))[0][0], rel=5e-3)
    assert rest.nodes[20, 0] > 0.0
