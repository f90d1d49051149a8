"""The line search on a thousand records of each kind, against the rates it states."""

from __future__ import annotations

import os

import pytest

from reports.line_calibration.kinds import KINDS, Kind
from reports.line_calibration.power import AMPLITUDES, NOISES, Noise, coverage, found_at
from reports.line_calibration.rates import rates
from reports.line_calibration.table import coverage_met, found_met

#: of each kind; 10,000 take an hour
RECORDS = int(os.environ.get("TETHERTEST_CALIBRATION_RECORDS", "1000"))

pytestmark = pytest.mark.verify


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.name)
def test_false_subharmonics_stay_below_one_percent(kind: Kind) -> None:
    found = rates(kind, RECORDS)
    assert found.met, found


@pytest.mark.parametrize("amplitude", AMPLITUDES)
def test_power_is_within_its_price_of_the_f_test_and_amplitudes_have_no_bias(amplitude: float) -> None:
    found = found_at(amplitude, RECORDS)
    assert found_met(found), found


@pytest.mark.parametrize(("name", "noise", "allowed"), NOISES, ids=[name for name, _, _ in NOISES])
def test_intervals_cover_what_they_state(name: str, noise: Noise, allowed: float) -> None:
    found = coverage(name, noise, allowed, RECORDS // 2)
    assert coverage_met(found), found
