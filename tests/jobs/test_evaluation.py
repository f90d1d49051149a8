"""What an evaluation is asked for is made once, and a run that lacks something still tells the rest."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from tethertest.errors import DataError
from tethertest.jobs.analysis_options import FALSE_LINES_OF_RUN, Options
from tethertest.jobs.evaluation import open_evaluation
from tethertest.jobs.report import make_report

ROOT = Path(__file__).parents[2]
RIGS = ROOT / "rigs"


@pytest.fixture(scope="module")
def motionless(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Run 16 without the log of its crank."""
    folder = tmp_path_factory.mktemp("motionless") / "run16"
    shutil.copytree(ROOT / "datasets" / "rig3m" / "run16", folder)
    file = folder / "run.toml"
    text = file.read_text(encoding="utf-8")
    file.write_text(text[: text.rindex("[[log]]")], encoding="utf-8")
    return folder


def test_a_report_without_motion_still_lists_the_lines_and_events_it_measured(motionless: Path) -> None:
    report = make_report(motionless, RIGS)
    assert report.response is None
    assert report.replayed == report.replayed_lines == ()
    top = next(lines for lines in report.measured_lines if lines.channel == "tension_top")
    first = top.line("1")
    assert first is not None
    assert first.verdict.value == "harmonic"
    assert report.comparison.verdict.value == "undecided"
    assert any("bottom motion was not logged" in metric.reason for metric in report.comparison.metrics)


def test_the_chance_of_a_false_line_is_shared_by_what_can_be_searched_whatever_is_shown() -> None:
    options = Options(rigs=RIGS, channels=("tension_top",))
    evaluation = open_evaluation(ROOT / "datasets" / "rig3m" / "run04", options)
    assert evaluation.significance == pytest.approx(FALSE_LINES_OF_RUN / 7)


def test_parts_are_made_once() -> None:
    evaluation = open_evaluation(ROOT / "datasets" / "rig3m" / "run04", Options(rigs=RIGS))
    channel = evaluation.conditioned.channels[0]
    assert evaluation.found(channel) is evaluation.found(channel)
    assert evaluation.conditioned is evaluation.conditioned


def test_an_error_of_a_part_names_the_run_file(motionless: Path) -> None:
    evaluation = open_evaluation(motionless, Options(rigs=RIGS, window=(-5.0, 1e6)))
    with pytest.raises(DataError, match="is not inside the record") as caught, evaluation.errors_placed():
        _ = evaluation.drive
    assert caught.value.path == str(motionless / "run.toml")
