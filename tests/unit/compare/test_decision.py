"""The decision rule: guard bands, and errors that the data do not resolve."""

from __future__ import annotations

import numpy as np
import pytest

from tethertest.compare import Uncertainty, decide, order_error
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
