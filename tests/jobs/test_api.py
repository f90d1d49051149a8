"""What a script calls: the same answers as the commands, as tables and on axes."""

from __future__ import annotations

import runpy
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import pandas as pd
import pytest

import tethertest as tt
from tethertest.records.scene import MeasuredMotion

ROOT = Path(__file__).parents[2]
RUN = ROOT / "datasets" / "rig3m" / "run04"
mpl.use("Agg")


@pytest.fixture(scope="module")
def tour(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """The names of docs/tour.py, run as a person runs it."""
    folder = tmp_path_factory.mktemp("tour")
    for name in ("datasets", "rigs"):
        (folder / name).symlink_to(ROOT / name)
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        names = runpy.run_path(str(ROOT / "docs" / "tour.py"))
    assert (folder / "tension.png").read_bytes().startswith(b"\x89PNG")
    return names


def test_channels_are_columns_over_the_runs_time(tour: dict[str, Any]) -> None:
    measured = tour["measured"]
    table = measured.to_pandas()
    assert list(table.columns) == [channel.name for channel in measured.channels]
    top = measured.channel("tension_top")
    column = table["tension_top"].dropna()
    assert np.array_equal(column.index, top.time[top.usable])
    assert np.array_equal(column, top.values[top.usable])
    assert table.index.is_monotonic_increasing


def test_a_log_is_told_sample_by_sample(tour: dict[str, Any]) -> None:
    log = tour["log"]
    table = log.to_pandas()
    assert len(table) == sum(channel.time.size for channel in log.channels)
    assert set(table.unit) == {channel.unit for channel in log.channels}


def test_lines_of_the_table_are_those_of_the_analysis(tour: dict[str, Any]) -> None:
    (item,) = tour["analysis"].channels
    assert list(tour["lines"].order) == [line.order for line in item.lines.lines]
    assert list(tour["lines"].amplitude) == [line.amplitude for line in item.lines.lines]
    drawn = tour["analysis"].plot(channel="tension_top")
    assert drawn.get_ylabel() == "amplitude [N]"
    with pytest.raises(tt.TethertestError, match="'nowhere' has no lines"):
        tour["analysis"].plot(channel="nowhere")


def test_metrics_of_the_table_are_those_of_the_report(tour: dict[str, Any]) -> None:
    report = tour["report"]
    assert list(report.to_pandas().error) == [metric.error for metric in report.comparison.metrics]
    axes = report.plot(channel="fbg1")
    assert [line.get_label() for line in axes.get_lines()] == ["fbg1 measured", "fbg1 replayed"]
    assert axes is report.plot(axes)


def test_the_solver_takes_a_series_for_the_motion_whatever_its_index(tour: dict[str, Any]) -> None:
    heave, scene, response = tour["heave"], tour["scene"], tour["response"]
    assert response.status.name == "OK"
    assert list(response.to_pandas().columns[:3]) == ["tension_N@0", "tension_N@0.5", "tension_N@1"]
    later = pd.Series(heave.to_numpy() + 7.0, pd.to_datetime(heave.index + 1.7e9, unit="s"))
    shifted = MeasuredMotion.of_series(later)
    assert shifted.time == pytest.approx(heave.index.to_numpy(), abs=1e-6)
    assert shifted.displacement == pytest.approx(heave.to_numpy(), abs=1e-12)
    same = tt.solve(scene, measured=MeasuredMotion(heave.index.to_numpy(), heave.to_numpy()))
    assert np.array_equal(same.tension, response.tension)


def test_a_series_that_is_no_motion_is_refused() -> None:
    with pytest.raises(tt.TethertestError, match="expected metres over seconds"):
        MeasuredMotion.of_series(pd.Series([0.0, 1.0], index=["a", "b"]))


def test_settings_of_a_log_are_keywords(tmp_path: Path) -> None:
    file = tmp_path / "force.csv"
    file.write_text("force,level\n" + "".join(f"{i % 7}.5,{i}\n" for i in range(64)), encoding="utf-8")
    log = tt.read_log(file, rate="50 Hz", units={"force": "N"})
    channel = log.channels[0]
    assert channel.unit == "N"
    assert channel.time[1] == pytest.approx(0.02)


def test_a_report_is_written_where_it_is_told(tmp_path: Path) -> None:
    tt.report(RUN, tmp_path / "out")
    assert {path.name for path in (tmp_path / "out").iterdir()} == {"report.html", "summary.json"}
