"""The transform of axial waves against the exact waves, a refined march, and a rod's standing-wave form."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tethertest.errors import DataError
from tethertest.records.arrays import FloatArray
from tethertest.records.cable import Cable
from tethertest.records.scene import Bottom, Geometry, MeasuredMotion, Output, Scene, Top
from tethertest.solver.linear.axial_waves import run_axial_waves
from tethertest.solver.linear.transfer import axial_transfer, run_axial_transform
from tethertest.solver.nonlinear.chain_march import run_chain

DAMPED = Scene(
    name="3 m rig",
    cable=Cable(3.0, "unstretched", 0.0484, axial_stiffness=10020.0, axial_damping_time=5e-4),
    geometry=Geometry("vertical"),
    bottom=Bottom("crank-slider", radius=0.05, rod_ratio=0.25, frequency=2.0, start="ramp", ramp=1.0),
    top=Top("platform", mass=0.4, static_tension=50.0, hover_stiffness=500.0, hover_damping=5.0),
    output=Output(4.0, 1000.0, (0.0, 0.37, 1.0), ("position", "velocity", "curvature")),
)
FREE = replace(DAMPED, cable=replace(DAMPED.cable, axial_damping_time=0.0))
TOPS = {"platform": DAMPED.top, "fixed": Top("fixed", static_tension=50.0)}


def relative(found: FloatArray, reference: FloatArray) -> float:
    dynamic = np.sqrt(np.max(np.mean((reference - reference[0]) ** 2, axis=0)))
    return float(np.sqrt(np.max(np.mean((found - reference) ** 2, axis=0))) / dynamic)


@pytest.mark.parametrize("top", TOPS.values(), ids=TOPS)
def test_response_is_that_of_standing_waves_at_complex_frequencies(top: Top) -> None:
    """u = cos(kx) + B sin(kx) with the top's own equation, written out with another basis."""
    s = np.array([0.3 + 2.0j, 5.0 + 400.0j, 40.0 - 90.0j])
    gauges = np.array([0.0, 0.4, 1.0])
    stiffness = 10020.0 * (1.0 + 5e-4 * s)
    wave = 1j * s * np.sqrt(0.0484 / stiffness)
    body = 0.4 * s**2 + 5.0 * s + 500.0
    cosine, sine = np.cos(3.0 * wave), np.sin(3.0 * wave)
    line = stiffness * wave
    end = (line * sine - body * cosine) / (line * cosine + body * sine)
    if top.kind == "fixed":
        end = -cosine / sine
    place = wave[:, None] * 3.0 * gauges
    found = axial_transfer(replace(DAMPED, top=top), s, gauges)
    strain = wave[:, None] * (end[:, None] * np.cos(place) - np.sin(place))
    np.testing.assert_allclose(found.strain, strain, rtol=1e-10)
    np.testing.assert_allclose(found.tension, stiffness[:, None] * strain, rtol=1e-10)
    moved = np.cos(place) + end[:, None] * np.sin(place)
    np.testing.assert_allclose(found.displacement, moved, rtol=1e-10, atol=1e-12)


@pytest.mark.parametrize("top", TOPS.values(), ids=TOPS)
def test_without_damping_it_is_the_exact_waves(top: Top) -> None:
    scene = replace(FREE, top=top)
    found, exact = run_axial_transform(scene, factor=2), run_axial_waves(scene, 20)
    assert relative(found.tension, exact.tension) < 1e-6
    assert relative(found.strain, exact.strain) < 1e-6
    np.testing.assert_allclose(found.platform_position, exact.platform_position, rtol=0.0, atol=1e-8)
    for name, atol in (("position", 1e-8), ("velocity", 1e-6), ("curvature", 0.0)):
        np.testing.assert_allclose(found.fields[name], exact.fields[name], rtol=0.0, atol=atol)


@pytest.mark.parametrize("top", TOPS.values(), ids=TOPS)
@pytest.mark.parametrize("factor", [1, 2])
def test_the_field_holds_the_extremes_of_gauges_at_its_places(top: Top, factor: int) -> None:
    """The field's waves are products of one another, those of gauges are exponentials."""
    places = tuple(np.linspace(0.0, 1.0, 41))
    scene = replace(DAMPED, top=top, output=replace(DAMPED.output, gauges=places))
    along, alone = (run_axial_transform(scene, factor=factor, with_field=given) for given in (True, False))
    np.testing.assert_array_equal(along.tension, alone.tension)
    np.testing.assert_array_equal(along.platform_position, alone.platform_position)
    np.testing.assert_allclose(along.field.position, places, atol=1e-15)
    for extreme in ("maximum", "minimum"):
        of_field, of_gauges = getattr(along.field, extreme), getattr(alone.field, extreme)
        np.testing.assert_allclose(of_field, of_gauges, rtol=0.0, atol=1e-11 * np.max(of_gauges))


def test_a_refined_march_of_the_damped_cable_approaches_it() -> None:
    exact = run_axial_transform(DAMPED, factor=2)
    marches = [run_chain(DAMPED, cells, viscous=False) for cells in (20, 80)]
    coarse, fine = (relative(march.tension, exact.tension) for march in marches)
    assert fine < 2e-7
    assert fine < 0.1 * coarse
    assert relative(run_axial_waves(FREE, 20).tension, exact.tension) > 10.0 * fine  # damping is seen
    coarse, fine = (relative(march.strain, exact.strain) for march in marches)
    assert fine < 1e-5  # the march lags its damping by half a step
    assert fine < 0.25 * coarse
    assert np.max(np.abs(marches[1].platform_position - exact.platform_position)) < 1e-8


def test_field_bounds_what_the_gauges_read() -> None:
    found = run_axial_transform(DAMPED)
    np.testing.assert_allclose(np.max(found.field.maximum[:, 0]), np.max(found.tension[:, 0]))
    np.testing.assert_allclose(np.min(found.field.minimum[:, -1]), np.min(found.tension[:, 2]))
    assert np.all(found.field.minimum <= found.field.maximum)


def test_measured_motion_counts_from_its_start() -> None:
    axis = np.linspace(0.0, 6.0, 601)
    motion = 0.01 * (1.0 - np.cos(3.0 * axis)) ** 2
    scene = replace(DAMPED, bottom=Bottom("measured"))
    low, high = (
        run_axial_transform(scene, measured=MeasuredMotion(axis, motion + offset)).tension
        for offset in (0.0, 0.7)
    )
    np.testing.assert_allclose(low, high, rtol=0.0, atol=1e-8)


def test_a_sudden_start_is_refused_with_a_remedy() -> None:
    sudden = replace(DAMPED, bottom=replace(DAMPED.bottom, start="jump", ramp=None))
    with pytest.raises(DataError, match="rings") as caught:
        run_axial_transform(sudden)
    assert "ramp" in caught.value.remedy
