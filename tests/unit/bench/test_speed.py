"""The measure itself: peaks, references by scene, and a taut scene's runs."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from reports.scenes import SHIPPED, condition, condition_upright, rig, snap
from tethertest.bench import speed
from tethertest.bench.case import Case, load_cases
from tethertest.bench.moordyn import moordyn_knows
from tethertest.bench.reference_for import closed_form, is_sudden, reference_for
from tethertest.bench.spectral_elements.march import run_spectral
from tethertest.bench.speed import mean_peak, scene_speed, variants
from tethertest.records.scene import Top
from tethertest.solver.norms import relative_difference


def shortened(name: str, duration: float) -> Case:
    (case,) = load_cases([SHIPPED / f"{name}.toml"])
    scene = case.scene
    return replace(case, scene=replace(scene, output=replace(scene.output, duration=duration)))


def test_peak_of_a_running_mean() -> None:
    tension = np.zeros((100, 2))
    tension[50, 0] = 10.0  # one row alone is thinned out
    tension[20:40, 1] = 3.0
    assert mean_peak(tension, 20) == pytest.approx(3.0)
    assert mean_peak(tension, 1) == pytest.approx(10.0)


def test_closed_form_of_the_first_passages_of_a_step() -> None:
    """A fixed end doubles the front, -Z v on its way and -2 Z v at the top."""
    case = shortened("straight-free-shape", 0.4)
    scene = case.scene
    rest_length = 100.0 / (1.0 + 100.0 / 20e3)
    mass = 0.05 * 100.0 / rest_length
    drop, traverse = 0.01 * math.sqrt(20e3 * mass), rest_length * math.sqrt(mass / 20e3)
    tension = closed_form(scene)
    assert tension is not None
    time = np.arange(tension.shape[0]) / scene.output.rate
    before, after = time < traverse - 1e-3, (time > traverse + 1e-3) & (time < 2.9 * traverse)
    np.testing.assert_allclose(tension[before, 2], 100.0, rtol=1e-12)
    np.testing.assert_allclose(tension[after, 2], 100.0 - 2.0 * drop, rtol=1e-12)
    np.testing.assert_allclose(tension[before, 0], 100.0 - drop, rtol=1e-12)


def test_closed_form_meets_spectral_elements_on_a_ramp() -> None:
    scene = condition_upright(0.25)
    exact = closed_form(scene)
    assert exact is not None
    assert relative_difference(run_spectral(scene, 8).tension, exact) < 1e-5


def test_closed_form_is_not_given_where_it_is_not_the_answer() -> None:
    upright = condition_upright(0.25)
    damped = replace(upright, cable=replace(upright.cable, axial_damping_time=1e-3))
    for scene in (snap(), rig(), damped):
        assert closed_form(scene) is None


@pytest.mark.parametrize(
    ("name", "duration", "kind", "found"),
    [
        ("taut-vertical-jump", 5.0, "closed form", "d'Alembert"),
        ("paper-1.1-f018-ramp", 12.0, "other discretisation", "spectral"),
        ("paper-1.1-f025", 2.0, "same scheme", "3200 cells"),
    ],
)
def test_reference_is_of_another_kind_where_there_is_one(
    name: str, duration: float, kind: str, found: str
) -> None:
    reference = reference_for(shortened(name, duration))
    assert reference.kind == kind
    assert found in reference.name


def test_a_taut_scene_by_every_model_that_takes_it() -> None:
    case = shortened("paper-1.1-f018-ramp", 20.0)
    found = scene_speed(case, meshes=(20, 40, 80))
    errors = {(run.curve, run.cells): run.error for run in found.entries}
    assert {curve for curve, _ in errors} == {
        "catenary",
        "linear, exact",
        "linear, two-grid",
        "linear, as-printed",
        "nonlinear, plain",
        "nonlinear, viscous",
        "nonlinear, extrapolated",
    }
    plain = [errors["nonlinear, plain", cells] or 0.0 for cells in (40, 80)]
    assert plain[0] / plain[1] == pytest.approx(4.0, abs=0.4)
    assert (errors["nonlinear, extrapolated", 80] or 1.0) < 0.2 * plain[1]
    assert (errors["catenary", 0] or 0.0) > 0.1
    chosen = found.chosen
    assert chosen.run.error is not None
    assert chosen.numerical is not None
    assert chosen.run.error < 3.0 * chosen.numerical
    assert all(run.wall > 0.0 for run in found.entries)
    assert not list(variants(case, found))


def test_moordyn_is_compared_at_the_ends_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """A stand-in is right at the top and wrong at the bottom; the gauges are the middle and the top."""
    case = shortened("straight-free-shape", 0.4)
    case = replace(case, scene=replace(case.scene, output=replace(case.scene.output, gauges=(0.5, 1.0))))
    exact = closed_form(case.scene)
    assert exact is not None
    ends = np.column_stack([np.zeros(exact.shape[0]), exact[:, 1]])
    monkeypatch.setattr(speed, "run_moordyn", lambda _scene, _segments: (ends, 0.5))
    found = [
        run for run in scene_speed(case, meshes=(20,), with_peers=True).entries if run.curve == "MoorDyn"
    ]
    assert [(run.cells, run.wall, run.error) for run in found] == [(n, 0.5, 0.0) for n in speed.SEGMENTS]
    held = replace(case, scene=replace(case.scene, top=Top("platform", mass=1.0)))
    assert not moordyn_knows(held)


def test_a_jump_without_a_reference_gets_a_variant_that_has_one() -> None:
    case = shortened("paper-1.1-f025", 2.0)
    found = scene_speed(case, meshes=(20,))
    ((variant, remark),) = variants(case, found)
    assert is_sudden(case)
    assert not is_sudden(variant)
    assert "0.2 s" in remark
    assert "spectral" in reference_for(variant).name


def test_condition_is_the_shipped_file() -> None:
    (case,) = load_cases([SHIPPED / "paper-1.1-f018-ramp.toml"])
    scene = condition()
    assert (scene.cable, scene.geometry, scene.bottom) == (
        case.scene.cable,
        case.scene.geometry,
        case.scene.bottom,
    )
