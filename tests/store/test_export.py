"""What other programs read is what the store holds."""

from __future__ import annotations

import datetime as dt
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tethertest.errors import TethertestError
from tethertest.jobs.export import FORMATS, export
from tethertest.jobs.exports.csv import safe_cell
from tethertest.jobs.exports.matlab import valid_names
from tethertest.jobs.exports.source import SeriesInMemory, time_bases
from tethertest.jobs.inspect import inspect_path
from tethertest.readers import read_log
from tethertest.records.channel import Channel, ConditionedRun, Flag
from tethertest.render.as_json import as_json
from tethertest.store import StoreHeader, write_store

ROOT = Path(__file__).parents[2]
RUN_FILE = """\
id = "run07"
title = "拉力"
rig = "rig3m"
date = 2026-09-05T14:20:00+08:00
drive = { kind = "none" }
log = [{ file = "a.csv", clock = "daq" }]
"""


@pytest.fixture
def store(tmp_path: Path, measured: ConditionedRun, header: StoreHeader) -> Path:
    rig = (ROOT / "rigs" / "rig3m.toml").read_text(encoding="utf-8")
    path = tmp_path / "run.h5"
    write_store(path, replace(header, run_file=RUN_FILE, rig_file=rig), measured)
    return path


@pytest.fixture
def pair(tmp_path: Path, measured: ConditionedRun, header: StoreHeader) -> tuple[Path, tuple[Channel, ...]]:
    """A store of two channels with one time base, their names awkward."""
    first = measured.channels[0]
    second = replace(first, name='=HYPERLINK("x"),1', values=first.values[::-1], kind="strain", unit="1")
    rig = (ROOT / "rigs" / "rig3m.toml").read_text(encoding="utf-8")
    path = tmp_path / "pair.h5"
    run = replace(measured, channels=(first, second))
    write_store(path, replace(header, run_file=RUN_FILE, rig_file=rig), run)
    return path, run.channels


def test_our_own_reader_takes_the_csv_back_to_the_last_bit(
    pair: tuple[Path, tuple[Channel, ...]], tmp_path: Path
) -> None:
    made = export(pair[0], "csv", tmp_path / "out.csv")
    assert made.paths == (tmp_path / "out.csv",)
    log = read_log(tmp_path / "out.csv")
    values = [channel for channel in log.channels if not channel.name.endswith(" flags")]
    assert [channel.name for channel in values] == [pair[1][0].name, "'" + pair[1][1].name]
    for read, channel in zip(values, pair[1], strict=True):
        assert np.array_equal(read.values, channel.values, equal_nan=True)
        assert np.array_equal(read.time, channel.time)
    flags = [channel for channel in log.channels if channel.name.endswith(" flags")]
    assert np.array_equal(flags[0].values, pair[1][0].flags)
    said = as_json(inspect_path(tmp_path / "out.csv"))["channels"]
    assert [said[0]["unit"], said[2]["kind"]] == ["N", "strain"]


@pytest.mark.parametrize(
    "text", ["=1+1", "+1", "-1", "@SUM(A1)", "\t=1", "\r=1", " =1", "a,b", 'a"b', "a\n=1"]
)
def test_no_cell_is_a_formula(text: str) -> None:
    import csv

    cell = safe_cell(text)
    (row,) = csv.reader([cell + ",2"])
    assert len(row) == 2
    assert row[0][0] not in "=+-@\t\r"
    assert row[0].lstrip()[0] not in "=+-@"


def test_each_time_base_has_its_own_table(store: Path, tmp_path: Path, measured: ConditionedRun) -> None:
    made = export(store, "csv", tmp_path / "out.csv")
    assert [path.name for path in made.paths] == [
        "out-daq.csv",
        "out-time.csv",
        "out-daq-2.csv",
        "out-time-2.csv",
    ]
    rows = [len(path.read_text(encoding="utf-8").splitlines()) - 2 for path in made.paths]
    assert rows == [channel.time.size for channel in measured.channels]


def test_channels_share_a_time_base_only_where_every_stamp_agrees(measured: ConditionedRun) -> None:
    first = measured.channels[0]
    moved = first.time.copy()
    moved[-1] += 1e-9
    series = [
        SeriesInMemory(first),
        SeriesInMemory(replace(first, time=moved)),
        SeriesInMemory(replace(first, name="b")),
    ]
    assert [len(base.series) for base in time_bases(series)] == [2, 1]


def test_parquet_keeps_values_flags_units_and_provenance(
    pair: tuple[Path, tuple[Channel, ...]], tmp_path: Path
) -> None:
    pq = pytest.importorskip("pyarrow.parquet")
    export(pair[0], "parquet", tmp_path / "out.parquet")
    table = pq.read_table(tmp_path / "out.parquet")
    for channel in pair[1]:
        assert np.array_equal(table[channel.name].to_numpy(), channel.values, equal_nan=True)
        assert np.array_equal(table[f"{channel.name} flags"].to_numpy(), channel.flags)
        about = table.schema.field(channel.name).metadata
        assert about[b"unit"].decode() == channel.unit
        assert channel.source is not None
        assert json.loads(about[b"steps"]) == list(channel.source.steps)
    assert np.array_equal(table["time"].to_numpy(), pair[1][0].time)
    assert table.schema.metadata[b"run_file"].decode() == RUN_FILE


def test_without_pyarrow_a_plain_message(
    store: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("tethertest.jobs.exports.parquet.find_spec", lambda name: None)
    with pytest.raises(TethertestError, match="pyarrow") as refused:
        export(store, "parquet", tmp_path / "out.parquet")
    assert "tethertest[tables]" in refused.value.remedy


def test_matlab_gets_a_struct_per_channel(store: Path, tmp_path: Path, measured: ConditionedRun) -> None:
    from scipy.io import loadmat

    export(store, "mat", tmp_path / "out.mat")
    found = loadmat(tmp_path / "out.mat", simplify_cells=True)
    names = valid_names(["run", *(channel.name for channel in measured.channels)])[1:]
    for name, channel in zip(names, measured.channels, strict=True):
        assert found[name]["name"] == channel.name
        assert np.array_equal(np.atleast_1d(found[name]["value"]), channel.values, equal_nan=True)
        assert np.array_equal(np.atleast_1d(found[name]["flag"]), channel.flags)
        assert np.array_equal(np.atleast_1d(found[name]["time"]), channel.time)
    assert found["run"]["run_file"] == RUN_FILE
    assert found["run"]["flags"]["spike"] == int(Flag.SPIKE)
    assert (tmp_path / "out.mat").read_bytes().startswith(b"MATLAB 5.0 MAT-file, tethertest")


def test_names_for_matlab_are_names_and_different() -> None:
    names = valid_names(["a b", "a_b", "A_b", "9", "end", "拉力", "", "x" * 70, "x" * 71])
    assert names == ["a_b", "a_b_2", "A_b_3", "x9", "xend", "x__", "x", "x" * 63, "x" * 61 + "_2"]


def test_sep005_dictionaries_have_the_keys_of_the_standard(
    store: Path, tmp_path: Path, measured: ConditionedRun
) -> None:
    export(store, "sep005", tmp_path / "out.json")
    found = json.loads((tmp_path / "out.json").read_text(encoding="utf-8"))
    assert len(found) == len(measured.channels)
    date = dt.datetime.fromisoformat("2026-09-05T14:20:00+08:00")
    for entry, channel in zip(found, measured.channels, strict=True):
        assert (entry["name"], entry["unit_str"], entry["quantity"]) == (channel.name, "N", "f")
        values = np.array([np.nan if value is None else value for value in entry["data"]])
        assert np.array_equal(values, channel.values, equal_nan=True)
        assert entry["flags"] == channel.flags.tolist()
        assert np.allclose(np.array(entry["time"]) + entry["time_of_start"], channel.time, atol=1e-12)
        start = dt.datetime.fromisoformat(entry["start_timestamp"])
        assert (start - date).total_seconds() == pytest.approx(channel.time[0], abs=1e-6)
        assert "timestamp" not in entry


@pytest.mark.parametrize("form", FORMATS)
def test_an_export_is_the_same_to_the_byte(form: str, store: Path, tmp_path: Path) -> None:
    made = [export(store, form, tmp_path / name / "run.x").paths for name in ("one", "two")]
    assert [path.read_bytes() for path in made[0]] == [path.read_bytes() for path in made[1]]


def test_a_run_folder_and_its_store_export_the_same(run: Path, tmp_path: Path) -> None:
    from tethertest.jobs.ingest import ingest_run

    stored = ingest_run(run, tmp_path / "run.h5", ROOT / "rigs").path
    one = export(stored, "csv", tmp_path / "one.csv").paths
    two = export(run, "csv", tmp_path / "two.csv", ROOT / "rigs").paths
    assert one[0].read_bytes() == two[0].read_bytes()


def test_files_of_a_run_are_left_alone(run: Path, tmp_path: Path) -> None:
    from tethertest.jobs.ingest import ingest_run

    stored = ingest_run(run, tmp_path / "run.h5", ROOT / "rigs").path
    for source, target in ((run, run / "tension.csv"), (stored, run / "run.toml"), (stored, stored)):
        before = target.read_bytes()
        with pytest.raises(TethertestError, match="left alone"):
            export(source, "csv", target, ROOT / "rigs")
        assert target.read_bytes() == before
