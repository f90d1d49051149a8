from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tethertest.conditioning import condition
from tethertest.conditioning.clocks.fitted import HAND_ERROR
from tethertest.records.run import ClockOffset, Override, Windows


@pytest.mark.parametrize("seed", [1, 2, 3])
@pytest.mark.parametrize(
    ("clock", "offset_limit", "drift_limit"), [("interrogator", 2e-4, 5e-6), ("encoder", 1e-3, 3e-5)]
)
def test_offset_and_drift_lie_within_their_stated_errors(maker, seed, clock, offset_limit, drift_limit):
    bench = maker(seed)
    conditioned = condition(bench.run, bench.logs(), bench.priors)
    fit = next(item for item in conditioned.clocks if item.clock == clock)
    offset, drift = bench.relative(clock)
    assert abs(fit.offset - offset) < min(3 * fit.offset_error, offset_limit)
    assert abs(fit.drift - drift) < min(3 * fit.drift_error, drift_limit)
    assert fit.offset_error < offset_limit


def test_reference_clock_is_the_identity(bench):
    conditioned = condition(bench.run, bench.logs(), bench.priors)
    fit = conditioned.clocks[0]
    assert (fit.clock, fit.offset, fit.drift) == ("daq", 0.0, 0.0)
    np.testing.assert_allclose(conditioned.channel("tension_top").time, bench.stamps["daq"], atol=1e-6)


def test_periodic_record_without_transients_is_refused(maker):
    bench = maker(taps=False, ramps=False)
    windows = Windows(rest_before=(3.0, 8.0), steady=(8.0, 30.0), reason="test")
    conditioned = condition(bench.with_file(windows=windows), bench.logs(), bench.priors)
    fatal = {(item.subject, item.kind) for item in conditioned.findings if item.severity == "fatal"}
    assert ("interrogator", "clock_ambiguous") in fatal
    assert ("encoder", "clock_ambiguous") in fatal
    text = next(item.text for item in conditioned.findings if item.kind == "clock_ambiguous")
    assert "override.clock_offset" in text


def test_start_and_stop_choose_the_cycle_without_taps(maker):
    bench = maker(taps=False)
    conditioned = condition(bench.run, bench.logs(), bench.priors)
    assert not [item for item in conditioned.findings if item.severity == "fatal"]
    fit = conditioned.clocks[2]
    assert abs(fit.offset - bench.relative("encoder")[0]) < 0.01
    assert any("no marker tap" in remark for remark in fit.remarks)


def test_offset_by_hand_wins(bench):
    override = Override({"interrogator": ClockOffset(0.5, "marker tap")})
    conditioned = condition(bench.with_file(override=override), bench.logs(), bench.priors)
    fit = conditioned.clocks[1]
    assert (fit.offset, fit.drift) == (0.5, 0.0)
    assert "marker tap" in fit.method
    assert fit.offset_error == HAND_ERROR
    assert "assumed" in fit.method
    assert [item.severity for item in conditioned.findings if item.kind == "clock_override"] == ["note"]


def test_an_offset_by_hand_carries_the_error_that_it_is_given(bench):
    override = Override({"interrogator": ClockOffset(0.5, "marker tap", 2e-3)})
    fit = condition(bench.with_file(override=override), bench.logs(), bench.priors).clocks[1]
    assert fit.offset_error == 2e-3
    assert "+/- 2 ms" in fit.method
    assert "assumed" not in fit.method


def test_clock_without_anything_to_compare_is_fatal(bench):
    priors = replace(bench.priors, expected_tension=None)
    conditioned = condition(bench.run, bench.logs(), priors)
    found = [item for item in conditioned.findings if item.severity == "fatal"]
    assert [(item.subject, item.kind) for item in found] == [("encoder", "clock_not_aligned")]


def test_phase_of_the_drive_does_not_enter_the_encoders_clock(bench):
    """A replay that is late by 20 degrees in the drive, but right in the taps, moves the clock by nothing."""

    def late(heave):
        right = bench.priors.expected_tension(heave)
        wrong = np.interp(right.time - 20.0 / 360.0 / 0.5, right.time, right.values)
        middle = (right.time > right.time[0] + 9.0) & (right.time < right.time[0] + 26.0)
        return right.with_values(np.where(middle, wrong, right.values))

    straight = condition(bench.run, bench.logs(), bench.priors).clocks[2]
    bent = condition(bench.run, bench.logs(), replace(bench.priors, expected_tension=late)).clocks[2]
    assert bent.offset == pytest.approx(straight.offset, abs=2e-5)
