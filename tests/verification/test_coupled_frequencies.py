"""Natural frequencies of the coupled cable against the paper's conditions, collocation and Irvine-Caughey."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import eigh_tridiagonal, expm

from tests.verification.closed_forms import (
    hanging_frequencies,
    irvine_caughey_frequencies,
    irvine_caughey_roots,
    irvine_parameter,
)
from tethertest.records.arrays import FloatArray
from tethertest.records.cable import Cable
from tethertest.records.scene import Bottom, Geometry, Output, Scene, Top
from tethertest.solver.linear.coupled import (
    CoupledCable,
    EndBody,
    system_matrix,
    undamped_transfer,
    wave_number_squares,
)
from tethertest.solver.modal.coupled_modes import (
    coupled_modes,
    in_plane_count,
    in_plane_frequencies,
    in_plane_modes,
    out_of_plane_frequencies,
)

#: tension N, length m, Young's modulus Pa, diameter mm, five frequencies Hz
CONDITIONS = {
    "1.1": (80.0, 250.0, 1.7e7, 3.0, [0.12996, 0.19341, 0.26012, 0.36615, 0.41391]),
    "1.2": (80.0, 200.0, 1.7e7, 3.0, [0.16091, 0.24452, 0.32218, 0.46230, 0.51259]),
    "1.3": (160.0, 250.0, 1.7e7, 3.0, [0.17956, 0.23576, 0.35886, 0.47122, 0.53900]),
    "1.4": (80.0, 250.0, 1.7e8, 3.0, [0.15343, 0.24546, 0.37773, 0.49162, 0.52924]),
    "1.5": (80.0, 250.0, 1.7e7, 12.0, [0.16695, 0.24614, 0.37868, 0.50104, 0.63096]),
}


def condition(name: str) -> CoupledCable:
    tension, length, modulus, diameter, _ = CONDITIONS[name]
    stiffness = modulus * math.pi * (1e-3 * diameter) ** 2 / 4.0
    return CoupledCable(length, 0.02, tension, stiffness, 0.02 * 9.81 / tension)


def of_speeds(ratio: float, bend: float, length: float = 100.0) -> CoupledCable:
    """Cable with ct = 50 m/s, c1 = ratio x ct and curvature x length = bend."""
    return CoupledCable(length, 0.04, 100.0, 100.0 * (ratio**2 - 1.0), bend / length)


def collocation_frequencies(cable: CoupledCable, points: int, count: int) -> FloatArray:
    """Chebyshev collocation of the second-order equations in (u1, u2): another discretisation."""
    node = np.cos(np.pi * np.arange(points + 1) / points)
    weight = np.ones(points + 1)
    weight[[0, -1]] = 2.0
    weight *= (-1.0) ** np.arange(points + 1)
    gap = node[:, None] - node[None, :] + np.eye(points + 1)
    slope = weight[:, None] / weight[None, :] / gap
    slope -= np.diag(np.sum(slope, axis=1))
    slope *= 2.0 / cable.length
    one, bend = np.eye(points + 1), cable.curvature
    axial, transverse = cable.axial_square, cable.transverse_square
    first, second = np.hstack([slope, -bend * one]), np.hstack([bend * one, slope])
    operator = np.vstack(
        [
            axial * slope @ first - bend * transverse * second,
            transverse * slope @ second + bend * axial * first,
        ]
    )
    inside = np.r_[1:points, points + 2 : 2 * points + 1]
    squares = np.sort(-np.linalg.eigvals(operator[np.ix_(inside, inside)]).real)
    return np.asarray(np.sqrt(squares[:count]) / (2.0 * np.pi))


@pytest.mark.parametrize("name", CONDITIONS)
def test_conditions_of_the_paper_to_five_digits(name: str) -> None:
    assert in_plane_frequencies(condition(name)) == pytest.approx(CONDITIONS[name][-1], abs=0.51e-5)


@pytest.mark.parametrize("name", ["1.1", "1.4"])
def test_chebyshev_collocation_agrees_to_nine_digits(name: str) -> None:
    cable = condition(name)
    assert in_plane_frequencies(cable, 10) == pytest.approx(collocation_frequencies(cable, 48, 10), rel=1e-9)


@pytest.mark.parametrize(("ratio", "bend"), [(2.0, 1e-6), (2.0, 1e-3), (3.0, 1e-4), (1.3, 1.0), (20.0, 0.6)])
def test_close_pairs_are_told_apart(ratio: float, bend: float) -> None:
    cable = of_speeds(ratio, bend)
    found = in_plane_frequencies(cable, 12)
    assert found == pytest.approx(collocation_frequencies(cable, 56, 12), rel=1e-8)
    for frequency, number in zip(found, range(1, 13), strict=True):
        assert in_plane_count(cable, np.array([frequency * (1 + 1e-12)]))[0] >= number


def test_without_curvature_the_string_and_the_rod_stand_side_by_side() -> None:
    """c1 = 2 ct: every second frequency of the string is also one of the rod, and is listed twice."""
    cable = of_speeds(2.0, 0.0)
    string = 0.25
    assert in_plane_frequencies(cable, 6) == pytest.approx(string * np.array([1, 2, 2, 3, 4, 4]), rel=1e-12)
    shares = [mode.axial_share for mode in in_plane_modes(cable, 3)]
    assert shares[0] == pytest.approx(0.0, abs=1e-12)
    assert sum(shares[1:]) == pytest.approx(1.0, abs=1e-9)
    assert out_of_plane_frequencies(cable, 2) == pytest.approx([0.25, 0.5])


@pytest.mark.parametrize("name", CONDITIONS)
def test_the_cut_off_is_no_natural_frequency(name: str) -> None:
    """A search for zeros of the determinant in the basis of waves finds kappa ct/2 pi as well."""
    cable = condition(name)
    for speed in (cable.transverse_speed, cable.axial_speed):
        cut_off = cable.curvature * speed / (2.0 * np.pi)
        below, above = in_plane_count(cable, cut_off * np.array([1 - 1e-9, 1 + 1e-9]))
        assert below == above


def test_shapes_hold_at_the_ends_and_are_orthogonal() -> None:
    modes = in_plane_modes(condition("1.1"), 5, stations=2001)
    fields = np.array([np.concatenate([mode.tangential, mode.normal]) for mode in modes])
    for mode in modes:
        ends = [mode.tangential[0], mode.tangential[-1], mode.normal[0], mode.normal[-1]]
        assert ends == pytest.approx([0.0] * 4, abs=1e-9)
        assert max(np.max(np.abs(mode.tangential)), np.max(np.abs(mode.normal))) == pytest.approx(1.0)
    gram = fields @ fields.T
    size = np.sqrt(np.diag(gram))
    assert gram / np.outer(size, size) == pytest.approx(np.eye(5), abs=1e-5)
    assert [mode.axial_share for mode in modes[:2]] == pytest.approx([0.004, 0.896], abs=1e-3)


def test_dispersion_relation_and_its_cut_offs() -> None:
    cable = condition("1.1")
    angular = np.array([0.05, 0.2, 0.5, 3.0, 40.0])
    axial, transverse, bend = cable.axial_square, cable.transverse_square, cable.curvature**2
    for square in -wave_number_squares(cable, 1j * angular).real:
        terms = np.array(
            [
                axial * transverse * square**2,
                -square * ((axial + transverse) * angular**2 + 2.0 * axial * transverse * bend),
                (angular**2 - transverse * bend) * (angular**2 - axial * bend),
            ]
        )
        assert np.sum(terms, axis=0) / np.max(np.abs(terms), axis=0) == pytest.approx(0.0, abs=1e-12)
    cut_offs = cable.curvature * np.array([cable.transverse_speed, cable.axial_speed])
    assert wave_number_squares(cable, 1j * cut_offs)[1] == pytest.approx(0.0, abs=1e-15)


def test_closed_form_transfer_is_the_matrix_exponential() -> None:
    cable = condition("1.1")
    angular = np.array([0.1, cable.curvature * cable.transverse_speed, 0.9, 4.0])
    found = undamped_transfer(cable, angular, cable.length)
    for index, matrix in enumerate(system_matrix(cable, 1j * angular)):
        exact = expm(matrix * cable.length).real
        np.testing.assert_allclose(found[index], exact, rtol=1e-9, atol=1e-11 * np.max(np.abs(exact)))


def test_irvine_caughey_roots_are_the_published_ones() -> None:
    parameters = [1.0, 10.0, 4 * np.pi**2, 100.0, 16 * np.pi**2]
    found = [irvine_caughey_roots(parameter, 1)[0] / np.pi for parameter in parameters]
    assert found == pytest.approx([1.040200, 1.345125, 2.0, 2.597185, 2.737486], abs=1e-6)


@pytest.mark.parametrize("parameter", [1.0, 10.0, 100.0])
def test_a_stiff_flat_cable_is_that_of_irvine_and_caughey(parameter: float) -> None:
    """Axial waves 1000 times as fast: what the shallow-cable theory leaves out is of the order 1e-6."""
    cable = of_speeds(1000.0, math.sqrt(parameter) / 1000.0)
    assert irvine_parameter(cable) == pytest.approx(parameter, rel=1e-4)
    assert in_plane_frequencies(cable, 6) == pytest.approx(irvine_caughey_frequencies(cable, 6), rel=2e-5)


def test_a_body_on_a_straight_cable_is_the_rod_with_a_tip_mass() -> None:
    """Axial: x tan x = cable mass/body mass; lateral: x tan x = (rl L/M) as well, x = w L/c."""
    cable = of_speeds(4.0, 0.0)
    mass = 1.7
    found = in_plane_frequencies(cable, 5, EndBody(mass))
    for frequency in found:
        phases = (
            2.0 * np.pi * frequency * cable.length / np.array([cable.transverse_speed, cable.axial_speed])
        )
        residuals = np.abs(
            np.sin(phases) * phases - cable.mass_per_length * cable.length / mass * np.cos(phases)
        )
        assert np.min(residuals) < 1e-9
    held = in_plane_frequencies(of_speeds(4.0, 0.3), 5, EndBody(1e9))  # the body itself barely moves
    assert held[2:] == pytest.approx(in_plane_frequencies(of_speeds(4.0, 0.3), 3), rel=1e-6)


def test_out_of_plane_a_body_is_the_tip_mass_of_a_string() -> None:
    cable = of_speeds(4.0, 0.3)
    found = out_of_plane_frequencies(cable, 4, mass=1.7, stiffness=20.0)
    flat = in_plane_frequencies(of_speeds(4.0, 0.0), 12, EndBody(1.7, ((1e-9, 0.0), (0.0, 20.0))))
    for frequency in found:  # without curvature the normal motion obeys the same equation
        assert np.min(np.abs(flat / frequency - 1.0)) < 1e-12
    assert out_of_plane_frequencies(cable, 4, mass=1e9)[1:] == pytest.approx(
        out_of_plane_frequencies(cable, 3), rel=1e-6
    )


def test_a_shallow_scene_names_its_modes() -> None:
    scene = Scene(
        name="paper 1.1",
        cable=Cable(250.0, "equilibrium", 0.02, youngs_modulus=1.7e7, diameter=3e-3),
        geometry=Geometry("shallow", tension=80.0),
        bottom=Bottom("fixed"),
        top=Top("fixed"),
        output=Output(1.0, 30.0, (1.0,)),
        gravity=9.81,
    )
    found = {mode.name: mode.frequency for mode in coupled_modes(scene, 2).frequencies}
    string = math.sqrt(80.0 / 0.02) / 500.0
    expected = {
        "in-plane 1": 0.12996,
        "in-plane 2": 0.19341,
        "out-of-plane 1": string,
        "out-of-plane 2": 2 * string,
    }
    assert found == pytest.approx(expected, abs=0.51e-5)
    held = replace(scene, top=Top("platform", mass=0.5, hover_stiffness=(1e9, 1e9)))
    assert coupled_modes(held, 2).frequencies[0].frequency == pytest.approx(0.12996, abs=0.51e-5)


def test_hanging_cable_meets_a_fine_chain_and_the_stretched_string() -> None:
    tension, weight, length, gravity, cells = 5.0, 0.0484 * 9.80665, 30.0, 9.80665, 4000
    cell = length / cells
    link = (tension + weight * cell * (np.arange(cells) + 0.5)) / cell
    scale = weight / gravity * cell
    squares = eigh_tridiagonal(
        (link[:-1] + link[1:]) / scale,
        -link[1:-1] / scale,
        eigvals_only=True,
        select="i",
        select_range=(0, 4),
    )
    chain = np.sqrt(squares) / (2.0 * np.pi)
    assert hanging_frequencies(tension, weight, length) == pytest.approx(chain, rel=2e-6)
    taut = hanging_frequencies(1e6 * weight, weight, length, 3)
    string = np.arange(1, 4) * math.sqrt(1e6 * gravity) / (2.0 * length)
    assert taut == pytest.approx(string, rel=1e-4)
