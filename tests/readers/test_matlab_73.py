"""MATLAB files of version 7.3: the layout that MATLAB gives to HDF5, written here by h5py."""

from __future__ import annotations

import h5py
import numpy as np
import pytest

from tethertest.errors import FileFormatError
from tethertest.readers import identify, read_log

T = np.arange(50) / 50.0
F = 5.0 + np.sin(T)
REFERENCE = h5py.special_dtype(ref=h5py.Reference)


def number(group, name, values):
    """Write an array as MATLAB does: at least two sides, reversed."""
    data = group.create_dataset(name, data=np.atleast_2d(values).T if np.ndim(values) < 2 else values.T)
    data.attrs["MATLAB_class"] = np.bytes_({"f8": "double", "i2": "int16"}[values.dtype.str[1:]])
    return data


def char(group, name, text):
    codes = np.frombuffer(text.encode("utf-16-le"), "<u2").reshape(-1, 1)
    data = group.create_dataset(name, data=codes)
    data.attrs["MATLAB_class"] = np.bytes_("char")
    return data


def referred(file, group, name, items):
    references = np.array([item.ref for item in items], dtype=REFERENCE).reshape(-1, 1)
    return group.create_dataset(name, data=references, dtype=REFERENCE)


def cells(file, group, name, texts):
    inner = file.require_group("#refs#")
    made = [char(inner, f"{name}{k}", text) for k, text in enumerate(texts)]
    referred(file, group, name, made).attrs["MATLAB_class"] = np.bytes_("cell")


def struct(file, name):
    group = file.create_group(name)
    group.attrs["MATLAB_class"] = np.bytes_("struct")
    return group


@pytest.fixture
def made(tmp_path):
    def maker(fill):
        path = tmp_path / "log.bin"
        with h5py.File(path, "w", userblock_size=512) as file:
            fill(file)
        data = bytearray(path.read_bytes())
        data[:128] = b"MATLAB 7.3 MAT-file, Platform: GLNXA64, HDF5 schema 1.00 .".ljust(124) + b"\x00\x02IM"
        path.write_bytes(data)
        return path

    return maker


def plain(file):
    number(file, "t", T)
    number(file, "F", F)


def test_vectors_behind_a_block_of_512_bytes(made):
    path = made(plain)
    assert identify(path).NAME == "matlab"
    (channel,) = read_log(path).channels
    np.testing.assert_array_equal(channel.values, F)
    np.testing.assert_array_equal(channel.time, T)


def test_a_matrix_is_turned_back_and_named_by_the_cells_beside_it(made):
    def fill(file):
        daq = struct(file, "daq")
        number(daq, "data", np.column_stack([T, F, 2 * F]))
        cells(file, daq, "names", ["time", "top", "下端"])
        cells(file, daq, "units", ["s", "N", "kN"])

    log = read_log(made(fill))
    assert [(channel.name, channel.unit) for channel in log.channels] == [("top", "N"), ("下端", "kN")]
    np.testing.assert_array_equal(log.channels[1].values, 2 * F)


def test_a_rate_beside_whole_numbers(made):
    def fill(file):
        number(file, "fs", np.array([50.0]))
        number(file, "n", np.arange(50, dtype="i2"))

    log = read_log(made(fill))
    assert (log.rate, log.channels[0].values[-1]) == (50.0, 49.0)


def test_a_char_matrix_has_a_text_in_each_row(made):
    def fill(file):
        number(file, "F", F)
        stamps = [f"2026-09-05 14:20:{k / 50:09.6f}" for k in range(50)]
        codes = np.array([[ord(letter) for letter in stamp] for stamp in stamps], "u2")
        file.create_dataset("when", data=codes.T).attrs["MATLAB_class"] = np.bytes_("char")

    np.testing.assert_allclose(read_log(made(fill)).channels[0].time, T, atol=1e-9)


def test_an_array_of_structs_is_as_many_tables(made, settings):
    def fill(file):
        run, inner = struct(file, "run"), file.create_group("#refs#")
        referred(file, run, "t", [number(inner, f"t{k}", T) for k in range(2)])
        referred(file, run, "F", [number(inner, f"F{k}", (k + 1) * F) for k in range(2)])

    path = made(fill)
    with pytest.raises(FileFormatError, match=r"2 tables that may be the log: 'run\(1\)'.*'run\(2\)'"):
        read_log(path)
    np.testing.assert_array_equal(read_log(path, settings(table="run(2)")).channels[0].values, 2 * F)


def marked(name, **attributes):
    def fill(file):
        data = number(file, name, F)
        for key, value in attributes.items():
            data.attrs[key] = value

    return fill


def sparse(file):
    file.create_group("x").attrs["MATLAB_sparse"] = np.uint64(3)


def complex_numbers(file):
    rows = np.zeros((1, 50), [("real", "f8"), ("imag", "f8")])
    file.create_dataset("x", data=rows).attrs["MATLAB_class"] = np.bytes_("double")


def mixed_cells(file):
    inner = file.create_group("#refs#")
    made = [number(inner, "a", F), char(inner, "b", "text")]
    referred(file, file, "x", made).attrs["MATLAB_class"] = np.bytes_("cell")


OTHERS = {
    "sparse": (sparse, "'x' is a sparse matrix and is left out"),
    "complex": (complex_numbers, "'x' holds complex numbers and"),
    "cells": (mixed_cells, "'x' is a cell array and"),
    "empty": (marked("x", MATLAB_empty=np.uint8(1)), "'x' is empty and"),
    "function": (marked("x", MATLAB_class=np.bytes_("function_handle")), "'x' is a function handle and"),
    "object": (
        marked("x", MATLAB_class=np.bytes_("timetable"), MATLAB_object_decode=np.int32(3)),
        "'x' is a MATLAB timetable and",
    ),
    "link": (
        lambda file: file.update(x=h5py.ExternalLink("/etc/passwd", "/x")),
        "'x' is a link, which is not",
    ),
    "huge": (
        lambda file: file.create_dataset("x", (10**9, 10**3), "f8", chunks=(1000, 1)),
        "'x' declares 1000x10",
    ),
    "3-D": (lambda file: file.create_dataset("x", data=np.zeros((2, 3, 4))), "'x' has 3 dimensions and"),
}


@pytest.mark.parametrize(("fill", "words"), OTHERS.values(), ids=OTHERS)
def test_what_is_no_channel_is_named_and_never_made(made, fill, words):
    log = read_log(made(lambda file: (plain(file), fill(file))))
    assert [channel.name for channel in log.channels] == ["F"]
    assert any(words in remark for remark in log.remarks), log.remarks


def test_structs_that_hold_themselves_end(made):
    def fill(file):
        plain(file)
        group = struct(file, "s")
        group["again"] = group

    with pytest.raises(FileFormatError, match="more than 32 levels"):
        read_log(made(fill))


def test_a_cut_file_is_refused(made):
    path = made(plain)
    for length in (200, 600, 2000):
        path.write_bytes(path.read_bytes()[:-length])
        with pytest.raises(FileFormatError, match="the HDF5 file is damaged or cut"):
            read_log(path)
