from __future__ import annotations

import datetime as dt
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tethertest.errors import FileFormatError
from tethertest.readers.tables.text.stamps import parse_stamps, stamp_kind

PATH = Path("log.txt")


def parse(cells, order=None):
    return parse_stamps(cells, PATH, np.arange(2, 2 + len(cells)), order)


@given(
    st.datetimes(dt.datetime(1971, 1, 1), dt.datetime(2068, 12, 31)),
    st.sampled_from(["%Y-%m-%dT%H:%M:%S.%f", "%Y/%m/%d %H:%M:%S,%f", "%d.%m.%Y %H:%M:%S.%f"]),
)
def test_stamps_survive_writing_and_reading(moment, form):
    assert parse([moment.strftime(form)]).start() == moment


@given(st.lists(st.datetimes(dt.datetime(2020, 1, 1), dt.datetime(2030, 1, 1)), min_size=2, max_size=9))
def test_differences_are_exact_and_order_is_kept(moments):
    cells = [f"{m.year}/{m.month}/{m.day} {m.hour}:{m:%M:%S.%f}" for m in moments]
    expected = [(m - moments[0]).total_seconds() for m in moments]
    assert parse(cells).seconds().tolist() == pytest.approx(expected, rel=1e-15)


@pytest.mark.parametrize(
    ("cell", "order", "start"),
    [
        ("2026/5/19 09:38:55.04646", "ymd", dt.datetime(2026, 5, 19, 9, 38, 55, 46460)),
        ("19/05/2026 14:00:00.5", "dmy", dt.datetime(2026, 5, 19, 14, 0, 0, 500000)),
        ("05/19/2026 2:00:00 PM", "mdy", dt.datetime(2026, 5, 19, 14)),
        ("05/19/2026 12:00:00 AM", "mdy", dt.datetime(2026, 5, 19)),
        ("10.11.17 16:53:58", "dmy", dt.datetime(2017, 11, 10, 16, 53, 58)),
        ("2026年9月5日 14:20:00", "ymd", dt.datetime(2026, 9, 5, 14, 20)),
        ("4/4/2026 10:00:00", "dmy", dt.datetime(2026, 4, 4, 10)),
    ],
)
def test_date_orders(cell, order, start):
    stamps = parse([cell])
    assert (stamps.date_order, stamps.start()) == (order, start)


@pytest.mark.parametrize(
    ("cells", "ways"),
    [
        (["26-09-05 10:00:00"], ("dmy", "ymd")),
        (["26/09/27 10:00:00", "26/09/28 10:00:00"], ("dmy", "ymd")),
        (["05/06/07 10:00:00"], ("dmy", "mdy", "ymd")),
        (["05/06/2026 10:00:00"], ("dmy", "mdy")),
    ],
)
def test_years_of_two_digits_may_stand_first(cells, ways):
    with pytest.raises(FileFormatError) as refused:
        parse_stamps(cells, Path("a.csv"), range(len(cells)))
    assert all((f'"{order}"' in refused.value.remedy) == (order in ways) for order in ("dmy", "mdy", "ymd"))
    starts = {parse_stamps(cells, Path("a.csv"), range(len(cells)), order).start() for order in ways}
    assert len(starts) == len(ways)


@pytest.mark.parametrize(
    ("cells", "order"),
    [
        (["09/26/26 10:00:00"], "mdy"),  # there is no month 26
        (["26/09/26 10:00:00"], "dmy"),
        (["26-09-05 10:00:00", "99-12-31 10:00:00"], "ymd"),  # there is no day 99
        (["31/12/99 10:00:00"], "dmy"),
    ],
)
def test_dates_that_leave_one_order(cells, order):
    assert parse_stamps(cells, Path("a.csv"), range(len(cells))).date_order == order


@pytest.mark.parametrize(("order", "month"), [("dmy", 9), ("mdy", 5)])
def test_the_settings_decide_an_open_date(order, month):
    assert parse(["05/09/2026 14:00:00"], order).start().month == month


def test_one_late_day_decides_the_whole_column():
    stamps = parse(["12/05/2026 23:59:59", "13/05/2026 00:00:00"])
    assert stamps.date_order == "dmy"
    assert stamps.seconds().tolist() == [0.0, 1.0]


def test_zones_are_kept_and_subtracted():
    stamps = parse(["2026-09-05T14:20:00+08:00", "2026-09-05T06:20:01Z"])
    assert stamps.start().utcoffset() == dt.timedelta(hours=8)
    assert stamps.start().hour == 14
    assert stamps.seconds().tolist() == [0.0, 1.0]


def test_backward_and_repeated_stamps_stay():
    cells = ["2026-09-05 10:00:00.2", "2026-09-05 10:00:00.1", "2026-09-05 10:00:00.1"]
    assert parse(cells).seconds().tolist() == pytest.approx([0.0, -0.1, -0.1])


def test_a_time_of_day_has_no_start():
    stamps = parse(["14:00:00.1", "14:00:00.3"])
    assert stamps.start() is None
    assert stamps.seconds()[1] == pytest.approx(0.2)


@pytest.mark.parametrize("cell", ["25:00:00", "14:61:00", "20:00.4", "12.5", "2026-09-0514:20:00", "abc"])
def test_what_is_no_stamp_names_its_line(cell):
    with pytest.raises(FileFormatError, match="expected a date and time") as caught:
        parse(["14:00:00", cell])
    assert caught.value.line == 3


@pytest.mark.parametrize(
    ("cell", "kind"),
    [
        ("2026-09-05 14:20", "datetime"),
        ("2026-09-05", "date"),
        ("14:20:00.5", "time"),
        ("-1.5", None),
        ("", None),
    ],
)
def test_kinds(cell, kind):
    assert stamp_kind(cell) == kind
