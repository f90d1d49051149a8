"""The commands as a user types them."""

from __future__ import annotations

import json
import shutil
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

from tethertest.cli import app, main

ROOT = Path(__file__).parents[2]
RUN = ROOT / "datasets" / "rig3m" / "run04"


def typed(
    arguments: list[str], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> tuple[int, str, str]:
    monkeypatch.setattr(sys, "argv", ["tethertest", *arguments])
    with pytest.raises(SystemExit) as left:
        main()
    said = capsys.readouterr()
    return int(left.value.code or 0), said.out, said.err


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, int, str, str]:
    """A report's folder, its exit code and what it printed."""
    folder = tmp_path_factory.mktemp("written")
    done = CliRunner().invoke(app, ["report", str(RUN), "-o", str(folder), "--json"])
    return folder, done.exit_code, done.stdout, done.stderr


def test_report_passes_and_writes_page_and_summary(written: tuple[Path, int, str, str]) -> None:
    folder, code, out, err = written
    assert (code, err) == (0, "")
    said = json.loads(out)
    assert said["verdict"] == "pass"
    assert {"run", "verdict", "reasons", "metrics", "lines", "paths"} <= set(said)
    assert {path.name for path in folder.iterdir()} == {"report.html", "summary.json"}


def test_a_second_report_is_the_same_to_the_byte(
    written: tuple[Path, int, str, str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    typed(["report", str(RUN), "-o", str(tmp_path)], monkeypatch, capsys)
    for file in ("report.html", "summary.json"):
        assert (tmp_path / file).read_bytes() == (written[0] / file).read_bytes()


def test_the_truth_beside_a_run_changes_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "run04"
    shutil.copytree(RUN, folder)
    (folder / "truth.json").write_text("not even JSON", encoding="utf-8")
    rigs = ["--rigs", str(ROOT / "rigs")]
    code, _, err = typed(["report", str(folder), "-o", str(tmp_path / "out"), *rigs], monkeypatch, capsys)
    assert (code, err) == (0, "")


def test_inspect_describes_a_bare_log_and_a_run(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    code, out, _ = typed(["inspect", str(RUN / "fbg.txt"), "--json"], monkeypatch, capsys)
    log = json.loads(out)
    assert code == 0
    assert log["format"].startswith("enlight")
    assert {channel["unit_as_written"] for channel in log["channels"]} == {"nm"}
    code, out, _ = typed(["inspect", str(RUN)], monkeypatch, capsys)
    assert code == 0
    assert "F_top" in out


def test_scale_prints_groups_ratios_and_conflicts(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    rig = str(ROOT / "rigs" / "rig3m.toml")
    code, out, _ = typed(["scale", rig, "--json"], monkeypatch, capsys)
    found = json.loads(out)
    assert code == 0
    assert found["ratios"]["length"] == pytest.approx(50.0)
    assert {"groups", "ratios", "conflicts"} <= set(found)
    code, out, _ = typed(["scale", rig], monkeypatch, capsys)
    assert code == 0
    assert "Ae/L" in out


@pytest.mark.parametrize(
    ("option", "text"),
    [("--frequency", "0 Hz"), ("--frequency", "-1 Hz"), ("--frequency", "1e300 Hz"), ("--amplitude", "0 m")],
)
def test_scale_refuses_a_drive_that_is_none(
    option: str, text: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    rig = str(ROOT / "rigs" / "rig3m.toml")
    code, out, err = typed(["scale", rig, option, text, "--json"], monkeypatch, capsys)
    assert (code, out) == (2, "")
    assert err.startswith(f"error: {option}: found '{text}'")


@pytest.mark.parametrize("kind", ["rig", "report"])
def test_schema_prints_a_json_schema(
    kind: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    code, out, _ = typed(["schema", kind], monkeypatch, capsys)
    assert code == 0
    assert json.loads(out)["$schema"].startswith("https://json-schema.org")


def test_version(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    code, out, _ = typed(["--version"], monkeypatch, capsys)
    assert code == 0
    assert out.startswith("tethertest ")
