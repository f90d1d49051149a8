"""How gratings move together, by hand; and peaks that do not move with them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tethertest.conditioning.gratings.pattern import Pattern, coarse, learnt
from tethertest.conditioning.gratings.spurious_peaks import stray, unmoved

EXPECTED = np.array([1500e-9, 1510e-9, 1540e-9])
CAPTURE = np.full(3, 3e-9)
STRAINED = np.array([True, True, False])
ROWS = np.arange(400)


def rough() -> Pattern:
    time = ROWS * 0.01
    return coarse(EXPECTED, CAPTURE, STRAINED, EXPECTED + 1e-12 * np.sin(time)[:, None], time)


def whole(late: float = 0.0) -> np.ndarray:
    """Return peaks that shift by 1e-3 at row 200, the second grating late there by a share of it."""
    shift = np.where(ROWS >= 200, 1e-3, 0.0)
    relative = np.column_stack((shift, 0.9 * shift + 2e-4, 0.0 * shift - 1e-4))
    relative[200, 1] -= late * 1e-3
    noise = 1e-12 * np.random.default_rng(2).standard_normal((400, 3))
    return EXPECTED * (1.0 + relative) + noise


def test_a_rig_file_alone_allows_a_quarter_of_the_way_to_the_nearest_neighbour() -> None:
    found = rough()
    # 10 nm and 10 nm; the third has 30 nm, but never more than four captures
    assert found.tolerance * EXPECTED == pytest.approx(0.25 * np.array([10e-9, 10e-9, 12e-9]))
    assert found.gain.tolist() == [1.0, 1.0, 0.0]
    assert found.reach == pytest.approx(3e-9 / 1500e-9 / 0.3)
    assert (found.low, found.high) == (-found.reach, found.reach)
    assert found.slack == pytest.approx(2.0 * 0.25 * 12e-9 / 1540e-9)


def test_whole_rows_teach_offsets_gains_and_the_span_of_the_motion() -> None:
    taught = learnt(rough(), whole(), ROWS, 400)
    assert taught is not None
    pattern, shift, keeps = taught
    # only the product of gain and shift is seen: the median gain is one
    assert pattern.gain[1] / pattern.gain[0] == pytest.approx(0.9, rel=0.01)
    assert pattern.gain[2] == pytest.approx(0.0, abs=0.01)
    assert pattern.offset[2] == pytest.approx(-1e-4, abs=2e-6)
    assert np.all(keeps)
    assert pattern.wavelength(shift) == pytest.approx(whole(), abs=1e-11)
    assert pattern.shift_of(whole()[300])[:2] == pytest.approx(shift[300], rel=0.02)
    assert np.isnan(pattern.shift_of(whole()[300])[2])
    assert (pattern.low, pattern.high) == pytest.approx((shift.min(), shift.max()))


def test_a_grating_may_part_by_three_tenths_of_a_fast_change() -> None:
    # the common motion of two is their mean, so that half of it is late in either, and the change less
    for late, kept in ((0.36, True), (0.46, False)):
        taught = learnt(rough(), whole(late), ROWS, 400)
        assert taught is not None
        keeps = taught[2]
        assert bool(keeps[200]) is kept
        assert np.count_nonzero(~keeps) == (0 if kept else 1)


def test_a_peak_that_stands_still_while_the_others_move_is_none_of_a_strained_grating() -> None:
    taught = learnt(rough(), whole(), ROWS, 400)
    assert taught is not None
    pattern, shift, _ = taught
    every = replace(pattern, strained=np.array([True, True, True]))
    column = np.tile(np.arange(3), (400, 1))
    assert unmoved(whole(), column, shift, every).tolist() == [False, False, True]
    assert unmoved(whole(), column, shift, pattern).tolist() == [False, False, False]
    # fewer than fifty peaks of one are no judgement, and do not end that of the others
    rare = column.copy()
    rare[49:, 0] = -1
    assert unmoved(whole(), rare, shift, every).tolist() == [False, False, True]
    # nor is one that is seen at rest only
    rest = column.copy()
    rest[100:, 0] = -1
    assert unmoved(whole(), rest, shift, every).tolist() == [False, False, True]
    rare[49:, 2] = -1
    assert unmoved(whole(), rare, shift, every).tolist() == [False, False, False]
    rare[:, 2] = np.where(ROWS % 8 == 0, 2, -1)
    assert unmoved(whole(), rare, shift, every).tolist() == [False, False, True]


def test_a_peak_next_to_one_that_nobody_owns_is_in_doubt_for_three_seconds() -> None:
    time = np.array([0.0, 1.0, 3.9, 4.1])
    at = 1500e-9
    peaks = np.array([[at, np.nan], [at + 10e-12, 1510e-9], [at, np.nan], [at, np.nan]])
    column = np.array([[0], [1], [0], [0]])
    # row 1 gives the grating its second peak, and leaves one that stands where the others' does
    assert stray(peaks, column, time)[:, 0].tolist() == [True, False, True, False]
    far = peaks.copy()
    far[1, 0] = at + 20e-12
    assert not stray(far, column, time).any()
