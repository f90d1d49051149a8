"""``tethertest analyze --across``: curves, jumps and loops of many runs; nothing is dropped silently."""

from __future__ import annotations

import json
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from tests.schema_check import faults
from tethertest.cli import app
from tethertest.cli.across import _print
from tethertest.cli.schemas import schema_of
from tethertest.errors import TethertestError
from tethertest.jobs.across import analyze_across, gathered
from tethertest.jobs.analysis_options import Options
from tethertest.records.across import Across, Direction, RunChannel, RunPart, StepVerdict
from tethertest.records.analysis import MEASURED
from tethertest.records.channel import Window
from tethertest.records.lines import ChannelLines, Line, LineVerdict
from tethertest.render.across import across_summary, write_across
from tethertest.render.as_json import as_json
from tethertest.units import Kind

CAMPAIGN = Path(__file__).parents[2] / "datasets" / "rig3m"
FREQUENCIES = np.round(np.arange(0.1, 0.5, 0.02), 3)


def line(order: str, frequency: float, amplitude: float, verdict: LineVerdict) -> Line:
    ends = (max(0.0, amplitude - 0.002), amplitude + 0.002)
    return Line(order, frequency, amplitude, 0.0, ends, 0.001, 1e-9, verdict, "")


def part(number: int, frequency: float, first: float, half: float, **other: object) -> RunPart:
    """Return a run whose top tension has two orders."""
    lines = ChannelLines(
        "tension_top",
        "N",
        Window(0.0, 100.0),
        (
            line("1", frequency, first, LineVerdict.HARMONIC),
            line("1/2", 0.5 * frequency, half, LineVerdict.SUBHARMONIC if half > 0.01 else LineVerdict.NONE),
        ),
        1000,
        0,
    )
    spectrum = np.linspace(0.0, 8.0 * frequency, 200), np.full(200, 0.01)
    channel = RunChannel("tension_top", Kind.TENSION, "N", MEASURED, 1.0, lines, "", "", first, 0.0, spectrum)
    stated = {
        "date": "2026-09-05T09:00:00+08:00",
        "time": float(number),
        "rig": "rig",
        "mode": "hold",
        "frequency": frequency,
        "nominal_frequency": frequency,
        "amplitude": 0.1,
        "nominal_amplitude": 0.1,
        "channels": (channel,),
    }
    return RunPart(f"run{number:02d}", f"runs/run{number:02d}", **{**stated, **other})  # type: ignore[arg-type]


@pytest.fixture(scope="module")
def there_and_back() -> Across:
    """A sweep up and down whose tension jumps at 0.37 Hz upwards and at 0.25 Hz downwards, f/2 above it."""
    random = np.random.default_rng(3)
    parts = []
    for place, frequency in enumerate((*FREQUENCIES, *FREQUENCIES[-2::-1])):
        jump = 0.37 if place < FREQUENCIES.size else 0.25
        above = bool(frequency > jump)
        first = 1.0 + frequency + (3.0 if above else 0.0) + 0.001 * random.standard_normal()
        parts.append(part(place, float(frequency), first, 1.0 + frequency if above else 0.0))
    return gathered("runs", parts)


def test_both_sweeps_jump_where_they_do_and_differ_between(there_and_back: Across) -> None:
    assert [group.against for group in there_and_back.groups] == ["frequency"]
    assert {(curve.order, curve.direction) for curve in there_and_back.curves} == {
        (order, direction) for order in ("1", "1/2") for direction in (Direction.UP, Direction.DOWN)
    }
    for curve in there_and_back.curves:
        (step,) = curve.judgement.steps
        assert step.verdict is StepVerdict.JUMP
        expected = (0.36, 0.38) if curve.direction is Direction.UP else (0.24, 0.26)
        assert step.interval == pytest.approx(expected)
        # one false jump in a hundred folders, shared among the curves
        assert curve.judgement.significance == pytest.approx(0.01 / 4)
    loop = next(loop for loop in there_and_back.loops if loop.order == "1").hysteresis
    assert loop.differs == pytest.approx((0.26, 0.36))
    assert loop.area == pytest.approx(-3.0 * 0.12, abs=0.01)


def test_a_damaged_run_is_shown_and_changes_no_judgement(there_and_back: Across) -> None:
    parts = list(there_and_back.runs)
    (channel,) = part(6, float(FREQUENCIES[6]), 50.0, 0.0).channels
    parts[6] = replace(parts[6], channels=(replace(channel, damage="half the window is missing"),))
    parts.append(RunPart("run99", "runs/run99", refused="tension.lvm is cut"))
    again = gathered("runs", parts)
    up = next(c for c in again.curves if c.order == "1" and c.direction is Direction.UP)
    assert [point.damage for point in up.points if point.run == "run06"] == ["half the window is missing"]
    assert [step.interval for step in up.judgement.steps] == [pytest.approx((0.36, 0.38))]
    found = as_json(across_summary(again))
    assert faults(found, schema_of("across")) == []
    assert [run["refused"] for run in found["runs"] if run["run"] == "run99"] == ["tension.lvm is cut"]


def test_runs_that_differ_in_two_settings_are_on_no_common_curve(there_and_back: Across) -> None:
    other = part(90, 0.2, 1.0, 0.0, amplitude=0.2, nominal_amplitude=0.2, mode="free")
    again = gathered("runs", [*there_and_back.runs, other])
    assert all("run90" not in group.runs for group in again.groups)
    assert any("run90" in note for note in again.notes)
    amplitude = part(91, 0.2, 1.0, 0.0, amplitude=0.2, nominal_amplitude=0.2)
    again = gathered("runs", [*there_and_back.runs, amplitude])
    by_amplitude = [group for group in again.groups if group.against == "amplitude"]
    assert [group.runs for group in by_amplitude] == [("run05", "run33", "run91")]


def test_a_slip_of_the_frequency_in_run_toml_takes_no_run_from_its_curve(there_and_back: Across) -> None:
    other = part(91, 0.2, 1.0, 0.0, amplitude=0.2, nominal_amplitude=0.2, nominal_frequency=0.22)
    again = gathered("runs", [*there_and_back.runs, other])
    (group,) = (group for group in again.groups if group.against == "amplitude")
    assert group.runs == ("run05", "run33", "run91")
    assert group.fixed == pytest.approx(0.2)


def test_the_largest_amplitude_is_one_of_a_line_that_is_there_and_judged() -> None:
    halves = (0.5, 0.009, 0.3)
    parts = [part(place, 0.2 + 0.1 * place, 1.0, half) for place, half in enumerate(halves)]
    (channel,) = parts[0].channels
    parts[0] = replace(parts[0], channels=(replace(channel, damage="half the window is missing"),))
    found = as_json(across_summary(gathered("runs", parts)))
    largest = {curve["order"]: curve["largest"] for curve in found["curves"]}
    assert (largest["1/2"]["run"], largest["1/2"]["amplitude"]) == ("run02", 0.3)
    # what is there in the damaged run alone is on no other
    parts[2] = part(2, 0.4, 1.0, 0.009)
    found = as_json(across_summary(gathered("runs", parts)))
    assert {curve["order"]: curve["largest"] for curve in found["curves"]}["1/2"] is None


def test_the_terminal_says_where_a_branch_has_no_line(capsys: pytest.CaptureFixture[str]) -> None:
    """An order that only the sweep up shows is on the sweep down too, at its limits."""
    count = FREQUENCIES.size
    # the run at the turn is on both sweeps
    halves = (*np.full(count - 1, 0.3), 0.009)
    there = [part(place, float(FREQUENCIES[place]), 1.0, half) for place, half in enumerate(halves)]
    back = [part(count + place, float(FREQUENCIES[-2 - place]), 1.0, 0.009) for place in range(count - 1)]
    _print(as_json(across_summary(gathered("runs", [*there, *back]))))
    rows = [line for line in capsys.readouterr().out.splitlines() if line.split()[1:2] == ["1/2"]]
    # the loop of both comes last
    assert [(row.split()[2], "no line" in row) for row in rows[:2]] == [("up", False), ("down", True)]


def test_the_folder_has_a_page_numbers_and_figures(there_and_back: Across, tmp_path: Path) -> None:
    paths = write_across(there_and_back, tmp_path / "out")
    names = {path.name for path in paths}
    assert {
        "across.md",
        "across.json",
        "amplitudes-1.png",
        "spectra-1-tension_top.png",
        "along-1.png",
    } <= names
    page = (tmp_path / "out" / "across.md").read_text(encoding="utf-8")
    assert "jump between 0.36 and 0.38" in page
    assert json.loads((tmp_path / "out" / "across.json").read_text(encoding="utf-8"))["loops"]


@pytest.mark.verify
def test_the_same_runs_give_the_same_bytes(there_and_back: Across, tmp_path: Path) -> None:
    first, again = (write_across(there_and_back, tmp_path / name) for name in ("first", "again"))
    assert [path.read_bytes() for path in again] == [path.read_bytes() for path in first]


def test_real_runs_and_what_is_wrong_with_others(tmp_path: Path) -> None:
    for name in ("run01", "run06"):
        shutil.copytree(CAMPAIGN / name, tmp_path / name)
    (tmp_path / "bad").mkdir()
    (tmp_path / "bad" / "run.toml").write_text("id = 3\n", encoding="utf-8")
    shutil.copytree(CAMPAIGN / "run06", tmp_path / "twice")
    called = ["analyze", str(tmp_path), "--across", "--jobs", "1", "--json", "--channel", "tension_top"]
    result = CliRunner().invoke(app, [*called, "--rigs", str(CAMPAIGN.parents[1] / "rigs")])
    assert result.exit_code == 0, result.output
    found = json.loads(result.stdout)
    refused = {Path(run["path"]).name: run["refused"] for run in found["runs"]}
    assert refused["run01"] == "no drive"
    assert refused["run06"] is None
    assert "the id of" in refused["twice"]
    assert refused["bad"]
    (run,) = [run for run in found["runs"] if run["refused"] is None]
    truth = json.loads((CAMPAIGN / "run06" / "truth.json").read_text(encoding="utf-8"))
    assert run["amplitude"] == pytest.approx(0.05, rel=1e-4)
    assert run["channels"][0]["name"] == "tension_top"
    assert run["channels"][0]["lines_found"] >= 2
    (top,) = run["channels"]
    true = truth["peaks"]["steady"]["tension_top"]["max"] - 5.0
    assert 0.0 < top["largest_raised_by_noise"] < 0.1
    assert true - 0.02 <= top["largest_dynamic"] <= true + 1.5 * top["largest_raised_by_noise"]
    assert found["curves"] == []
    assert "in one setting only" in found["notes"][0]


def test_folders_without_runs_are_refused(tmp_path: Path) -> None:
    for path, words in (
        (tmp_path, "no run folder"),
        (tmp_path / "none", "no such folder"),
        (CAMPAIGN / "run06", "is one run"),
        (CAMPAIGN / "run06" / "run.toml", "found a file"),
    ):
        with pytest.raises(TethertestError, match=words) as refusal:
            analyze_across(path, Options(), jobs=1)
        assert refusal.value.remedy
    shutil.copytree(CAMPAIGN / "run01", tmp_path / "run01")
    with pytest.raises(TethertestError, match="not one of 1 runs can be analysed: rig3m-run01: no drive"):
        analyze_across(tmp_path, Options(rigs=CAMPAIGN.parents[1] / "rigs"), jobs=1)
