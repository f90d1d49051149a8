"""Characteristics on two grids against the exact transform, d'Alembert's series and the bottom's motion."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tethertest.errors import DataError
from tethertest.records.arrays import FloatArray
from tethertest.records.cable import Cable
from tethertest.records.scene import Bottom, Geometry, Output, Scene, Top
from tethertest.solver.linear.coupled import coupled_cable
from tethertest.solver.linear.coupled_solve import solve_coupled
from tethertest.solver.linear.two_grid import grid_pair, run_two_grid
from tethertest.solver.motion import displacement

GAUGES = (0.0, 0.25, 0.5, 0.75, 1.0)
RAMPED = Bottom("harmonic", amplitude=2.0, frequency=0.18, start="ramp", ramp=10.0)
PAPER_CABLE = Cable(250.0, "equilibrium", 0.02, youngs_modulus=1.7e7, diameter=3e-3)
#: c1/ct = 8/5 exactly: no error of speed hides the order
RATIONAL_CABLE = Cable(250.0, "equilibrium", 0.02, axial_stiffness=80.0 * (2.56 - 1.0))
HELD = Top("platform", mass=0.4, hover_stiffness=(30.0, 50.0), hover_damping=(2.0, 4.0))


def paper(bottom: Bottom = RAMPED, duration: float = 68.27) -> Scene:
    return Scene(
        name="paper 1.1",
        cable=PAPER_CABLE,
        geometry=Geometry("shallow", tension=80.0),
        bottom=bottom,
        top=Top("fixed"),
        output=Output(duration, 30.0, GAUGES),
        gravity=9.81,
    )


def relative(found: FloatArray, reference: FloatArray) -> float:
    dynamic = np.sqrt(np.max(np.mean((reference - reference[0]) ** 2, axis=0)))
    return float(np.sqrt(np.max(np.mean((found - reference) ** 2, axis=0))) / dynamic)


def test_ramped_paper_scene_against_the_transform() -> None:
    scene = paper()
    exact = solve_coupled(scene, tolerance=1e-6).response
    coarse, fine = run_two_grid(scene, 55), run_two_grid(scene, 110)
    assert relative(coarse.tension, exact.tension) < 2.5e-3
    assert relative(fine.tension, exact.tension) < 6e-4
    assert np.max(coarse.tension) == pytest.approx(np.max(exact.tension), rel=2e-3)
    assert relative(fine.strain, exact.strain) < 6e-4


@pytest.mark.parametrize(
    "top", [Top("fixed"), HELD, replace(HELD, mass=0.0)], ids=["fixed", "body", "massless"]
)
def test_second_order_against_the_transform_at_every_gauge(top: Top) -> None:
    scene = replace(paper(duration=30.0), cable=RATIONAL_CABLE, top=top)
    exact = solve_coupled(scene, tolerance=1e-7)
    errors = []
    for cells in (40, 80):
        found = run_two_grid(scene, cells)
        tension = [
            relative(a[:, None], b[:, None])
            for a, b in zip(found.tension.T, exact.response.tension.T, strict=True)
        ]
        if top.kind == "platform":
            tension.append(relative(found.platform_position[:, None], exact.platform_position[:, None]))
        errors.append(tension)
    coarse, fine = np.array(errors)
    assert np.max(fine) < 3e-3
    assert np.log2(coarse / fine) == pytest.approx(2.0, abs=0.25)


def test_sudden_start_against_the_transform_in_the_mean() -> None:
    scene = paper(Bottom("harmonic", amplitude=2.0, frequency=0.18))
    exact = solve_coupled(scene, tolerance=1e-4).response.tension
    coarse, fine = (
        np.mean(np.abs(run_two_grid(scene, cells).tension - exact)[:, [0, -1]])
        / np.mean(np.abs(exact - 80.0)[:, [0, -1]])
        for cells in (55, 110)
    )
    assert coarse < 7e-3
    assert fine < 0.5 * coarse


def test_velocity_jump_of_the_straight_cable_is_dalemberts_square_wave_outside_one_step() -> None:
    scene = replace(paper(Bottom("step", velocity=0.5), 12.0), gravity=0.0)
    found = run_two_grid(replace(scene, output=replace(scene.output, fields=("position",))), 55)
    traverse = 250.0 / coupled_cable(scene).axial_speed
    unit = -0.5 / coupled_cable(scene).axial_speed * coupled_cable(scene).stretch
    settled = (found.time > found.time_step) & (found.time < 2.0 * traverse - found.time_step)
    assert found.strain[settled, 0] == pytest.approx(unit, rel=1e-9)
    top = found.strain[:, -1] / unit
    assert top[found.time < traverse - found.time_step] == pytest.approx(0.0, abs=1e-9)
    plateau = (found.time > traverse + found.time_step) & (found.time < 3.0 * traverse - found.time_step)
    assert top[plateau] == pytest.approx(2.0, rel=1e-9)
    inside = found.fields["position"][:, 2, 0] - 125.0  # the front passes at half the traverse
    spread = 1.5 * found.time_step  # the gauge lies between nodes
    later = (found.time > 0.5 * traverse + spread) & (found.time < 1.5 * traverse - spread)
    assert inside[later] == pytest.approx(0.5 * (found.time[later] - 0.5 * traverse), abs=1e-9)


def test_field_keeps_the_extremes_of_the_gauges_at_the_time_levels() -> None:
    scene = paper()
    found = run_two_grid(scene, 55, native_times=True)
    assert found.time == pytest.approx(np.arange(found.time.size) * found.time_step)
    assert found.field.time.size <= 480
    ends = found.tension[:, [0, -1]]
    assert np.max(found.field.maximum[:, [0, -1]], axis=0) == pytest.approx(np.max(ends, axis=0), rel=1e-12)
    assert np.min(found.field.minimum[:, [0, -1]], axis=0) == pytest.approx(np.min(ends, axis=0), rel=1e-12)


def test_fields_against_the_bottoms_motion_and_the_integral_of_the_curvature() -> None:
    """Curvature per stretched length, summed, is the turn of the tangent: its ends' eps2."""
    fine = tuple(np.linspace(0.0, 1.0, 201))
    scene = replace(paper(replace(RAMPED, direction="vertical"), 20.0))
    output = Output(20.0, 5.0, fine, ("position", "velocity", "curvature"))
    found = run_two_grid(replace(scene, output=output), 110)
    position, velocity, curvature = (found.fields[name] for name in output.fields)
    lifted = displacement(scene.bottom, found.time)
    assert position[:, 0, 2] == pytest.approx(lifted, abs=1e-12)
    assert position[:, 0, 0] == pytest.approx(0.0, abs=1e-12)
    rate = (position[2:, 100] - position[:-2, 100]) * 2.5
    assert rate == pytest.approx(velocity[1:-1, 100], abs=0.05 * np.max(np.abs(velocity)))
    secant = np.diff(position, axis=1)  # the shape itself: its tangent turns by the curvature
    turned = np.unwrap(np.arctan2(secant[..., 2], secant[..., 0]))
    length = np.linalg.norm(secant, axis=-1)
    bend = np.diff(turned, axis=1) / (0.5 * (length[:, 1:] + length[:, :-1]))
    rest = coupled_cable(scene).curvature
    smooth = np.abs(bend - curvature[:, 1:-1])[:, 5:-5]
    assert np.mean(smooth) < 0.1 * np.mean(np.abs(curvature - rest))


def test_grids_are_the_continued_fraction_of_the_two_speeds() -> None:
    cable = coupled_cable(paper())
    pair = grid_pair(cable.axial_speed / cable.transverse_speed, 55)
    assert (pair.axial, pair.transverse) == (55, 87)
    assert abs(pair.speed_error) == pytest.approx(1.5e-5, rel=0.02)
    assert abs(grid_pair(286.3651515, 8).speed_error) < 1e-5


def test_refusals_name_what_the_scheme_does_not_know() -> None:
    scene = paper()
    with pytest.raises(DataError, match="axial damping"):
        run_two_grid(replace(scene, cable=replace(PAPER_CABLE, axial_damping_time=1e-3)), 55)
    with pytest.raises(DataError, match="follow the cable's plane alone"):
        run_two_grid(replace(scene, bottom=replace(RAMPED, direction=(0.0, 1.0, 1.0))), 55)
    with pytest.raises(DataError, match="too few"):
        run_two_grid(scene, 3)
