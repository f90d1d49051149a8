"""``tethertest ingest`` and ``inspect`` of its store, as a user types them."""

from __future__ import annotations

import hashlib
import json
import random
import sys
from pathlib import Path

import numpy as np
import pytest

from reports.crash_safety.battery import Battery, Tally, kill_at_random, starve
from tethertest.cli import main
from tethertest.conditioning import condition
from tethertest.jobs.evaluation import read_logs, rig_priors
from tethertest.jobs.stored import run_of
from tethertest.readers import load_run
from tethertest.store import load_store

ROOT = Path(__file__).parents[2]
RIGS = ROOT / "rigs"


def typed(
    arguments: list[str], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> tuple[int, str, str]:
    monkeypatch.setattr(sys, "argv", ["tethertest", *arguments])
    with pytest.raises(SystemExit) as left:
        main()
    said = capsys.readouterr()
    return int(left.value.code or 0), said.out, said.err


def content(folder: Path) -> dict[str, str]:
    return {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in folder.iterdir()}


def test_a_store_holds_what_the_report_would_see(
    run: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    before = content(run)
    monkeypatch.chdir(tmp_path)
    code, out, err = typed(["ingest", str(run), "--rigs", str(RIGS), "--json"], monkeypatch, capsys)
    said = json.loads(out)
    assert (code, err) == (0, "")
    assert said["path"] == "reports/rest-01/run.h5"
    assert said["channels"] == {"tension_top": 8000, "tension_bottom": 8000}
    assert content(run) == before
    stored = load_store(Path(said["path"]))
    read = load_run(run, RIGS)
    expected = condition(read, read_logs(read), rig_priors(read))
    assert (stored.measured.clocks, stored.measured.findings) == (expected.clocks, expected.findings)
    for one, other in zip(stored.measured.channels, expected.channels, strict=True):
        assert np.array_equal(one.values, other.values, equal_nan=True)
        assert np.array_equal(one.flags, other.flags)
        assert one.source == other.source
    again = run_of(stored.header, Path(said["path"]))
    assert (again.file, again.rig) == (read.file, read.rig)


def test_inspect_says_what_a_store_is(
    run: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    store = str(tmp_path / "run.h5")
    typed(["ingest", str(run), "--rigs", str(RIGS), "-o", store], monkeypatch, capsys)
    code, out, _ = typed(["inspect", store, "--json"], monkeypatch, capsys)
    said = json.loads(out)
    assert (code, said["format"], said["run"]) == (0, "tethertest-run", "rest-01")
    top, bottom = said["channels"]
    assert (top["unit"], top["n"], top["flags"]) == ("N", 8000, {"spike": 1})
    assert bottom["flags"] == {"missing": 1}
    assert top["maximum"] < 6.0  # the spike is flagged, so it is no maximum
    code, out, _ = typed(["inspect", store], monkeypatch, capsys)
    assert code == 0
    assert "run store of rest-01" in out


@pytest.mark.parametrize("victim", ["tension.csv", "run.toml", "notes.txt", "."])
def test_nothing_but_an_older_store_is_replaced(
    victim: str, run: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (run / "notes.txt").write_text("keep me")
    before = content(run)
    code, out, err = typed(
        ["ingest", str(run), "--rigs", str(RIGS), "-o", str(run / victim)], monkeypatch, capsys
    )
    assert (code, out) == (2, "")
    assert "fix:" in err
    assert content(run) == before


def test_a_store_among_raw_logs_only_where_it_is_asked_for(
    run: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for _ in range(2):  # the second replaces the first
        code, _, _ = typed(
            ["ingest", str(run), "--rigs", str(RIGS), "-o", str(run / "run.h5")], monkeypatch, capsys
        )
        assert code == 0
    assert set(content(run)) == {"run.toml", "tension.csv", "run.h5"}


def test_a_kill_at_any_instant_leaves_the_old_store_or_the_new_one(run: Path, tmp_path: Path) -> None:
    scratch = tmp_path / "scratch"
    scratch.mkdir()
    tally = Tally()
    kill_at_random(Battery(run, RIGS, scratch), 5, random.Random(3), tally)
    assert tally.faults == []
    assert tally.steps > 30


@pytest.mark.verify
@pytest.mark.parametrize("part", range(4))  # of two hundred kills, so that processes share them
def test_fifty_kills_a_part(run: Path, tmp_path: Path, part: int) -> None:
    scratch = tmp_path / "scratch"
    scratch.mkdir()
    tally = Tally()
    kill_at_random(Battery(run, RIGS, scratch), 50, random.Random(part), tally)
    assert tally.faults == []
    stepwise = "step of the writing phase"
    assert tally.outcomes[stepwise, "left-over"] > 12
    assert tally.outcomes[stepwise, "old"] + tally.outcomes[stepwise, "new"] == 25


@pytest.mark.verify
def test_twenty_limits_of_the_file_size(run: Path, tmp_path: Path) -> None:
    scratch = tmp_path / "scratch"
    scratch.mkdir()
    tally = Tally()
    starve(Battery(run, RIGS, scratch), 20, tally)
    assert tally.faults == []
    assert tally.outcomes["file-size limit", "old"] == 20
