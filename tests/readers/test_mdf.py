"""ASAM MDF files, written by asammdf and damaged block by block."""

from __future__ import annotations

import datetime as dt
import struct
import sys

import numpy as np
import pytest
from asammdf import MDF, Signal

from tethertest.errors import FileFormatError
from tethertest.readers import identify, read_log
from tethertest.readers.formats import mdf
from tethertest.readers.guards import mdf_blocks, sandboxed_read
from tethertest.records.run import DEFAULT

T = np.arange(40) / 50.0
F = 5.0 + np.sin(T)
SLOW = np.arange(8) / 10.0
START = dt.datetime(2026, 9, 5, 14, 20, 0, 250000, tzinfo=dt.timezone(dt.timedelta(hours=8)))


@pytest.fixture
def made(tmp_path):
    """Write groups of signals, given as name of the acquisition and signals."""

    def maker(*groups, version="4.10", start=START, change=None, **keys):
        path = tmp_path / ("log.mf4" if version >= "4" else "log.mdf")
        with MDF(version=version) as file:
            file.start_time = start
            for name, signals in groups or [("fast", [Signal(F, T, name="F", unit="kN")])]:
                file.append(signals, acq_name=name)
            file.save(path, overwrite=True, **keys)
        if change:
            path.write_bytes(change(path.read_bytes()))
        return path

    return maker


def refused(path, words, settings=DEFAULT):
    with pytest.raises(FileFormatError, match=words):
        read_log(path, settings)


@pytest.mark.parametrize("compression", [0, 1, 2])
@pytest.mark.parametrize("version", ["4.00", "4.10", "4.20", "3.10", "3.30"])
def test_every_version_and_compression(made, version, compression):
    path = made(version=version, compression=compression)
    assert identify(path).NAME == "mdf"
    log = read_log(path)
    (channel,) = log.channels
    assert (channel.name, channel.unit) == ("F", "kN")
    np.testing.assert_array_equal(channel.values, F)
    np.testing.assert_allclose(channel.time, T, rtol=1e-15)


def test_version_4_starts_in_its_own_zone_and_version_3_without_one(made, settings):
    assert read_log(made()).start == START
    assert str(read_log(made(), settings(time_zone="UTC")).start) == "2026-09-05 06:20:00.250000+00:00"
    old = read_log(made(version="3.30")).start
    assert old is not None
    assert old.tzinfo is None


def test_each_group_has_a_time_of_its_own(made, settings):
    fast = [Signal(F, T, name="F", unit="N"), Signal(2 * F, T, name="x", unit="N")]
    path = made(("fast", fast), ("slow", [Signal(SLOW + 1.0, SLOW, name="x", unit="degC")]))
    log = read_log(path)
    sizes = {channel.name: channel.time.size for channel in log.channels}
    assert sizes == {"F": 40, "fast/x": 40, "slow/x": 8}
    np.testing.assert_array_equal(log.channels[1].values, 2 * F)
    np.testing.assert_array_equal(log.channels[2].time, SLOW)
    assert "groups with a time of their own: 'fast', 'slow'" in log.remarks
    (only,) = read_log(path, settings(table="slow")).channels
    assert (only.name, only.unit) == ("x", "degC")
    refused(path, "table = \"slo\", the MDF file has 'fast', 'slow'", settings(table="slo"))


def test_groups_without_names_are_numbered(made, settings):
    path = made(("", [Signal(F, T, name="F")]), ("", [Signal(SLOW, SLOW, name="G")]))
    assert [channel.name for channel in read_log(path, settings(table="group 2")).channels] == ["G"]


@pytest.mark.parametrize("version", ["4.10", "3.30"])
def test_counts_become_physical_values(made, version):
    counts = np.arange(40, dtype=np.int16)
    signal = Signal(counts, T, name="F", unit="N", conversion={"a": 0.5, "b": -3.0})
    (channel,) = read_log(made(("", [signal]), version=version)).channels
    np.testing.assert_array_equal(channel.values, 0.5 * counts - 3.0)


def test_values_marked_as_invalid_are_missing_and_counted(made):
    """asammdf would leave them out, and shorten the channel."""
    invalid = np.zeros(40, bool)
    invalid[[3, 7]] = True
    log = read_log(made(("", [Signal(F, T, name="F", invalidation_bits=invalid), Signal(F, T, name="G")])))
    np.testing.assert_array_equal(np.isnan(log.channels[0].values), invalid)
    assert np.isfinite(log.channels[1].values).all()
    assert "channel 'F': 2 values marked as invalid read as missing" in log.remarks


def test_what_is_no_channel_is_named(made):
    signals = [
        Signal(F, T, name="F"),
        Signal(np.array([b"on", b"off"] * 20), T, name="state", encoding="utf-8"),
        Signal(np.arange(40), T, name="calculated", conversion={"formula": "X * 2 + 1"}),
    ]
    log = read_log(made(("", signals)))
    assert [channel.name for channel in log.channels] == ["F"]
    for words in (
        "channel 'state' holds no single numbers and is left out",
        "channel 'calculated' has a formula as conversion and is left out",
    ):
        assert words in log.remarks


def test_the_elements_of_a_vector_are_channels(made):
    values = np.arange(120.0).reshape(40, 3)
    rows = np.rec.fromarrays([values], dtype=[("grating", "<f8", (3,))])
    log = read_log(made(("", [Signal(rows, T, name="grating")])))
    assert [channel.name for channel in log.channels] == [f"grating[{k}]" for k in range(3)]
    for column, channel in enumerate(log.channels):
        np.testing.assert_array_equal(channel.values, values[:, column])
    assert "channel 'grating' holds no single numbers and is left out" in log.remarks


@pytest.mark.parametrize("version", ["4.10", "3.30"])
def test_a_formula_of_the_file_is_not_evaluated(made, version):
    signal = Signal(np.arange(40), T, name="F", conversion={"formula": "X1 * 2"})
    refused(made(("", [signal]), version=version), "has a formula as conversion and is left out")


def find(data, kind, number=0):
    place = -1
    for _ in range(number + 1):
        place = data.index(kind, place + 1)
    return place


def put(kind, offset, form, value, number=0):
    """Return a change of one number of a block, at an offset from its beginning."""

    def change(data):
        changed = bytearray(data)
        struct.pack_into(form, changed, find(data, kind, number) + offset, value)
        return bytes(changed)

    return change


def looped(kind, link):
    """Let a link of a block lead to the block itself."""
    return lambda data: put(kind, 24 + 8 * link, "<Q", find(data, kind))(data)


HOSTILE = {
    "records that are not there": (put(b"##CG", 80, "<Q", 10**12), "records of 16000000000000 bytes"),
    "texts that are not there": (
        lambda data: put(b"##CG", 88, "<H", 1)(put(b"##CG", 80, "<Q", 10**12)(data)),
        "declares records of 4000000000000 bytes",
    ),
    "fewer records than data": (put(b"##CG", 80, "<Q", 30), "records of 480 bytes and holds 640"),
    "a channel that is its own next": (looped(b"##CN", 0), "a list of its blocks leads back to itself"),
    "a channel in itself": (looped(b"##CN", 1), "a list of its blocks leads back to itself"),
    "a group that is its own next": (looped(b"##DG", 0), "a list of its blocks leads back to itself"),
    "a channel outside of its record": (put(b"##CN", 92, "<I", 2**16, 1), "at byte 65536 of a record of 16"),
    "a float of three bytes": (put(b"##CN", 96, "<I", 24, 1), "floating-point numbers of 24 bits"),
    "a channel too wide": (put(b"##CN", 91, "<B", 1, 1), "lies at byte 8 of a record of 16"),
    "a block far away": (put(b"##DG", 24, "<Q", 2**40), "a block lies at byte 1099511627776"),
    "a block too long": (put(b"##CN", 8, "<Q", 2**62), "declares 4611686018427387904 bytes"),
    "a block of many links": (put(b"##CN", 16, "<Q", 2**40), "the block at byte"),
    "a channel without links": (put(b"##CN", 16, "<Q", 0, 1), "has 0 links"),
    "a group followed by the header": (put(b"##DG", 24, "<Q", 64), "is of the kind b'##HD'"),
    "a group of few links": (put(b"##CG", 16, "<Q", 2), "has 2 links"),
    "not finalised": (lambda data: b"UnFinMF " + data[8:60] + b"\5" + data[61:], "was not finalised"),
    "another version": (lambda data: data.replace(b"4.10", b"5.00", 1), "found MDF of version '5.00'"),
    "no header": (lambda data: data.replace(b"##HD", b"##XX", 1), "does not begin with a header"),
    "entities": (
        lambda data: data.replace(b"<FHcomment", b"<!DOCTYPE>", 1), "declares XML entities",
    ),
}  # fmt: skip


@pytest.mark.parametrize(("change", "words"), HOSTILE.values(), ids=HOSTILE)
def test_hostile_blocks_are_refused_before_they_are_followed(made, change, words, monkeypatch):
    path = made(change=change)
    monkeypatch.setattr(sandboxed_read, "_child", None)  # no other process is asked: it would raise
    refused(path, words)


OLD = {
    "records that are not there": (put(b"CG", 22, "<I", 10**9), "declares records of 16000000000 bytes"),
    "a channel that is its own next": (
        lambda data: put(b"CN", 4, "<I", find(data, b"CN"))(data), "leads back to itself",
    ),
    "a group that is its own next": (
        lambda data: put(b"DG", 4, "<I", find(data, b"DG"))(data), "leads back to itself",
    ),
    "a block far away": (put(b"DG", 8, "<I", 10**9), "no block CG lies at byte 1000000000"),
    "channels that are not there": (put(b"CG", 18, "<H", 9), "declares 9 channels and lists 2"),
    "a channel outside of its record": (put(b"CN", 186, "<H", 256, 1), "ends at bit 320 of a record of 128"),
    "a channel far outside": (put(b"CN", 226, "<H", 256, 1), "of a record of 128"),
    "a float of three bytes": (put(b"CN", 188, "<H", 24, 1), "floating-point numbers of 24 bits"),
}  # fmt: skip


@pytest.mark.parametrize(("change", "words"), OLD.values(), ids=OLD)
def test_hostile_blocks_of_version_3_are_refused(made, change, words, monkeypatch):
    path = made(version="3.30", change=change)
    monkeypatch.setattr(sandboxed_read, "_child", None)
    refused(path, words)


def no_bits(version, number):
    """Return a change that leaves a channel of whole numbers without bits."""
    kind, bits, width, form = (b"##CN", 96, "<I", 90) if version >= "4" else (b"CN", 188, "<H", 190)
    whole = put(kind, form, "<B", 0, number)
    return lambda data: put(kind, bits, width, 0, number)(whole(data))


NO_BITS = {
    "time": (("4.10", no_bits("4.10", 0)), "their time has no bits in the records"),
    "channel": (("4.10", no_bits("4.10", 1)), "channel 'F' has no bits in the records"),
    "time of version 3": (("3.30", no_bits("3.30", 0)), "their time has no bits in the records"),
    "channel of version 3": (("3.30", no_bits("3.30", 1)), "channel 'F' has no bits in the records"),
}


@pytest.mark.parametrize(("written", "words"), NO_BITS.values(), ids=NO_BITS)
def test_what_has_no_bits_is_not_made_up(made, written, words):
    """asammdf gives a time without bits a sample in each second, and a channel zeros."""
    version, change = written
    refused(made(version=version, change=change), words)


@pytest.mark.parametrize("version", ["4.10", "3.30"])
def test_a_cut_file_is_refused(made, version):
    data = made(version=version, compression=0).read_bytes()
    path = made(version=version)
    for length in range(70, len(data) - 1, 191):
        path.write_bytes(data[:length])
        refused(path, "damaged or cut")


def test_a_packed_block_that_says_it_is_huge_is_refused(made):
    path = made(compression=1, change=put(b"##DZ", 24 + 8, "<Q", 2**40))
    refused(path, "unpacks to more than a log of its size holds")


def test_a_packed_block_of_columns_without_width_is_refused(made, monkeypatch):
    path = made(compression=2, change=put(b"##DZ", 24 + 4, "<I", 0))
    monkeypatch.setattr(sandboxed_read, "_child", None)
    refused(path, "turned by columns of no width")


def test_what_asammdf_prints_is_no_answer(made, capsys, monkeypatch):
    """It prints its lists to standard output where a channel cannot be selected: here its name is no text."""
    path = made(change=put(b"##CN", 24 + 16, "<Q", 64, 1))
    monkeypatch.setattr(mdf, "read_in_sandbox", lambda *_: None)
    refused(path, "the MDF file is damaged or cut")
    assert capsys.readouterr().out == ""


def test_more_values_than_a_log_has_are_refused(made, monkeypatch):
    monkeypatch.setattr(mdf_blocks, "CELLS", 50)
    refused(made(), "the MDF file declares 80 values, expected at most 50")


def test_without_asammdf_the_error_says_what_to_install(made, monkeypatch):
    path = made()
    monkeypatch.setitem(sys.modules, "asammdf", None)
    refused(path, r"asammdf that reads it is not installed\n.*pip install 'tethertest\[mdf\]'")


def test_records_of_two_groups_in_one_block_of_data(made):
    """Loggers that write as the samples come put the number of the group before each record."""

    def unsorted(data):
        changed = bytearray(data)
        groups, channels = [find(data, b"##DG", k) for k in (0, 1)], [find(data, b"##CG", k) for k in (0, 1)]
        records = []
        for group, listed, number in zip(groups, channels, (1, 2), strict=True):
            place = struct.unpack_from("<Q", data, group + 40)[0]
            length = struct.unpack_from("<Q", data, place + 8)[0]
            body = data[place + 24 : place + length]
            records += [bytes([number]) + body[row : row + 16] for row in range(0, len(body), 16)]
            struct.pack_into("<Q", changed, listed + 72, number)
        records.sort(key=lambda record: struct.unpack_from("<d", record, 1))
        body = b"".join(records)
        struct.pack_into("<Q", changed, groups[0] + 24, 0)
        struct.pack_into("<Q", changed, channels[0] + 24, channels[1])
        struct.pack_into("<Q", changed, groups[0] + 40, len(changed))
        changed[groups[0] + 56] = 1
        return bytes(changed) + struct.pack("<4s4xQQ", b"##DT", 24 + len(body), 0) + body

    fast, slow = [Signal(F, T, name="F", unit="N")], [Signal(SLOW + 1.0, SLOW, name="G", unit="N")]
    log = read_log(made(("fast", fast), ("slow", slow), change=unsorted))
    np.testing.assert_array_equal(log.channels[0].values, F)
    np.testing.assert_array_equal(log.channels[1].values, SLOW + 1.0)
    np.testing.assert_array_equal(log.channels[1].time, SLOW)


@pytest.mark.parametrize("time", [np.nan, np.inf, 1e300])
def test_a_time_that_is_none_is_refused(made, time):
    times = T.copy()
    times[2] = time
    refused(made(("fast", [Signal(F, times, name="F", unit="kN")])), "sample 3 of 'F' has the time")
