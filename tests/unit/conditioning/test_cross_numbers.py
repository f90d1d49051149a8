"""Gains of strain over tension and their uncertainty, on channels of known size."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tethertest.conditioning.cross_check import Gain, cross_findings, gains
from tethertest.conditioning.inertia import Inertia
from tethertest.records.channel import Channel, Flag, Window

from .conftest import RIG, STIFFNESS

RATE, LASTS = 200.0, 20.0
TIME = np.arange(int(LASTS * RATE)) / RATE
WINDOW = Window(0.0, LASTS)
SWING = np.sin(2.0 * np.pi * 0.5 * TIME)
MOVED = np.std(SWING.reshape(-1, 10).mean(axis=1))  # of means over 50 ms
#: a rig that is known exactly, so that what a test leaves unknown stands alone
EXACT = replace(RIG, uncertainty={})


def channel(name: str, kind: str, values: np.ndarray, at: float, **fields: float) -> Channel:
    unit = "N" if kind == "tension" else "1"
    return Channel(name, kind, unit, TIME, values, np.zeros(TIME.size, np.uint16), at=at, **fields)


def top(scale: float = 1.0, at: float = 1.0, **fields: float) -> Channel:
    return channel("tension_top", "tension", 5.0 + scale * SWING, at, **fields)


def bottom(scale: float = 1.0, at: float = 0.0, **fields: float) -> Channel:
    return channel("tension_bottom", "tension", 3.6 + scale * SWING, at, **fields)


def grating(scale: float, at: float = 0.5, rest: float = 0.0, **fields: float) -> Channel:
    return channel("fbg1", "strain", (rest + scale * SWING) / STIFFNESS, at, **fields)


STATIC = {"tension_top": 5.0, "tension_bottom": 3.6}


def gain(*channels: Channel, inertia: float = 0.0) -> Gain:
    """Return the first gain: against both cells where there are two."""
    return gains(channels, EXACT, WINDOW, STATIC, Inertia(inertia))[0]


def test_a_gain_is_stiffness_times_strain_over_tension() -> None:
    found = gain(grating(0.9), top())
    assert found.gain == pytest.approx(0.9)
    assert (found.grating, found.cells) == ("fbg1", ("tension_top",))
    assert found.uncertainty == pytest.approx(0.0, abs=1e-6)
    assert gain(grating(0.9), top(2.0)).gain == pytest.approx(0.45)


def test_between_two_cells_the_tension_is_a_straight_line_between_their_places() -> None:
    # from 1 N at 0.2 to 3 N at 0.8: at 0.35 it is 1.5 N
    found = gain(grating(1.5, at=0.35), bottom(1.0, at=0.2), top(3.0, at=0.8))
    assert found.cells == ("tension_bottom", "tension_top")
    assert found.gain == pytest.approx(1.0)
    every = gains(
        (grating(1.5, at=0.35), bottom(1.0, at=0.2), top(3.0, at=0.8)), EXACT, WINDOW, STATIC, Inertia(0.0)
    )
    assert [item.gain for item in every] == pytest.approx([1.0, 1.5, 0.5, 1.0 / 3.0])
    assert (every[-1].grating, every[-1].cells) == ("tension_bottom", ("tension_top",))


def test_scales_of_grating_cell_and_cable_add_in_square() -> None:
    rig = replace(EXACT, uncertainty={"cable.axial_stiffness": 0.02 * STIFFNESS})
    one = gains((grating(0.9, uncertainty=0.01), top(uncertainty=0.02)), rig, WINDOW, STATIC, Inertia(0.0))[0]
    assert one.uncertainty == pytest.approx(0.9 * 0.03, rel=1e-4)
    # of two cells the mean square counts
    two = gain(grating(0.9), bottom(uncertainty=0.02), top(uncertainty=0.01))
    assert two.uncertainty == pytest.approx(0.9 * np.sqrt(2.5) * 0.01, rel=1e-4)


def test_inertia_counts_by_the_way_between_as_a_rectangle() -> None:
    one = gain(grating(0.9, at=0.75), top(), inertia=0.08)
    assert one.uncertainty == pytest.approx(0.9 * 0.08 * 0.25 / np.sqrt(3.0) / MOVED, rel=3e-3)
    both = gain(grating(0.9), bottom(), top(), inertia=0.08)
    assert both.uncertainty == pytest.approx(0.9 * 0.01 / np.sqrt(3.0) / MOVED, rel=3e-3)
    cells = gains((bottom(), top(at=0.8)), EXACT, WINDOW, STATIC, Inertia(0.08))[-1]
    assert cells.uncertainty == pytest.approx(0.08 * 0.8 / np.sqrt(3.0) / MOVED, rel=3e-3)


def test_the_offset_is_at_mean_tension_and_knows_both_zeros() -> None:
    found = gain(grating(1.0, rest=0.3, offset_uncertainty=3e-6), top(offset_uncertainty=0.04))
    assert found.offset == pytest.approx(0.3, abs=1e-6)
    assert found.offset_uncertainty == pytest.approx(np.hypot(3e-6 * STIFFNESS, 0.04), rel=1e-4)
    # an uncertain gain leaves the offset uncertain as far as the mean is from rest
    loaded = channel("tension_top", "tension", 7.0 + SWING, 1.0, uncertainty=0.05)
    raised = gain(grating(1.0, rest=2.0), loaded)
    assert raised.offset == pytest.approx(0.0, abs=1e-6)
    assert raised.offset_uncertainty == pytest.approx(0.05 * 2.0, rel=1e-3)


def test_noise_of_the_tension_flattens_a_slope_and_is_put_back() -> None:
    random = np.random.default_rng(4)
    found = []
    for _ in range(20):
        # 0.3 N a sample are 0.095 N a mean of ten: 1.8 % of the variance
        noisy = channel(
            "tension_top", "tension", 5.0 + SWING + 0.3 * random.standard_normal(TIME.size), 1.0, noise=0.3
        )
        found.append(gain(grating(1.0), noisy))
    assert np.mean([item.gain for item in found]) == pytest.approx(1.0, abs=0.006)
    # the jackknife's error is the scatter of the gains
    scatter = np.std([item.gain for item in found])
    assert np.mean([item.uncertainty for item in found]) == pytest.approx(scatter, rel=0.4)


def test_a_gain_agrees_within_three_standard_uncertainties() -> None:
    plain = gain(grating(1.0), top())
    assert replace(plain, gain=1.029, uncertainty=0.01).agrees
    assert replace(plain, gain=0.971, uncertainty=0.01).agrees
    assert not replace(plain, gain=1.031, uncertainty=0.01).agrees
    assert not replace(plain, gain=0.969, uncertainty=0.01).agrees


def test_a_tension_that_hardly_moves_or_a_short_window_tells_nothing() -> None:
    # five standard errors of a mean: 5 x 0.3 / sqrt(10) = 0.474 N, and the swing has 0.7 N
    assert gains((grating(1.0), top(0.64, noise=0.3)), EXACT, WINDOW, STATIC, Inertia(0.0)) == ()
    assert gains((grating(1.0), top(0.72, noise=0.3)), EXACT, WINDOW, STATIC, Inertia(0.0))
    for length, told in ((1.95, False), (2.1, True)):
        found = gains((grating(1.0), top()), EXACT, Window(0.0, length), STATIC, Inertia(0.0))
        assert bool(found) is told


def test_means_with_a_lost_sample_do_not_count() -> None:
    spoiled = grating(1.0).with_values(np.where(TIME < 10.0, 50.0 / STIFFNESS, SWING / STIFFNESS))
    lost = spoiled.with_flags((TIME < 10.0) & (np.arange(TIME.size) % 10 == 5), Flag.LOST)
    assert gain(lost, top()).gain == pytest.approx(1.0)


def test_two_gratings_off_by_one_factor_are_told_so_and_by_several_not() -> None:
    def said(*sizes: float) -> str:
        strains = [
            replace(grating(size), name=name) for size, name in zip(sizes, ("fbg1", "fbg2"), strict=True)
        ]
        found = gains((*strains, bottom(), top()), EXACT, WINDOW, STATIC, Inertia(0.0))
        (warning,) = [item for item in cross_findings(found, EXACT) if item.severity == "warning"]
        assert warning.subject == "cable"
        return warning.text

    assert "all gratings disagree with the tension by one factor: " in said(1.4, 1.42)
    assert "all gratings disagree with the tension: " in said(1.4, 2.4)


def test_a_doubt_about_the_inertia_is_told_with_the_gains() -> None:
    found = gains((grating(1.0), top()), EXACT, WINDOW, STATIC, Inertia(0.0))
    (plain,) = cross_findings(found, EXACT)
    (doubted,) = cross_findings(found, EXACT, "no motion was measured")
    assert doubted.text == f"{plain.text}; no motion was measured"
    assert plain.text.startswith(
        "axial stiffness times strain over tension, 3 standard uncertainties: fbg1 1 +/- "
    )
