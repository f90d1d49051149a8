"""What is written comes back bit by bit, and other programs can read it."""

from __future__ import annotations

import time
from dataclasses import fields
from pathlib import Path

import h5py
import numpy as np

from tethertest.records.channel import Channel, ConditionedRun, Flag
from tethertest.store import StoreHeader, load_store, new_store, open_store, write_store


def assert_same(found: ConditionedRun, expected: ConditionedRun) -> None:
    for field in fields(ConditionedRun):
        if field.name != "channels":
            assert getattr(found, field.name) == getattr(expected, field.name), field.name
    assert len(found.channels) == len(expected.channels)
    for one, other in zip(found.channels, expected.channels, strict=True):
        for field in fields(Channel):
            left, right = getattr(one, field.name), getattr(other, field.name)
            if isinstance(right, np.ndarray):
                assert (left.dtype, left.tobytes()) == (right.dtype, right.tobytes()), field.name
            else:
                assert left == right, field.name


def test_a_run_comes_back_bit_by_bit(tmp_path: Path, measured: ConditionedRun, header: StoreHeader) -> None:
    write_store(tmp_path / "run.h5", header, measured)
    stored = load_store(tmp_path / "run.h5")
    assert_same(stored.measured, measured)
    for field in fields(StoreHeader):
        if field.name != "described":
            assert getattr(stored.header, field.name) == getattr(header, field.name), field.name


def test_a_run_without_anything_comes_back(tmp_path: Path, header: StoreHeader) -> None:
    empty = ConditionedRun((), (), (), None, None, None)
    write_store(tmp_path / "run.h5", header, empty)
    assert_same(load_store(tmp_path / "run.h5").measured, empty)


def test_the_same_run_makes_the_same_bytes(
    tmp_path: Path, measured: ConditionedRun, header: StoreHeader
) -> None:
    write_store(tmp_path / "one.h5", header, measured)
    time.sleep(1.1)  # HDF5 keeps times to the second
    write_store(tmp_path / "two.h5", header, measured)
    assert (tmp_path / "one.h5").read_bytes() == (tmp_path / "two.h5").read_bytes()


def test_blocks_of_any_size_make_the_same_series(
    tmp_path: Path, measured: ConditionedRun, header: StoreHeader
) -> None:
    whole = measured.channels[0]
    with new_store(tmp_path / "run.h5", header) as store:
        series = store.channel(whole.name)
        for start in range(0, whole.time.size, 7001):
            part = slice(start, start + 7001)
            series.append(whole.time[part], whole.values[part], whole.flags[part])
        series.describe(whole)
        store.conclude((), (), {})
    with open_store(tmp_path / "run.h5") as opened:
        read = opened.series[0].read(6990, 7020)
    assert_same(load_store(tmp_path / "run.h5").measured, ConditionedRun((whole,), (), (), None, None, None))
    assert read.time.tobytes() == whole.time[6990:7020].tobytes()


def test_other_programs_find_names_units_and_meanings(
    tmp_path: Path, measured: ConditionedRun, header: StoreHeader
) -> None:
    write_store(tmp_path / "run.h5", header, measured)
    with h5py.File(tmp_path / "run.h5") as file:
        assert (file.attrs["format"], file.attrs["format_version"]) == ("tethertest-run", 1)
        assert (file.attrs["run_file"], file.attrs["drive_frequency_Hz"]) == (header.run_file, 0.3)
        group = file["channels/%E6%8B%89%E5%8A%9B%2Ftop .%2A"]
        assert group.attrs["name"] == "拉力/top .*"
        assert group["value"].attrs["units"] == group.attrs["unit"] == "N"
        meanings = dict(
            zip(group["flag"].attrs["flag_meanings"].split(), group["flag"].attrs["flag_masks"], strict=True)
        )
        assert meanings == {flag.name.lower(): int(flag) for flag in Flag if flag and flag.name}
        assert list(group.attrs["steps"]) == ["one step", "Δ second step"]
