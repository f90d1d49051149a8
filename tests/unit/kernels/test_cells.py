"""Forces in cells and at nodes against direct formulas, dense algebra and energy."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from tethertest.kernels import cells
from tethertest.records.arrays import FloatArray

Run = Callable[[Any], Any]


def units(vectors: FloatArray) -> FloatArray:
    return np.asarray(vectors / np.linalg.norm(vectors, axis=0))


def stretched(run: Run, position: FloatArray, cell: float, before: FloatArray) -> tuple[FloatArray, ...]:
    """Stretch, increments and unit vectors of a chain's cells."""
    n = position.shape[1] - 1
    stretch, rate, along = before.copy(), np.zeros(n + 2), np.zeros((position.shape[0], n))
    run(cells.stretch_cells)(position, 1.0 / cell, stretch, rate, along)
    return stretch, rate, along


@pytest.mark.parametrize("d", [1, 2, 3])
def test_stretch_is_length_over_cell_and_its_ghosts_repeat_the_second_cells(run: Run, d: int) -> None:
    random = np.random.default_rng(d)
    steps = np.abs(random.normal(size=(d, 6))) + 0.1
    position = np.concatenate([np.zeros((d, 1)), np.cumsum(steps, axis=1)], axis=1)
    before = random.uniform(0.9, 1.1, 6)
    stretch, rate, along = stretched(run, position, 0.5, before)
    np.testing.assert_allclose(stretch, np.linalg.norm(steps, axis=0) / 0.5, rtol=1e-14)
    np.testing.assert_allclose(along, units(steps), rtol=1e-13)
    np.testing.assert_array_equal(rate[1:-1], stretch - before)
    assert (rate[0], rate[-1]) == (rate[2], rate[-3])


def test_a_folded_cell_has_negative_stretch_on_a_line_and_turns_over_in_a_plane(run: Run) -> None:
    line = np.array([[0.0, 1.0, 0.4, 1.5]])
    stretch, _, along = stretched(run, line, 0.5, np.ones(3))
    np.testing.assert_allclose(stretch, [2.0, -1.2, 2.2])
    np.testing.assert_array_equal(along, np.ones((1, 3)))
    for d in (2, 3):
        space = np.zeros((d, 4))
        space[-1] = line
        stretch, _, along = stretched(run, space, 0.5, np.ones(3))
        np.testing.assert_allclose(stretch, [2.0, 1.2, 2.2])
        np.testing.assert_allclose(along[-1], [1.0, -1.0, 1.0])


def test_cells_of_no_length_have_no_direction_and_no_tension(run: Run) -> None:
    stretch, rate, along = stretched(run, np.zeros((2, 4)), 0.5, np.ones(3))
    tension = np.full(5, 9.0)
    run(cells.pull_cells)(stretch, rate, 100.0, 50.0, 20.0, tension)
    assert not np.any(along)
    np.testing.assert_array_equal(tension[1:-1], 0.0)


def pulled(run: Run, strain: float, below: float, centre: float, above: float) -> float:
    """Tension of a cell under EA = 100 N, damping 2 N and viscosity 10 N per increment."""
    tension = np.full(3, np.nan)
    run(cells.pull_cells)(
        np.array([1.0 + strain]), np.array([below, centre, above]), 100.0, 2.0, 10.0, tension
    )
    return float(tension[1])


@pytest.mark.parametrize("centre", [-3.0, 0.0, 3.0])
def test_slack_carries_no_force_at_all_however_fast_it_stretches(run: Run, centre: float) -> None:
    assert pulled(run, -1e-12, 0.0, centre, 0.0) == 0.0
    assert pulled(run, 0.0, 0.0, centre, 0.0) == 0.0


def test_a_taut_cell_that_shortens_fast_does_not_push(run: Run) -> None:
    assert pulled(run, 0.01, -1.0, -1.0, -1.0) == 0.0  # 1 N of elastic pull, 2 N of damping


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(
    ("neighbours", "excess"),
    [
        ((2.0, 4.0), 0.0),  # evenly growing
        ((1.0, 5.0), 1.0),  # too steeply: limited by twice the smaller neighbour
        ((3.0, 3.0), 0.0),  # even
        ((2.0, 3.0), 0.5),  # above the neighbours' mean of 2.5
        ((0.4, 3.0), 2.2),
        ((3.0, 0.4), 2.2),
        ((-1.0, 6.0), 3.0),  # neighbours disagree
        ((0.0, 0.0), 3.0),  # a front
    ],
)
def test_viscosity_acts_on_what_the_neighbours_do_not_explain(
    run: Run, neighbours: tuple[float, float], excess: float, sign: float
) -> None:
    found = pulled(run, 10.0, sign * neighbours[0], sign * 3.0, sign * neighbours[1])
    assert found == pytest.approx(1000.0 + sign * (2.0 * 3.0 + 10.0 * excess))


def test_the_elastic_pull_is_that_without_damping_and_viscosity(run: Run) -> None:
    random = np.random.default_rng(4)
    stretch, rate, along = (
        random.uniform(0.9, 1.2, 40),
        random.normal(size=42),
        units(random.normal(size=(3, 40))),
    )
    whole, elastic, force = np.zeros(42), np.zeros(42), np.zeros((3, 40))
    run(cells.pull_cells)(stretch, rate, 100.0, 0.0, 0.0, whole)
    run(cells.pull_cells_elastic)(stretch, 100.0, along, elastic, force)
    np.testing.assert_array_equal(elastic, whole)
    np.testing.assert_allclose(elastic[1:-1], 100.0 * np.maximum(stretch - 1.0, 0.0), rtol=1e-13)
    np.testing.assert_array_equal(force, along * elastic[1:-1])
    assert 0 < np.count_nonzero(elastic) < 40


def blown(run: Run, along: FloatArray, velocity: FloatArray, wind: FloatArray, cell: float) -> FloatArray:
    d, nodes = velocity.shape
    load = np.full((d, nodes), np.nan)
    scratch = (np.zeros((d, nodes)), np.zeros(nodes), np.zeros(nodes), np.zeros(nodes))
    run(cells.drag_nodes)(along, velocity, wind, 0.25, 0.5, cell, *scratch, load)
    return load


def test_drag_pushes_with_the_wind_and_splits_into_normal_and_tangential(run: Run) -> None:
    """A cable along (0.6, 0.8): 5 m/s of wind is 3 m/s along and 4 m/s across."""
    along = np.tile([[0.6], [0.8]], (1, 4))
    load = blown(run, along, np.zeros((2, 5)), np.array([5.0, 0.0]), 1.0)
    normal, tangential = 0.25 * 16.0, 0.5 * 9.0
    share = np.array([0.5, 1.0, 1.0, 1.0, 0.5])  # an end has half a cell
    np.testing.assert_allclose(load[0], share * (normal * 0.8 + tangential * 0.6))
    np.testing.assert_allclose(load[1], share * (-normal * 0.6 + tangential * 0.8))
    moving = blown(run, along, np.tile([[5.0], [0.0]], (1, 5)), np.zeros(2), 1.0)
    np.testing.assert_allclose(moving, -load)  # motion through still air is resisted


@pytest.mark.parametrize("d", [1, 2, 3])
def test_drag_of_a_bent_moving_cable_is_morisons_node_by_node(run: Run, d: int) -> None:
    random = np.random.default_rng(10 + d)
    along, velocity, wind = (
        units(random.normal(size=(d, 7))),
        random.normal(size=(d, 8)),
        random.normal(size=d),
    )
    if d == 1:
        along = np.ones((1, 7))
    load = blown(run, along, velocity, wind, 0.3)
    for node in range(8):
        total = along[:, max(node - 1, 0) : node + 1].sum(axis=1)
        tangent = total / np.linalg.norm(total)
        relative = wind - velocity[:, node]
        past = relative @ tangent
        across = relative - past * tangent
        force = 0.25 * np.linalg.norm(across) * across + 0.5 * abs(past) * past * tangent
        share = 0.5 if node in (0, 7) else 1.0
        np.testing.assert_allclose(load[:, node], 0.3 * share * force, rtol=1e-12, atol=1e-15)


def bent(run: Run, position: FloatArray, stiffness: float) -> FloatArray:
    force = np.zeros_like(position)
    run(cells.bend_nodes)(position, stiffness, np.zeros(position.shape[1]), force)
    return force


@pytest.mark.parametrize("d", [1, 2, 3])
def test_bending_is_the_slope_of_its_energy_and_pushes_nothing_as_a_whole(run: Run, d: int) -> None:
    position = np.random.default_rng(20 + d).normal(size=(d, 8))
    force = bent(run, position, 3.0)
    second = np.diff(np.eye(8), n=2, axis=0)  # E = stiffness/2 |second x|^2, hinged ends
    np.testing.assert_allclose(force, -3.0 * position @ second.T @ second, rtol=1e-12, atol=1e-13)
    np.testing.assert_allclose(force.sum(axis=1), 0.0, atol=1e-13)
    np.testing.assert_allclose(force @ np.arange(8.0), 0.0, atol=1e-12)  # nor does it turn anything


def test_bending_straightens_a_kink_and_adds_to_what_is_there(run: Run) -> None:
    position = np.array([[0.0, 0.0, 1.0, 0.0, 0.0]])
    np.testing.assert_allclose(bent(run, position, 2.0), 2.0 * np.array([[-1.0, 4.0, -6.0, 4.0, -1.0]]))
    force = np.full((1, 5), 7.0)
    run(cells.bend_nodes)(position, 2.0, np.zeros(5), force)
    np.testing.assert_allclose(force - 7.0, bent(run, position, 2.0))
    assert not np.any(bent(run, np.arange(10.0).reshape(2, 5), 2.0))  # a straight cable is not bent


class Damped:
    """A random chain before and after implicit damping; the first node is held, or moves as prescribed."""

    def __init__(
        self, run: Run, seed: int, d: int, held_top: bool, gain: float, lag: float, slack: float
    ) -> None:
        random = np.random.default_rng(seed)
        self.n, self.share, self.gain = 9, 0.2, gain
        self.along = np.ones((1, 9)) if d == 1 else units(random.normal(size=(d, 9)))
        self.velocity = random.normal(size=(d, 10))
        self.velocity[:, 0] = 0.0
        self.rate = 0.1 * random.normal(size=11)
        self.end_share = np.zeros(d) if held_top else random.uniform(0.01, 0.1, d)
        self.tension = np.zeros(11)
        self.tension[1:-1] = random.uniform(0.5, 4.0, 9) * (random.uniform(size=9) >= slack)
        if slack == 0.0:
            self.tension[1:-1] += 3.0  # enough that none is left without
        self.after, self.pull = self.velocity.copy(), self.tension.copy()
        self.force = self.along * self.tension[1:-1]
        work = np.full((5, 9), np.nan)
        run(cells.damp_cells)(
            self.along,
            self.after,
            self.rate,
            gain,
            lag,
            self.share,
            self.end_share,
            work,
            self.pull,
            self.force,
        )
        self.damping = (self.pull - self.tension)[1:-1]
        self.wanted = np.sum(self.along * np.diff(self.velocity, axis=1), axis=0) + lag * self.rate[1:-1]
        self.left = np.sum(self.along * np.diff(self.after, axis=1), axis=0) + lag * self.rate[1:-1]

    def matrix(self) -> FloatArray:
        """Rate of stretch that unit damping forces take away: B M B' with B the cells' gradient."""
        d = self.along.shape[0]
        gradient = np.zeros((9, d, 10))
        for i in range(9):
            gradient[i, :, i + 1], gradient[i, :, i] = self.along[:, i], -self.along[:, i]
        inverse_mass = np.full((d, 10), self.share)
        inverse_mass[:, 0], inverse_mass[:, 9] = 0.0, self.end_share
        return np.asarray(np.einsum("icm,cm,jcm->ij", gradient, inverse_mass, gradient))

    def energy(self, velocity: FloatArray) -> float:
        moving = self.end_share > 0.0
        end = np.sum(velocity[moving, 9] ** 2 / self.end_share[moving])
        return float(0.5 * np.sum(velocity[:, 1:9] ** 2) / self.share + 0.5 * end)


@pytest.mark.parametrize("d", [1, 2, 3])
@pytest.mark.parametrize("held_top", [True, False])
@pytest.mark.parametrize("lag", [0.0, 0.7])
def test_damping_of_a_taut_chain_is_the_dense_solution(run: Run, d: int, held_top: bool, lag: float) -> None:
    case = Damped(run, d, d, held_top, 0.3, lag, slack=0.0)
    expected = np.linalg.solve(np.eye(9) / 0.3 + case.matrix(), case.wanted)
    assert np.all(case.tension[1:-1] + expected > 0.0)
    np.testing.assert_allclose(case.damping, expected, rtol=1e-11)
    np.testing.assert_allclose(case.damping, 0.3 * case.left, rtol=1e-11)  # it resists the rate that is left
    np.testing.assert_allclose(case.force, case.along * case.pull[1:-1], rtol=1e-12)


@pytest.mark.parametrize("seed", range(30))
@pytest.mark.parametrize("gain", [0.1, 5.0, 1e4])
def test_slack_cells_carry_nothing_none_pushes_and_energy_never_grows(
    run: Run, seed: int, gain: float
) -> None:
    case = Damped(run, seed, 1 + seed % 3, seed % 2 == 0, gain, 0.0, slack=0.3)
    slack = case.tension[1:-1] == 0.0
    assert np.all(case.pull[1:-1][slack] == 0.0)
    assert np.all(case.pull >= 0.0)
    assert np.all(case.pull[[0, -1]] == 0.0)  # the ends' tension is the march's own affair
    np.testing.assert_allclose(case.force, case.along * case.pull[1:-1], atol=1e-12)
    assert case.energy(case.after) <= case.energy(case.velocity) * (1.0 + 1e-12)
    # what moved is what the forces moved
    pushes = np.zeros_like(case.velocity)
    pushes[:, :-1] += case.along * case.damping
    pushes[:, 1:] -= case.along * case.damping
    np.testing.assert_allclose((case.after - case.velocity)[:, 1:9], case.share * pushes[:, 1:9], atol=1e-12)
    np.testing.assert_allclose((case.after - case.velocity)[:, 9], case.end_share * pushes[:, 9], atol=1e-12)
    np.testing.assert_array_equal(case.after[:, 0], 0.0)


def test_a_cell_that_damping_would_push_is_left_without_tension(run: Run) -> None:
    """One cell under a free end that flies towards the bottom: 2 N of pull cannot become a push."""
    for tension, expected in ((2.0, 0.0), (100.0, 100.0 - 6.0 / (1.0 / 3.0 + 0.1))):
        pull, force, after = np.array([0.0, tension, 0.0]), np.array([[tension]]), np.array([[0.0, -6.0]])
        run(cells.damp_cells)(
            np.ones((1, 1)), after, np.zeros(3), 3.0, 0.0, 0.5, np.array([0.1]), np.zeros((5, 1)), pull, force
        )
        assert pull[1] == pytest.approx(expected)
        assert force[0, 0] == pytest.approx(expected)
        assert after[0, 1] == pytest.approx(-6.0 + 0.1 * (tension - expected))
