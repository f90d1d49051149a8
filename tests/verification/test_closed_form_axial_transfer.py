"""The march against the closed-form steady response of a rod with mass, spring and damper at its end."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tethertest.records.arrays import FloatArray
from tethertest.records.cable import Cable
from tethertest.records.scene import Bottom, Geometry, Output, Scene, Top
from tethertest.solver import rest_state
from tethertest.solver.linear.transfer import tension_transfer
from tethertest.solver.nonlinear.chain_march import run_chain

FREQUENCY = 5.0
AMPLITUDE = 1e-4


def rig(**top: float) -> Scene:
    return Scene(
        name="3 m rig",
        cable=Cable(3.0, "unstretched", 0.0484, axial_stiffness=10020.0, axial_damping_time=5e-4),
        geometry=Geometry("vertical"),
        bottom=Bottom("harmonic", amplitude=AMPLITUDE, frequency=FREQUENCY, start="ramp", ramp=2.0),
        top=Top("platform", mass=0.4, static_tension=5.0, **top),  # type: ignore[arg-type]
        output=Output(12.0, 1000.0, (0.0, 0.5, 1.0)),
    )


def complex_amplitude(time: FloatArray, values: FloatArray, frequency: float) -> complex:
    design = np.column_stack(
        [np.ones(time.size), np.cos(2 * np.pi * frequency * time), np.sin(2 * np.pi * frequency * time)]
    )
    _, cosine, sine = np.linalg.lstsq(design, values, rcond=None)[0]
    return complex(cosine, -sine)


@pytest.mark.parametrize("viscous", [False, True])
def test_march_meets_the_closed_form_in_amplitude_and_phase(viscous: bool) -> None:
    scene = rig(hover_stiffness=50.0, hover_damping=5.0)
    gauges = np.array(scene.output.gauges)
    exact = tension_transfer(scene, np.array([FREQUENCY]), gauges)[0] * AMPLITUDE
    solution = run_chain(scene, 40, viscous=viscous)
    steady = solution.time > 8.0
    for g in range(gauges.size):
        # the drive is A sin(wt) = A Re(-i exp(iwt))
        found = complex_amplitude(solution.time[steady], solution.tension[steady, g], FREQUENCY)
        assert abs(found - exact[g] * -1j) < 2e-3 * abs(exact[g])


def test_march_is_of_second_order_in_the_cells() -> None:
    scene = rig(hover_stiffness=50.0, hover_damping=5.0)
    scene = replace(scene, cable=replace(scene.cable, axial_damping_time=0.0))
    exact = tension_transfer(scene, np.array([FREQUENCY]), np.array([0.0]))[0, 0] * AMPLITUDE
    errors = []
    for cells in (10, 20, 40):
        solution = run_chain(scene, cells, viscous=False)
        steady = solution.time > 8.0
        found = complex_amplitude(solution.time[steady], solution.tension[steady, 0], FREQUENCY)
        errors.append(abs(abs(found) - abs(exact)))
    orders = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    assert orders == pytest.approx(2.0, abs=0.25)


def test_rigid_cable_limit_is_newtons_law() -> None:
    """Far below resonance a free UAV's tension is minus (M + cable mass above the gauge) x acceleration."""
    scene = replace(rig(), cable=replace(rig().cable, axial_stiffness=1e8, axial_damping_time=0.0))
    found = tension_transfer(scene, np.array([0.3]), np.array([0.0, 1.0]))[0].real
    square = (2 * np.pi * 0.3) ** 2
    assert found == pytest.approx([(0.4 + 3 * 0.0484) * square, 0.4 * square], rel=1e-4)


def test_fixed_top_at_low_frequency_is_a_spring() -> None:
    scene = replace(rig(), top=Top("fixed"), geometry=Geometry("vertical", tension=20.0))
    found = tension_transfer(scene, np.array([0.05]), np.array([1.0]))[0, 0]
    assert found.real == pytest.approx(-10020.0 / 3.0, rel=1e-3)  # upwards motion lowers the tension


def test_a_cable_without_motion_stays_at_its_rest_tension() -> None:
    scene = replace(rig(), bottom=Bottom("fixed"), air=None)
    rest = rest_state(scene)
    solution = run_chain(scene, 20)
    expected = [rest.bottom_tension, rest.tension(0.5), 5.0]
    np.testing.assert_allclose(solution.tension, np.broadcast_to(expected, solution.tension.shape), atol=1e-9)
    np.testing.assert_allclose(solution.strain, 0.0, atol=1e-12)
