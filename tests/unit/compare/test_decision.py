"""The decision rule: guard bands, and errors that the data do not resolve."""

from __future__ import annotations

import numpy as np
import pytest

from tethertest.compare import Uncertainty, decide, order_error
from tethertest.compare.orders import phasors, wrapped
from tethertest.records.channel import Channel, Flag, Window
from tethertest.records.comparison import Verdict
from tethertest.records.lines import Line, LineVerdict


@pytest.mark.parametrize(
    ("error", "guard", "simple"),
    [
        (0.080, Verdict.PASS, Verdict.PASS),
        (-0.080, Verdict.PASS, Verdict.PASS),
        (0.090, Verdict.UNDECIDED, Verdict.PASS),
        (-0.110, Verdict.UNDECIDED, Verdict.FAIL),
        (0.120, Verdict.FAIL, Verdict.FAIL),
    ],
)
def test_the_guard_band_is_1645_standard_uncertainties_wide(
    error: float, guard: Verdict, simple: Verdict
) -> None:
    # u = 0.01: pass up to 0.1 - 0.01645, fail from 0.1 + 0.01645 on
    uncertainty = Uncertainty(data=0.006, inputs=0.008)
    assert uncertainty.total == pytest.approx(0.01)
    assert decide(error, uncertainty, 0.1, "guard")[0] is guard
    assert decide(error, uncertainty, 0.1, "simple")[0] is simple


def test_the_reason_names_error_limit_and_distance() -> None:
    reason = decide(0.13, Uncertainty(0.001), 0.1, "guard")[1]
    assert reason.startswith("error +13 % ± 0.1 % (data 0.1 %, rig 0 %, numerical 0 %), limit 10 %")
    assert reason.endswith("beyond by 3 %")
    late = decide(-0.2, Uncertainty(0.01), 0.1, "guard", angle=True)[1]
    assert late.startswith("error -0.2 rad ± 0.01 rad")


def test_an_unresolved_error_passes_a_wide_limit_and_says_that_it_is_unresolved() -> None:
    verdict, reason = decide(0.015, Uncertainty(0.01), 0.1, "guard")
    assert verdict is Verdict.PASS
    assert "not resolved at this noise" in reason
    assert "not resolved" not in decide(0.05, Uncertainty(0.01), 0.1, "guard")[1]


def test_without_a_limit_nothing_is_decided() -> None:
    assert decide(3.0, Uncertainty(), None, "guard")[0] is Verdict.INFORMATIVE


def line(amplitude: float, phase: float, standard_error: float) -> Line:
    interval = (amplitude - 2 * standard_error, amplitude + 2 * standard_error)
    return Line("1", 0.3, amplitude, phase, interval, standard_error, 0.0, LineVerdict.HARMONIC, "")


def test_a_replay_that_is_larger_and_later_has_positive_ratio_error_and_negative_phase() -> None:
    # later by 0.1 s at 0.3 Hz: cos(w (t - 0.1)) has a phase of -0.1885 rad
    error = order_error(line(2.0, 0.0, 0.02), line(2.2, -0.1885, 0.0), scale=0.01)
    assert error.amplitude == pytest.approx(0.1)
    assert error.phase == pytest.approx(-0.1885)
    assert error.amplitude_uncertainty == pytest.approx(1.1 * np.hypot(0.01, 0.01))
    assert error.phase_uncertainty == pytest.approx(0.01)


def test_phases_either_side_of_half_a_turn_are_close() -> None:
    assert order_error(line(1.0, 3.1, 0.0), line(1.0, -3.1, 0.0)).phase == pytest.approx(
        2 * np.pi - 6.2, abs=1e-12
    )


def test_the_limit_itself_passes_and_the_far_edge_of_the_guard_band_does_not_fail() -> None:
    sure, half = Uncertainty(), Uncertainty(numerical=0.5)
    assert decide(0.25, sure, 0.25, "guard")[0] is Verdict.PASS
    assert decide(-0.25, sure, 0.25, "simple")[0] is Verdict.PASS
    # 1.645 x 0.5 = 0.8225: both edges exact in binary arithmetic
    assert decide(1.0, half, 1.0 + 0.8225, "guard")[0] is Verdict.PASS
    assert decide(1.0 + 0.8225, half, 1.0, "guard")[0] is Verdict.UNDECIDED
    assert decide(1.0 + 0.8226, half, 1.0, "guard")[0] is Verdict.FAIL


def test_u_val_is_the_root_of_the_sum_of_three_squares() -> None:
    assert Uncertainty(2.0, 3.0, 6.0).total == pytest.approx(7.0)
    assert Uncertainty(0.0, 0.0, 6.0).total == 6.0


def test_two_standard_uncertainties_are_not_resolved_and_no_more() -> None:
    assert "not resolved" in decide(0.5, Uncertainty(0.25), None, "guard")[1]
    assert "not resolved" not in decide(0.51, Uncertainty(0.25), None, "guard")[1]
    assert "not resolved" in decide(0.0, Uncertainty(), None, "guard")[1]


def test_what_stays_undecided_says_on_which_side_it_lies() -> None:
    words = [decide(error, Uncertainty(0.02), 0.1, "guard")[1] for error in (0.09, 0.12)]
    assert "inside by 1 %, which the uncertainty does not settle" in words[0]
    assert "beyond by 2 %, which the uncertainty does not settle" in words[1]
    assert "data 2 %, rig 0 %, numerical 0 %" in words[0]
    assert decide(0.0, Uncertainty(), None, "guard")[1].startswith("error +0 %")
    budget = decide(0.1, Uncertainty(0.01, 0.02, 0.03), None, "guard", angle=True)[1]
    assert "(data 0.01 rad, rig 0.02 rad, numerical 0.03 rad), no limit" in budget


def test_a_measured_amplitude_of_zero_has_no_ratio() -> None:
    found = order_error(line(0.0, 0.0, 0.1), line(1.0, 0.5, 0.0))
    assert found.amplitude == found.amplitude_uncertainty == found.phase_uncertainty == np.inf
    assert found.phase == 0.0


def test_scale_alone_and_noise_alone_enter_the_amplitude() -> None:
    scale = order_error(line(2.0, 0.0, 0.0), line(1.0, 0.0, 0.0), scale=0.02)
    noise = order_error(line(2.0, 0.0, 0.04), line(1.0, 0.0, 0.0))
    assert (scale.amplitude_uncertainty, scale.phase_uncertainty) == pytest.approx((0.01, 0.0))
    assert (noise.amplitude_uncertainty, noise.phase_uncertainty) == pytest.approx((0.01, 0.02))


@pytest.mark.parametrize(("angle", "same"), [(3.5, 3.5 - 2 * np.pi), (-3.5, 2 * np.pi - 3.5), (1.0, 1.0)])
def test_angles_are_wrapped_to_half_a_turn(angle: float, same: float) -> None:
    assert wrapped(angle) == pytest.approx(same)


def test_phasors_of_a_sum_come_apart_with_phases_from_the_windows_start() -> None:
    time = np.arange(4000) / 100.0
    values = 3.0 + 2.0 * np.cos(np.pi * (time - 10.0) + 0.4) + 0.3 * np.cos(2 * np.pi * (time - 10.0) - 1.0)
    flags = np.zeros(time.size, dtype=np.uint16)
    channel = Channel("tension_top", "tension", "N", time, np.where(time < 10.0, 70.0, values), flags)
    found = phasors(channel, Window(10.0, 30.0), [0.5, 1.0])
    assert found[0.5] == pytest.approx(2.0 * np.exp(0.4j), rel=1e-6)
    assert found[1.0] == pytest.approx(0.3 * np.exp(-1.0j), rel=1e-6)
    spiked = channel.with_flags((time > 20.0) & (time < 20.1), Flag.SPIKE)
    spiked = spiked.with_values(np.where((time > 20.0) & (time < 20.1), 500.0, channel.values))
    assert phasors(spiked, Window(10.0, 30.0), [0.5, 1.0])[1.0] == pytest.approx(
        0.3 * np.exp(-1.0j), rel=1e-6
    )


def test_phasors_are_fitted_to_twenty_means_a_period_of_the_highest_order() -> None:
    """At 2000 Hz and 1 Hz a mean holds 100 samples: what alternates from sample to sample is gone."""
    time = np.arange(20_000) / 2000.0
    values = np.cos(2 * np.pi * time) + 5.0 * (-1.0) ** np.arange(time.size)
    channel = Channel("t", "tension", "N", time, values, np.zeros(time.size, dtype=np.uint16))
    assert phasors(channel, Window(0.0, 9.9995), [1.0])[1.0] == pytest.approx(1.0, rel=1e-9)
