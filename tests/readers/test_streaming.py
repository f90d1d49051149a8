"""A log in pieces is the log, wherever the pieces and the blocks behind them are cut."""

from __future__ import annotations

import datetime as dt
import gzip
import io
import subprocess
import sys
import threading
import zipfile
from dataclasses import fields

import numpy as np
import pytest
from nptdms import ChannelObject, RootObject, TdmsWriter

from tethertest.errors import FileFormatError
from tethertest.readers import read_log
from tethertest.readers.streaming import stream_log
from tethertest.readers.tables.text import textlog

START = np.datetime64("2026-09-05T06:20:00.250000")
STAMPS = "".join(f"{day:02}/05/2026 23:59:5{day - 8}.5;{day},5\n" for day in range(9, 15))
#: text, how it is written, settings
LOGS = {
    "plain": ("time [s],F [N]\n" + "".join(f"{k / 8},{k}.5\n" for k in range(12)), {}, {}),
    "units row, comma, dos": (
        "time;F;T\ns;N;degC\n0,0;1,5;20\n\n0,5;;21\n1,0;3,5;22\n;;\n;;\n", {"line_end": "\r\n"}, {},
    ),
    "words": ("time [s],F [N],T [degC]\n0,1,20\n1,LOST,21\n2,3,NaN\n3,LOST,-inf\n4,inf,LOST\n", {}, {}),
    "comments, blanks and quotes": (
        '# start: 2026-09-05 14:20:00.5\ntime_s,"F [N]"\n0,"1.5"\n# tap\n  \n1," 2.5"\n#\n2,-3e-2\n', {}, {},
    ),
    "separator at the end": ("time [s];F [N];\n0;1,5;\n1;2,5;\n2;3,5;\n", {}, {}),
    "aligned": ("# t  F_top\n0.0   1.5\n 0.5  -2.5\n1.0\t3.5\n", {}, {}),
    "epoch": ("Time,F\n1788588000.123456,1\n1788588000.123457,2\n1788588001,3\n1788588000.9,4\n", {}, {}),
    "late date": ("time;F [N]\n" + STAMPS, {}, {}),
    "date and clock": ("date,clock,F\n2026-09-05,1:59:59.5,1\n2026-09-06,12:00:00 AM,2\n", {}, {}),
    "zones": ("stamp,F\n2026-09-05T14:20:00+08:00,1\n2026-09-05T06:20:01Z,2\n", {}, {}),
    "chinese": ("时间,拉力(千牛),备注\n2026年9月5日 14:20:00,1.5,起\n2026年9月5日 14:20:01,2.5,止\n",
                {"encoding": "gb18030"}, {}),
    "utf-16": ("时间(s)\t拉力(N)\n0\t1.5\n1\t2.5\n2\t3.5\n", {"encoding": "utf-16"}, {}),
    "bare returns": ("time [s],F [N]\n0,1\n1,2\n2,3\n", {"line_end": "\r"}, {}),
    "late western byte": ("time [s]\tF\n0\t1\n1\t2\n# 20 °C\n2\t3\n", {"encoding": "cp1252"}, {}),
    "byte-order mark": ("time [s],F [µm]\n0,1\n1,2\n", {"encoding": "utf-8-sig"}, {}),
    "no line end": ("time [s],F\n" + "".join(f"{k},{k}.25\n" for k in range(8)) + "8,8.25", {}, {}),
    "rate": ("5,1\n4,2\n6,3\n", {}, {"rate": 50.0, "columns": ("F_top", "T [degC]")}),
    "gzip": ("time [s],F\n0,1\n1,2\n2,3\n", {"compression": "gz"}, {}),
    "zip": ("time [s],F\n0,1\n1,2\n2,3\n", {"compression": "zip"}, {}),
}  # fmt: skip
BAD = {
    "short row": "time [s],F\n0,1\n1\n2,3\n",
    "long row": "time [s],F\n0,1\n1,2,3\n2,3\n",
    "cut row": "time [s],F\n0,1\n1,2\n2",
    "cut number": "time [s],F\n" + "".join(f"{k},{k}.25\n" for k in range(8)) + "8,8.",
    "text": "time [s],F\n0,1\n1,2\n2,loose\n3,4\n",
    "no time": "time [s],F\n0,1\n1,2\n,3\n3,4\n",
    "no stamp": "time,F\n2026-09-05 14:20:00,1\n2026-09-05 14:20:01,1\n14:20,2\n",
    "stamp without date": "time,F\n2026-09-05 14:20:00,1\n2026-09-05 14:20:01,1\n14:20:02,2\n",
    "year behind": "time,F\n2026-09-05 14:20:00,1\n2026-09-05 14:20:01,1\n05/09/26 14:20:02,2\n",
    "open date": "time,F\n05/09/2026 14:20:00,1\n05/09/2026 14:20:01,2\n06/09/2026 14:20:01,2\n",
    "open quote": 'time [s],F\n0,1\n1,"2\n2,3\n',
    "behind the last name": "time [s];F;\n0;1;\n1;2;7\n2;3;\n",
    "nul": "time [s],F\n0,1\n1,2\n\0\0\0\0\n",
}


def facts(log):
    """Everything but the arrays."""
    names = {field.name for field in fields(log)} - {"channels"}
    channels = [(channel.name, channel.unit) for channel in log.channels]
    return {name: getattr(log, name) for name in names} | {"channels": channels}


def assert_same(log, other):
    assert facts(log) == facts(other)
    for channel, twin in zip(log.channels, other.channels, strict=True):
        np.testing.assert_array_equal(channel.time, twin.time)
        np.testing.assert_array_equal(channel.values, twin.values)


def assert_joined(pieces, log):
    """The pieces are the log, but for the remarks."""
    for piece in pieces:
        for key in ("path", "format", "sha256", "start", "rate", "decimal", "separator", "date_order",
                    "header_line", "reason"):  # fmt: skip
            assert getattr(piece, key) == getattr(log, key)
        assert [(c.name, c.unit) for c in piece.channels] == [(c.name, c.unit) for c in log.channels]
    assert pieces[-1].encoding == log.encoding
    for place, channel in enumerate(log.channels):
        for what in ("time", "values"):
            joined = np.concatenate([getattr(piece.channels[place], what) for piece in pieces])
            np.testing.assert_array_equal(joined, getattr(channel, what))


@pytest.fixture(params=LOGS)
def case(request, write, settings):
    text, how, keys = LOGS[request.param]
    return write(text, **how), settings(**keys)


@pytest.mark.parametrize("size", [4, 7, 20, 55])
def test_blocks_may_end_anywhere(case, monkeypatch, size):
    whole = read_log(*case)
    monkeypatch.setattr(textlog, "BLOCK_BYTES", size)
    assert_same(read_log(*case), whole)


def test_pieces_may_end_at_any_row(case):
    log = read_log(*case)
    for rows in range(1, log.channels[0].values.size + 2):
        pieces = list(stream_log(*case, rows=rows))
        assert_joined(pieces, log)
        assert all(piece.channels[0].values.size == rows for piece in pieces[:-1])


@pytest.mark.parametrize("size", [4, 30])
@pytest.mark.parametrize("rows", [1, 3])
def test_pieces_and_blocks_may_end_apart(case, monkeypatch, size, rows):
    log = read_log(*case)
    monkeypatch.setattr(textlog, "BLOCK_BYTES", size)
    assert_joined(list(stream_log(*case, rows=rows)), log)


@pytest.mark.parametrize("name", BAD)
def test_a_mistake_is_the_same_wherever_blocks_end(write, monkeypatch, name):
    path = write(BAD[name])
    with pytest.raises(FileFormatError) as whole:
        read_log(path)
    for size in (4, 9, 26):
        monkeypatch.setattr(textlog, "BLOCK_BYTES", size)
        with pytest.raises(FileFormatError) as caught:
            list(stream_log(path, rows=1))
        assert str(caught.value) == str(whole.value)


def test_what_was_read_before_a_mistake_is_right(write):
    seen = []
    with pytest.raises(FileFormatError, match="found 'loose'"):
        seen.extend(piece.channels[0].values.item() for piece in stream_log(write(BAD["text"]), rows=1))
    assert seen == [1.0, 2.0]


def test_a_remark_stands_in_its_own_piece(write):
    text = LOGS["words"][0]
    first, second, third = stream_log(write(text), rows=2)
    assert first.remarks == ("column 'F': 1 cells 'LOST' read as missing, first in line 3",)
    assert second.remarks == (
        "column 'F': 1 cells 'LOST' read as missing, first in line 5",
        "column 'T': 1 cells 'NaN' read as missing, first in line 4",
        "column 'T': 1 infinite values read as missing",
    )
    assert [remark[:20] for remark in third.remarks] == ["column 'F': 1 infini", "column 'T': 1 cells "]


def test_a_remark_on_the_log_stands_in_the_first_piece(write):
    text = "time,F,phase\n0,1,start\n1,2,stop\n"
    first, second = stream_log(write(text), rows=1)
    assert first.remarks == (
        "the time 'time' has no unit and is taken as seconds",
        "column 'phase' holds text and is not a channel",
    )
    assert second.remarks == ()


def test_an_open_date_is_refused_before_the_first_piece(write):
    with pytest.raises(FileFormatError, match="day/month and as month/day"):
        next(stream_log(write(BAD["open date"]), rows=1))


def test_a_date_that_only_the_last_row_settles(write):
    first = next(stream_log(write(LOGS["late date"][0]), rows=1))
    assert (first.start, first.date_order) == (dt.datetime(2026, 5, 9, 23, 59, 51, 500000), "dmy")


@pytest.mark.parametrize("compression", ["", "gz", "zip"])
def test_progress_counts_the_bytes_of_the_file(write, monkeypatch, compression):
    monkeypatch.setattr(textlog, "BLOCK_BYTES", 50)
    path = write(LOGS["plain"][0] * 1, compression=compression)
    seen = []
    list(stream_log(path, progress=lambda done, total: seen.append((done, total))))
    assert len(seen) > 2
    assert seen == sorted(seen)
    assert seen[-1] == (path.stat().st_size, path.stat().st_size)


def test_a_log_dropped_half_read_waits_for_no_thread(write, monkeypatch):
    """The garbage collector may drop it while another thread starts, and to join one there never ends."""
    monkeypatch.setattr(textlog, "BLOCK_BYTES", 16)
    pieces = stream_log(write("time [s],F\n" + "".join(f"{k},{k}.25\n" for k in range(80))), rows=1)
    next(pieces)
    joined = []
    monkeypatch.setattr(threading.Thread, "join", lambda thread, timeout=None: joined.append(thread))
    pieces.close()
    assert joined == []


def test_pieces_of_no_rows_make_no_sense(write):
    with pytest.raises(ValueError, match="rows must be at least 1"):
        stream_log(write(LOGS["plain"][0]), rows=0)


def tdms(write, segments, compression=""):
    buffer = io.BytesIO()
    with TdmsWriter(buffer) as writer:
        for channels in segments:
            writer.write_segment([RootObject(properties={"name": "rig"}), *channels])
    return write(buffer.getvalue(), "t.tdms", compression=compression)


def waveform(name, values, increment):
    properties = {"wf_start_time": START, "wf_increment": increment, "unit_string": "N"}
    return ChannelObject("G", name, values, properties=properties)


@pytest.mark.parametrize("compression", ["", "gz", "zip"])
def test_tdms_of_two_rates(write, compression):
    segments = [
        [waveform("fast", np.arange(8.0) + 8 * k, 0.001), waveform("slow", np.arange(2) + 2 * k, 0.004)]
        for k in range(3)
    ]
    path = tdms(write, segments, compression)
    log = read_log(path)
    for rows in range(1, 26):
        pieces = list(stream_log(path, rows=rows))
        assert_joined(pieces, log)
        assert max(piece.channels[0].values.size for piece in pieces) <= rows
        assert any("2 rates" in remark for remark in pieces[0].remarks)
        assert not any(piece.remarks for piece in pieces[1:])


def test_tdms_whose_channels_follow_one_another(write):
    first = [ChannelObject("G", "Time", START + np.arange(6) * np.timedelta64(10, "ms"))]
    later = [[ChannelObject("G", name, np.arange(6.0))] for name in ("F", "e")]
    path = tdms(write, [first, *later])
    log = read_log(path)
    assert log.channels[0].time.tolist() == [0.0, 0.01, 0.02, 0.03, 0.04, 0.05]
    for rows in range(1, 8):
        pieces = list(stream_log(path, rows=rows))
        assert_joined(pieces, log)
        assert all(piece.channels[0].time.size == piece.channels[0].values.size for piece in pieces)


def test_progress_through_tdms(write):
    path = tdms(write, [[waveform("F", np.arange(4.0), 0.1)]] * 5)
    seen = []
    list(stream_log(path, progress=lambda done, total: seen.append((done, total))))
    size = path.stat().st_size
    assert [done for done, _ in seen] == [size * k // 5 for k in range(1, 6)] + [size]


def test_any_other_format_comes_in_one_piece(write):
    text = (
        "LabVIEW Measurement\nWriter_Version\t2\nSeparator\tTab\nX_Columns\tOne\n***End_of_Header***\n\n"
        "Channels\t1\nSamples\t2\nY_Unit_Label\tN\nDelta_X\t0.5\n***End_of_Header***\n"
        "X_Value\tF\tComment\n0.0\t1.5\n0.5\t2.5\n"
    )
    path = write(text, "log.lvm")
    seen = []
    (piece,) = stream_log(path, rows=1, progress=lambda *state: seen.append(state))
    assert_same(piece, read_log(path))
    assert seen == [(path.stat().st_size, path.stat().st_size)]


def test_keys_that_a_reader_does_not_use_are_refused(write, settings):
    path = write(LOGS["plain"][0])
    with pytest.raises(FileFormatError, match="table is set, which the reader of delimited"):
        list(stream_log(path, settings(table="sheet")))


MEASURE = """
import resource, sys
from tethertest.readers import read_log
from tethertest.readers.streaming import stream_log
read_log(sys.argv[1])
def peak():
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
before, rows = peak(), 0
for piece in stream_log(sys.argv[2], rows=20_000):
    rows += piece.channels[0].values.size
print(rows, peak() - before)
"""


@pytest.mark.verify
@pytest.mark.parametrize("compression", ["", "gz", "zip"])
def test_memory_does_not_grow_with_the_log(tmp_path, compression):
    small, large = tmp_path / "small.csv", tmp_path / "large.csv"
    small.write_text("time [s],F\n" + "".join(f"{k},{k}.5\n" for k in range(100)))
    rows = "".join(f"{k / 1000:.3f}," + ",".join(["-123.4567"] * 8) + "\n" for k in range(10_000))
    with (gzip.open if compression == "gz" else open)(large, "wt", encoding="ascii") as stream:
        stream.write("time [s],a,b,c,d,e,f,g,h\n")
        for _ in range(400):
            stream.write(rows)
    if compression == "zip":
        with zipfile.ZipFile(tmp_path / "large.zip", "w", zipfile.ZIP_DEFLATED) as archive:
            archive.write(large)
        large = tmp_path / "large.zip"
    command = [sys.executable, "-c", MEASURE, str(small), str(large)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    count, grown = done.stdout.split()
    assert int(count) == 4_000_000  # 350 MB of text, 290 MB of numbers
    assert float(grown) < 100.0  # MB
