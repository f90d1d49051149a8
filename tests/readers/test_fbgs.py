from __future__ import annotations

import datetime as dt

import numpy as np
import pytest

from tethertest.errors import FileFormatError
from tethertest.readers import read_log
from tethertest.records.channel import Flag

USUAL = np.array([1520.0, 1526.0, 1533.0, 1541.0, 1516.0, 1524.0, 1530.0])
NAMES = ["A1", "A2", "A3", "A4", "B1", "B2", "B3"]  # fibre A of four gratings, fibre B of three
START = dt.datetime(2026, 9, 5, 14, 20, tzinfo=dt.timezone(dt.timedelta(hours=8)))


def strained(count=200, rate=20.0, usual=USUAL, size=0.4):
    """Return wavelengths [nm] of a fibre that swings at 0.7 Hz, each grating by its own amount."""
    time = np.arange(count) / rate
    share = 1.0 + 0.1 * np.arange(usual.size)
    return usual + size * np.sin(2 * np.pi * 0.7 * time)[:, None] * share


def export(
    values,
    rate=20.0,
    numbers=None,
    seconds=None,
    status=None,
    names=NAMES,
    decimal=".",
    split=False,
    digits=4,
):
    numbers = np.arange(1, len(values) + 1) if numbers is None else numbers
    seconds = np.floor((np.asarray(numbers) - numbers[0]) / rate + 0.13) if seconds is None else seconds
    lines = ["\t".join(["Date", "Time", "Linenumber", "Error status", *names])]
    for row, (number, second) in enumerate(zip(numbers, seconds, strict=True)):
        stamp = START + dt.timedelta(seconds=float(second))
        date, clock = (f"{stamp:%d.%m.%Y}", f"{stamp:%H:%M:%S}") if split else (stamp.isoformat(), "")
        cells = [
            "" if np.isnan(value) else f"{value:.{digits}f}".replace(".", decimal) for value in values[row]
        ]
        lines.append("\t".join([date, clock, str(number), "0;0" if status is None else status[row], *cells]))
    return "\n".join(lines) + "\n"


def table(log):
    return np.column_stack([channel.values for channel in log.channels])


def flagged(log, flag):
    empty = np.zeros(log.channels[0].values.size, np.uint16)
    columns = [empty if channel.flags is None else channel.flags for channel in log.channels]
    return (np.column_stack(columns) & np.uint16(flag)) != 0


def only(log, *words):
    found = [remark for remark in log.remarks if all(word in remark for word in words)]
    assert len(found) == 1, log.remarks
    return found[0]


@pytest.mark.parametrize("decimal", [".", ","])
@pytest.mark.parametrize("line_end", ["\n", "\r\n"])
@pytest.mark.parametrize(
    ("encoding", "compression"), [("latin-1", "gz"), ("utf-8-sig", ""), ("utf-16", "zip")]
)
@pytest.mark.parametrize("split", [False, True])
def test_round_trip(write, decimal, line_end, encoding, compression, split):
    values = strained()
    text = export(values, decimal=decimal, split=split)
    log = read_log(write(text, encoding=encoding, line_end=line_end, compression=compression))
    assert (log.format, log.decimal, log.header_line, log.rate) == ("fbgs", decimal, 1, 20.0)
    assert [channel.name for channel in log.channels] == NAMES
    np.testing.assert_allclose(table(log), values, atol=5.1e-5)
    np.testing.assert_allclose(log.channels[0].time, np.arange(200) / 20.0, rtol=0, atol=1e-12)
    assert log.start.replace(tzinfo=None) == START.replace(tzinfo=None)
    assert log.start.utcoffset() == (None if split else dt.timedelta(hours=8))
    assert all(channel.flags is None and channel.unit == "nm" for channel in log.channels)
    assert "wavelengths in nm" in only(log, "states no units")


@pytest.mark.parametrize("mutate", [
    lambda text: "\ufeff" + text,
    lambda text: text + "\n",
    lambda text: text.rstrip("\n"),
    lambda text: text.replace("\n", "\t\n"),
    lambda text: text.replace("A1\t", "A1 \t"),
])  # fmt: skip
def test_what_means_nothing_changes_nothing(write, mutate):
    text = export(strained())
    plain, other = read_log(write(text, "a.txt")), read_log(write(mutate(text), "b.txt"))
    np.testing.assert_array_equal(table(other), table(plain))
    np.testing.assert_array_equal(other.channels[0].time, plain.channels[0].time)
    assert [channel.name for channel in other.channels] == NAMES


@pytest.mark.parametrize("rate", [1.0, 10.0, 20.0, 50.0, 100.0, 250.0])
def test_a_round_rate_that_the_stamps_bear_out(write, rate):
    count = int(12 * rate)
    log = read_log(write(export(strained(count, rate), rate)))
    assert log.rate == rate
    assert log.channels[0].time[-1] == pytest.approx((count - 1) / rate, abs=1e-9)
    assert f"line number at {rate:g} Hz" in only(log, "changes of the stamp")


def test_a_rate_that_is_not_round_is_fitted_and_said(write):
    log = read_log(write(export(strained(4000), 19.93)))
    assert log.rate == pytest.approx(19.93, rel=3e-4)
    assert "at the fitted 19.9" in only(log, "changes of the stamp")


def test_stamps_that_jitter_by_a_line_do_not_move_the_rate(write):
    count = 4000
    late = np.random.default_rng(3).integers(-1, 2, count) * 0.05
    seconds = np.maximum.accumulate(np.floor(np.arange(count) / 20.0 + 0.4 + late))
    log = read_log(write(export(strained(count), seconds=seconds - seconds[0])))
    assert log.rate == 20.0


def test_missing_line_numbers_are_a_gap(write):
    numbers = np.delete(np.arange(1, 201), slice(60, 85))
    values = np.delete(strained(), slice(60, 85), axis=0)
    log = read_log(write(export(values, numbers=numbers)))
    np.testing.assert_allclose(log.channels[0].time, (numbers - 1) / 20.0, atol=1e-12)
    assert "25 line numbers are missing, at line 62" in only(log, "missing")


def test_a_pause_that_only_the_stamps_show_is_a_gap(write):
    seconds = np.floor(np.arange(400) / 20.0 + 0.13 + np.where(np.arange(400) >= 200, 7.4, 0.0))
    log = read_log(write(export(strained(400), seconds=seconds)))
    step = np.diff(log.channels[0].time)
    assert int(np.argmax(step)) == 199
    assert step[199] == pytest.approx(7.4 + 0.05, abs=0.1)
    np.testing.assert_allclose(np.delete(step, 199), 0.05, atol=1e-9)
    assert log.rate == 20.0
    assert "line 202" in only(log, "it is a gap")


@pytest.mark.parametrize(
    ("numbers", "match", "line"),
    [
        ([*range(1, 101), *range(1, 101)], "Linenumber 1 follows 100", 102),
        ([*range(1, 101), 100, *range(102, 201)], "Linenumber 100 follows 100", 102),
    ],
)
def test_line_numbers_that_do_not_increase(write, numbers, match, line):
    text = export(strained(), numbers=numbers, seconds=np.arange(200) // 20)
    with pytest.raises(FileFormatError, match=match) as caught:
        read_log(write(text))
    assert caught.value.line == line


def test_a_leap_of_the_line_numbers_that_the_stamps_deny(write):
    numbers = np.arange(1, 401) + np.where(np.arange(400) >= 200, 500, 0)
    text = export(strained(400), numbers=numbers, seconds=np.floor(np.arange(400) / 20.0 + 0.13))
    with pytest.raises(
        FileFormatError, match=r"Linenumber goes from 200 to 701 while the stamps go on by"
    ) as caught:
        read_log(write(text))
    assert caught.value.line == 202


def test_stamps_that_go_back(write):
    seconds = np.arange(200) // 20 - np.where(np.arange(200) >= 100, 3, 0)
    with pytest.raises(FileFormatError, match="the stamps go back by 2 s") as caught:
        read_log(write(export(strained(), seconds=seconds)))
    assert caught.value.line == 102


def test_too_short_to_show_a_rate(write, settings):
    path = write(export(strained(40)))
    with pytest.raises(FileFormatError, match=r"too little to show their rate\n  fix: set rate"):
        read_log(path)
    log = read_log(path, settings(rate=20.0))
    assert log.channels[0].time[-1] == pytest.approx(39 / 20.0)
    assert any("20 Hz that the run file states" in remark for remark in log.remarks)


def test_a_stated_rate_that_the_stamps_deny(write, settings):
    with pytest.raises(FileFormatError, match="the stamps stray by"):
        read_log(write(export(strained(4000))), settings(rate=25.0))


def slipped_left(values, rows, grating, end):
    """Return the rows with one grating lost and all later ones of its fibre a column to the left."""
    result = values.copy()
    for row in rows:
        result[row, grating:end] = [*values[row, grating + 1 : end], np.nan]
    return result


@pytest.mark.parametrize("grating", [0, 1, 2, 3])
@pytest.mark.parametrize("alarm", [True, False])
@pytest.mark.parametrize("gone", [np.nan, 0.0])
def test_a_lost_grating_moves_no_other(write, grating, alarm, gone):
    values = strained()
    rows = [40, 41, 42, 90, 150]
    bad = slipped_left(values, rows, grating, 4)
    bad[rows, 3] = gone
    status = ["1;0" if alarm and row in rows else "0;0" for row in range(200)]
    log = read_log(write(export(bad, status=status)))
    expected = values.copy()
    expected[rows, grating] = np.nan
    np.testing.assert_allclose(table(log), expected, atol=5.1e-5)
    lost = np.zeros(values.shape, dtype=bool)
    lost[rows, grating] = True
    np.testing.assert_array_equal(flagged(log, Flag.LOST), lost)
    slipped = np.zeros(values.shape, dtype=bool)
    for row in rows:
        slipped[row, grating + 1 : 4] = True
    np.testing.assert_array_equal(flagged(log, Flag.SLIPPED), slipped)
    if grating < 3:
        assert "A1 to A4: slipped: in 5 lines" in only(log, "slipped")
        assert "(lines 42, 43, 44, 92, ..., last 152)" in only(log, "slipped")
        np.testing.assert_allclose(
            log.channels[grating].as_written[rows], values[rows, grating + 1], atol=5.1e-5
        )


def test_a_peak_too_many_moves_the_others_right_and_is_left_out(write):
    values = strained()
    bad = values.copy()
    bad[70:75, 1:4] = values[70:75, 0:3] + [3.0, 0.0, 0.0]  # a ghost between A1 and A2; A4 falls out
    bad[70:75, 2] = values[70:75, 1]
    bad[70:75, 3] = values[70:75, 2]
    log = read_log(write(export(bad)))
    expected = values.copy()
    expected[70:75, 3] = np.nan
    np.testing.assert_allclose(table(log), expected, atol=5.1e-5)
    assert "5 peaks left out that fit no grating" in only(log, "slipped")


def test_two_lost_gratings_and_two_fibres(write):
    values = strained()
    bad = values.copy()
    bad[100, :4] = [values[100, 1], values[100, 3], np.nan, np.nan]  # A1 and A3 lost
    bad[100, 4:] = [values[100, 4], values[100, 6], np.nan]  # B2 lost
    log = read_log(write(export(bad)))
    expected = values.copy()
    expected[100, [0, 2, 5]] = np.nan
    np.testing.assert_allclose(table(log), expected, atol=5.1e-5)


def test_a_peak_between_two_gratings_is_given_to_neither(write):
    values = strained()
    bad = slipped_left(values, [100], 1, 4)
    bad[100, 1] = 0.5 * (values[100, 1] + values[100, 2])
    log = read_log(write(export(bad)))
    assert np.isnan(table(log)[100, [1, 2]]).all()
    np.testing.assert_allclose(table(log)[100, [0, 3]], values[100, [0, 3]], atol=5.1e-5)


def test_a_status_alone_condemns_nothing(write):
    values = strained()
    status = ["1;0" if 50 <= row < 60 else "0;0" for row in range(200)]
    log = read_log(write(export(values, status=status)))
    np.testing.assert_allclose(table(log), values, atol=5.1e-5)
    assert all(channel.flags is None for channel in log.channels)
    assert "10 of 200 lines have an error status, first in line 52" in only(
        log, "have an error status, first"
    )
    assert "10 more lines" in only(log, "run on smoothly")


def test_most_lines_slipped_still_find_their_gratings(write):
    values = strained()
    rows = [row for row in range(200) if row % 5]
    log = read_log(write(export(slipped_left(values, rows, 1, 4))))
    expected = values.copy()
    expected[rows, 1] = np.nan
    np.testing.assert_allclose(table(log), expected, atol=5.1e-5)


def test_a_fibre_that_is_never_whole_is_lost_and_left_as_written(write):
    values = strained()
    bad = slipped_left(values, range(200), 1, 4)
    log = read_log(write(export(bad)))
    assert np.isnan(table(log)[:, :4]).all()
    np.testing.assert_allclose(log.channels[1].as_written, values[:, 2], atol=5.1e-5)
    np.testing.assert_allclose(table(log)[:, 4:], values[:, 4:], atol=5.1e-5)
    assert "which grating is missing cannot be told" in only(log, "A1 to A4")


def strain_file(rows, alarm=True):
    """Return microstrain, and the same with a peak too many before S2 in some rows: later ones move right."""
    time = np.arange(400) / 20.0
    strain = 100.0 + 40.0 * np.sin(2 * np.pi * 0.3 * time)[:, None] * np.array([1.0, 1.1, 1.2, 1.3, 0.9, 1.0])
    bad = strain.copy()
    bad[rows, 1:4] = strain[rows, 0:3] - [1500.0, 2400.0, 3100.0]
    status = ["0;1" if alarm and row in rows else "0;0" for row in range(400)]
    return strain, export(bad, names=["S1", "S2", "S3", "S4", "T1", "T2"], status=status, digits=1)


def test_strain_of_slipped_gratings_is_lost_and_never_put_elsewhere(write):
    rows = [100, 101, 102, 200, 333]
    strain, text = strain_file(rows)
    log = read_log(write(text))
    expected = strain.copy()
    expected[rows, 1:4] = np.nan
    np.testing.assert_allclose(table(log), expected, atol=0.051)
    assert {channel.unit for channel in log.channels} == {""}
    remark = only(log, "slipped")
    assert "in 5 lines" in remark
    assert "S2 to S4" in remark
    assert "(lines 102, 103, 104, 202, ..., last 335)" in remark
    assert int(flagged(log, Flag.LOST).sum()) == 15


def test_leaps_of_strain_without_a_status_are_kept_and_said(write):
    rows = [100, 200]
    _strain, text = strain_file(rows, alarm=False)
    log = read_log(write(text))
    assert not np.isnan(table(log)).any()
    assert "2 lines without an error status leap" in only(log, "leap")


def test_a_snap_of_the_whole_fibre_is_no_slip(write):
    time = np.arange(400) / 20.0
    snap = 300.0 * np.exp(-(((time - 10.0) / 0.05) ** 2))
    strain = 100.0 + 40.0 * np.sin(2 * np.pi * 0.3 * time)[:, None] * np.ones(6) + snap[:, None]
    log = read_log(write(export(strain, names=["S1", "S2", "S3", "S4", "T1", "T2"], digits=1)))
    np.testing.assert_allclose(table(log), strain, atol=0.051)


@pytest.mark.parametrize(
    ("mutate", "match", "line"),
    [
        (lambda text: text[: text.rindex("\t")], "the last row is cut: found 10 of 11 columns", 201),
        (lambda text: text.replace("\t50\t", "\tfifty\t"), "found 'fifty' in column 'Linenumber'", 51),
        (lambda text: text.replace("\t50\t", "\t50.5\t"), "Linenumber is blank or no whole number", 51),
        (lambda text: text.replace("\t50\t", "\t\t"), "Linenumber is blank or no whole number", 51),
        (lambda text: text.replace("\t50\t0;0\t", "\t50\t0;0\t\t"), "found 12 columns, expected 11", 51),
        (lambda text: text.replace("Date\tTime\t", "x\ty\t"), "names no column of Date or Time", 1),
    ],
)
def test_refusals(write, mutate, match, line):
    with pytest.raises(FileFormatError, match=match) as caught:
        read_log(write(mutate(export(strained()))))
    assert caught.value.line == line
