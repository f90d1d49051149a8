"""Random runs with known clocks: coverage, error over the bound, wrong cycles, refusals.

What is demanded and what is reached stands in reports/clock-errors.md.
"""

from __future__ import annotations

import os
from functools import cache

import pytest

from tethertest.studies.clock_errors.judge import Judged, judged
from tethertest.studies.clock_errors.rig import KNOWN_RIG
from tethertest.studies.clock_errors.table import demands

RUNS = int(os.environ.get("TETHERTEST_CLOCK_RUNS", "300"))

pytestmark = pytest.mark.verify


@cache
def runs() -> tuple[Judged, ...]:
    return tuple(judged(number, KNOWN_RIG) for number in range(RUNS))


def test_no_wrong_cycle_is_accepted() -> None:
    assert [run.number for run in runs() if run.outcome == "wrong cycle"] == []


def test_a_steady_drive_alone_is_refused() -> None:
    assert [run.number for run in runs() if run.transients == "none" and run.outcome != "refused"] == []


def test_every_demand_is_met() -> None:
    assert [demand for demand in demands(runs()) if not demand.met] == []
