"""The transform against d'Alembert, the matrix exponential, a march in time and a rod's closed form."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from tethertest.errors import DataError
from tethertest.records.arrays import FloatArray
from tethertest.records.cable import Cable
from tethertest.records.scene import Bottom, Geometry, MeasuredMotion, Output, Scene, Top
from tethertest.solver.linear.coupled import (
    CoupledCable,
    EndBody,
    coupled_cable,
    end_angle,
    end_body,
    local_direction,
    system_matrix,
)
from tethertest.solver.linear.coupled_solve import solve_coupled
from tethertest.solver.linear.coupled_transfer import strain_transfer
from tethertest.solver.linear.transfer import tension_transfer
from tethertest.solver.linear.transform import exact_response
from tethertest.solver.motion import displacement

GAUGES = (0.0, 0.25, 0.5, 0.75, 1.0)
RAMPED = Bottom("harmonic", amplitude=2.0, frequency=0.18, start="ramp", ramp=10.0)


def paper(bottom: Bottom = RAMPED, duration: float = 68.27, gauges: tuple[float, ...] = GAUGES) -> Scene:
    return Scene(
        name="paper 1.1",
        cable=Cable(250.0, "equilibrium", 0.02, youngs_modulus=1.7e7, diameter=3e-3),
        geometry=Geometry("shallow", tension=80.0),
        bottom=bottom,
        top=Top("fixed"),
        output=Output(duration, 30.0, gauges),
        gravity=9.81,
    )


def relative(found: FloatArray, reference: FloatArray) -> float:
    dynamic = np.sqrt(np.max(np.mean((reference - reference[0]) ** 2, axis=0)))
    return float(np.sqrt(np.max(np.mean((found - reference) ** 2, axis=0))) / dynamic)


def motion_of(bottom: Bottom) -> Callable[[FloatArray], FloatArray]:
    return lambda time: displacement(bottom, time)


def smooth(time: FloatArray) -> FloatArray:
    """A motion with all the derivatives that matter."""
    return 0.3 * np.sin(1.1 * time) * np.tanh(0.4 * time) ** 8


def test_paper_scene_within_1e_6_of_a_four_times_finer_one_and_says_so() -> None:
    scene = paper()
    solution = solve_coupled(scene, tolerance=1e-6)
    factor = round(1.0 / (30.0 * solution.time_step))
    finer = exact_response(
        coupled_cable(scene),
        motion_of(scene.bottom),
        (1.0, 0.0),
        np.array(GAUGES),
        rows=2049,
        rate=30.0,
        factor=4 * factor,
    )
    true = relative(solution.response.tension, finer.tension)
    assert true < 1e-6
    assert true < solution.numerical_error < 1e-6


def test_straight_cable_is_dalemberts_series() -> None:
    """Ramped motion, fixed top: strain at a station is the sum of what passed it upwards and downwards."""
    cable = replace(coupled_cable(paper()), curvature=0.0)
    stations = np.array([0.0, 0.4, 1.0])
    found = exact_response(cable, motion_of(RAMPED), (1.0, 0.0), stations, rows=1801, rate=30.0, factor=8)
    instant = 1e-4

    def velocity(time: FloatArray) -> FloatArray:
        return (displacement(RAMPED, time + instant) - displacement(RAMPED, time - instant)) / (2.0 * instant)

    speed, length = cable.axial_speed, cable.length
    for g, fraction in enumerate(stations):
        strain = np.zeros(found.time.size)
        for n in range(20):
            strain -= velocity(found.time - (2 * n + fraction) * length / speed) / speed
            strain -= velocity(found.time - (2 * (n + 1) - fraction) * length / speed) / speed
        np.testing.assert_allclose(found.tangential_strain[:, g], strain, atol=1e-6 * np.max(np.abs(strain)))
        assert np.max(np.abs(found.normal_strain[:, g])) == 0.0


def test_nothing_arrives_before_the_axial_wave() -> None:
    response = solve_coupled(paper(replace(RAMPED, ramp=1.0))).response
    arrival = 250.0 / coupled_cable(paper()).axial_speed
    before = response.time < arrival - 0.05
    assert np.max(np.abs(response.tension[before, -1] - 80.0)) < 1e-4
    soon_after = (response.time > arrival) & (response.time < arrival + 0.5)
    assert np.max(np.abs(response.tension[soon_after, -1] - 80.0)) > 1.0


@pytest.mark.parametrize("body", [None, EndBody(0.4, ((30.0, 7.0), (7.0, 50.0)), ((2.0, 0.5), (0.5, 4.0)))])
def test_transfer_functions_are_those_of_the_matrix_exponential(body: EndBody | None) -> None:
    cable = CoupledCable(60.0, 0.05, 90.0, 800.0, 0.011, 0.03, 0.2, 0.7)
    direction = (0.6, -0.8)
    s = np.array([0.3 + 0.0j, 0.2 + 0.5j, 0.1 + 2.0j, 0.4 + 9.0j])
    stations = np.array([0.0, 0.3, 1.0])
    strains, end = strain_transfer(cable, s, direction, stations, body)
    for n, matrix in enumerate(system_matrix(cable, s)):
        whole = expm(matrix * cable.length)
        rows, load = whole[:2, 2:], whole[:2, :2] @ direction
        if body is not None:
            impedance = body.mass * s[n] ** 2 * np.eye(2) + s[n] * np.array(body.damping) + body.stiffness
            rows = impedance @ whole[:2, 2:] + cable.mass_per_length * whole[2:, 2:]
            load = impedance @ whole[:2, :2] @ direction + cable.mass_per_length * whole[2:, :2] @ direction
        start = np.concatenate([direction, -np.linalg.solve(rows, load)])
        axial = cable.axial_square * (1.0 + s[n] * cable.axial_damping_time)
        for g, station in enumerate(stations):
            state = expm(matrix * cable.length * station) @ start
            exact = np.array([state[2] / axial, state[3] / cable.transverse_square])
            np.testing.assert_allclose(strains[g, :, n], exact, rtol=1e-8, atol=1e-12)
        np.testing.assert_allclose(end[:, n], (whole @ start)[:2], atol=1e-10)


def test_long_cables_and_high_frequencies_do_not_overflow() -> None:
    cable = CoupledCable(500.0, 0.05, 1.0, 90000.0, 0.01)
    s = 0.3 + 1j * np.geomspace(0.1, 1e5, 200)
    with np.errstate(over="raise", invalid="raise", divide="raise"):
        strains, _ = strain_transfer(cable, s, (0.8, 0.6), np.array([0.0, 0.5, 1.0]))
    assert np.all(np.isfinite(strains))


def test_coupled_response_is_that_of_a_march_in_time() -> None:
    """Chebyshev collocation in space, an eighth-order march in time: neither waves nor transforms."""
    cable = coupled_cable(paper())
    points, direction = 36, (0.8, 0.6)
    node = np.cos(np.pi * np.arange(points + 1) / points)[::-1]
    edge = np.where((np.arange(points + 1) % points) == 0, 2.0, 1.0) * (-1.0) ** np.arange(points + 1)
    gap = node[:, None] - node[None, :] + np.eye(points + 1)
    slope = edge[:, None] / edge[None, :] / gap
    slope = (slope - np.diag(np.sum(slope, axis=1))) * 2.0 / cable.length
    one, bend = np.eye(points + 1), cable.curvature
    first, second = np.hstack([slope, -bend * one]), np.hstack([bend * one, slope])
    operator = np.vstack(
        [
            cable.axial_square * slope @ first - bend * cable.transverse_square * second,
            cable.transverse_square * slope @ second + bend * cable.axial_square * first,
        ]
    )
    inside = np.r_[1:points, points + 2 : 2 * points + 1]
    inner = operator[np.ix_(inside, inside)]
    driven = operator[inside][:, [0, points + 1]] @ direction

    def rates(time: float, state: FloatArray) -> FloatArray:
        half = inside.size
        return np.concatenate([state[half:], inner @ state[:half] + driven * smooth(np.array(time))])

    time = np.arange(601) / 30.0
    states = solve_ivp(
        rates, (0.0, 20.0), np.zeros(2 * inside.size), "DOP853", time, rtol=1e-9, atol=1e-11
    ).y.T
    field = np.zeros((time.size, 2 * (points + 1)))
    field[:, inside] = states[:, : inside.size]
    field[:, [0, points + 1]] = smooth(time)[:, None] * direction
    found = exact_response(cable, smooth, direction, np.array([0.0, 1.0]), rows=601, rate=30.0, factor=2)
    for index, station in ((0, 0), (1, points)):
        np.testing.assert_allclose(found.tangential_strain[:, index], field @ first[station], atol=2e-7)
        np.testing.assert_allclose(found.normal_strain[:, index], field @ second[station], atol=2e-7)


def test_straight_cable_with_a_platform_is_the_rod_of_the_material_coordinate() -> None:
    """Lengths at rest against unstretched ones; damping, mass, hover spring and hover damper."""
    scene = Scene(
        name="upright",
        cable=Cable(3.0, "unstretched", 0.0484, axial_stiffness=100.0, axial_damping_time=2e-2),
        geometry=Geometry("straight", tension=30.0),
        bottom=Bottom("fixed"),
        top=Top("platform", mass=0.4, hover_stiffness=50.0, hover_damping=5.0),
        output=Output(1.0, 10.0, (0.0, 0.5, 1.0)),
    )
    cable = coupled_cable(scene)
    assert cable.length == pytest.approx(3.0 * 1.3)
    frequency = np.array([0.3, 2.0, 7.0])
    s = 2j * np.pi * frequency
    strains, _ = strain_transfer(cable, s, (1.0, 0.0), np.array([0.0, 0.5, 1.0]), end_body(scene, cable))
    force = (100.0 + 30.0) * (1.0 + s * 2e-2) * strains[:, 0]
    exact = tension_transfer(scene, frequency, np.array([0.0, 0.5, 1.0])).T
    np.testing.assert_allclose(force, exact, rtol=1e-10)


def test_tip_mass_follows_the_closed_form_until_the_second_arrival() -> None:
    """M v' + Z v = 2 Z v0(t - L/c) for t < 3 L/c, the smooth form of 2 v0 (1 - exp(-Z (t - L/c)/M))."""
    cable = CoupledCable(100.0, 0.05, 100.0, 20000.0, 0.0)
    impedance, mass = cable.mass_per_length * cable.axial_speed, 3.0
    traverse = cable.length / cable.axial_speed
    bottom = Bottom("harmonic", amplitude=0.1, frequency=1.0, start="ramp", ramp=0.4)
    rows = int(3.0 * traverse * 1000.0)
    found = exact_response(
        cable, motion_of(bottom), (1.0, 0.0), np.array([1.0]), rows=rows, rate=1000.0, top=EndBody(mass)
    )
    # integrated once: M u' + Z u = 2 Z u0(t - L/c)
    fine = np.arange(20 * (rows - 1) + 1) / 20000.0
    load = 2.0 * impedance / mass * displacement(bottom, fine - traverse)
    growth = np.exp(impedance / mass * fine)
    area = (
        np.concatenate([[0.0], np.cumsum(0.5 * (load * growth)[1:] + 0.5 * (load * growth)[:-1])]) / 20000.0
    )
    exact = (area / growth)[::20]
    assert np.max(np.abs(exact)) > 0.05
    np.testing.assert_allclose(found.top_displacement[:, 0], exact, atol=1e-6 * 0.1)


def test_energy_put_in_at_the_bottom_stays_in_the_cable() -> None:
    """After the bottom stops, the undamped cable holds the work done, half of it as strain on the average."""
    cable = coupled_cable(paper())
    stations = 0.5 * (1.0 - np.cos(np.pi * np.arange(161) / 160))

    def pulse(time: FloatArray) -> FloatArray:
        ratio = np.clip(time / 6.0, 0.0, 1.0)
        return 64.0 * (ratio * (1.0 - ratio)) ** 6 * 64.0

    found = exact_response(cable, pulse, (0.6, 0.8), stations, rows=301, rate=20.0, factor=2)
    velocity = np.gradient(pulse(found.time), found.time, edge_order=2)
    pull = cable.axial_square * found.tangential_strain[:, 0] * 0.6
    pull += cable.transverse_square * found.normal_strain[:, 0] * 0.8
    work = -np.trapezoid(pull * velocity, found.time)
    elastic = (
        cable.axial_square * found.tangential_strain**2 + cable.transverse_square * found.normal_strain**2
    )
    late = found.time > 6.5
    potential = 0.5 * np.trapezoid(elastic[late], stations * cable.length, axis=1)
    assert work > 0.0
    assert np.max(potential) < work * 1.001  # never more than was put in
    assert np.mean(potential) == pytest.approx(0.5 * work, rel=0.3)


def test_true_and_printed_tension_differ_by_one_and_two_thirds_in_condition_1_1() -> None:
    response = solve_coupled(paper(replace(RAMPED, amplitude=1e-4))).response
    late = response.time > 20.0
    ratio = np.std(response.tension[late, 0]) / np.std(response.printed_tension[late, 0])
    assert ratio == pytest.approx(1.0 + 80.0 / 120.166, rel=1e-4)
    grating = 120.166 * np.std(response.strain[late, 0])
    assert grating == pytest.approx(np.std(response.tension[late, 0]), rel=1e-4)


def test_strain_of_the_paper_is_half_the_growth_of_the_squared_length() -> None:
    response = solve_coupled(paper(replace(RAMPED, direction="vertical", amplitude=8.0))).response
    square = (1.0 + response.tangential_strain) ** 2 + response.normal_strain**2
    assert np.max(response.normal_strain**2) > 1e-3
    np.testing.assert_allclose(response.printed_tension, 120.1659190 * 0.5 * (square - 1.0), atol=1e-6)
    np.testing.assert_allclose(
        response.tension, (80.0 + response.printed_tension) * np.sqrt(square), rtol=1e-12
    )


def test_damped_tension_has_the_closed_forms_amplitude_and_phase() -> None:
    scene = Scene(
        name="damped",
        cable=Cable(3.0, "unstretched", 0.0484, axial_stiffness=1000.0, axial_damping_time=2e-2),
        geometry=Geometry("straight", tension=30.0),
        bottom=Bottom("harmonic", amplitude=1e-6, frequency=5.0, start="ramp", ramp=2.0),
        top=Top("platform", mass=0.4, hover_damping=9.0),
        output=Output(12.0, 100.0, (0.0, 1.0)),
    )
    response = solve_coupled(scene).response
    late = response.time > 8.0
    phase = 2.0 * np.pi * 5.0 * response.time[late]
    design = np.column_stack([np.ones(phase.size), np.sin(phase), np.cos(phase)])
    parts = np.linalg.lstsq(design, response.tension[late], rcond=None)[0]
    exact = tension_transfer(scene, np.array([5.0]), np.array([0.0, 1.0]))[0] * 1e-6
    np.testing.assert_allclose(parts[1] + 1j * parts[2], exact, rtol=1e-4)


def test_a_platform_without_hold_is_carried_along_by_a_slow_motion() -> None:
    """The equilibrium moves as a whole: a metre up at the bottom is a metre up at the top."""
    time = np.arange(0.0, 400.0, 0.5)
    ratio = np.clip(time / 250.0, 0.0, 1.0)
    measured = MeasuredMotion(time, ratio**3 * (10.0 - 15.0 * ratio + 6.0 * ratio**2))
    held = Top("platform", mass=0.4, hover_damping=2.0)
    for direction, rise in (("vertical", 1.0), ("horizontal", 0.0)):
        scene = paper(Bottom("measured", direction=direction), 390.0)  # type: ignore[arg-type]
        solution = solve_coupled(replace(scene, top=held), measured=measured, tolerance=1e-3)
        assert solution.platform_position[-1] == pytest.approx(rise, abs=0.01)


def test_hover_stiffness_of_a_vector_acts_along_the_vertical() -> None:
    scene = replace(paper(), top=Top("platform", mass=0.4, hover_stiffness=(0.0, 50.0)))
    cable = coupled_cable(scene)
    body = end_body(scene, cable)
    assert body is not None
    angle = end_angle(scene, cable, 1.0)
    up, level = np.array([math.sin(angle), math.cos(angle)]), np.array([math.cos(angle), -math.sin(angle)])
    assert np.array(body.stiffness) @ up == pytest.approx(50.0 * up)
    assert np.array(body.stiffness) @ level == pytest.approx([0.0, 0.0], abs=1e-12)


def test_vertical_and_horizontal_turn_with_the_arc() -> None:
    scene = paper()
    cable = coupled_cable(scene)
    upwards = local_direction(replace(scene, bottom=replace(RAMPED, direction="vertical")), cable)
    level = local_direction(replace(scene, bottom=replace(RAMPED, direction=(3.0, 0.0))), cable)
    half = 0.5 * cable.curvature * cable.length
    assert upwards == pytest.approx((-math.sin(half), math.cos(half)))  # the cable starts downhill
    assert level == pytest.approx((math.cos(half), math.sin(half)))
    # moving both ends alike does not strain the cable: the static matrix only turns the vector
    turned = expm(system_matrix(cable, np.array([0j]))[0].real * cable.length) @ [*upwards, 0.0, 0.0]
    angle = end_angle(scene, cable, 1.0)
    assert turned == pytest.approx([math.sin(angle), math.cos(angle), 0.0, 0.0], abs=1e-12)


def test_measured_motion_gives_what_the_formula_gives() -> None:
    time = np.arange(0.0, 68.4, 0.02)
    measured = MeasuredMotion(time, displacement(RAMPED, time))
    found = solve_coupled(paper(Bottom("measured")), measured=measured, tolerance=1e-3).response
    exact = solve_coupled(paper()).response
    assert relative(found.tension[:-30], exact.tension[:-30]) < 1e-3


@pytest.mark.parametrize(
    ("scene", "words"),
    [
        (paper(replace(RAMPED, direction=(0.0, 0.0))), "without length"),
        (replace(paper(), geometry=Geometry("vertical", tension=80.0)), "no uniform tension"),
        (
            replace(
                paper(Bottom("step", velocity=0.01)),
                cable=Cable(250.0, "equilibrium", 0.02, axial_stiffness=120.0, axial_damping_time=0.01),
            ),
            "with a damped cable",
        ),
    ],
)
def test_what_the_transform_cannot_do_is_an_error_with_a_remedy(scene: Scene, words: str) -> None:
    with pytest.raises(DataError, match=words) as raised:
        solve_coupled(scene)
    assert "fix:" in str(raised.value)


def test_measured_motion_that_starts_displaced_is_an_error() -> None:
    measured = MeasuredMotion(np.array([0.0, 30.0, 68.3]), np.array([0.5, 0.6, 0.5]))
    with pytest.raises(DataError, match=r"jumps by 0\.5 m"):
        solve_coupled(paper(Bottom("measured")), measured=measured)
