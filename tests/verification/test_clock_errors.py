"""Random runs with known clocks: coverage, error over the bound, wrong cycles, refusals.

What is demanded and what is reached stands in reports/clock_errors.
"""

from __future__ import annotations

import os

import pytest

from reports.clock_errors.judge import judged
from reports.clock_errors.rig import KNOWN_RIG
from reports.clock_errors.table import demands

RUNS = int(os.environ.get("TETHERTEST_CLOCK_RUNS", "300"))


@pytest.mark.verify
def test_every_demand_is_met_and_a_steady_drive_alone_is_refused() -> None:
    runs = [judged(number, KNOWN_RIG) for number in range(RUNS)]
    assert [demand for demand in demands(runs) if not demand.met] == []
    assert [run.number for run in runs if run.transients == "none" and run.outcome != "refused"] == []
