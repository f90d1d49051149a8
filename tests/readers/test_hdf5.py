from __future__ import annotations

import h5py
import numpy as np
import pytest

from tethertest.errors import FileFormatError
from tethertest.readers import read_log
from tethertest.readers.formats import hdf5
from tethertest.store import layout

T = np.arange(50) / 50.0
F = 5.0 + np.sin(T)


@pytest.fixture
def made(tmp_path):
    def maker(fill):
        path = tmp_path / "log.bin"
        with h5py.File(path, "w") as file:
            fill(file)
        return path

    return maker


def plain(file, group="daq"):
    file[f"{group}/time"] = T
    file[f"{group}/F_top"] = F
    file[f"{group}/F_top"].attrs["unit"] = "N"


def test_vectors_of_a_group_with_units(made):
    (channel,) = read_log(made(plain)).channels
    assert (channel.name, channel.unit) == ("F_top", "N")
    np.testing.assert_array_equal(channel.values, F)
    np.testing.assert_array_equal(channel.time, T)


def test_a_matrix_with_named_columns_lies_either_way(made):
    def fill(file):
        file["time"] = T
        file["data"] = np.array([F, 2 * F])
        file["data"].attrs["columns"] = ["top", "bottom"]

    log = read_log(made(fill))
    assert [channel.name for channel in log.channels] == ["top", "bottom"]
    np.testing.assert_array_equal(log.channels[1].values, 2 * F)
    assert any("is 2x50 and is read as 2 columns of 50" in remark for remark in log.remarks)


def test_records_are_a_table(made):
    rows = np.zeros(50, dtype=[("t", "f8"), ("F", "f4")])
    rows["t"], rows["F"] = T, F
    log = read_log(made(lambda file: file.create_dataset("rows", data=rows)))
    np.testing.assert_allclose(log.channels[0].values, F, rtol=1e-7)


def test_two_groups_are_listed_and_one_is_named(made, settings):
    path = made(lambda file: (plain(file), plain(file, "fbg")))
    with pytest.raises(FileFormatError, match=r"2 tables that may be the log: 'daq'.*'fbg'"):
        read_log(path)
    assert read_log(path, settings(table="/fbg")).channels[0].name == "F_top"


def test_a_run_store_is_named_as_such(made):
    assert hdf5._STORE == layout.FORMAT
    path = made(lambda file: file.attrs.update(format="tethertest-run"))
    with pytest.raises(FileFormatError, match="found a run that tethertest has stored"):
        read_log(path)


HOSTILE = {
    "external link": (
        lambda f: f.update(x=h5py.ExternalLink("/etc/passwd", "/x")),
        "a link into another file",
    ),
    "soft link to itself": (lambda f: f.update(x=h5py.SoftLink("/x")), "is a link to '/x', which is not"),
    "huge and empty": (
        lambda f: f.create_dataset("x", (10**12,), "f8", chunks=(10**4,)),
        "declares 1000000000000",
    ),
    "declared only": (lambda f: f.create_dataset("x", (10**4,), "f8"), "declares values but holds none"),
    "values elsewhere": (
        lambda f: f.create_dataset("x", (10,), "f8", external=[("other.bin", 0, 80)]),
        "keeps its values in another file",
    ),
}


@pytest.mark.parametrize(("fill", "words"), HOSTILE.values(), ids=HOSTILE)
def test_what_lies_elsewhere_or_nowhere_is_not_read(made, fill, words):
    with pytest.raises(FileFormatError, match=words):
        read_log(made(fill))


def test_a_group_that_holds_itself_ends(made):
    def fill(file):
        plain(file)
        file["daq/again"] = file["daq"]

    assert len(read_log(made(fill)).channels) == 1


def test_chunks_that_were_never_written_are_not_zeros(made):
    def fill(file):
        file["time"] = T
        file.create_dataset("F", (50,), "f8", chunks=(10,))[:10] = 1.0

    with pytest.raises(FileFormatError, match="no channels"):
        read_log(made(fill))


def test_a_cut_file_is_refused(made):
    path = made(plain)
    path.write_bytes(path.read_bytes()[:2000])
    with pytest.raises(FileFormatError, match="the HDF5 file is damaged or cut"):
        read_log(path)


PACKED = {"units": "N", "scale_factor": 0.001, "add_offset": 1.0, "_FillValue": np.int16(-32767)}


@pytest.mark.parametrize("shape", [(100,), (100, 2)])
def test_packed_numbers_are_unpacked_and_said(tmp_path, shape):
    """As the CF conventions of netCDF have it: scale, then offset, and a number for no value."""
    path = tmp_path / "packed.h5"
    stored = np.full(shape, 4000, "i2")
    stored[50] = -32767
    with h5py.File(path, "w") as file:
        file["time"] = np.arange(100) * 0.01
        file["time"].attrs["units"] = "s"
        file["F"] = stored
        file["F"].attrs.update(PACKED)
    log = read_log(path)
    assert len(log.channels) == len(stored.reshape(100, -1)[0])
    for channel in log.channels:
        assert np.flatnonzero(np.isnan(channel.values)).tolist() == [50]
        np.testing.assert_array_equal(np.delete(channel.values, 50), 5.0)
    assert any(
        "scale_factor 0.001 times" in remark and "-32767 read as missing" in remark for remark in log.remarks
    )


@pytest.mark.parametrize("value", [np.nan, "text", [1.0, 2.0]])
def test_attributes_that_say_no_number_change_nothing(tmp_path, value):
    path = tmp_path / "plain.h5"
    with h5py.File(path, "w") as file:
        file["time"] = np.arange(100) * 0.01
        file["F"] = np.arange(100.0)
        file["F"].attrs["_FillValue"] = value
        file["F"].attrs["scale_factor"] = value
    np.testing.assert_array_equal(read_log(path).channels[0].values, np.arange(100.0))
