"""A sudden start at the bottom: the square wave of the straight cable, superposition, the stated error."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from tethertest.records.arrays import FloatArray
from tethertest.records.cable import Cable
from tethertest.records.scene import Bottom, Geometry, Output, Scene, Top
from tethertest.solver.linear.coupled import coupled_cable
from tethertest.solver.linear.coupled_solve import solve_coupled
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


def test_sudden_start_of_a_straight_cable_is_a_square_wave() -> None:
    """Strain -v0/c at the bottom, -2 v0/c at the top from L/c to 3 L/c, -3 v0/c at the bottom from 2 L/c."""
    scene = replace(paper(Bottom("step", velocity=0.5), 12.0), gravity=0.0)
    response = solve_coupled(scene).response
    cable = coupled_cable(scene)
    traverse = cable.length / cable.axial_speed
    unit = -0.5 / cable.axial_speed
    bottom, top = response.tangential_strain[:, 0] / unit, response.tangential_strain[:, -1] / unit
    time = response.time
    first, second = (
        time < 2.0 * traverse - 0.01,
        (time > 2.0 * traverse + 0.01) & (time < 4.0 * traverse - 0.01),
    )
    assert bottom[first] == pytest.approx(1.0, abs=1e-9)
    assert bottom[second] == pytest.approx(3.0, abs=1e-9)
    assert top[time < traverse - 0.01] == pytest.approx(0.0, abs=1e-9)
    assert top[(time > traverse + 0.01) & (time < 3.0 * traverse - 0.01)] == pytest.approx(2.0, abs=1e-9)


def test_sudden_start_of_the_curved_cable_is_what_superposition_asks() -> None:
    """A smooth motion is a sum of velocity steps: its strain is the acceleration convolved with theirs."""
    cable = coupled_cable(paper())
    stations, direction = np.array([0.0, 0.6, 1.0]), (0.8, 0.6)

    def unit_step(time: FloatArray) -> FloatArray:
        return np.maximum(time, 0.0)

    rows, rate = 8001, 400.0
    step = exact_response(cable, unit_step, direction, stations, rows=rows, rate=rate, factor=2)
    exact = exact_response(cable, smooth, direction, stations, rows=rows, rate=rate)
    time, near = np.arange(rows) / rate, 1e-3
    acceleration = (smooth(time + near) - 2.0 * smooth(time) + smooth(np.abs(time - near))) / near**2
    for strain, reference in (
        (step.tangential_strain, exact.tangential_strain),
        (step.normal_strain, exact.normal_strain),
    ):
        strain[0] *= 0.5  # the end of the trapezoidal rule
        summed = np.array([np.convolve(acceleration, column)[:rows] / rate for column in strain.T]).T
        assert relative(summed, reference) < 8e-4  # fronts fall between the samples


def test_sudden_start_on_a_stiff_short_cable_does_not_trust_a_coarse_pair() -> None:
    """The axial wave is back after a third of the output interval: coarse samplings agree and are wrong."""
    scene = paper(Bottom("harmonic", direction="vertical", amplitude=0.03, frequency=0.9), 3.0, (0.0, 1.0))
    cable = Cable(16.5, "equilibrium", 0.0157, axial_stiffness=88000.0)
    scene = replace(scene, cable=cable, geometry=Geometry("shallow", tension=22.9))
    solution = solve_coupled(scene, tolerance=1e-2)
    assert solution.time_step < 0.25 * 16.5 / coupled_cable(scene).axial_speed
    assert solution.numerical_error > 0.0


def test_sudden_start_converges_and_its_error_is_covered() -> None:
    scene = paper(Bottom("harmonic", amplitude=2.0, frequency=0.25))
    cable = coupled_cable(scene)
    finest = exact_response(
        cable, motion_of(scene.bottom), (1.0, 0.0), np.array(GAUGES), rows=2049, rate=30.0, factor=32
    )
    assert finest.tangential_strain[0, 0] == pytest.approx(-np.pi / cable.axial_speed, rel=1e-6)
    solution = solve_coupled(scene, tolerance=1e-3)
    assert relative(solution.response.tension, finest.tension) < solution.numerical_error < 1e-3
