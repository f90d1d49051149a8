"""A motion that is not as run.toml states it, or was not measured, is told of and accuses no load cell."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from tethertest.jobs.across_runs import run_part
from tethertest.jobs.analysis_options import Options
from tethertest.jobs.analyze import analyze
from tethertest.jobs.evaluation import open_evaluation

DATASETS = Path(__file__).parents[2] / "datasets" / "rig3m"
RIGS = Path(__file__).parents[2] / "rigs"
ACCUSED = "strain_against_tension"


def copied(name: str, to: Path, drive: str | None = None) -> Path:
    """Copy a run, with another [drive] in its run.toml."""
    shutil.copytree(DATASETS / name, to / name)
    if drive is not None:
        file = to / name / "run.toml"
        before, rest = file.read_text(encoding="utf-8").split("[drive]")
        after = rest[rest.index("[platform]") :]
        file.write_text(f"{before}[drive]\n{drive}\n{after}", encoding="utf-8")
    return to / name


@pytest.fixture(scope="module")
def halved(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Run 4 with its crank's log at half size."""
    folder = copied("run04", tmp_path_factory.mktemp("halved"))
    first, *lines = (folder / "crank.csv").read_text(encoding="utf-8").splitlines()
    rows = [line.split(";") for line in lines]
    text = "\n".join([first, *(";".join([*row[:2], f"{float(row[2]) / 2:.2f}"]) for row in rows)])
    (folder / "crank.csv").write_text(f"{text}\n", encoding="utf-8")
    return folder


def test_healthy_load_cells_are_not_accused_where_no_motion_was_measured(tmp_path: Path) -> None:
    """Run 16 without its crank's log: 2.3 % between the cells, of which inertia is known to 2.5 %."""
    folder = copied("run16", tmp_path)
    file = folder / "run.toml"
    text = file.read_text(encoding="utf-8")
    file.write_text(text[: text.rindex("[[log]]")], encoding="utf-8")
    evaluation = open_evaluation(folder, Options(rigs=RIGS))
    assert [log.file for log in evaluation.run.file.log] == ["tension.asc", "fbg.txt"]
    assert not [finding for finding in evaluation.measured.findings if finding.kind == ACCUSED]
    part = run_part(folder, Options(rigs=RIGS))
    assert (part.amplitude, part.amplitude_measured) == (part.nominal_amplitude, False)


def test_analyze_says_what_the_report_says_of_a_motion_that_is_not_as_stated(halved: Path) -> None:
    evaluation = open_evaluation(halved, Options(rigs=RIGS))
    assert not [finding for finding in evaluation.measured.findings if finding.kind == ACCUSED]
    (said,) = evaluation.stated
    assert "radius is 0.1 m, heave moves by +/-0.05" in said.text
    assert f"run.toml: {said.text}" in analyze(halved, Options(rigs=RIGS, channels=("tension_top",))).notes


def test_a_run_with_a_motion_in_doubt_is_on_no_judged_curve(halved: Path) -> None:
    part = run_part(halved, Options(rigs=RIGS, channels=("tension_top",)))
    assert part.amplitude == pytest.approx(0.05, rel=1e-3)
    (channel,) = part.channels
    assert "radius is 0.1 m, heave moves by +/-0.05" in channel.damage
    assert any(remark == f"run.toml: {channel.damage}" for remark in part.remarks)


def test_a_slip_of_the_frequency_is_a_remark_and_its_run_is_judged(tmp_path: Path) -> None:
    drive = 'kind = "crank-slider"\nfrequency = "0.32 Hz"\nradius = "0.05 m"'
    part = run_part(copied("run06", tmp_path, drive), Options(rigs=RIGS, channels=("tension_top",)))
    assert part.frequency == pytest.approx(0.3, rel=1e-4)
    assert any("[drive] frequency is 0.32 Hz" in remark for remark in part.remarks)
    assert part.channels[0].damage == ""


def test_a_run_that_moves_and_says_it_does_not_is_left_out_with_that(tmp_path: Path) -> None:
    part = run_part(copied("run06", tmp_path, 'kind = "none"'), Options(rigs=RIGS))
    assert part.refused.startswith('no drive: [drive] kind is "none", but heave moves')
