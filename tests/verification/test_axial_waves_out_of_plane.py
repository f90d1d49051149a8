"""Slopes across the plane against fronts, an exact string march and a standing wave: equation (27)."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from tethertest.errors import DataError
from tethertest.records.cable import Cable
from tethertest.records.scene import Bottom, Geometry, Output, Scene, Top
from tethertest.solver.linear.axial_waves import out_of_plane_slope, run_axial_waves

LENGTH, MASS, TENSION = 250.0, 0.02, 80.0  # at rest
SPEED = math.sqrt(TENSION / MASS)
ACROSS = (0.0, 1.0, 0.0)
FIXED = Top("fixed")


def paper(bottom: Bottom, duration: float = 30.0, kind: str = "shallow", top: Top = FIXED) -> Scene:
    return Scene(
        name="paper 1.1",
        cable=Cable(LENGTH, "equilibrium", MASS, youngs_modulus=1.7e7, diameter=3e-3),
        geometry=Geometry(kind, tension=TENSION),  # type: ignore[arg-type]
        bottom=bottom,
        top=top,
        output=Output(duration, 40.0, (0.0, 0.5, 1.0)),
        gravity=9.81,
    )


@pytest.mark.parametrize("kind", ["shallow", "straight"])
def test_a_step_across_the_plane_turns_the_cable_by_velocity_over_transverse_speed(kind: str) -> None:
    """The cable behind the front falls back: u3,s = -v0/ct, and twice that at the fixed end."""
    scene = paper(Bottom("step", ACROSS, velocity=0.3), kind=kind)
    slope = out_of_plane_slope(scene, 20, native_times=True)
    rows = [0, 9, 10, 19, 20, 29, 30, 39, 40]
    fronts = [
        [1, 0, 0],
        [1, 0, 0],
        [1, 1, 0],
        [1, 1, 0],
        [1, 1, 2],
        [1, 1, 2],
        [1, 2, 2],
        [1, 2, 2],
        [3, 2, 2],
    ]
    np.testing.assert_allclose(slope[rows], -0.3 / SPEED * np.array(fronts), rtol=1e-9, atol=1e-15)


def test_an_exact_march_of_the_string_has_the_same_slopes_to_second_order() -> None:
    """The string's difference equation at Courant number 1 is exact in displacement."""
    bottom = Bottom("harmonic", ACROSS, amplitude=2.0, frequency=0.18, start="ramp", ramp=10.0)
    errors = []
    for nodes in (20, 40, 80):
        slope = out_of_plane_slope(paper(bottom), nodes, native_times=True)
        cell = LENGTH / nodes
        time = np.arange(slope.shape[0]) * cell / SPEED
        ratio = np.clip(time / 10.0, 0.0, 1.0)
        drive = 2.0 * np.sin(2.0 * np.pi * 0.18 * time) * ratio**3 * (10.0 - 15.0 * ratio + 6.0 * ratio**2)
        last, now = np.zeros(nodes + 1), np.zeros(nodes + 1)
        difference = np.zeros(time.size)
        for k in range(1, time.size):
            new = np.zeros(nodes + 1)
            new[1:-1] = now[2:] + now[:-2] - last[1:-1]
            new[0] = drive[k]
            last, now = now, new
            difference[k] = (now[nodes // 2 + 1] - now[nodes // 2 - 1]) / (2.0 * cell)
        errors.append(np.max(np.abs(slope[:, 1] - difference)) / np.max(np.abs(difference)))
    assert np.log2(np.array(errors[:-1]) / errors[1:]) == pytest.approx(2.0, abs=0.1)


def test_a_hovering_platform_is_met_by_the_standing_wave() -> None:
    """u3 = cos(kx) + B sin(kx) with P u3,s = (M w^2 - i w c - k) u3 at the top; the loop's y constants."""
    hover, damping, mass, frequency = 0.7, 1.1, 0.5, 0.09
    top = Top(
        "platform",
        mass=mass,
        static_tension=TENSION,
        hover_stiffness=(1e3, hover, 1e4),
        hover_damping=(1e3, damping, 1e4),
    )
    bottom = Bottom("harmonic", ACROSS, amplitude=0.5, frequency=frequency, start="ramp", ramp=20.0)
    scene = paper(bottom, 300.0, top=top)
    slope = out_of_plane_slope(scene, 20)
    angular = 2.0 * np.pi * frequency
    wave = angular / SPEED
    body = mass * angular**2 - 1j * angular * damping - hover
    cosine, sine, line = np.cos(wave * LENGTH), np.sin(wave * LENGTH), TENSION * wave
    end = (line * sine + body * cosine) / (line * cosine - body * sine)
    place = wave * LENGTH * np.array([0.0, 0.5, 1.0])
    exact = 0.5 * wave * (end * np.cos(place) - np.sin(place)) * -1j  # the drive is A sin(wt)
    time = np.arange(slope.shape[0]) / 40.0
    late = time > 300.0 - 10.0 / frequency
    angle = angular * time[late]
    design = np.column_stack([np.cos(angle), np.sin(angle)])
    (real, imaginary), *_ = np.linalg.lstsq(design, slope[late], rcond=None)
    np.testing.assert_allclose(real - 1j * imaginary, exact, rtol=0.0, atol=1e-5 * np.max(np.abs(exact)))


def test_a_motion_in_the_plane_has_no_slope_across_it() -> None:
    assert not np.any(out_of_plane_slope(paper(Bottom("step", (1.0, 0.0, 1.0), velocity=0.3)), 10))


def test_a_straight_cable_shares_an_oblique_motion_between_axis_and_plane() -> None:
    scene = paper(Bottom("step", (0.0, 3.0, 4.0), velocity=0.5), kind="straight")
    whole = replace(scene, bottom=Bottom("step", velocity=0.4))
    np.testing.assert_allclose(
        run_axial_waves(scene, 10).tension, run_axial_waves(whole, 10).tension, rtol=1e-12
    )
    slope = out_of_plane_slope(scene, 10)
    assert slope[0, 0] == pytest.approx(-0.3 / SPEED, rel=1e-12)


def test_a_vertical_cable_has_no_uniform_tension_and_is_refused() -> None:
    with pytest.raises(DataError, match="uniform tension"):
        out_of_plane_slope(paper(Bottom("step", ACROSS, velocity=0.3), kind="vertical"), 10)
