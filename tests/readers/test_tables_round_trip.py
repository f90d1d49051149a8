"""Tables as laboratories write them, written by hand here and read back exactly."""

from __future__ import annotations

import datetime as dt
import itertools
import random

import numpy as np
import pytest

from tethertest.readers import read_log
from tethertest.readers.inspect import described_channels
from tethertest.readers.streaming import stream_log

VALUES = [[5.125, -0.5, 1234.75, 0.0, 1e-6], [-12.5, 0.0625, 3.0, 99.999, -7.25]]
TIME = [0.0, 0.25, 0.5, 0.75, 1.0]
HEADERS = {
    "square": (["time [s]", "F_top [kN]", "ε [μm/m]"], []),
    "round": (["time (s)", "F_top (kN)", "ε (μm/m)"], []),
    "row": (["time", "F_top", "ε"], ["s", "kN", "μm/m"]),
    "bracketed row": (["time", "F_top", "ε"], ["[s]", "[kN]", "[μm/m]"]),
}
ENCODINGS = ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be", "gb18030"]
SIGNS = [("\t", "."), ("\t", ","), (";", "."), (";", ","), (",", "."), ("|", ",")]


def written(cells, separator, decimal, line_end="\n"):
    rows = [[f"{value:.6f}".replace(".", decimal) if isinstance(value, float) else value for value in row]
            for row in cells]  # fmt: skip
    return line_end.join(separator.join(row) for row in rows) + line_end


def assert_read(log, names, units):
    assert [channel.name for channel in log.channels] == names
    assert [channel.unit for channel in log.channels] == units
    for channel, values in zip(log.channels, VALUES, strict=True):
        assert channel.values.tolist() == values
        assert channel.time.tolist() == TIME


@pytest.mark.parametrize("encoding", ENCODINGS)
@pytest.mark.parametrize("header", HEADERS)
def test_numbers(write, encoding, header):
    names, units = HEADERS[header]
    for (separator, decimal), line_end in itertools.product(SIGNS, ["\n", "\r\n", "\r"]):
        rows = [names, *([units] if units else []), *zip(TIME, *VALUES, strict=True)]
        data = written(rows, separator, decimal, line_end).encode(encoding)
        log = read_log(write(data))
        assert_read(log, ["F_top", "ε"], ["kN", "μm/m"])
        assert (log.encoding, log.separator, log.decimal) == (encoding, separator, decimal)
        assert log.remarks == ()


ORDERS = {"ymd": "%Y-%m-%d", "ymd/": "%Y/%m/%d", "dmy": "%d/%m/%Y", "mdy": "%m/%d/%Y", "dmy.": "%d.%m.%Y"}
CLOCKS = {"%H:%M:%S.%f": 6, "%H:%M:%S,%f": 6, "%I:%M:%S.%f %p": 6}
FIRST = dt.datetime(2026, 9, 25, 14, 20, 0, 250_000)


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("clock", CLOCKS)
@pytest.mark.parametrize("columns", [1, 2])
@pytest.mark.parametrize("encoding", ["utf-8", "utf-16"])
def test_stamps(write, order, clock, columns, encoding):
    stamps = [FIRST + dt.timedelta(seconds=seconds) for seconds in TIME]
    between = " " if columns == 1 else ";"
    cells = [[f"{stamp:{ORDERS[order]}}{between}{stamp:{clock}}"] for stamp in stamps]
    header = ["stamp"] if columns == 1 else ["day;hour"]
    rows = [[*header, "F_top [kN]", "ε [μm/m]"]]
    rows += [[*cell, *values] for cell, values in zip(cells, zip(*VALUES, strict=True), strict=True)]
    log = read_log(write(written(rows, ";", ","), encoding=encoding))
    assert_read(log, ["F_top", "ε"], ["kN", "μm/m"])
    assert (log.start, log.date_order) == (FIRST, order[:3])


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "gb18030"])
@pytest.mark.parametrize(
    ("header", "units"),
    [
        ("时间(s),拉力(N),应变(微应变)", ["N", "微应变"]),
        ("时间（s）,拉力（千牛）,应变（με）", ["千牛", "με"]),
        ("采样时间[s],拉力[千牛],应变[微应变]", ["千牛", "微应变"]),
        ("时间,拉力,应变\n秒,千牛,微应变", ["千牛", "微应变"]),
        ("时间【秒】,拉力【牛】,应变【微应变】", ["牛", "微应变"]),
    ],
)
@pytest.mark.parametrize("separator", [",", "\t"])
def test_chinese_acquisition_systems(write, encoding, header, units, separator):
    text = header.replace(",", separator) + "\n"
    text += written(zip(TIME, *VALUES, strict=True), separator, ".")
    log = read_log(write(text, encoding=encoding, line_end="\r\n"))
    assert_read(log, ["拉力", "应变"], units)
    kinds = [(channel.kind, channel.unit) for channel in described_channels(log)[0]]
    assert kinds == [("tension", "N"), ("strain", "1")]


def test_chinese_stamps_and_numbers_of_rows(write):
    text = "序号,时间,拉力(千牛)\n1,2026年9月5日 14:20:00.5,1.5\n2,2026年9月5日 14:20:01.5,2.5\n"
    log = read_log(write(text, encoding="gb18030"))
    assert log.start == dt.datetime(2026, 9, 5, 14, 20, 0, 500000)
    assert log.channels[-1].time.tolist() == [0.0, 1.0]
    assert (log.channels[-1].unit, log.channels[-1].values.tolist()) == ("千牛", [1.5, 2.5])


def ragged(chance):
    """Return a table with what loggers do to it, and what it holds."""
    separator, decimal = chance.choice(SIGNS)
    count, width = chance.randrange(3, 12), chance.randrange(1, 5)
    words = chance.choice([["", ""], ["", "NaN"], ["--", "LOST"]])
    end = chance.choice(["", separator])
    names = [f"c{column}" for column in range(width)]
    lines = [separator.join(["time [s]", *names]) + end]
    values = []
    for row in range(count):
        numbers = [chance.choice([chance.gauss(0, 1e3), float(chance.randrange(99)), np.nan]) for _ in names]
        if row < 2:
            numbers = [chance.gauss(0, 10) for _ in names]
        cells = [chance.choice(words) if np.isnan(number) else repr(number).replace(".", decimal)
                 for number in numbers]  # fmt: skip
        quoted = [f'"{cell}"' if chance.random() < 0.1 else cell for cell in cells]
        blank = chance.choice(["", "", " "])
        time = repr(row / 8).replace(".", decimal)
        lines.append(separator.join(f"{blank}{cell}{blank}" for cell in [time, *quoted]) + end)
        lines += chance.choice([[], [], [""], ["# event"]])
        values.append(numbers)
    line_end = chance.choice(["\n", "\r\n"])
    return line_end.join(lines) + chance.choice(["", line_end, line_end * 3]), np.array(values).T


@pytest.mark.parametrize("seed", range(40))
def test_tables_of_chance(write, seed):
    chance = random.Random(seed)
    text, values = ragged(chance)
    path = write(text, compression=chance.choice(["", "gz", "zip"]))
    log = read_log(path)
    for channel, expected in zip(log.channels, values, strict=True):
        np.testing.assert_array_equal(channel.values, expected)
        np.testing.assert_array_equal(channel.time, np.arange(values.shape[1]) / 8)
    rows = chance.randrange(1, 6)
    pieces = list(stream_log(path, rows=rows))
    for place, channel in enumerate(log.channels):
        joined = np.concatenate([piece.channels[place].values for piece in pieces])
        np.testing.assert_array_equal(joined, channel.values)
