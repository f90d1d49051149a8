"""The whole chain on the synthetic campaign, held against the truth that the chain never opens."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from reports.rig3m_campaign import check
from tethertest.records.channel import Flag
from tethertest.records.report import Report

ROOT = Path(__file__).parents[2]
CAMPAIGN = ROOT / "datasets" / "rig3m"
#: run -> verdicts that are right for it; the axial replay cannot pass a cable that bows sideways while slack
QUICK = {"run04": {"pass"}, "run15": {"fail", "undecided"}, "run16": {"pass"}, "run19": {"undecided"}}
OTHERS = sorted(path.name for path in CAMPAIGN.glob("run*") if path.name not in QUICK)


Reports = Callable[[Path], Report]


@pytest.mark.parametrize("name", QUICK)
def test_what_the_report_recovers_is_the_truth(
    name: str, campaign_report: Reports, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(check, "make_report", campaign_report)
    found = check.check_run(CAMPAIGN / name)
    assert found.complaints == []
    assert found.verdict in QUICK[name]


@pytest.mark.verify
@pytest.mark.parametrize("name", OTHERS)
def test_every_other_run_too(name: str) -> None:
    assert check.check_run(CAMPAIGN / name).complaints == []


def test_f_over_two_of_the_drive_is_told_from_a_true_period_two(campaign_report: Reports) -> None:
    """Run 16's half-order comes in through a gear; run 15's is made by the cable."""
    borne = campaign_report(CAMPAIGN / "run16")
    made = campaign_report(CAMPAIGN / "run15")

    def verdict_of_half_order(report: object) -> str:
        lines = next(item for item in report.measured_lines if item.channel == "tension_top")  # type: ignore[attr-defined]
        return str(lines.line("1/2").verdict.value)

    assert verdict_of_half_order(borne) == "input_borne"
    assert verdict_of_half_order(made) == "subharmonic"
    assert any("moves along the cable only" in reason for reason in made.comparison.reasons)
    assert not any("moves along the cable only" in reason for reason in borne.comparison.reasons)


def test_a_lost_grating_blanks_itself_and_moves_no_other(campaign_report: Reports) -> None:
    report = campaign_report(CAMPAIGN / "run18")
    truth = json.loads((CAMPAIGN / "run18" / "truth.json").read_text(encoding="utf-8"))
    lost = {flaw["channel"]: flaw["samples"] for flaw in truth["flaws"]}
    for channel in report.measured.channels:
        if channel.kind != "strain":
            continue
        blank = (channel.flags & Flag.LOST) != 0
        assert blank.sum() == lost.get(channel.name, 0)
        replayed = next(item for item in report.replayed if item.name == channel.name)
        common = channel.between(replayed.time[0], replayed.time[-1])
        difference = common.values[common.usable] - replayed.values[common.usable]
        assert abs(difference).max() < 2e-4  # a neighbour's wavelength would be off by 8e-3
