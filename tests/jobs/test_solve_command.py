"""``tethertest solve`` as a user types it."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
import pytest

from tethertest.cli import main

SCENES = Path(__file__).parents[2] / "rigs" / "scenes"


def typed(
    arguments: list[str], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> tuple[int, str]:
    monkeypatch.setattr(sys, "argv", ["tethertest", "solve", *arguments])
    with pytest.raises(SystemExit) as left:
        main()
    said = capsys.readouterr()
    return int(left.value.code or 0), said.out + said.err


def test_a_scene_becomes_rows_at_its_gauges(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    target = tmp_path / "out.csv"
    code, said = typed(
        [str(SCENES / "paper-1.2.toml"), "-o", str(target), "--tolerance", "10 %", "--json"],
        monkeypatch,
        capsys,
    )
    assert code == 0
    found = json.loads(said)
    assert found["status"] == "ok"
    assert found["error"]["numerical"] <= 0.1
    names = target.read_text(encoding="utf-8").splitlines()[0].split(",")
    assert names[0] == "time_s"
    gauges = [name.removeprefix("tension_N@") for name in names if name.startswith("tension")]
    assert [f"strain@{gauge}" for gauge in gauges] == names[1 + len(gauges) :]
    table = np.loadtxt(target, delimiter=",", skiprows=1)
    assert np.all(np.isfinite(table))
    assert table[:, 1 : 1 + len(gauges)].max() == pytest.approx(max(g["maximum"] for g in found["gauges"]))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--tolerance", "0 %"], "tolerance"),
        (["-o", "/proc/x/out.csv"], "cannot be made"),
    ],
)
def test_what_cannot_be_done_is_said(
    arguments: list[str], message: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    code, said = typed([str(SCENES / "paper-1.2.toml"), *arguments], monkeypatch, capsys)
    assert code == 2
    assert message in said
    assert "fix: " in said


def test_linear_and_nonlinear_models_of_a_shallow_cable_agree_for_a_small_motion() -> None:
    from dataclasses import replace

    from tethertest.readers import load_scene
    from tethertest.solver import modes, solve

    scene = load_scene(SCENES / "paper-1.2.toml")
    bottom = replace(scene.bottom, amplitude=0.05, start="ramp", ramp=10.0)
    small = replace(scene, bottom=bottom)
    linear, nonlinear = solve(small, fidelity="linear"), solve(small, fidelity="nonlinear", tolerance=0.005)
    dynamic = [response.tension - response.tension[0] for response in (linear, nonlinear)]
    difference = np.sqrt(np.mean((dynamic[0] - dynamic[1]) ** 2)) / np.std(dynamic[1])
    assert difference < 0.1  # the linear cable has one tension and one curvature along its whole length
    assert modes(scene).frequencies[0].frequency == pytest.approx(0.16091, abs=1e-5)
