"""A draft of run.toml: valid, never written over another, stopped by its TODOs, and right once filled."""

from __future__ import annotations

import json
import shutil
import tomllib
from pathlib import Path

import pytest
from typer.testing import CliRunner

from tethertest.cli import app
from tethertest.errors import TethertestError
from tethertest.jobs.new_run import new_run
from tethertest.jobs.report import make_report
from tethertest.readers import load_run

ROOT = Path(__file__).parents[2]
RIGS = ROOT / "rigs"


def folder_of(tmp_path, run):
    folder = tmp_path / run
    shutil.copytree(ROOT / "datasets" / "rig3m" / run, folder)
    (folder / "run.toml").unlink()
    (folder / "truth.json").unlink()
    return folder


def filled(path, **values):
    text = path.read_text(encoding="utf-8")
    for key, value in values.items():
        assert f'{key} = "TODO"' in text
        text = text.replace(f'{key} = "TODO"', f'{key} = "{value}"')
    path.write_text(text, encoding="utf-8")


@pytest.mark.parametrize(
    ("run", "date"),
    [
        ("run02", "2026-09-05T09:39:59+08:00"),
        ("run04", "2026-09-05T10:29:59"),
        ("run09", "2026-09-07T09:14:59+08:00"),
    ],
)
def test_what_the_logs_tell_is_filled_in(tmp_path, run, date):
    folder = folder_of(tmp_path, run)
    path, _ = new_run(folder, rigs=RIGS)
    data = tomllib.loads(path.read_text(encoding="utf-8"))
    committed = tomllib.loads((ROOT / "datasets" / "rig3m" / run / "run.toml").read_text(encoding="utf-8"))
    assert data["rig"] == "rig3m"
    assert data["date"].isoformat() == date
    assert {log["file"]: log["clock"] for log in data["log"]} == {
        log["file"]: log["clock"] for log in committed["log"]
    }
    (tension,) = [log for log in data["log"] if log["file"].startswith("tension")]
    assert tension["channels"] == {"F_top": "tension_top", "F_bottom": "tension_bottom"}


def test_todos_stop_a_report_and_filled_it_gives_the_verdict_of_the_run(tmp_path):
    folder = folder_of(tmp_path, "run02")
    path, _ = new_run(folder, rigs=RIGS)
    with pytest.raises(TethertestError, match=r"run\.toml: 3 problems(?s:.*)found 'TODO'"):
        load_run(folder, RIGS)
    filled(path, kind="crank-slider", frequency="0.1 Hz", radius="0.1 m", mode="soft")
    report = make_report(folder, RIGS)
    assert report.comparison.verdict.value == "pass"
    assert report.drive.frequency == pytest.approx(0.1, rel=1e-3)


def test_motion_of_the_encoder_is_told_and_not_filled_in(tmp_path):
    path, _ = new_run(folder_of(tmp_path, "run02"), rigs=RIGS)
    text = path.read_text(encoding="utf-8")
    assert "heave of crank.csv moves by about +/-99.9 mm, mostly near 0.1 Hz" in text
    assert 'frequency = "TODO"' in text


def test_an_existing_run_file_is_never_touched(tmp_path):
    folder = folder_of(tmp_path, "run02")
    (folder / "run.toml").write_text("mine", encoding="utf-8")
    with pytest.raises(TethertestError, match="never overwritten"):
        new_run(folder, rigs=RIGS)
    assert (folder / "run.toml").read_text(encoding="utf-8") == "mine"


def test_an_ambiguous_log_keeps_the_readers_words_and_its_settings_as_comments(tmp_path):
    folder = tmp_path / 'odd "name" 测试'
    folder.mkdir()
    lines = ["time [s];F_top [N]", *(f"{number},125;1,{500 + number}" for number in range(100, 160))]
    (folder / "t.csv").write_text("\n".join(lines), encoding="utf-8")
    (folder / "picture.dat").write_bytes(b"\x89PNG\r\n\x1a\n" + bytes(200))
    path, draft = new_run(folder, rigs=RIGS)
    text = path.read_text(encoding="utf-8")
    data = tomllib.loads(text)
    assert data["id"] == folder.name
    assert [log["file"] for log in data["log"]] == ["t.csv"]
    if draft.logs[0].problem:
        assert f"# TODO: the reader says: {draft.logs[0].problem.splitlines()[0]}" in text
        assert '# decimal = ","' in text
    assert "# not used: picture.dat" in text


def test_hostile_names_stay_inside_their_strings_and_comments(tmp_path):
    folder = tmp_path / "r"
    folder.mkdir()
    rows = "\n".join(f"{number / 100:.2f},{number % 7}" for number in range(300))
    (folder / 'a"b.csv').write_text('time [s],x]\\"y [N]\n' + rows, encoding="utf-8")
    path, _ = new_run(folder, rigs=RIGS)
    assert tomllib.loads(path.read_text(encoding="utf-8"))["log"][0]["file"] == 'a"b.csv'


def test_without_a_rig_and_without_logs(tmp_path):
    empty = tmp_path / "empty"
    empty.mkdir()
    with pytest.raises(TethertestError, match="no file that a reader recognises"):
        new_run(empty, rigs=RIGS)
    with pytest.raises(TethertestError, match="no such folder"):
        new_run(tmp_path / "absent")
    folder = folder_of(tmp_path, "run02")
    with pytest.raises(TethertestError, match="inside the run folder"):
        new_run(folder, [ROOT / "README.md"], RIGS)
    path, _ = new_run(folder, [Path("tension.tdms")], empty)
    data = tomllib.loads(path.read_text(encoding="utf-8"))
    assert data["rig"] == "TODO"
    assert [log["clock"] for log in data["log"]] == ["TODO"]


def test_command_prints_what_is_left(tmp_path):
    folder = folder_of(tmp_path, "run02")
    result = CliRunner().invoke(app, ["new", str(folder), "--rigs", str(RIGS), "--json"])
    assert result.exit_code == 0
    found = json.loads(result.stdout)
    assert found["rig"] == "rig3m"
    assert len(found["todo"]) == 4
