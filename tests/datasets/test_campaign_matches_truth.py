"""The committed campaign is complete, labelled synthetic, and its logs are as long as they say."""

from __future__ import annotations

import json
import tomllib
from functools import cache
from pathlib import Path
from typing import Any

import pytest

CAMPAIGN = Path(__file__).parents[2] / "datasets" / "rig3m"
RUNS = sorted(folder.name for folder in CAMPAIGN.iterdir() if folder.is_dir())
FLAWED = {
    "run17": {"saturated"},
    "run18": {"lost-grating"},
    "run19": {"stuck"},
    "run20": {"clock-jump"},
    "run21": {"spikes", "hum", "dropped"},
    "run22": {"swapped-date"},
}
LARGEST = 40_000_000


@cache
def truth(run: str) -> dict[str, Any]:
    text = (CAMPAIGN / run / "truth.json").read_text(encoding="utf-8")
    stated: dict[str, Any] = json.loads(text)
    return stated


@cache
def card(run: str) -> dict[str, Any]:
    return tomllib.loads((CAMPAIGN / run / "run.toml").read_text(encoding="utf-8"))


def data_rows(path: Path) -> int:
    """Count the rows after the last header row of a text log."""
    rows = path.read_bytes().decode("latin-1").splitlines()
    wide = max(len(row) for row in rows[-20:])
    numbers = [row for row in rows if row[:1] in "-0123456789\t" and len(row) <= wide + 8]
    return sum(1 for row in numbers if sum(sign.isdigit() for sign in row) > len(row) // 2)


def test_the_campaign_has_all_runs() -> None:
    assert [f"run{number:02d}" for number in range(1, 23)] == RUNS


def test_the_campaign_is_small_enough() -> None:
    assert sum(path.stat().st_size for path in CAMPAIGN.rglob("*") if path.is_file()) < LARGEST


@pytest.mark.parametrize("run", RUNS)
def test_a_run_is_complete_and_labelled_synthetic(run: str) -> None:
    stated, described = truth(run), card(run)
    assert stated["synthetic"] is True
    assert "synthetic" in described["title"].lower()
    assert described["date"].utcoffset() is not None
    files = {entry["file"] for entry in described["log"]}
    assert {path.name for path in (CAMPAIGN / run).iterdir()} == files | {"run.toml", "truth.json"}
    assert {entry["clock"] for entry in described["log"]} == set(stated["clocks"]["each"])


@pytest.mark.parametrize("run", RUNS)
def test_logs_are_the_committed_ones(run: str) -> None:
    for name, size in truth(run)["logs"].items():
        assert (CAMPAIGN / run / name).stat().st_size == size


@pytest.mark.parametrize("run", RUNS)
def test_text_logs_have_the_rows_that_truth_states(run: str) -> None:
    stated = truth(run)
    missing = {entry["clock"]: entry["samples"] for entry in stated["flaws"] if entry["kind"] == "dropped"}
    for entry in card(run)["log"]:
        if entry["file"].endswith(".tdms"):
            continue
        expected = stated["clocks"]["each"][entry["clock"]]["samples"] - missing.get(entry["clock"], 0)
        assert abs(data_rows(CAMPAIGN / run / entry["file"]) - expected) <= 2, entry["file"]


@pytest.mark.parametrize("run", RUNS)
def test_only_the_flawed_runs_have_flaws(run: str) -> None:
    assert {entry["kind"] for entry in truth(run)["flaws"]} == FLAWED.get(run, set())


@pytest.mark.parametrize("run", RUNS)
def test_clocks_disagree_as_separate_instruments_do(run: str) -> None:
    for relative in truth(run)["clocks"]["relative_to_daq"].values():
        assert 0.3 <= abs(relative["offset_s"]) <= 3.0
        assert 20.0 <= abs(relative["drift_ppm"]) <= 80.0


def test_slack_runs_are_slack_at_the_bottom() -> None:
    for run in ("run12", "run13", "run14", "run15"):
        assert truth(run)["slack"]["tension_bottom_fraction"] > 0.1
    for run in ("run02", "run08", "run11"):
        assert truth(run)["slack"]["tension_bottom"] == []


@pytest.mark.parametrize("run", RUNS)
def test_snaps_follow_slack_and_stay_below_the_largest_tension(run: str) -> None:
    stated = truth(run)
    for end in ("tension_bottom", "tension_top"):
        snaps, slack = stated["snaps"][end], stated["slack"][end]
        assert bool(snaps["start_s"]) == bool(slack)
        for start, peak_time, peak in zip(snaps["start_s"], snaps["peak_s"], snaps["peak_N"], strict=True):
            assert start <= peak_time
            assert stated["snaps"]["below_N"] <= peak <= stated["peaks"]["run"][end]["max"]
        # a long slack interval ends in a snap, within one step of the record
        assert all(
            any(begin < start <= stop + 1e-3 for start in snaps["start_s"])
            for begin, stop in slack
            if stop - begin > 0.05
        )


def test_the_largest_tension_of_the_period_two_run_is_a_snap() -> None:
    stated = truth("run15")
    assert max(stated["snaps"]["tension_bottom"]["peak_N"]) == stated["peaks"]["run"]["tension_bottom"]["max"]


def test_period_two_is_in_the_tension_and_not_in_the_drive() -> None:
    lines = truth("run15")["orders"]
    assert lines["tension_top"]["1/2"]["amplitude"] > 1.0
    assert lines["heave"]["1/2"]["amplitude"] < 1e-6


def test_the_gear_error_is_in_the_drive() -> None:
    lines = truth("run16")["orders"]
    assert lines["heave"]["1/2"]["amplitude"] == pytest.approx(3e-3, rel=1e-3)
    assert lines["tension_top"]["1/2"]["amplitude"] > 0.03


def test_an_inertial_run_pulls_with_the_mass_it_moves() -> None:
    lines = truth("run08")["orders"]
    moved = 0.4 + 0.0484 * 3.0
    inertia = moved * (2.0 * 3.141592653589793 * 0.3) ** 2 * lines["heave"]["1"]["amplitude"]
    assert lines["tension_bottom"]["1"]["amplitude"] == pytest.approx(inertia, rel=2e-3)
