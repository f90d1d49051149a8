"""Random runs with known clocks on a rig that differs from its file by as much as the file says."""

from __future__ import annotations

import pytest

from reports.clock_errors.judge import judged
from reports.clock_errors.table import demands

RUNS = 300


@pytest.mark.verify
def test_every_demand_is_met_where_the_rig_is_off() -> None:
    runs = [judged(number) for number in range(RUNS)]
    assert [demand for demand in demands(runs) if not demand.met] == []
