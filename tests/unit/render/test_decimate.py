from itertools import pairwise

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from tethertest.render.decimate import envelope, extreme_indices, greatest_indices, reduced_rows


def test_single_spikes_survive_a_thousandfold_decimation():
    time = np.arange(100_000) * 1e-3
    values = np.sin(time)
    values[41_234], values[77_777] = 30.0, -20.0
    keep = extreme_indices(time, values, 100)
    assert keep.size <= 400
    assert {41_234, 77_777} <= set(keep)
    assert np.all(np.diff(keep) > 0)


@given(st.integers(1, 60), st.integers(500, 3000), st.integers(0, 2**31))
def test_every_column_keeps_its_least_and_greatest(columns, size, seed):
    rng = np.random.default_rng(seed)
    time = np.sort(rng.uniform(0.0, 10.0, size))
    values = rng.standard_normal(size)
    keep = extreme_indices(time, values, columns)
    edges = np.linspace(time[0], time[-1], columns + 1)
    edges[-1] = np.inf
    for left, right in pairwise(edges):
        inside = (time >= left) & (time < right)
        if inside.any():
            chosen = values[keep][(time[keep] >= left) & (time[keep] < right)]
            assert chosen.min() == values[inside].min()
            assert chosen.max() == values[inside].max()


def test_a_short_series_is_left_alone():
    assert extreme_indices(np.arange(40.0), np.zeros(40), 10).tolist() == list(range(40))


def test_a_gap_wider_than_a_column_stays_a_gap():
    values = np.ones(10_000)
    values[4000:6000] = np.nan
    keep = extreme_indices(np.arange(10_000.0), values, 50)
    assert np.isnan(values[keep]).any()
    assert np.isfinite(values[keep]).sum() >= 80


def test_a_spectral_line_one_bin_wide_keeps_its_height():
    frequency = np.linspace(0.1, 500.0, 50_000)
    amplitude = np.full(50_000, 1e-3)
    amplitude[1234] = 5.0
    keep = greatest_indices(np.log(frequency), amplitude, 300)
    assert amplitude[keep].max() == 5.0
    assert keep.size <= 300


def test_the_outline_touches_crests_and_troughs():
    time = np.arange(9000) * 0.01
    _, low, high = envelope(time, np.cos(2 * np.pi * 3.0 * time), 60)
    np.testing.assert_allclose(high, 1.0, atol=0.02)
    np.testing.assert_allclose(low, -1.0, atol=0.02)


def test_a_map_keeps_its_peak_and_where_rows_begin():
    tension = np.zeros((1000, 3))
    tension[637, 1] = 9.0
    rows, starts = reduced_rows(tension, 40, np.fmax)
    assert rows.shape == (40, 3)
    assert rows[np.searchsorted(starts, 637, "right") - 1, 1] == 9.0
