from __future__ import annotations

import datetime as dt
from pathlib import Path

import numpy as np
import pytest

from tethertest.conditioning.stamps import audited
from tethertest.conditioning.starts import start_after
from tethertest.errors import DataError
from tethertest.records.channel import Flag, RawLog
from tethertest.records.run import Log

DATE = dt.datetime(2026, 9, 5, 14, 20, tzinfo=dt.timezone(dt.timedelta(hours=8)))
ENTRY = Log("fbg.txt", "interrogator")


def log(start: dt.datetime | None = None) -> RawLog:
    return RawLog(Path("run07/fbg.txt"), "test", "0" * 64, start, (), header_line=10)


def test_clean_stamps_stay_as_they_are():
    time = 0.3 + np.arange(500) * 0.01
    stamps = audited(time, log(), "interrogator")
    np.testing.assert_array_equal(stamps.time, time)
    assert stamps.findings == ()
    assert not stamps.flags.any()


def test_time_going_backwards_names_line_and_values():
    time = np.arange(500) * 0.01
    time[107] = 0.9
    with pytest.raises(
        DataError, match=r"run07/fbg.txt:118: time goes backwards at row 108 \(0.9 s after 1.06 s"
    ):
        audited(time, log(), "interrogator")


def test_coarse_stamps_are_rebuilt_from_rows():
    true = np.arange(2000) * 0.01
    stamps = audited(np.floor(true / 0.0125) * 0.0125, log(), "interrogator")
    assert [(item.kind, item.severity) for item in stamps.findings] == [("quantised_time", "note")]
    assert np.ptp(stamps.time - true) < 1e-4
    assert np.max(np.abs(stamps.time - true)) < 0.0125


def test_jitter_is_rebuilt_on_both_sides_of_a_gap():
    random = np.random.default_rng(4)
    true = np.delete(np.arange(2000) * 0.01, slice(900, 950))
    stamps = audited(true + random.uniform(-0.001, 0.001, true.size), log(), "interrogator")
    assert [item.kind for item in stamps.findings] == ["jitter"]
    assert np.max(np.abs(stamps.time - true)) < 2e-4
    assert np.flatnonzero(stamps.flags & np.uint16(Flag.GAP)).tolist() == [900]


def test_stamp_that_stood_still_moves_and_row_written_twice_counts_once():
    time = np.arange(1000) * 0.01
    time[300] = time[299]
    time = np.insert(time, 700, time[699])
    stamps = audited(time, log(), "interrogator")
    np.testing.assert_allclose(stamps.time, np.arange(1000) * 0.01, atol=1e-12)
    assert np.flatnonzero(~stamps.rows).tolist() == [700]
    assert [item.kind for item in stamps.findings] == ["duplicate_time"]


@pytest.mark.parametrize(
    ("start", "seconds", "kinds"),
    [
        (dt.datetime(2026, 9, 5, 14, 20, 1, 500_000), 1.5, []),
        (dt.datetime(2026, 9, 5, 6, 20, 2, tzinfo=dt.UTC), 2.0, []),
        (dt.datetime(2026, 5, 9, 14, 19, 58), -2.0, ["day_month_swapped"]),
        (dt.datetime(2026, 9, 5, 6, 20, 2), 2.0, ["hours_off"]),
        (dt.datetime(2026, 5, 9, 13, 20, 2), 2.0, ["day_month_swapped", "hours_off"]),
        (None, 0.0, ["no_start"]),
    ],
)
def test_start_of_a_log(start, seconds, kinds):
    found, findings = start_after(log(start), ENTRY, DATE)
    assert found == pytest.approx(seconds)
    assert [item.kind for item in findings] == kinds


def test_zone_of_the_log_wins():
    entry = Log("fbg.txt", "interrogator", time_zone="UTC")
    assert start_after(log(dt.datetime(2026, 9, 5, 6, 20, 3)), entry, DATE)[0] == pytest.approx(3.0)


def test_half_an_hour_is_a_zone_only_where_the_laboratory_has_such_a_zone():
    half_an_hour_late = dt.datetime(2026, 9, 5, 14, 50, 2)
    with pytest.raises(DataError, match="never overlap in time"):
        start_after(log(half_an_hour_late), ENTRY, DATE)
    india = DATE.replace(tzinfo=dt.timezone(dt.timedelta(hours=5.5)))
    utc = dt.datetime(2026, 9, 5, 8, 50, 2)
    assert start_after(log(utc), ENTRY, india)[0] == pytest.approx(2.0)


def test_log_of_another_day_never_overlaps():
    with pytest.raises(DataError, match="never overlap in time"):
        start_after(log(dt.datetime(2026, 9, 17, 14, 20)), ENTRY, DATE)
