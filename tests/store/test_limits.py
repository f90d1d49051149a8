"""Limits of a store from both sides, and what its messages name."""

from __future__ import annotations

import hashlib
import os
import stat
from pathlib import Path

import h5py
import numpy as np
import pytest

from tethertest.errors import FileFormatError, TethertestError
from tethertest.records.channel import ConditionedRun
from tethertest.store import StoreHeader, guards, load_store, read, write_store, written_whole
from tethertest.store.seal import check_seal, is_sealed, seal

from .test_hostile import sealed_again


@pytest.fixture
def store(tmp_path: Path, measured: ConditionedRun, header: StoreHeader) -> Path:
    path = tmp_path / "run.h5"
    write_store(path, header, measured)
    return path


@pytest.fixture
def few(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(guards, "_LARGEST_LIST", 3)


@pytest.fixture
def empty(tmp_path: Path) -> h5py.File:
    with h5py.File(tmp_path / "made.h5", "w") as file:
        yield file


PLACE = Path("made.h5")


@pytest.mark.usefixtures("few")
def test_lists_may_have_as_many_entries_as_the_limit_and_no_more(empty: h5py.File) -> None:
    for name in "abc":
        empty.create_group(name)
    assert guards.members(PLACE, empty) == ["a", "b", "c"]
    empty.attrs["list"] = ["x", "y", "z"]
    assert guards.texts(PLACE, empty, "list") == ("x", "y", "z")
    column = empty["a"].create_dataset("words", data=["x", "y", "z"])
    assert guards.read_texts(PLACE, column) == ("x", "y", "z")
    empty.create_group("d")
    with pytest.raises(FileFormatError, match="found 4 members"):
        guards.members(PLACE, empty)
    empty.attrs["list"] = ["w", "x", "y", "z"]
    with pytest.raises(FileFormatError, match=r"/@list: found shape \(4,\), expected a single value"):
        guards.texts(PLACE, empty, "list")
    longer = empty["a"].create_dataset("more", data=["w", "x", "y", "z"])
    with pytest.raises(FileFormatError, match="/a/more: found 4 texts"):
        guards.read_texts(PLACE, longer)


def test_attributes_are_what_they_are_asked_for(empty: h5py.File) -> None:
    empty.attrs["number"], empty.attrs["word"], empty.attrs["bad"] = 2.5, "x", np.inf
    empty.attrs["whole"], empty.attrs["nothing"] = 3, h5py.Empty("f8")
    assert (guards.number(PLACE, empty, "number"), guards.number(PLACE, empty, "whole")) == (2.5, 3.0)
    for key in ("bad", "word", "missing"):
        with pytest.raises(FileFormatError, match=f"/@{key}: found .*, expected a number"):
            guards.number(PLACE, empty, key)
    with pytest.raises(FileFormatError, match="/@nothing: found shape None"):
        guards.number(PLACE, empty, "nothing")
    assert guards.text(PLACE, empty, "word") == "x"
    assert guards.text(PLACE, empty, "missing", "else") == "else"
    assert guards.optional_text(PLACE, empty, "missing") is None
    assert guards.optional_text(PLACE, empty, "word") == "x"
    with pytest.raises(FileFormatError, match="/@missing: found nothing, expected text"):
        guards.text(PLACE, empty, "missing")
    with pytest.raises(FileFormatError, match=r"/@number: found .*, expected text"):
        guards.text(PLACE, empty, "number", "else")
    for key in ("word", "missing"):
        with pytest.raises(FileFormatError, match=f"/@{key}: found .*, expected a list of texts"):
            guards.texts(PLACE, empty, key)


def test_a_dataset_of_another_shape_or_type_is_told_the_one_expected(empty: h5py.File) -> None:
    row, table = (
        empty.create_dataset("row", data=np.zeros(5)),
        empty.create_dataset("table", data=np.zeros((4, 2))),
    )
    assert guards.checked_series(PLACE, row, "<f8") == 5
    assert guards.checked_series(PLACE, table, "<f8", 2) == 4
    big_endian = empty.create_dataset("swapped", data=np.arange(3.0).astype(">f8"))
    assert guards.checked_series(PLACE, big_endian, "<f8") == 3
    assert guards.read_block(PLACE, big_endian, 1, 3).tolist() == [1.0, 2.0]
    with pytest.raises(FileFormatError, match=r"/table: found shape \(4, 2\), expected \(n,\)"):
        guards.checked_series(PLACE, table, "<f8")
    with pytest.raises(FileFormatError, match=r"/row: found shape \(5,\), expected \(n, 2\)"):
        guards.checked_series(PLACE, row, "<f8", 2)
    with pytest.raises(FileFormatError, match=r"/table: found shape \(4, 2\), expected \(n, 3\)"):
        guards.checked_series(PLACE, table, "<f8", 3)
    for wrong in ("<f4", "<i8", "<u8"):
        with pytest.raises(FileFormatError, match="/row: found type float64"):
            guards.checked_series(PLACE, row, wrong)


def test_a_series_as_long_as_the_limit_passes(empty: h5py.File, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(guards, "LARGEST_SERIES", 5)
    assert guards.checked_series(PLACE, empty.create_dataset("five", data=np.zeros(5)), "<f8") == 5
    with pytest.raises(FileFormatError, match="/six: found 6 samples, more than any run has"):
        guards.checked_series(PLACE, empty.create_dataset("six", data=np.zeros(6)), "<f8")


def test_chunks_are_small_and_all_of_them_are_there(
    empty: h5py.File, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(guards, "_LARGEST_CHUNK", 64)
    whole = empty.create_dataset("whole", data=np.zeros(20), chunks=(8,))
    assert guards.checked_series(PLACE, whole, "<f8") == 20
    with pytest.raises(FileFormatError, match=r"found chunks of \(9,\)"):
        guards.checked_series(PLACE, empty.create_dataset("large", data=np.zeros(20), chunks=(9,)), "<f8")
    partly = empty.create_dataset("partly", shape=(20,), chunks=(8,), dtype="<f8")
    partly[:16] = 1.0
    with pytest.raises(FileFormatError, match=r"declared with shape \(20,\), but not all of it was written"):
        guards.checked_series(PLACE, partly, "<f8")
    partly[16:] = 1.0
    assert guards.checked_series(PLACE, partly, "<f8") == 20


@pytest.mark.parametrize(
    ("version", "said"), [(2, "with the tethertest that wrote it"), (0, "from its raw logs")]
)
def test_another_version_is_told_apart_as_newer_or_older(store: Path, version: int, said: str) -> None:
    with h5py.File(store, "r+") as file:
        file.attrs["format_version"] = version
    sealed_again(store)
    with pytest.raises(FileFormatError, match=f"found {version}, this version reads 1") as refused:
        load_store(store)
    assert said in refused.value.remedy


def test_a_window_of_one_instant_is_a_span_and_one_that_ends_before_is_none(store: Path) -> None:
    for stop, passes in ((8.1, True), (8.0999, False)):
        with h5py.File(store, "r+") as file:
            file["windows/steady"].attrs["stop"] = stop
        sealed_again(store)
        if passes:
            steady = load_store(store).measured.steady
            assert steady is not None
            assert steady.length == 0.0
        else:
            with pytest.raises(FileFormatError, match="expected a span of time"):
                load_store(store)


@pytest.mark.parametrize("owner", [-1, 3])
def test_a_span_belongs_to_one_of_the_findings(store: Path, owner: int) -> None:
    with h5py.File(store, "r+") as file:
        file["findings/span_of"][0] = owner
    sealed_again(store)
    with pytest.raises(FileFormatError, match=f"found {owner}, there are 3 findings"):
        load_store(store)


def test_a_run_larger_than_memory_allows_is_not_read_at_once(
    store: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    samples = 40_000 + 31 + 5 + 1
    monkeypatch.setattr(read, "LARGEST_IN_MEMORY", 18 * samples)
    assert len(load_store(store).measured.channels) == 4
    monkeypatch.setattr(read, "LARGEST_IN_MEMORY", 18 * samples - 1)
    with pytest.raises(FileFormatError, match="more than is read at once"):
        load_store(store)


def test_a_series_is_read_from_sample_to_sample(store: Path, measured: ConditionedRun) -> None:
    whole = measured.channels[0]
    with read.open_store(store) as opened:
        series = opened.series[0]
        assert series.size == 40_000
        part = series.read(39_990, 50_000)
        np.testing.assert_array_equal(part.time, whole.time[39_990:])
        np.testing.assert_array_equal(part.values, whole.values[39_990:])
        np.testing.assert_array_equal(series.read(3, 7).flags, whole.flags[3:7])
        assert (part.name, part.uncertainty, part.noise) == (whole.name, whole.uncertainty, whole.noise)


def test_the_seal_is_the_hash_of_all_that_stands_before_it(tmp_path: Path) -> None:
    path = tmp_path / "sealed.h5"
    content = b"\x89HDF\r\n\x1a\n" + bytes(range(256)) * 5000  # more than one block of a megabyte
    with written_whole(path) as file:
        file.write(content)
        seal(file)
    found = path.read_bytes()
    line = f"\ntethertest-run sha256 {hashlib.sha256(content).hexdigest()}\n".encode()
    assert found == content + line
    check_seal(path)
    path.write_bytes(content[:-1] + b"x" + line)
    assert is_sealed(path)
    with pytest.raises(FileFormatError, match="damaged or was changed"):
        check_seal(path)
    path.write_bytes(content + line + b"x")
    assert not is_sealed(path)
    path.write_bytes(b"x" + found[1:])
    assert not is_sealed(path)
    with pytest.raises(FileFormatError, match="found no HDF5 file"):
        check_seal(path)


def test_what_the_system_refuses_is_told_in_its_words(tmp_path: Path) -> None:
    with pytest.raises(FileFormatError, match=r"cannot be read \(no such file or directory\)"):
        check_seal(tmp_path / "nothing.h5")
    long = tmp_path / ("x" * 300)
    told = pytest.raises(TethertestError, match=r"cannot be written \(file name too long\)")
    with told as refused, written_whole(long):
        pass
    assert "shorter name" in refused.value.remedy


def test_a_file_has_the_permissions_that_any_new_file_has(tmp_path: Path) -> None:
    old = os.umask(0o022)
    try:
        with written_whole(tmp_path / "run.h5") as file:
            file.write(b"x")
    finally:
        os.umask(old)
    assert stat.S_IMODE((tmp_path / "run.h5").stat().st_mode) == 0o644
