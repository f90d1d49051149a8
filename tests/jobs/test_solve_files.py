"""The files that ``tethertest solve`` writes."""

from __future__ import annotations

import io
import json
import sys
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest

from tethertest.cli import main
from tethertest.jobs.response_files import response_csv, response_h5
from tethertest.readers import load_scene
from tethertest.records.response import ErrorBudget, Field, Response, Status

SCENES = Path(__file__).parents[2] / "rigs" / "scenes"


@pytest.fixture
def response() -> Response:
    """Return a response whose every number says what it is of."""
    scene = load_scene(SCENES / "snap-150m.toml")
    scene = replace(scene, output=replace(scene.output, gauges=(0.0, 0.25)))
    time = np.array([0.0, 1.0 / 3.0])
    tension = np.array([[50.0, 51.0], [60.0, 1234567.8912]])
    vector = np.arange(12.0).reshape(2, 2, 3)
    return Response(
        scene=scene,
        status=Status.TOLERANCE_NOT_MET,
        fidelity="nonlinear",
        scheme="leapfrog",
        cells=80,
        time_step=1e-4,
        wall=3.0,
        time=time,
        gauges=np.array([0.0, 0.25]),
        tension=tension,
        strain=tension / 1e4,
        platform_position=np.array([0.0, -0.1]),
        field=Field(time, np.array([0.1, 0.9]), tension, tension - 1.0),
        error=ErrorBudget(numerical=0.05),
        slack={0.0: ((0.1, 0.2), (0.3, 0.4)), 0.25: ()},
        warnings=("no air",),
        fields={"position": vector, "velocity": vector + 100.0, "curvature": tension / 1e3},
    )


def test_csv_has_tension_then_strain_at_every_gauge(response: Response) -> None:
    lines = response_csv(replace(response, fields={})).decode().splitlines()
    assert lines[0] == "time_s,tension_N@0,tension_N@0.25,strain@0,strain@0.25"
    assert lines[2] == "0.333333333,60,1234567.89,0.006,123.456789"
    assert len(lines) == 3


def test_csv_has_fields_component_by_component(response: Response) -> None:
    names = response_csv(response).decode().splitlines()[0].split(",")[5:]
    table = np.loadtxt(io.BytesIO(response_csv(response)), delimiter=",", skiprows=1)[:, 5:]
    assert names == [
        *(f"position_{axis}_m@{at}" for axis in "xyz" for at in ("0", "0.25")),
        *(f"velocity_{axis}_m_s@{at}" for axis in "xyz" for at in ("0", "0.25")),
        *(f"curvature_1_m@{at}" for at in ("0", "0.25")),
    ]
    columns = dict(zip(names, table.T, strict=True))
    assert columns["position_z_m@0.25"] == pytest.approx(response.fields["position"][:, 1, 2])
    assert columns["velocity_x_m_s@0"] == pytest.approx(response.fields["velocity"][:, 0, 0])
    assert columns["curvature_1_m@0.25"] == pytest.approx(response.fields["curvature"][:, 1])


def test_hdf5_has_every_series_with_its_unit_and_says_how_it_was_made(response: Response) -> None:
    with h5py.File(io.BytesIO(response_h5(response))) as file:
        for name, values, unit in (
            ("time", response.time, "s"),
            ("gauges", response.gauges, "1"),
            ("tension", response.tension, "N"),
            ("strain", response.strain, "1"),
            ("fields/position", response.fields["position"], "m"),
            ("fields/velocity", response.fields["velocity"], "m/s"),
            ("fields/curvature", response.fields["curvature"], "1/m"),
            ("field/time", response.field.time, "s"),
            ("field/position", response.field.position, "1"),
            ("field/maximum", response.field.maximum, "N"),
            ("field/minimum", response.field.minimum, "N"),
        ):
            np.testing.assert_array_equal(file[name][()], values)
            assert file[name].attrs["units"] == unit
        np.testing.assert_array_equal(file["slack/0"][()], [[0.1, 0.2], [0.3, 0.4]])
        assert file["slack/0.25"].shape == (0, 2)
        assert file.attrs["scene"] == response.scene.name
        assert file.attrs["status"] == "tolerance_not_met"
        assert file.attrs["scheme"] == "leapfrog"
        assert file.attrs["error_numerical"] == 0.05
        assert np.isnan(file.attrs["error_spread"])
        assert list(file.attrs["warnings"]) == ["no air"]


def test_a_second_hdf5_file_is_the_same_to_the_byte(response: Response) -> None:
    assert response_h5(response) == response_h5(replace(response, wall=99.0))


def test_csv_and_hdf5_of_a_solved_scene_hold_the_same_numbers(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in ("out.csv", "out.h5"):
        arguments = [str(SCENES / "straight-free-shape.toml"), "-o", str(tmp_path / name), "--json"]
        monkeypatch.setattr(sys, "argv", ["tethertest", "solve", *arguments])
        with pytest.raises(SystemExit):
            main()
        said = json.loads(capsys.readouterr().out)
    table = np.loadtxt(tmp_path / "out.csv", delimiter=",", skiprows=1)
    assert {path.name for path in tmp_path.iterdir()} == {"out.csv", "out.h5"}
    with h5py.File(tmp_path / "out.h5") as file:
        assert table[:, 0] == pytest.approx(np.arange(4001) / 2000.0, abs=1e-8)
        assert table[:, 1:4] == pytest.approx(file["tension"][()], rel=1e-8)
        assert file.attrs["status"] == said["status"]
