"""Every command says the same of a run: the same drive, lines, verdicts, events, findings and words."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from tests.schema_check import faults
from tethertest.cli.schemas import schema_of
from tethertest.jobs.across_runs import run_part
from tethertest.jobs.analysis_options import Options
from tethertest.jobs.analyze import analyze
from tethertest.jobs.ingest import ingest_run
from tethertest.records.across import RunPart
from tethertest.records.analysis import MEASURED, REPLAYED, Analysis
from tethertest.records.lines import ChannelLines
from tethertest.records.report import Report
from tethertest.render.analysis import analysis_summary
from tethertest.render.as_json import as_json, json_line
from tethertest.render.page import page
from tethertest.render.summary import summary

ROOT = Path(__file__).parents[2]
RIGS = ROOT / "rigs"
#: taut, and slack with snaps
RUNS = ("run02", "run12")


@dataclass(frozen=True)
class Answers:
    """What the commands say of one run."""

    report: Report
    analysis: Analysis
    of_store: Analysis
    part: RunPart


@pytest.fixture(scope="module", params=RUNS)
def answers(
    request: pytest.FixtureRequest,
    tmp_path_factory: pytest.TempPathFactory,
    campaign_report: Callable[[Path], Report],
) -> Answers:
    folder = ROOT / "datasets" / "rig3m" / request.param
    store = tmp_path_factory.mktemp(request.param) / "run.h5"
    ingest_run(folder, store, RIGS)
    options = Options(rigs=RIGS, replay=True)
    return Answers(
        campaign_report(folder),
        analyze(folder, options),
        analyze(store, options),
        run_part(folder, options),
    )


def told(found: ChannelLines) -> list[tuple[Any, ...]]:
    return [
        (line.order, line.frequency, line.amplitude, line.phase, line.interval, line.verdict, line.reason)
        for line in found.lines
    ]


def lines_of(analysis: Analysis, side: str) -> dict[str, list[tuple[Any, ...]]]:
    return {
        item.channel.name: told(item.lines)
        for item in analysis.channels
        if item.side == side and item.lines is not None
    }


def test_the_drive_and_the_window_are_the_same(answers: Answers) -> None:
    report, analysis = answers.report, answers.analysis
    assert report.drive is not None
    assert analysis.drive == answers.of_store.drive == report.drive
    assert analysis.window == answers.of_store.window == report.measured.steady
    assert answers.part.frequency == report.drive.frequency


@pytest.mark.parametrize("side", [MEASURED, REPLAYED])
def test_lines_have_the_same_numbers_verdicts_and_reasons(answers: Answers, side: str) -> None:
    lines = answers.report.measured_lines if side == MEASURED else answers.report.replayed_lines
    said = {found.channel: told(found) for found in lines}
    assert len(said) >= 7
    assert lines_of(answers.analysis, side) == said
    assert lines_of(answers.of_store, side) == said
    curves = {
        item.name: told(item.lines) for item in answers.part.channels if item.side == side and item.lines
    }
    assert curves == {name: found for name, found in said.items() if name in curves}
    assert len(curves) >= 7


def test_one_channel_asked_for_is_told_what_it_is_told_among_all(answers: Answers) -> None:
    folder = ROOT / "datasets" / "rig3m" / answers.report.run.folder.name
    alone = analyze(folder, Options(rigs=RIGS, channels=("fbg5",)))
    assert lines_of(alone, MEASURED)["fbg5"] == lines_of(answers.analysis, MEASURED)["fbg5"]


def test_events_are_the_same(answers: Answers) -> None:
    report, analysis = answers.report, answers.analysis
    for events, side in ((report.events, MEASURED), (report.replayed_events, REPLAYED)):
        assert events == tuple(e for item in analysis.channels if item.side == side for e in item.events)


def test_json_keeps_to_the_published_schemas(answers: Answers) -> None:
    printed = {**as_json(summary(answers.report)), "paths": ["report.html"]}
    assert faults(printed, schema_of("report")) == []
    for analysis in (answers.analysis, answers.of_store):
        assert faults(as_json(analysis_summary(analysis)), schema_of("analyze")) == []


def test_lines_and_events_have_the_same_json(answers: Answers) -> None:
    reported, analysed = as_json(summary(answers.report)), as_json(analysis_summary(answers.analysis))
    channels = {item["name"]: item for item in analysed["channels"] if item["side"] == MEASURED}
    assert {item["name"] for item in reported["lines"]["channels"]} == channels.keys()
    for item in reported["lines"]["channels"]:
        assert item["lines"] == channels[item["name"]]["lines"]
        assert item["events"] == channels[item["name"]]["events"]


def test_findings_of_the_report_are_notes_of_the_analysis(answers: Answers) -> None:
    severe = [
        f"{found.subject}: {found.text}"
        for found in answers.report.measured.findings
        if found.severity != "note"
    ]
    assert [note for note in answers.analysis.notes if note in severe] == severe
    assert answers.part.remarks == tuple(severe)


def test_a_verdict_has_one_word(answers: Answers) -> None:
    shown = page(answers.report)
    printed = json_line(analysis_summary(answers.analysis))
    assert '"verdict": "harmonic"' in printed
    assert ">harmonic<" in shown
    assert ">drive<" not in shown
