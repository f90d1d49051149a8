"""What a motion across the cable's plane adds to its tension: the linear model against the march in space."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tethertest.records.arrays import FloatArray
from tethertest.records.cable import Cable
from tethertest.records.scene import Bottom, Geometry, Output, Scene, Top
from tethertest.solver.linear.coupled import coupled_cable
from tethertest.solver.linear.coupled_solve import solve_coupled, swung
from tethertest.solver.nonlinear.chain_march import run_chain


def across(amplitude: float, gravity: float) -> Scene:
    """The paper's condition 1.1, its bottom end moved across the plane; gauges all along the cable."""
    return Scene(
        name="paper 1.1, sideways",
        cable=Cable(250.0, "equilibrium", 0.02, youngs_modulus=1.7e7, diameter=3e-3),
        geometry=Geometry("shallow", tension=80.0),
        bottom=Bottom("harmonic", (0.0, 1.0, 0.0), amplitude, 0.18, start="ramp", ramp=10.0),
        top=Top("fixed"),
        output=Output(40.0, 30.0, tuple((np.arange(80) + 0.5) / 80)),
        gravity=gravity,
    )


def added(tension: FloatArray) -> FloatArray:
    """Mean along the cable of what is added to the rest; between fixed ends axial waves only move it."""
    return np.asarray(np.mean(tension - tension[0], axis=1))


def distance(amplitude: float, gravity: float) -> float:
    scene = across(amplitude, gravity)
    linear, march = solve_coupled(scene).response.tension, run_chain(scene, 160, viscous=False).tension
    assert np.min(linear) >= np.min(linear[0]) - 1e-9  # a swing out of the plane only ever pulls
    exact = added(march)
    assert np.max(exact) > 0.04 * amplitude**2
    return float(np.sqrt(np.mean((added(linear) - exact) ** 2) / np.mean(exact**2)))


def test_without_gravity_the_mean_tension_is_that_of_the_march_to_fourth_order() -> None:
    large, small = distance(4.0, 0.0), distance(2.0, 0.0)
    assert small < 6e-3
    assert large / small == pytest.approx(4.0, abs=0.3)


def test_a_curved_cable_turns_some_of_the_strain_into_sideways_motion() -> None:
    assert distance(1.0, 9.81) < 0.15


@pytest.mark.parametrize("slope", [0.0, 0.3, -0.3])
def test_a_slope_lengthens_the_cable_by_half_its_square(slope: float) -> None:
    """T = (P + EA (e + u3,s^2/2)) sqrt((1 + e1)^2 + e2^2 + u3,s^2), and damping stays what it was."""
    scene = across(1.0, 9.81)
    cable = replace(coupled_cable(scene), axial_damping_time=0.01)
    flat = solve_coupled(replace(scene, bottom=replace(scene.bottom, direction="tangent"))).response
    damped = replace(flat, tension=flat.tension + 3.0)
    found = swung(damped, cable, np.full_like(flat.tension, slope))
    first, second = flat.tangential_strain, flat.normal_strain
    strain = first + 0.5 * (first**2 + second**2 + slope**2)
    stretch = np.sqrt((1.0 + first) ** 2 + second**2 + slope**2)
    np.testing.assert_allclose(
        found.tension, (80.0 + cable.axial_stiffness * strain) * stretch + 3.0, rtol=1e-12
    )
    np.testing.assert_allclose(found.printed_tension, cable.axial_stiffness * strain, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(found.strain, cable.stretch * (stretch - 1.0), rtol=1e-12, atol=1e-12)
