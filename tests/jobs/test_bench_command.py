"""``tethertest bench`` as a user types it."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import pytest

from tethertest.cli import main

SCENE = """
name = "short taut cable"
gravity = "0 m/s^2"
[cable]
length = "20 m"
length_state = "unstretched"
mass_per_length = "0.05 kg/m"
axial_stiffness = "20 kN"
[geometry]
kind = "straight"
tension = "100 N"
[bottom]
motion = "harmonic"
direction = "tangent"
amplitude = "2 mm"
frequency = "5 Hz"
start = "ramp"
ramp = "0.2 s"
[top]
kind = "fixed"
[output]
duration = "0.5 s"
rate = "500 Hz"
gauges = [0.0, 1.0]
"""


def typed(
    arguments: list[str], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> tuple[int, str, str]:
    monkeypatch.setattr(sys, "argv", ["tethertest", "bench", *arguments])
    with pytest.raises(SystemExit) as left:
        main()
    said = capsys.readouterr()
    return int(left.value.code or 0), said.out, said.err


def test_one_scene_becomes_table_figure_and_json(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    scene = tmp_path / "short.toml"
    scene.write_text(SCENE, encoding="utf-8")
    code, out, err = typed([str(scene), "-o", str(tmp_path / "found"), "--json"], monkeypatch, capsys)
    assert code == 0
    found = json.loads(out)
    assert [entry["scene"] for entry in found["scenes"]] == ["short"]
    assert found["scenes"][0]["reference_kind"] == "closed form"
    assert found["scenes"][0]["chosen"]["run"]["error"] < 1e-3
    folder = tmp_path / "found"
    assert {path.name for path in folder.iterdir()} == {"README.md", "speed.csv", "speed.json", "speed.png"}
    assert "Written by `tethertest bench short.toml`" in (folder / "README.md").read_text(encoding="utf-8")
    assert len(err.splitlines()) == 4


def test_scenes_must_be_named(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    code, _, err = typed([], monkeypatch, capsys)
    assert code == 2
    assert "Missing argument 'scenes'" in err


def test_a_missing_peer_is_told_before_anything_is_measured(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    scene = tmp_path / "short.toml"
    scene.write_text(SCENE, encoding="utf-8")
    monkeypatch.setitem(sys.modules, "moordyn", None)
    monkeypatch.setattr("tethertest.bench.speed.scene_speed", None)
    code, _, err = typed([str(scene), "--peers"], monkeypatch, capsys)
    assert code == 2
    assert "pip install 'tethertest[peers]'" in err
