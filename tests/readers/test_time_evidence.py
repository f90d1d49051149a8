"""Logs whose time stands in several columns, or can be read in two ways: never one of them in silence."""

import datetime as dt
from pathlib import Path

import numpy as np
import pytest

from tethertest.errors import FileFormatError
from tethertest.readers import read_log
from tethertest.readers.tables.text import textlog
from tethertest.records.channel import RawLog

BASE = dt.datetime(2026, 9, 5, 10)


def rows(head, row, count=60):
    return head + "\n" + "".join(row(k) + "\n" for k in range(count))


def second(k):
    return BASE + dt.timedelta(seconds=k // 10)


SEVERAL = {
    "by unit": rows("t1 [s],F1 [N],t2 [s],F2 [N]", lambda k: f"{k / 100},{k % 7},{3 + k / 20},{k % 5}"),
    "by unit and name": rows(
        "Time 1 - fast [s],F1 [N],Time 2 - slow [s],F2 [N]", lambda k: f"{k / 100},{k % 7},{k / 20},{k % 5}"
    ),
    "by name": rows("Date,Time [s],F [N]", lambda k: f"{46270.4 + k / 1e7:.10f},{k / 100},{k % 7}"),
    "stamps": rows(  # one a second later
        "sent,received,F [N]", lambda k: f"{second(10 * k)},{second(10 * k + 10)},{k % 7}"
    ),
}  # fmt: skip
PARTS = {
    "milliseconds": rows(
        "No,Date&Time,ms,F [N]", lambda k: f"{k},{second(k):%Y/%m/%d %H:%M:%S},{k % 10 * 100},{k % 7}"
    ),
    "nanoseconds": rows("sec,nsec,F [N]", lambda k: f"{1789000000 + k // 10},{k % 10 * 10**8},{k % 7}"),
    "stamp": rows("time,stamp_nsecs,F [N]", lambda k: f"{1789000000 + k // 10},{k % 10 * 10**8},{k % 7}"),
}


@pytest.mark.parametrize("text", SEVERAL.values(), ids=SEVERAL)
def test_two_columns_that_may_be_the_time_are_refused(write, text):
    with pytest.raises(FileFormatError, match="more than one column may be the time"):
        read_log(write(text))


def test_the_run_file_chooses_among_them(write, settings):
    log = read_log(write(SEVERAL["by unit"]), settings(time="t2"))
    assert log.channels[0].time[0] == 3.0


def test_a_time_that_only_its_unit_shows_is_remarked(write):
    log = read_log(write(rows("loop [ms],F [N]", lambda k: f"{10 * k},{k % 7}")))
    assert log.channels[0].time[1] == 0.01
    assert "column 'loop' is taken as the time by its unit" in log.remarks


@pytest.mark.parametrize("text", PARTS.values(), ids=PARTS)
def test_fractions_of_a_second_that_the_values_bear_out_are_put_to_the_seconds(write, text):
    log = read_log(write(text))
    np.testing.assert_allclose(log.channels[-1].time, np.arange(60) / 10, atol=1e-12)
    assert any("is the fraction of a second" in remark for remark in log.remarks)


@pytest.mark.parametrize("size", [64, 1 << 20])
def test_a_fraction_of_more_than_a_second_is_refused_in_its_line(write, monkeypatch, size):
    monkeypatch.setattr(textlog, "BLOCK_BYTES", size)
    text = rows("sec,nsec,F [N]", lambda k: f"{k // 10},{k % 10 * 10**8 + (k == 250) * 10**9},{k % 7}", 300)
    with pytest.raises(FileFormatError, match="the fraction of a second is 1 s") as caught:
        read_log(write(text))
    assert caught.value.line == 252


@pytest.mark.parametrize("fraction", [lambda k: k * 37 % 1000, lambda k: 250, lambda k: 100 * k])
def test_a_column_that_does_not_complete_the_seconds_is_refused(write, fraction):
    text = rows("Time,ms,F [N]", lambda k: f"{k},{fraction(k)},{k % 7}")
    with pytest.raises(FileFormatError, match="looks like the fraction of a second") as caught:
        read_log(write(text))
    assert caught.value.keys == ("rate", "time")


@pytest.mark.parametrize(
    ("head", "row"),
    [
        ("Time [s],ms,F [N]", lambda k: f"{k / 100},{k % 9},{k % 7}"),
        ("Time,delay_ms,F [N]", lambda k: f"{k},{k % 9},{k % 7}"),
        ("Time,Pos [mm],ms2 [m/s2]", lambda k: f"{k},{k % 9},{k % 7}"),
    ],
)
def test_other_columns_are_no_fractions(write, head, row):
    log = read_log(write(rows(head, row)))
    assert len(log.channels) == 2


def test_the_run_file_says_that_a_column_is_no_fraction(write, settings):
    log = read_log(write(PARTS["milliseconds"]), settings(time="Date&Time"))
    assert [channel.name for channel in log.channels] == ["No", "ms", "F"]


@pytest.mark.parametrize("head", ["Elapsed [mm:ss]", "Time", "Zeit"])
def test_two_numbers_of_a_clock_are_refused(write, head):
    with pytest.raises(FileFormatError, match="hours and minutes, or minutes and seconds"):
        read_log(write(rows(f"{head},F [N]", lambda k: f"{k // 60:02d}:{k % 60:02d},{k % 7}")))


@pytest.mark.parametrize("form", ["%Y-%m-%d,%H:%M", "%Y-%m-%d %H:%M,1"])
def test_hours_and_minutes_of_a_date_are_read(write, form):
    head = "Date,Time,F [N]" if form[8] == "," else "Stamp,a,F [N]"
    log = read_log(write(rows(head, lambda k: f"{BASE + dt.timedelta(minutes=k):{form}},{k % 7}")))
    np.testing.assert_array_equal(np.diff(log.channels[0].time), 60.0)


@pytest.mark.parametrize("cells", [("AM", "PM"), ("a.m.", "p.m."), ("上午", "下午")])
def test_halves_of_the_day_in_a_column_of_their_own_are_refused(write, cells):
    text = rows("Date,Time,half,F [N]", lambda k: f"2026-09-05,02:00:{k % 60:02d},{cells[1]},{k % 7}")
    with pytest.raises(FileFormatError, match="holds AM and PM apart from the time"):
        read_log(write(text))


@pytest.mark.parametrize(
    ("day", "order", "start"),
    [
        ("05.09.26", None, BASE),
        ("26.09.05", "ymd", BASE),
        ("26.09.05", "dmy", BASE.replace(year=2005, day=26)),
        ("05.09.2026", None, BASE),
    ],
)
def test_dotted_dates(write, settings, day, order, start):
    text = rows("Time;F [N]", lambda k: f"{day} 10:00:{k:02d};{k % 7}")
    assert read_log(write(text), settings(date_order=order)).start == start


def test_a_dotted_date_that_may_begin_with_the_year_is_refused(write):
    with pytest.raises(FileFormatError, match="can be read as day/month and as year/month/day"):
        read_log(write(rows("Time;F [N]", lambda k: f"26.09.05 10:00:{k:02d};{k % 7}")))


@pytest.mark.parametrize("size", [64, 1 << 20])
def test_times_of_day_go_on_over_midnight(write, monkeypatch, size):
    monkeypatch.setattr(textlog, "BLOCK_BYTES", size)
    start = dt.datetime(2026, 9, 5, 23, 59, 30)
    text = rows("Time,F [N]", lambda k: f"{start + dt.timedelta(hours=k):%H:%M:%S.%f},{k % 7}")
    log = read_log(write(text))
    np.testing.assert_array_equal(log.channels[0].time, 3600.0 * np.arange(60))
    assert any("a step back of half a day is midnight" in remark for remark in log.remarks)


def test_a_small_step_back_is_no_midnight(write):
    text = rows("Time,F [N]", lambda k: f"10:00:{(k if k < 30 else k - 5):02d},{k % 7}")
    assert np.count_nonzero(np.diff(read_log(write(text)).channels[0].time) < 0) == 1


@pytest.mark.parametrize("size", [64, 1 << 20])
def test_comments_among_the_rows_are_remarked(write, monkeypatch, size):
    monkeypatch.setattr(textlog, "BLOCK_BYTES", size)
    data = [f"{k / 100},{k % 7}\n" for k in range(60)]
    data[20] += "# gain changed\n"
    data[40] += "# hit\n\n"
    data[50] += "# hit\n"
    log = read_log(write("# start: 2026-09-05 10:00:00\nTime [s],F [N]\n" + "".join(data)))
    assert log.start == BASE
    assert [remark for remark in log.remarks if "comment" in remark] == [
        "comment 'gain changed' among the rows, 1 times, first in line 24",
        "comment 'hit' among the rows, 2 times, first in line 45",
    ]


@pytest.mark.parametrize("first", ["", "# start: 2026-09-05 10:00:00\n"])
def test_a_start_among_the_rows_is_refused(write, first):
    data = "".join(f"{k / 100},{k % 7}\n" for k in range(60))
    text = f"{first}Time [s],F [N]\n{data}# start: 2026-09-05 11:00:00\n{data}"
    with pytest.raises(FileFormatError, match="among the rows begins a second recording") as caught:
        read_log(write(text))
    assert caught.value.line == 62 + bool(first)


@pytest.mark.parametrize("size", [64, 1 << 20])
def test_rows_know_their_lines(write, monkeypatch, size):
    monkeypatch.setattr(textlog, "BLOCK_BYTES", size)
    data = [f"{k / 100},{k % 7}" for k in range(60)]
    lines = ["time,F", "s,N", *data[:20], "# event", "", *data[20:40], "# event", *data[40:]]
    log = read_log(write("\n".join(lines) + "\n"))
    assert [log.line_of(row) for row in range(60)] == [lines.index(cells) + 1 for cells in data]


def test_a_row_of_an_unknown_line_has_none():
    assert RawLog(Path("log.tdms"), "tdms", None, ()).line_of(3) is None


def test_a_start_that_is_no_stamp_is_a_comment(write):
    text = rows(
        "# start: cold\nTime [s],F [N]",
        lambda k: f"{k / 100},{k % 7}" + ("\n# started: again" if k == 9 else ""),
    )
    log = read_log(write(text))
    assert log.start is None
    assert "comment 'started: again' among the rows, 1 times, first in line 13" in log.remarks
