"""What is kept of a march: readings between stations, curvature of circles, extremes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from tethertest.kernels import record
from tethertest.records.arrays import FloatArray
from tethertest.records.scene import Output
from tethertest.solver.nonlinear.chain_march import empty_record

Run = Callable[[Any], Any]
STIFFNESS, CELL = 200.0, 0.5


def test_extremes_only_widen(run: Run) -> None:
    highest, lowest = np.array([1.0, 5.0, -np.inf]), np.array([1.0, 4.0, np.inf])
    run(record.widen)(np.array([2.0, 4.5, 3.0]), highest, lowest)
    np.testing.assert_array_equal(highest, [2.0, 5.0, 3.0])
    np.testing.assert_array_equal(lowest, [1.0, 4.0, 3.0])


def read(
    run: Run, gauges: tuple[float, ...], station: FloatArray, stretch: FloatArray, d: int = 2
) -> FloatArray:
    """Readings of gauges on a cable whose node i lies at i and moves with -i."""
    n = stretch.size
    kept = empty_record(Output(1.0, 1.0, gauges, ("position",)), n, 10, d, 0.1, native_times=False)
    now = np.full((len(gauges), 3 + 2 * d), np.nan)
    position = np.outer(np.arange(1.0, d + 1.0), np.arange(n + 1.0))
    along = np.tile(np.eye(d)[:, :1], (1, n))
    run(record.sample_tension)(kept.gauge_index, kept.gauge_weight, station, stretch, STIFFNESS, now)
    places = (kept.node_index, kept.node_weight)
    run(record.sample_motion)(places, position, -position, along, stretch, CELL, now)
    return now


def test_gauges_read_between_bottom_end_cell_centres_and_top_end(run: Run) -> None:
    gauges = (0.0, 0.0625, 0.125, 0.25, 0.4375, 0.875, 0.9375, 1.0)
    station, stretch = (
        np.array([1.0, 2.0, 4.0, 8.0, 16.0, 32.0]),
        1.0 + np.array([2.0, 4.0, 8.0, 16.0]) / STIFFNESS,
    )
    now = read(run, gauges, station, stretch)
    tension = np.array([1.0, 1.5, 2.0, 3.0, 5.0, 16.0, 24.0, 32.0])
    np.testing.assert_allclose(now[:, 0], tension)
    np.testing.assert_allclose(now[:, 1], tension / STIFFNESS)  # an end's strain follows its tension
    place = np.array(gauges) * 4.0
    np.testing.assert_allclose(now[:, 2:4], np.outer(place, [1.0, 2.0]), atol=1e-15)
    np.testing.assert_allclose(now[:, 4:6], -np.outer(place, [1.0, 2.0]), atol=1e-15)
    np.testing.assert_allclose(now[:, 6], 0.0)


def test_damping_shows_in_the_tension_and_not_in_the_strain(run: Run) -> None:
    stretch = np.array([1.01, 1.02, 1.03, 1.04])
    station = STIFFNESS * np.array([0.005, 0.01, 0.02, 0.03, 0.04, 0.045]) + 7.0
    now = read(run, (0.0, 0.125, 0.5, 1.0), station, stretch)
    np.testing.assert_allclose(now[:, 1], [0.005, 0.01, 0.025, 0.045])
    np.testing.assert_allclose(now[:, 0], STIFFNESS * now[:, 1] + 7.0)


def test_slack_has_no_strain(run: Run) -> None:
    now = read(run, (0.0, 0.5, 1.0), np.zeros(6), np.array([0.9, 0.8, 0.8, 0.9]))
    np.testing.assert_array_equal(now[:, 1], 0.0)


@pytest.mark.parametrize("d", [2, 3])
def test_curvature_of_a_circle_is_the_reciprocal_radius_up_to_its_ends(run: Run, d: int) -> None:
    angle = np.linspace(0.2, 1.4, 7)
    position = np.zeros((d, 7))
    position[0], position[1] = 2.5 * np.cos(angle), 2.5 * np.sin(angle)
    if d == 3:
        position = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0] @ position
    steps = np.diff(position, axis=1)
    size = np.linalg.norm(steps, axis=0)
    for node in range(7):
        found = run(record.bend_at)(steps / size, size / CELL, CELL, node)
        assert found == pytest.approx(1.0 / 2.5, rel=1e-12)
    assert run(record.bend_at)(steps[:, :1] / size[:1], size[:1] / CELL, CELL, 0) == 0.0  # one cell alone


def test_rows_of_the_scheme_and_of_the_output() -> None:
    output = Output(2.0, 5.0, (0.0, 1.0))
    asked = empty_record(output, 4, 100, 2, 0.021, native_times=False)
    assert asked.rows.shape == (11, 2, 2)
    assert asked.interval == 0.2
    native = empty_record(output, 4, 100, 2, 0.021, native_times=True)
    assert native.rows.shape[0] * 0.021 > 2.0 > (native.rows.shape[0] - 4) * 0.021
    assert native.interval == 0.0
    for kept in (asked, native):
        assert kept.bin_steps * kept.field_maximum.shape[0] >= 100
        assert np.all(kept.field_maximum == -np.inf)
        assert np.all(kept.field_minimum == np.inf)
