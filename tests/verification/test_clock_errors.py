"""Three hundred random runs with known clocks: coverage, error over the bound, wrong cycles, refusals.

What is demanded and what is reached stands in reports/clock-errors.md.
"""

from __future__ import annotations

import os
from functools import cache

import pytest

from tethertest.studies.clock_errors.judge import Judged, judged
from tethertest.studies.clock_errors.table import Demand, demands

#: demanded and not reached, and why: what is reached is asserted below
MISSED = {
    # 2 demanded, of noise alone; with the rig's uncertainty among the bound's unknowns, as in the fit, it
    # is met
    "median error of the offset over the bound": 2.6,
    # 95 % demanded: records slower than 40 Hz fold knocks and bouncing into their band
    "true offsets inside the stated interval of 95 %": 93.0,
}

RUNS = int(os.environ.get("TETHERTEST_CLOCK_RUNS", "300"))

pytestmark = pytest.mark.verify


@cache
def runs() -> tuple[Judged, ...]:
    return tuple(judged(number) for number in range(RUNS))


@cache
def found() -> dict[str, Demand]:
    return {demand.text: demand for demand in demands(runs())}


def test_no_wrong_cycle_is_accepted() -> None:
    assert [run.number for run in runs() if run.outcome == "wrong cycle"] == []


def test_a_steady_drive_alone_is_refused() -> None:
    assert [run.number for run in runs() if run.transients == "none" and run.outcome != "refused"] == []


def test_every_demand_is_met_but_those_that_are_known_to_be_missed() -> None:
    missed = {text: demand.found for text, demand in found().items() if not demand.met}
    assert set(missed) <= set(MISSED), missed


def test_what_is_missed_is_missed_by_no_more_than_known() -> None:
    over = float(found()["median error of the offset over the bound"].found)
    assert over <= MISSED["median error of the offset over the bound"]
    covered = float(found()["true offsets inside the stated interval of 95 %"].found.rstrip(" %"))
    assert covered >= MISSED["true offsets inside the stated interval of 95 %"]
