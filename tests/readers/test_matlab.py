"""MATLAB files of version 5 to 7: written by scipy, and by hand where scipy writes no such thing."""

from __future__ import annotations

import io
import struct
import zlib

import numpy as np
import pytest
import scipy.io

from tethertest.errors import FileFormatError
from tethertest.readers import read_log
from tethertest.readers.tables.containers import mat5

T = np.arange(50) / 50.0
F = 5.0 + np.sin(T)


def saved(variables, **keys):
    buffer = io.BytesIO()
    scipy.io.savemat(buffer, variables, **keys)
    return buffer.getvalue()


def element(kind, data):
    return struct.pack("<II", kind, len(data)) + data + bytes(-len(data) % 8)


def array(name, kind, content, *, sides=(50, 1), flags=0, type_of_name=1):
    head = element(6, struct.pack("<II", kind | flags, 0)) + element(
        5, struct.pack(f"<{len(sides)}i", *sides)
    )
    return element(14, head + element(type_of_name, name) + content)


def level_5(*elements):
    return b"MATLAB 5.0 MAT-file".ljust(124) + b"\x00\x01IM" + b"".join(elements)


DOUBLES_T = array(b"t", 6, element(9, T.astype("<f8").tobytes()))
DOUBLES_F = array(b"F", 6, element(9, F.astype("<f8").tobytes()))


@pytest.mark.parametrize("do_compression", [False, True])
@pytest.mark.parametrize("oned_as", ["row", "column"])
def test_vectors_of_the_file_itself(write, do_compression, oned_as):
    path = write(saved({"t": T, "F": F}, do_compression=do_compression, oned_as=oned_as), "log.csv")
    log = read_log(path)
    (channel,) = log.channels
    assert (log.format, channel.name) == ("matlab", "F")
    np.testing.assert_array_equal(channel.values, F)
    np.testing.assert_array_equal(channel.time, T)


@pytest.mark.parametrize("kind", ["i1", "u1", "i2", "u2", "i4", "u4", "i8", "u8", "f4", "f8"])
def test_every_type_of_number(write, kind):
    counts = np.arange(50).astype(kind)
    (channel,) = read_log(write(saved({"t": T, "n": counts}), "log.mat")).channels
    np.testing.assert_array_equal(channel.values, np.arange(50.0))


def test_bytes_of_the_other_order(write):
    def swapped(kind, data):
        return struct.pack(">II", kind, len(data)) + data + bytes(-len(data) % 8)

    def one(name, values):
        head = swapped(6, struct.pack(">II", 6, 0)) + swapped(5, struct.pack(">ii", 1, 50))
        return swapped(14, head + swapped(1, name) + swapped(9, values.astype(">f8").tobytes()))

    head = b"MATLAB 5.0 MAT-file".ljust(124) + b"\x01\x00MI"
    (channel,) = read_log(write(head + one(b"t", T) + one(b"F", F), "log.mat")).channels
    np.testing.assert_array_equal(channel.values, F)


def test_names_and_units_stand_beside_a_matrix(write):
    daq = {
        "data": np.column_stack([T, F, 2 * F]),
        "names": np.array(["time", "top", "unten ä"], dtype=object),
        "units": np.array(["ms", "N", "kN"], dtype=object),
    }
    log = read_log(write(saved({"daq": daq, "title": "rig"}), "log.mat"))
    assert [(channel.name, channel.unit) for channel in log.channels] == [("top", "N"), ("unten ä", "kN")]
    np.testing.assert_array_equal(log.channels[1].values, 2 * F)
    np.testing.assert_allclose(log.channels[1].time, T / 1000.0, rtol=1e-15)


def test_units_by_name_and_the_rate_of_a_struct(write):
    daq = {"fs": 50.0, "top": F, "low": 2 * F, "units": {"top": "N", "low": "kN"}}
    log = read_log(write(saved({"daq": daq}), "log.mat"))
    assert [(channel.name, channel.unit) for channel in log.channels] == [("top", "N"), ("low", "kN")]
    np.testing.assert_allclose(log.channels[0].time, T, rtol=1e-15)
    assert log.rate == 50.0


def test_one_unit_belongs_to_the_one_channel(write):
    (channel,) = read_log(write(saved({"s": {"time": T, "F": F, "unit": "kN"}}), "log.mat")).channels
    assert channel.unit == "kN"
    two = read_log(write(saved({"s": {"time": T, "F": F, "G": F, "unit": "kN"}}), "log.mat")).channels
    assert [channel.unit for channel in two] == ["", ""]


def test_stamps_as_the_rows_of_a_char_matrix(write):
    stamps = [f"2026-09-05 14:20:{k / 50:09.6f}" for k in range(50)]
    for text in (np.array(stamps), np.array(stamps, dtype=object)):
        log = read_log(write(saved({"when": text, "F": F}), "log.mat"))
        np.testing.assert_allclose(log.channels[0].time, T, atol=1e-9)
        assert log.start is not None
        assert log.start.isoformat() == "2026-09-05T14:20:00"


def test_an_array_of_structs_of_single_values_is_a_table(write):
    rows = np.zeros(50, dtype=[("t", object), ("F", object)])
    for row in range(50):
        rows[row] = (T[row], F[row])
    (channel,) = read_log(write(saved({"rows": rows}), "log.mat")).channels
    np.testing.assert_array_equal(channel.values, F)
    np.testing.assert_array_equal(channel.time, T)


def test_an_array_of_structs_of_vectors_is_as_many_tables(write, settings):
    runs = np.zeros(2, dtype=[("t", object), ("F", object)])
    runs[0], runs[1] = (T, F), (T, 3 * F)
    path = write(saved({"run": runs}), "log.mat")
    with pytest.raises(FileFormatError, match=r"2 tables that may be the log: 'run\(1\)'.*'run\(2\)'"):
        read_log(path)
    np.testing.assert_array_equal(read_log(path, settings(table="run(2)")).channels[0].values, 3 * F)


def test_a_struct_in_a_struct_is_named_by_dots(write, settings):
    path = write(saved({"a": {"b": {"t": T, "F": F}}, "c": {"t": T, "F": -F}}), "log.mat")
    assert read_log(path, settings(table="a.b")).channels[0].values[0] == F[0]
    path = write(saved({"a": {"data": F}, "clock": {"t": T}}), "log.mat")
    log = read_log(path, settings(table="a.data", time="clock.t"))
    np.testing.assert_array_equal(log.channels[0].time, T)


def test_datenum_is_a_calendar_only_where_run_toml_says_so(write, settings):
    days = 740230.0 + T / 86400.0
    log = read_log(write(saved({"t": days, "F": F}), "log.mat"), settings(time="t", units={"t": "datenum"}))
    assert log.start is not None
    assert log.start.date().isoformat() == "2026-09-05"


OTHERS = {
    "complex": (saved({"t": T, "F": F, "x": F + 1j}), "'x' holds complex numbers and is left out"),
    "sparse": (saved({"t": T, "F": F, "x": scipy.sparse.csc_array(np.eye(3))}), "'x' is a sparse matrix and"),
    "cells": (saved({"t": T, "F": F, "x": np.array([F, T, 1.0], dtype=object)}), "'x' is a cell array and"),
    "3-D": (saved({"t": T, "F": F, "x": np.zeros((2, 3, 4))}), "'x' has 3 dimensions and is left out"),
    "empty": (saved({"t": T, "F": F, "x": np.zeros((0, 0))}), "'x' is empty and is left out"),
    "texts": (saved({"t": T, "F": F, "x": ["ab", "cd"]}), "'x' holds text and is left out"),
    "function": (
        level_5(DOUBLES_T, DOUBLES_F, array(b"x", 16, b"", sides=(1, 1))),
        "'x' is a function handle",
    ),
    "old object": (level_5(DOUBLES_T, DOUBLES_F, array(b"x", 3, b"", sides=(1, 1))), "'x' is an object and"),
    "timetable": (
        level_5(
            DOUBLES_T,
            DOUBLES_F,
            element(
                14,
                element(6, struct.pack("<II", 17, 0))
                + element(1, b"x")
                + element(1, b"MCOS")
                + element(1, b"timetable"),
            ),
        ),
        "'x' is a MATLAB timetable and is left out",
    ),
}


@pytest.mark.parametrize(("data", "words"), OTHERS.values(), ids=OTHERS)
def test_what_is_no_channel_is_named_and_never_made(write, data, words):
    log = read_log(write(data, "log.mat"))
    assert [channel.name for channel in log.channels] == ["F"]
    assert any(words in remark for remark in log.remarks), log.remarks


def test_a_file_of_objects_alone_says_so(write):
    data = (
        element(6, struct.pack("<II", 17, 0)) + element(1, b"x") + element(1, b"MCOS") + element(1, b"table")
    )
    with pytest.raises(FileFormatError, match="no array of numbers: 'x' is a MATLAB table"):
        read_log(write(level_5(element(14, data)), "log.mat"))


DEEP = array(b"", 1, b"", sides=(1, 1))
for _ in range(40):
    DEEP = array(b"x", 1, DEEP, sides=(1, 1))
HOSTILE = {
    "a huge shape": (
        level_5(array(b"F", 6, element(9, bytes(8)), sides=(2**31 - 1, 2**31 - 1))),
        "declares 2147",
    ),
    "a huge length": (
        level_5(struct.pack("<II", 14, 2**32 - 1)),
        "declares 4294967295 bytes, and 0 are left",
    ),
    "a huge cell array": (
        level_5(array(b"x", 1, b"", sides=(2**31 - 1, 2**31 - 1))),
        "an element begins 0 bytes",
    ),
    "cells in cells": (level_5(DEEP), "more than 32 levels"),
    "40 dimensions": (level_5(array(b"F", 6, b"", sides=(1,) * 40)), r"has the sides \(1, 1, 1, 1\)"),
    "a negative side": (level_5(array(b"F", 6, b"", sides=(-1, 5))), r"has the sides \(-1, 5\)"),
    "a field twice": (
        level_5(array(b"s", 2, element(5, struct.pack("<i", 2)) + element(1, b"a\0a\0"), sides=(1, 1))),
        "a struct repeats a field",
    ),
    "the same name twice": (level_5(DOUBLES_F, DOUBLES_F), "holds the variable 'F' twice"),
    "a text longer than its shape": (
        level_5(array(b"F", 4, element(16, b"a" * 300))),
        "a text of 50 letters has 300 bytes",
    ),
    "an unknown class": (level_5(array(b"F", 30, b"")), "an element begins 0 bytes"),
    "no variable": (level_5(element(9, bytes(8))), "a variable is of type 9"),
}


@pytest.mark.parametrize(("data", "words"), HOSTILE.values(), ids=HOSTILE)
def test_hostile_files_are_refused(write, data, words):
    with pytest.raises(FileFormatError, match=words):
        read_log(write(data, "log.mat"))


def test_a_bomb_stops_at_the_ratio(write, monkeypatch):
    monkeypatch.setattr(mat5, "RATIO_FROM", 2**16)
    bomb = struct.pack("<II", 15, len(data := zlib.compress(bytes(10**7)))) + data
    with pytest.raises(FileFormatError, match="unpacks to more than a log of its size holds"):
        read_log(write(level_5(bomb), "log.mat"))


@pytest.mark.parametrize("do_compression", [False, True])
def test_a_cut_file_is_refused_wherever_it_is_cut(write, do_compression):
    data = saved(
        {"daq": {"t": T, "F": F, "names": np.array(["a", "b"], dtype=object)}}, do_compression=do_compression
    )
    for length in range(20, len(data), 7):
        with pytest.raises(FileFormatError, match="damaged or cut"):
            read_log(write(data[:length], "log.mat"))


def test_a_changed_byte_of_a_packed_variable_is_seen(write):
    data = bytearray(saved({"t": T, "F": F}, do_compression=True))
    data[-20] ^= 1
    with pytest.raises(FileFormatError, match="the MATLAB file is damaged or cut"):
        read_log(write(bytes(data), "log.mat"))


@pytest.mark.parametrize("order", ["little", "big"])
def test_version_4_is_told(write, order):
    def one(name, values):
        letter, kind = ("<", 0) if order == "little" else (">", 1000)
        head = struct.pack(f"{letter}5i", kind, len(values), 1, 0, len(name) + 1)
        return head + name + b"\0" + values.astype(f"{letter}f8").tobytes()

    with pytest.raises(FileFormatError, match=r"format of version 4, which is not read\n.*'-v7'"):
        read_log(write(one(b"t", T) + one(b"F", F), "log.mat"))


def test_octave_text_is_told(write):
    text = "# Created by Octave 8.4.0, Sat Sep 05 2026\n# name: t\n# type: matrix\n# rows: 2\n 0\n 1\n"
    with pytest.raises(FileFormatError, match="found Octave's text format"):
        read_log(write(text, "log.mat"))
