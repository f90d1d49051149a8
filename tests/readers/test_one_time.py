"""One table, written as text, tree and sheet: the same time, or the same refusal with the same remedy."""

from __future__ import annotations

import datetime as dt
import io
import json
import re
from dataclasses import dataclass, field
from typing import Any

import h5py
import numpy as np
import openpyxl
import pytest
import scipy.io

from tethertest.errors import FileFormatError
from tethertest.readers import read_log
from tethertest.records.run import Log

COUNT = 60
K = range(COUNT)
BASE = dt.datetime(2026, 9, 5, 10)
EPOCH = 1_788_602_400  # BASE
F = [5.0 + k % 7 for k in K]
#: uneven times of a slow logger, whose whole seconds never stand twice
UNEVEN = [k * 1.3 + 0.27 * np.sin(3.1 * k) + 0.5 for k in K]


@dataclass(frozen=True)
class Table:
    """Columns by name, with units, and what reading them must give."""

    columns: dict[str, list[Any]]
    units: dict[str, str] = field(default_factory=dict)
    time: list[float] | None = None  #: None where it must be refused
    start: dt.datetime | None = None
    said: str = ""  #: in the refusal, or in a remark
    keys: dict[str, Any] = field(default_factory=dict)  #: with which the refused log is read
    then: list[float] | None = None  #: its time with them
    settings: dict[str, Any] = field(default_factory=dict)
    within: float = 1e-6  #: [s]


def stamps(form, seconds):
    return [f"{BASE + dt.timedelta(seconds=second):{form}}" for second in seconds]


def even(step, begin=0.0):
    return [begin + step * k for k in K]


TENTHS = [k / 10 for k in K]
UTC = BASE.replace(tzinfo=dt.UTC)
FULL, DAY, CLOCK = "%Y-%m-%d %H:%M:%S.%f", "%Y-%m-%d", "%H:%M:%S.%f"
TABLES = {
    "seconds": Table({"time": TENTHS, "F": F}, {"time": "s"}, TENTHS),
    "no unit": Table({"time": TENTHS, "F": F}, time=TENTHS, said="has no unit and is taken as seconds"),
    "from 3 s": Table({"t": even(0.1, 3.0), "F": F}, {"t": "s"}, even(0.1, 3.0)),
    "ms by unit": Table({"time": even(100), "F": F}, {"time": "ms"}, TENTHS),
    "ms by name": Table({"time_ms": even(100), "F": F}, time=TENTHS),
    "millis": Table({"millis": even(100), "F": F}, time=TENTHS, said="by its unit"),
    "by unit": Table({"loop": even(100), "F": F}, {"loop": "ms"}, TENTHS, said="'loop' is taken as the time"),
    "minutes": Table({"t": even(0.5), "F": F}, {"t": "min"}, even(30.0)),
    "epoch": Table({"timestamp": even(0.5, EPOCH), "F": F}, time=even(0.5), start=UTC, said="s since 1970"),
    "epoch ms": Table({"timestamp": even(500, EPOCH * 1000), "F": F}, time=even(0.5), start=UTC),
    "labview": Table({"time": even(1.0, EPOCH + 2_082_844_800), "F": F}, time=even(1.0), start=UTC,
                     said="since 1904"),
    "sec nsec": Table({"sec": [k // 10 for k in K], "nsec": [k % 10 * 10**8 for k in K], "F": F}, time=TENTHS,
                      said="'nsec' is the fraction of a second [ns]"),
    "epoch nsec": Table({"secs": [EPOCH + (k + 5) // 10 for k in K],
                         "nsecs": [(k + 5) % 10 * 10**8 for k in K], "F": F},
                        time=TENTHS, start=UTC + dt.timedelta(milliseconds=500)),
    "tv": Table({"tv_sec": [k // 10 for k in K], "tv_usec": [k % 10 * 10**5 for k in K], "F": F},
                time=TENTHS),
    "uneven nsec": Table({"time": [int(t) for t in UNEVEN], "nsecs": [round(t % 1 * 1e9) for t in UNEVEN],
                          "F": F}, time=UNEVEN, said="fraction of a second"),
    "fraction": Table({"seconds": [k // 10 for k in K], "fraction": [k % 10 / 10 for k in K], "F": F},
                      time=TENTHS, said="'fraction' is the fraction of a second [s]"),
    "no fraction": Table({"time": even(1.0), "ms": [k * 37 % 100 for k in K], "F": F},
                         said="'ms' looks like the fraction of a second", keys={"time": "time"},
                         then=even(1.0)),
    "running ms": Table({"time": [k // 10 for k in K], "ms": even(100), "F": F},
                        said="'ms' looks like the fraction of a second", keys={"rate": 10.0}, then=TENTHS),
    "dates": Table({"stamp": stamps(FULL, TENTHS), "F": F}, time=TENTHS, start=BASE),
    "date and time": Table({"Date": stamps(DAY, TENTHS), "Time": stamps(CLOCK, TENTHS), "F": F}, time=TENTHS,
                           start=BASE),
    "stamp and ms": Table({"stamp": stamps("%Y-%m-%d %H:%M:%S", [k // 10 for k in K]),
                           "ms": [k % 10 * 100 for k in K], "F": F}, time=TENTHS, start=BASE),
    "over midnight": Table({"time": stamps(CLOCK, even(3600.0)), "F": F}, time=even(3600.0),
                           said="a step back of half a day is midnight"),
    "days alone": Table({"Date": stamps(DAY, even(86400.0)), "F": F}, said="dates without a time of day",
                        keys={"rate": 10.0}, then=TENTHS),
    "day or month": Table({"stamp": stamps("%d/%m/%Y %H:%M:%S", [k - k % 1 for k in K]), "F": F},
                          said="can be read as day/month and as month/day", keys={"date_order": "dmy"},
                          then=even(1.0)),
    "two counters": Table({"time": TENTHS, "F": F, "timestamp": even(0.2), "G": F},
                          said="more than one column may be the time: 'time', 'timestamp'",
                          keys={"time": "timestamp"}, then=even(0.2)),
    "two clocks": Table({"t": TENTHS, "F": F, "t2": even(0.2), "G": F}, {"t": "s", "t2": "s"},
                        said="more than one column may be the time: 't', 't2'", keys={"time": "t"},
                        then=TENTHS),
    "two units": Table({"t1": TENTHS, "F": F, "t2": even(0.2)}, {"t1": "s", "t2": "s"},
                       said="more than one column may be the time: 't1', 't2'", keys={"time": "t1"},
                       then=TENTHS),
    "a delay": Table({"t": TENTHS, "delay": [k * 37 % 9 for k in K], "F": F},
                     {"t": "s", "delay": "ms"}, TENTHS),
    "a delay alone": Table({"delay": [k * 37 % 9 for k in K], "F": F}, {"delay": "ms"},
                           said="found no time column among 'delay', 'F'", keys={"rate": 10.0}, then=TENTHS),
    "none": Table({"F": F, "G": F}, said="found no time column among 'F', 'G'", keys={"rate": 10.0},
                  then=TENTHS),
    "counter": Table({"Sample": list(K), "F": F}, said="found no time column among 'Sample', 'F'",
                     keys={"rate": 10.0}, then=TENTHS),
    "serial days": Table({"Time": even(0.1 / 86400, 46270.5), "F": F}, said="may count days", within=2e-5,
                         keys={"units": {"Time": "excel"}}, then=TENTHS),
    "excel days": Table({"Time": even(0.1 / 86400, 46270.5), "F": F}, {"Time": "excel"}, TENTHS,
                        BASE.replace(hour=12), within=2e-5),
    "datenum": Table({"Time": even(0.1 / 86400, 740230.5), "F": F}, {"Time": "datenum"}, TENTHS,
                     BASE.replace(hour=12), within=2e-5),
    "no day": Table({"time": even(1e8, 1e8), "F": F}, settings={"units": {"time": "excel"}},
                    said="is no day of 'excel'", keys={"units": {"time": "s"}}, then=even(1e8, 1e8)),
    "other unit": Table({"time": TENTHS, "F": F}, {"time": "N"}, said="has the unit 'N'",
                        keys={"units": {"time": "s"}}, then=TENTHS),
    "set unit": Table({"time": even(100), "F": F}, time=TENTHS, settings={"units": {"time": "ms"}}),
    "set rate": Table({"time": [7.0 * k for k in K], "F": F}, time=TENTHS, settings={"rate": 10.0},
                      said="column 'time' is not used as the time"),
    "not there": Table({"time": TENTHS, "F": F}, settings={"time": "clock"},
                       said='time = "clock" is set, which the table does not have', keys={"time": "time"},
                       then=TENTHS),
    "uneven": Table({"time": UNEVEN, "F": F}, {"time": "s"}, UNEVEN),
    "a missing cell": Table({"time": [None if k == 9 else k / 10 for k in K], "F": F}, {"time": "s"},
                            said="the row has no time", keys={"rate": 10.0}, then=TENTHS),
    "a missing stamp": Table({"stamp": [*stamps(FULL, TENTHS[:9]), "", *stamps(FULL, TENTHS[10:])], "F": F},
                             said="the row has no time", keys={"rate": 10.0}, then=TENTHS),
    "going back": Table({"time": [k / 10 - 2.0 * (k > 30) for k in K], "F": F}, {"time": "s"},
                        [k / 10 - 2.0 * (k > 30) for k in K]),
    "duplicates": Table({"time": [k // 2 / 10 for k in K], "F": F}, {"time": "s"}, [k // 2 / 10 for k in K]),
}  # fmt: skip


def csv_text(table):
    names = [f"{name} [{table.units[name]}]" if name in table.units else name for name in table.columns]
    rows = zip(*table.columns.values(), strict=True)
    lines = [",".join("" if cell is None else str(cell) for cell in row) for row in rows]
    return "\n".join([",".join(names), *lines, ""]).encode()


def json_text(table):
    units = {"units": table.units} if table.units else {}
    return json.dumps({**units, **table.columns}).encode()


def as_array(cells):
    return np.array([np.nan if cell is None else cell for cell in cells])


def hdf5_bytes(table):
    buffer = io.BytesIO()
    with h5py.File(buffer, "w", track_order=True) as file:
        for name, cells in table.columns.items():
            file[name] = as_array(cells)
            if name in table.units:
                file[name].attrs["units"] = table.units[name]
    return buffer.getvalue()


def matlab_bytes(table):
    buffer = io.BytesIO()
    variables = {}
    for name, cells in table.columns.items():
        is_text = isinstance(cells[0], str)
        variables[name] = np.array(cells, dtype=object)[:, None] if is_text else as_array(cells)
    if table.units:
        variables["units"] = table.units
    scipy.io.savemat(buffer, variables)
    return buffer.getvalue()


def excel_bytes(table):
    book = openpyxl.Workbook()
    book.active.append(
        [f"{name} [{table.units[name]}]" if name in table.units else name for name in table.columns]
    )
    for row in zip(*table.columns.values(), strict=True):
        book.active.append([None if cell == "" else cell for cell in row])
    buffer = io.BytesIO()
    book.save(buffer)
    return buffer.getvalue()


WRITERS = {
    "csv": csv_text,
    "json": json_text,
    "hdf5": hdf5_bytes,
    "matlab": matlab_bytes,
    "excel": excel_bytes,
}
#: HDF5 of loggers has no stamps as text: the reader takes numbers alone
WITHOUT_TEXT = {"hdf5"}


def answer(path, keys):
    """Return all that a log says of its time, or why it is refused, without its place in the file."""
    try:
        log = read_log(path, Log(file="log", clock="daq", **keys))
    except FileFormatError as error:
        problem = re.sub(r"^(?:sheet '\w+' )?row \d+: ", "", error.problem)
        return problem, error.remedy, error.keys
    return log


@pytest.mark.parametrize("kind", WRITERS)
@pytest.mark.parametrize("name", TABLES)
def test_a_table_has_one_time_however_it_is_stored(write, name, kind):
    table = TABLES[name]
    has_text = any(isinstance(cell, str) for cells in table.columns.values() for cell in cells)
    if has_text and kind in WITHOUT_TEXT:
        pytest.skip("no text in this format")
    path = write(WRITERS[kind](table), "log.bin")
    found = answer(path, table.settings)
    if table.time is None:
        assert isinstance(found, tuple), found.remarks
        assert table.said in found[0]
        text = write(csv_text(table), "same.csv")
        assert found == answer(text, table.settings)
        expected, log = table.then, answer(path, table.keys)
        assert not isinstance(log, tuple), log
    else:
        assert not isinstance(found, tuple), found
        expected, log = table.time, found
        assert log.start == table.start
        same = answer(write(csv_text(table), "same.csv"), table.settings)
        assert log.remarks == same.remarks
        assert table.said in " | ".join(log.remarks)
        assert log.rate == same.rate
    np.testing.assert_allclose(log.channels[-1].time, expected, rtol=1e-14, atol=table.within)


@pytest.mark.parametrize("name", [name for name, table in TABLES.items() if table.time is None])
def test_a_refusal_about_a_setting_carries_its_key(write, name):
    table = TABLES[name]
    _, remedy, keys = answer(write(csv_text(table)), table.settings)
    if keys:
        assert set(table.keys) <= set(keys) or "rate" in table.keys
        assert all(key in remedy for key in keys)
        assert remedy.endswith("(in this log's entry in run.toml)")


@pytest.mark.parametrize(
    ("columns", "forms"),
    [
        ({"stamp": stamps(FULL, TENTHS), "F": F}, {"stamp": (FULL, "yyyy-mm-dd hh:mm:ss.000")}),
        (
            {"Date": stamps(DAY, TENTHS), "Time": stamps(CLOCK, TENTHS), "F": F},
            {"Date": (DAY, "yyyy-mm-dd"), "Time": (CLOCK, "hh:mm:ss.000")},
        ),
        ({"Time": stamps(CLOCK, even(3600.0)), "F": F}, {"Time": (CLOCK, "hh:mm:ss")}),
        (
            {
                "stamp": stamps("%Y-%m-%d %H:%M:%S", [k // 10 for k in K]),
                "ms": [k % 10 * 100 for k in K],
                "F": F,
            },
            {"stamp": ("%Y-%m-%d %H:%M:%S", "yyyy-mm-dd hh:mm:ss")},
        ),
    ],
    ids=["stamps", "date and time", "time of day", "stamps and ms"],
)
def test_dates_of_a_spreadsheet_are_the_stamps_that_it_shows(write, columns, forms):
    book = openpyxl.Workbook()
    book.active.append(list(columns))
    for row, cells in enumerate(zip(*columns.values(), strict=True), start=2):
        for place, (name, cell) in enumerate(zip(columns, cells, strict=True), start=1):
            value = cell
            if name in forms:
                moment = dt.datetime.strptime(cell, forms[name][0]) - dt.datetime(1899, 12, 30)
                value = moment / dt.timedelta(days=1)
                value = value % 1.0 if forms[name][0] == CLOCK else value
            book.active.cell(row, place, value).number_format = forms.get(name, ("", "General"))[1]
    buffer = io.BytesIO()
    book.save(buffer)
    sheet = read_log(write(buffer.getvalue(), "log.xlsx"))
    text = read_log(write(csv_text(Table(columns)), "log.csv"))
    np.testing.assert_allclose(sheet.channels[-1].time, text.channels[-1].time, atol=2e-6)
    assert [channel.name for channel in sheet.channels] == [channel.name for channel in text.channels]
    if text.start is not None:
        assert abs(sheet.start - text.start) < dt.timedelta(microseconds=2)
    else:
        assert sheet.start is None
