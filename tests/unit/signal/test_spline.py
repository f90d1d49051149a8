"""The package's own spline, filters and windows give the numbers of scipy's, which take long to import."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from scipy.signal import butter, sosfiltfilt

from tethertest.signal.filters import low_passed
from tethertest.signal.spline import spline

RANDOM = np.random.default_rng(3)


@pytest.mark.parametrize("count", [2, 3, 4, 5, 200])
@pytest.mark.parametrize("columns", [(), (3,)])
def test_a_spline_is_scipys_at_knots_between_them_and_beyond(count, columns):
    time = np.cumsum(RANDOM.uniform(0.5, 1.5, count))
    values = RANDOM.normal(size=(count, *columns))
    at = np.concatenate((time, RANDOM.uniform(time[0] - 1.0, time[-1] + 1.0, 300)))
    ours, theirs = spline(time, values), CubicSpline(time, values)
    for derivative in (0, 1, 2):
        np.testing.assert_allclose(ours(at, derivative), theirs(at, derivative), rtol=1e-13, atol=1e-13)
    np.testing.assert_allclose(ours.slope()(at), theirs.derivative()(at), rtol=1e-13, atol=1e-13)


def test_a_spline_keeps_the_shape_of_the_times():
    time = np.arange(5.0)
    assert spline(time, time**3)(np.full((2, 3), 2.5)) == pytest.approx(np.full((2, 3), 2.5**3))


@pytest.mark.parametrize("cutoff", [0.05, 1.0, 20.0, 44.0])
@pytest.mark.parametrize("count", [1, 2, 50, 3000])
def test_the_low_pass_is_a_butterworth_run_both_ways(cutoff, count):
    values, rate = np.cumsum(RANDOM.normal(size=count)), 100.0
    single = min(cutoff / (np.sqrt(2.0) - 1.0) ** 0.25, 0.45 * rate)
    sections = butter(2, single, fs=rate, output="sos")
    padding = min(count - 1, round(3.0 * rate / cutoff))
    wanted = sosfiltfilt(sections, values, padlen=padding)
    np.testing.assert_allclose(low_passed(values, rate, cutoff), wanted, rtol=1e-12, atol=1e-12)
