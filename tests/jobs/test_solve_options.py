"""What ``tethertest solve`` hands to the solver, and what it makes of the answer."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.schema_check import faults
from tethertest.cli import main
from tethertest.cli.schemas import schema_of
from tethertest.records.response import ErrorBudget, Field, Response, Status
from tethertest.records.scene import Scene

SCENE = Path(__file__).parents[2] / "rigs" / "scenes" / "inclined-ends-wind.toml"
MEASURED = (
    '"measured"\nfile = "heave.csv"\ntime_column = "time_s"\ndisplacement_column = "heave_mm"\nunit = "mm"\n'
)
TIME = np.array([0.0, 0.02, 0.04])


def answered(scene: Scene, status: Status = Status.OK, native_times: bool = False) -> Response:
    """Return a response of that scene in which every number says where it stands."""
    gauges = np.array(scene.output.gauges)
    row = np.arange(TIME.size)[:, None]
    tension = 100.0 + 10.0 * row + gauges
    vector = np.stack([tension, tension + 1000.0, tension + 2000.0], axis=2)
    known = {"position": vector, "velocity": -vector, "curvature": tension / 1e6}
    return Response(
        scene=scene,
        status=status,
        fidelity="nonlinear",
        scheme="stub",
        cells=10,
        time_step=1e-3,
        wall=0.1,
        time=TIME,
        gauges=gauges,
        tension=tension if status is not Status.NOT_FINITE else np.full_like(tension, np.nan),
        strain=tension / 1e5,
        platform_position=TIME,
        field=Field(TIME, gauges, tension, tension),
        error=ErrorBudget(numerical=np.nan, spread=0.2),
        slack={float(gauge): ((0.0, 0.02),) for gauge in gauges},
        warnings=("the wind is öde",),
        fields={name: known[name] for name in scene.output.fields},
        native_times=native_times,
    )


class Solver:
    """Stands where the solver does and remembers what it was asked."""

    def __init__(self) -> None:
        self.status = Status.OK
        self.scene: Scene | None = None
        self.asked: dict[str, Any] = {}

    def __call__(self, scene: Scene, **asked: Any) -> Response:
        self.scene, self.asked = scene, asked
        return answered(scene, self.status, asked["native_times"])


@pytest.fixture
def solver(monkeypatch: pytest.MonkeyPatch) -> Solver:
    from tethertest.jobs import solve

    stub = Solver()
    monkeypatch.setattr(solve, "solve", stub)
    return stub


@pytest.fixture
def typed(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Callable[..., Any]:
    """Return what runs the command and gives its exit code, output and messages."""

    def run(*arguments: str) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["tethertest", "solve", *arguments])
        with pytest.raises(SystemExit) as left:
            main()
        said = capsys.readouterr()
        return int(left.value.code or 0), said.out, said.err

    return run


def test_options_reach_the_solver(solver: Solver, typed: Callable[..., Any]) -> None:
    options = ["--fidelity", "catenary", "--tolerance", "3 %", "--cells", "64", "--native-times", "--json"]
    code, out, _ = typed(str(SCENE), *options)
    assert (code, json.loads(out)["native_times"]) == (0, True)
    assert solver.asked == {
        "measured": None,
        "wind": None,
        "fidelity": "catenary",
        "tolerance": pytest.approx(0.03),
        "scheme": "auto",
        "cells": 64,
        "native_times": True,
    }


def test_fields_of_the_command_line_take_the_place_of_the_scenes(
    solver: Solver, typed: Callable[..., Any]
) -> None:
    typed(str(SCENE), "--fields", "velocity, curvature,velocity")
    assert solver.scene is not None
    assert solver.scene.output.fields == ("velocity", "curvature")


def test_series_are_read_beside_the_scene_and_not_beside_the_caller(
    solver: Solver, typed: Callable[..., Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "scenes"
    folder.mkdir()
    head, tail = SCENE.read_text(encoding="utf-8").split("motion = ")
    text = head + "motion = " + MEASURED + 'direction = "vertical"\n[top]' + tail.split("[top]")[1]
    text = text.replace('wind = "10 m/s"', 'wind_file = "gust.csv"').replace('"120 s"', '"12 s"')
    (folder / "scene.toml").write_text(text, encoding="utf-8")
    rows = [f"{0.1 * i:.1f},{100.0 * np.sin(0.1 * i):.6f},{5 + 0.1 * i:.1f}" for i in range(200)]
    for name, names in (("heave", "time_s,heave_mm,unused"), ("gust", "time_s,unused,wind_x_m_s")):
        (folder / f"{name}.csv").write_text("\n".join([names, *rows, ""]), encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    code, _, _ = typed("scenes/scene.toml")
    assert code == 0
    assert solver.asked["measured"].displacement[10] == pytest.approx(0.1 * np.sin(1.0), abs=1e-8)
    assert solver.asked["wind"].velocity[10] == pytest.approx([6.0, 0.0, 0.0])


def test_the_summary_agrees_with_its_published_schema(solver: Solver, typed: Callable[..., Any]) -> None:
    _, out, _ = typed(str(SCENE), "--json")
    found = json.loads(out)
    assert faults(found, schema_of("solve")) == []
    assert found["error"] == {
        "numerical": None,
        "model": None,
        "spread": 0.2,
        "peak": None,
        "peak_range": None,
    }
    assert found["slack"]["0.5"] == [[0.0, 0.02]]
    assert out.count("\n") == 1


def test_a_solution_that_left_the_numbers_is_advice_and_no_file(
    solver: Solver, typed: Callable[..., Any], tmp_path: Path
) -> None:
    solver.status = Status.NOT_FINITE
    code, out, err = typed(str(SCENE), "-o", str(tmp_path / "out.csv"), "--json")
    assert code == 4
    assert json.loads(out)["gauges"][0]["maximum"] is None
    assert "nothing was written" in err
    assert Status.NOT_FINITE.value in err
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--tolerance", "0"], "--tolerance: found '0', expected more than 0"),
        (["--tolerance", "150 %"], "--tolerance: found '150 %', expected at most 1"),
        (["--tolerance", "1 mm"], "--tolerance"),
        (
            ["--fields", "positon"],
            "--fields: found 'positon', expected some of position, velocity, curvature",
        ),
        (["-o", "out.txt"], "expected a name that ends with .csv or .h5"),
        (["-o", "out"], "expected a name that ends with .csv or .h5"),
    ],
)
def test_an_option_that_cannot_be_is_named_before_anything_is_solved(
    arguments: list[str], message: str, solver: Solver, typed: Callable[..., Any], tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    monkeypatch.chdir(tmp_path)
    code, out, err = typed(str(SCENE), *arguments)
    assert (code, out) == (2, "")
    assert err.startswith("error: ")
    assert message in err
    assert "fix: " in err
    assert solver.scene is None
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("cells", ["0", "1", "-5", "1000000000"])
def test_a_mesh_that_cannot_be_is_refused(cells: str, solver: Solver, typed: Callable[..., Any]) -> None:
    code, _, err = typed(str(SCENE), "--cells", cells)
    assert code == 2
    assert "--cells" in err
    assert solver.scene is None


def test_fields_that_do_not_fit_into_memory_are_refused(
    solver: Solver, typed: Callable[..., Any], tmp_path: Path
) -> None:
    scene = tmp_path / "scene.toml"
    scene.write_text(SCENE.read_text(encoding="utf-8").replace('"50 Hz"', '"50 kHz"'), encoding="utf-8")
    assert typed(str(scene))[0] == 0
    code, _, err = typed(str(scene), "--fields", "position")
    assert code == 2
    assert "--fields: found 50000 Hz over 120 s at 3 gauges, which makes 9e+07 values" in err


def test_the_scenes_own_fields_are_left_alone_without_the_option(
    solver: Solver, typed: Callable[..., Any], tmp_path: Path
) -> None:
    scene = tmp_path / "scene.toml"
    text = SCENE.read_text(encoding="utf-8")
    scene.write_text(text.replace("[output]", '[output]\nfields = ["curvature"]'), encoding="utf-8")
    typed(str(scene))
    assert solver.scene is not None
    assert solver.scene.output.fields == ("curvature",)
    assert replace(solver.scene.output, fields=()).gauges == (0.0, 0.5, 1.0)
