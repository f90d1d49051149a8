from __future__ import annotations

import datetime as dt
from pathlib import Path

import numpy as np
import pytest

from tethertest.conditioning.timestamps.stamps import audit_stamps
from tethertest.conditioning.timestamps.starts import start_after
from tethertest.errors import DataError
from tethertest.records.channel import Flag, RawLog
from tethertest.records.run import Log

DATE = dt.datetime(2026, 9, 5, 14, 20, tzinfo=dt.timezone(dt.timedelta(hours=8)))
ENTRY = Log("fbg.txt", "interrogator")


def log(start: dt.datetime | None = None) -> RawLog:
    return RawLog(Path("run07/fbg.txt"), "test", start, (), row_lines=((0, 11),))


def test_clean_stamps_stay_as_they_are():
    time = 0.3 + np.arange(500) * 0.01
    stamps = audit_stamps(time, log(), "interrogator")
    np.testing.assert_array_equal(stamps.time, time)
    assert stamps.findings == ()
    assert not stamps.flags.any()


def test_time_going_backwards_names_line_and_values():
    time = np.arange(500) * 0.01
    time[107] = 0.9
    with pytest.raises(
        DataError, match=r"run07/fbg.txt:118: time goes backwards at row 108 \(0.9 s after 1.06 s"
    ):
        audit_stamps(time, log(), "interrogator")


def test_coarse_stamps_are_rebuilt_from_rows():
    true = np.arange(2000) * 0.01
    stamps = audit_stamps(np.floor(true / 0.0125) * 0.0125, log(), "interrogator")
    assert [(item.kind, item.severity) for item in stamps.findings] == [("quantised_time", "note")]
    assert np.ptp(stamps.time - true) < 1e-4
    assert np.max(np.abs(stamps.time - true)) < 0.0125


@pytest.mark.parametrize("rate", [34.7, 38.0, 47.3, 57.97, 61.2, 64.0, 71.0, 78.9])
@pytest.mark.parametrize("decimals", [12, 3])
def test_stamps_cut_to_nearly_a_step_are_no_gaps(rate, decimals):
    """Rows every 17.3 ms with stamps of 12.5 ms: 12.5 ms or 25 ms apart, once taken for 80 Hz with losses."""
    true = np.delete(np.arange(3000) / rate, slice(1200, 1300))
    stamps = audit_stamps(np.round(np.floor(true / 0.0125) * 0.0125, decimals), log(), "interrogator")
    assert [item.kind for item in stamps.findings] == ["quantised_time"]
    assert "cut to 12.5 ms" in stamps.findings[0].text
    off = stamps.time - true
    assert np.ptp(off) < 1.5e-3
    assert abs(np.mean(off) + 0.00625) < 2e-3
    assert np.flatnonzero(stamps.flags).tolist() == [1200]


def test_every_fifth_row_missing_looks_like_stamps_that_are_cut_and_both_are_said():
    time = np.arange(2000) * 0.0125
    stamps = audit_stamps(time[np.arange(2000) % 5 != 4], log(), "interrogator")
    assert [(item.kind, item.severity) for item in stamps.findings] == [("quantised_time", "warning")]
    assert "rows every 12.5 ms, some missing in a pattern of 4, look the same" in stamps.findings[0].text


def test_a_pattern_of_stamps_goes_on_behind_a_gap():
    """60 Hz with stamps of 10 ms: 10 ms, 20 ms and 20 ms apart, over and over."""
    true = np.delete(np.arange(3000) / 60.0, slice(1200, 1300))
    stamps = audit_stamps(np.floor(true / 0.01 + 1e-9) * 0.01, log(), "interrogator")
    assert "some missing in a pattern of 3, look the same" in stamps.findings[0].text
    stamps = audit_stamps(np.floor(true / 0.01001) * 0.01001, log(), "interrogator")
    assert "look the same" not in stamps.findings[0].text


@pytest.mark.parametrize("share", [0.02, 0.1, 0.3, 0.5])
@pytest.mark.parametrize("seed", range(20))
def test_rows_lost_by_chance_are_gaps(share, seed):
    random = np.random.default_rng([seed, round(100 * share)])
    time = np.arange(3000) * 0.0125
    kept = random.random(3000) >= share
    stamps = audit_stamps(time[kept], log(), "interrogator")
    np.testing.assert_array_equal(stamps.time, time[kept])
    if share < 0.5:  # else neighbours are no longer the usual case
        gaps = np.flatnonzero(np.diff(time[kept]) > 0.02) + 1
        assert np.flatnonzero(stamps.flags & np.uint16(Flag.GAP)).tolist() == gaps.tolist()


def test_jitter_is_rebuilt_on_both_sides_of_a_gap():
    random = np.random.default_rng(4)
    true = np.delete(np.arange(2000) * 0.01, slice(900, 950))
    stamps = audit_stamps(true + random.uniform(-0.001, 0.001, true.size), log(), "interrogator")
    assert [item.kind for item in stamps.findings] == ["jitter"]
    assert np.max(np.abs(stamps.time - true)) < 2e-4
    assert np.flatnonzero(stamps.flags & np.uint16(Flag.GAP)).tolist() == [900]


def test_stamp_that_stood_still_moves_and_row_written_twice_counts_once():
    time = np.arange(1000) * 0.01
    time[300] = time[299]
    time = np.insert(time, 700, time[699])
    stamps = audit_stamps(time, log(), "interrogator")
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
