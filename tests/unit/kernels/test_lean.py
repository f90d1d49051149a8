"""The short way through a plane without damping, air or fields: the same numbers as the long way."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tethertest.kernels import cells
from tethertest.records.cable import Cable
from tethertest.records.scene import Bottom, Geometry, Output, Scene, Top
from tethertest.solver.nonlinear.chain_march import run_chain

Run = Callable[[Any], Any]
LEVEL = Scene(
    name="level",
    cable=Cable(250.0, "equilibrium", 0.02, axial_stiffness=120.17),
    geometry=Geometry("shallow", tension=80.0),
    bottom=Bottom("harmonic", amplitude=2.0, frequency=0.18, start="ramp", ramp=5.0),
    top=Top("fixed"),
    output=Output(10.0, 20.0, (0.0, 0.3, 1.0)),
)


def test_one_pass_gives_what_stretch_and_pull_give(run: Run) -> None:
    random = np.random.default_rng(1)
    position = np.cumsum(random.normal(size=(2, 9)), axis=1)
    position[:, 4] = position[:, 3]  # a cell of no length
    stretch, tension, force = np.ones(8), np.zeros(10), np.zeros((2, 8))
    run(cells.pull_plane)(position, 1.25, 70.0, stretch, tension, force)
    long_stretch, rate, along = np.ones(8), np.zeros(10), np.zeros((2, 8))
    long_tension, long_force = np.zeros(10), np.zeros((2, 8))
    cells.stretch_cells(position, 1.25, long_stretch, rate, along)
    cells.pull_cells_elastic(long_stretch, 70.0, along, long_tension, long_force)
    assert np.any(tension == 0.0)
    assert np.any(tension > 0.0)
    np.testing.assert_allclose(stretch, long_stretch, rtol=1e-15)
    np.testing.assert_allclose(tension, long_tension, rtol=1e-14)
    np.testing.assert_allclose(force, long_force, rtol=1e-13, atol=1e-14)


@pytest.mark.parametrize("top", [Top("fixed"), Top("platform", mass=2.0, hover_stiffness=9.0)])
def test_a_march_that_keeps_fields_has_the_tension_of_one_that_does_not(top: Top) -> None:
    scene = replace(LEVEL, top=top)
    kept = replace(scene, output=replace(scene.output, fields=("position",)))
    lean, full = run_chain(scene, 20, viscous=False), run_chain(kept, 20, viscous=False)
    assert np.ptp(lean.tension[:, -1]) > 5.0
    np.testing.assert_allclose(lean.tension, full.tension, rtol=1e-9)
    np.testing.assert_allclose(lean.platform_position, full.platform_position, atol=1e-9)
