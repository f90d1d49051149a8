"""The commands as a user types them."""

from __future__ import annotations

import json
import shutil
import sys
from pathlib import Path

import pytest

from tethertest.cli import main

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


def test_report_passes_and_writes_page_and_summary(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    code, out, err = typed(["report", str(RUN), "-o", str(tmp_path), "--json"], monkeypatch, capsys)
    assert (code, err) == (0, "")
    said = json.loads(out)
    assert said["verdict"] == "pass"
    assert {"run", "verdict", "reasons", "metrics", "lines", "paths"} <= set(said)
    assert {path.name for path in tmp_path.iterdir()} == {"report.html", "summary.json"}


def test_a_second_report_is_the_same_to_the_byte(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in ("first", "second"):
        typed(["report", str(RUN), "-o", str(tmp_path / name)], monkeypatch, capsys)
    for file in ("report.html", "summary.json"):
        assert (tmp_path / "first" / file).read_bytes() == (tmp_path / "second" / file).read_bytes()


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
