from __future__ import annotations

import datetime as dt
import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st

from tethertest.errors import FileFormatError
from tethertest.readers import read_log

FORCE = [5.125, -0.5, 1234.75, 0.0]
TIME = [0.0, 0.25, 0.5, 0.75]


def table(separator, decimal, header="time [s]{0}F_top [N]", quote="", end=""):
    rows = [header.format(separator) + end]
    for time, force in zip(TIME, FORCE, strict=True):
        cells = [f"{quote}{value:.3f}{quote}".replace(".", decimal) for value in (time, force)]
        rows.append(separator.join(cells) + end)
    return "\n".join(rows) + "\n"


def only(log):
    assert len(log.channels) == 1
    return log.channels[0]


@pytest.mark.parametrize(
    ("separator", "decimal", "quote"),
    [
        ("\t", ".", ""), ("\t", ",", ""), (";", ".", ""), (";", ",", ""), (",", ".", ""), (",", ",", '"'),
        ("|", ".", ""), ("   ", ".", ""), ("  ", ",", ""),
    ],
)  # fmt: skip
@pytest.mark.parametrize("line_end", ["\n", "\r\n"])
@pytest.mark.parametrize("compression", ["", "gz", "zip"])
def test_separators_and_decimal_signs(write, separator, decimal, quote, line_end, compression):
    header = "time_s{0}F_top" if separator.isspace() and separator != "\t" else "time [s]{0}F_top [N]"
    text = table(separator, decimal, header, quote)
    log = read_log(write(text, line_end=line_end, compression=compression))
    channel = only(log)
    assert channel.values.tolist() == FORCE
    assert channel.time.tolist() == TIME
    assert log.decimal == decimal
    assert log.separator == ("spaces" if separator.strip("\t") and separator.isspace() else separator)


@hypothesis_settings(deadline=None)
@given(st.lists(st.floats(-1e9, 1e9), min_size=2, max_size=20), st.sampled_from([".", ","]))
def test_numbers_survive_to_the_last_bit(tmp_path_factory, values, decimal):
    path = tmp_path_factory.mktemp("log") / "log.csv"
    rows = "".join(f"{k};{value!r}\n".replace(".", decimal) for k, value in enumerate([0.5, *values]))
    path.write_text("time [s];F [N]\n" + rows)
    assert only(read_log(path)).values.tolist() == [0.5, *values]


def test_the_directive_of_a_spreadsheet(write):
    log = read_log(write("sep=;\ntime [s];F [N];T [degC]\n0,5;1,5;20\n1,5;2,5;21\n"))
    assert [channel.values.tolist() for channel in log.channels] == [[1.5, 2.5], [20, 21]]
    assert (log.separator, log.header_line) == (";", 2)


def test_blanks_around_numbers(write):
    log = read_log(write("time [s], F [N] , T [degC]\n 0.0, 1.5 , 20\n 0.5 , -2.5,  \n"))
    assert [channel.name for channel in log.channels] == ["F", "T"]
    assert log.channels[0].values.tolist() == [1.5, -2.5]
    assert np.isnan(log.channels[1].values).tolist() == [False, True]


def test_a_separator_at_the_end_of_every_row(write):
    assert only(read_log(write(table(";", ",", end=";")))).values.tolist() == FORCE


def test_a_separator_at_the_end_of_the_rows_only(write):
    head, rows = table(";", ",").split("\n", 1)
    assert only(read_log(write(head + "\n" + rows.replace("\n", ";\n")))).values.tolist() == FORCE


@pytest.mark.parametrize(
    ("names", "expected"),
    [
        ("time [s],F_top [kN]", "kN"), ("time (s),F_top (kN)", "kN"), ("time,F_top\ns,kN", "kN"),
        ("time,F_top\n[s],[kN]", "kN"), ("time,F_top", ""), ("time [s],F_top [mV/V]", "mV/V"),
    ],
)  # fmt: skip
def test_units(write, names, expected):
    log = read_log(write(names + "\n0.0,1.5\n0.5,2.5\n"))
    assert (only(log).name, only(log).unit) == ("F_top", expected)
    assert only(log).values.tolist() == [1.5, 2.5]
    assert log.header_line == 1


@pytest.mark.parametrize(
    ("header", "cells", "start", "steps"),
    [
        ("time [ms],F", ("0", "500", "1500"), None, [0.0, 0.5, 1.5]),
        ("time_ms,F", ("0", "500", "1500"), None, [0.0, 0.5, 1.5]),
        ("t,F", ("-1.5", "0", "1.5"), None, [-1.5, 0.0, 1.5]),
        ("Time,F", ("1788588000.5", "1788588001", "1788588002"),
         dt.datetime(2026, 9, 5, 6, 0, 0, 500000, tzinfo=dt.UTC), [0.0, 0.5, 1.5]),
        ("Time [ms],F", ("1788588000500", "1788588001000", "1788588002000"),
         dt.datetime(2026, 9, 5, 6, 0, 0, 500000, tzinfo=dt.UTC), [0.0, 0.5, 1.5]),
        ("Time,F", ("3871432800.5", "3871432801", "3871432802"),
         dt.datetime(2026, 9, 5, 6, 0, 0, 500000, tzinfo=dt.UTC), [0.0, 0.5, 1.5]),
        ("stamp,F", ("2026-09-05T14:20:00.5", "2026-09-05T14:20:01.0", "2026-09-05T14:20:02.0"),
         dt.datetime(2026, 9, 5, 14, 20, 0, 500000), [0.0, 0.5, 1.5]),
        ("date,clock,F", ("2026-09-05,14:20:00.5", "2026-09-05,14:20:01.0", "2026-09-05,14:20:02.0"),
         dt.datetime(2026, 9, 5, 14, 20, 0, 500000), [0.0, 0.5, 1.5]),
        ("clock,F", ("14:20:00.5", "14:20:01.0", "14:20:02.0"), None, [0.0, 0.5, 1.5]),
    ],
)  # fmt: skip
def test_times(write, header, cells, start, steps):
    log = read_log(write(header + "\n" + "".join(f"{cell},{k}.5\n" for k, cell in enumerate(cells))))
    assert log.start == start
    assert only(log).time == pytest.approx(steps, abs=1e-6)
    assert only(log).values.tolist() == [0.5, 1.5, 2.5]


def test_a_swapped_iso_date_is_read_as_written(write):
    log = read_log(write("time,heave [mm]\n2026-05-09T14:20:00.00000,0.1\n2026-05-09T14:20:00.00500,0.2\n"))
    assert (log.start, log.date_order) == (dt.datetime(2026, 5, 9, 14, 20), "ymd")
    assert only(log).time.tolist() == [0.0, 0.005]


def test_a_comment_states_the_start(write):
    log = read_log(
        write("# start: 2026-09-05 14:20:00.96128\ntime [s],heave [mm]\n0.000,-0.29\n0.005,-0.28\n")
    )
    assert log.start == dt.datetime(2026, 9, 5, 14, 20, 0, 961280)
    assert only(log).time.tolist() == [0.0, 0.005]
    assert log.header_line == 2


def test_names_in_a_comment_above_aligned_columns(write):
    log = read_log(write("# time_s F_top\n0.0  1.5\n0.5 -2.5\n"))
    assert (only(log).name, log.separator, log.header_line) == ("F_top", "spaces", 1)
    assert only(log).values.tolist() == [1.5, -2.5]


def test_a_temperature_called_t_is_not_the_time(write):
    log = read_log(write("T [degC],F [N],clock [s]\n20,1,0\n21,2,0.5\n"))
    assert [channel.name for channel in log.channels] == ["T", "F"]
    assert log.channels[0].time.tolist() == [0.0, 0.5]


def test_names_in_a_comment_above_columns(write):
    log = read_log(write("# time_s,F [N]\n0.0,1.5\n0.5,2.5\n"))
    assert (only(log).name, only(log).unit, log.header_line) == ("F", "N", 1)


def test_without_a_header_the_columns_are_numbered(write):
    log = read_log(write("0.0,1.5\n0.5,2.5\n1.0,3.5\n"))
    assert (only(log).name, log.header_line) == ("column 2", None)
    assert any("no header" in remark for remark in log.remarks)


def test_duplicate_and_backward_stamps_stay(write):
    log = read_log(write("time [s],F [N]\n0.0,1\n0.5,2\n0.5,3\n0.2,4\n"))
    assert only(log).time.tolist() == [0.0, 0.5, 0.5, 0.2]


def test_blank_cells_are_holes_and_shift_nothing(write):
    log = read_log(write("time [s],F [N],T [degC]\n0.0,,20\n0.5,2,\n1.0,,\n"))
    np.testing.assert_array_equal(log.channels[0].values, [np.nan, 2, np.nan])
    np.testing.assert_array_equal(log.channels[1].values, [20, np.nan, np.nan])
    assert log.channels[0].time.tolist() == [0.0, 0.5, 1.0]


def test_words_for_missing_are_counted_in_the_remarks(write):
    log = read_log(write("time [s],F [N]\n0.0,1\n0.5,LOST\n1.0,NaN\n1.5,LOST\n2.0,inf\n"))
    np.testing.assert_array_equal(only(log).values, [1, np.nan, np.nan, np.nan, np.nan])
    assert "column 'F': 2 cells 'LOST' read as missing, first in line 3" in log.remarks
    assert "column 'F': 1 cells 'NaN' read as missing, first in line 4" in log.remarks


def test_infinite_values_are_holes_with_a_remark(write):
    log = read_log(write("time [s],F [N]\n0.0,1\n0.5,-inf\n"))
    np.testing.assert_array_equal(only(log).values, [1, np.nan])
    assert "column 'F': 1 infinite values read as missing" in log.remarks


def test_text_columns_are_named_and_left_out(write):
    log = read_log(write("time [s],phase,F [N]\n0.0,start,1\n0.5,drive,2\n1.0,drive,3\n"))
    assert only(log).values.tolist() == [1, 2, 3]
    assert "column 'phase' holds text and is not a channel" in log.remarks


def test_an_empty_channel_is_kept_as_missing(write):
    log = read_log(write("time [s],F [N],T [degC]\n0.0,1,\n0.5,2,\n"))
    assert np.isnan(log.channels[1].values).all()


def test_lines_above_the_header_and_blank_lines_keep_line_numbers(write):
    text = "Rig three\nOperator;A. Technician;;\n\ntime;F;T\ns;N;degC\n\n0,5;1,25;20\n\n1,5;2,25;21\n"
    log = read_log(write(text))
    assert [channel.unit for channel in log.channels] == ["N", "degC"]
    assert log.header_line == 4
    assert log.channels[0].time.tolist() == [0.5, 1.5]


def test_rows_can_be_skipped(write, settings):
    text = "rig,rig,rig\ntime,F_top,F_bottom\n0.0,1.0,2.0\n0.1,1.1,2.1\n"
    log = read_log(write(text), settings(skip_rows=1))
    assert [channel.name for channel in log.channels] == ["F_top", "F_bottom"]
    assert log.header_line == 2


def test_comments_between_rows_are_passed_over(write):
    log = read_log(write("time [s],F [N]\n0.0,1\n# tap\n0.5,2\n"))
    assert only(log).values.tolist() == [1, 2]


def test_settings_decide_what_is_open(write, settings):
    log = read_log(write("time;F\n1;1,234\n2;1,235\n"), settings(decimal=",", units={"F": "kN"}))
    assert only(log).values.tolist() == [1.234, 1.235]
    assert only(log).unit == "kN"
    log = read_log(
        write("time,F\n05/09/2026 14:20:00,1\n05/09/2026 14:20:01,2\n"), settings(date_order="dmy")
    )
    assert (log.start.month, log.date_order) == (9, "dmy")
    log = read_log(write("time F\n0 1\n1 2\n"), settings(separator="space", time_zone="Asia/Shanghai"))
    assert only(log).values.tolist() == [1, 2]


def test_a_decimal_comma_that_shows_far_down_decides(write):
    rows = "".join(f"{k};1,{k % 900 + 100}\n" for k in range(2000))
    log = read_log(write("time;F\n" + rows + "2000;0,5\n"))
    assert only(log).values[:2].tolist() == [1.1, 1.101]
    assert only(log).values[-1] == 0.5


def test_the_time_unit_of_the_settings(write, settings):
    log = read_log(write("time,F\n0,1\n500,2\n"), settings(units={"time": "ms"}))
    assert only(log).time.tolist() == [0.0, 0.5]


def test_columns_and_rate_of_the_settings(write, settings):
    log = read_log(write("5;1\n6;2\n4;3\n"), settings(columns=("F_top", "T [degC]"), rate=50.0))
    assert [(channel.name, channel.unit) for channel in log.channels] == [("F_top", ""), ("T [degC]", "degC")]
    assert log.channels[0].time.tolist() == [0.0, 0.02, 0.04]
    assert (log.rate, log.header_line, log.start) == (50.0, None, None)
    assert log.remarks == ("the time is counted from the rate 50 Hz that is set",)


def test_a_rate_is_taken_before_the_log_s_own_time_and_says_so(write, settings):
    log = read_log(write("time [s],F\n0,1\n7,2\n"), settings(rate=10.0))
    assert [channel.name for channel in log.channels] == ["time", "F"]
    assert log.channels[1].time.tolist() == [0.0, 0.1]
    assert "column 'time' is not used as the time" in log.remarks


@pytest.mark.parametrize(
    ("unit", "cells", "start", "steps"),
    [
        ("ms", ("0", "3", "1001"), None, [0.0, 0.003, 1.001]),
        ("us", ("0", "3", "7"), None, [0.0, 3e-6, 7e-6]),
        ("min", ("0", "0.5", "1"), None, [0.0, 30.0, 60.0]),
        ("s", ("1788588000.5", "1788588001", "1788588002"),
         dt.datetime(2026, 9, 5, 6, 0, 0, 500000, tzinfo=dt.UTC), [0.0, 0.5, 1.5]),
        ("excel", ("46270.5", "46270.75", "46271"), dt.datetime(2026, 9, 5, 12), [0.0, 21600.0, 43200.0]),
        ("datenum", ("740230.5", "740230.75", "740231"), dt.datetime(2026, 9, 5, 12),
         [0.0, 21600.0, 43200.0]),
    ],
)  # fmt: skip
def test_the_time_that_the_settings_name(write, settings, unit, cells, start, steps):
    text = "time,clock,F\n" + "".join(f"{k},{cell},{k}.5\n" for k, cell in enumerate(cells))
    log = read_log(write(text), settings(time="clock", units={"clock": unit}))
    assert [channel.name for channel in log.channels] == ["time", "F"]
    assert log.channels[1].time.tolist() == steps
    assert log.start == start


def test_stamps_that_the_settings_name(write, settings):
    text = "time [s],day,hour,F\n0,2026-09-05,14:20:00,1\n1,2026-09-05,14:20:02,2\n"
    log = read_log(write(text), settings(time="day"))
    assert log.start == dt.datetime(2026, 9, 5, 14, 20)
    assert log.channels[-1].time.tolist() == [0.0, 2.0]


@pytest.mark.parametrize(
    ("text", "keys", "match"),
    [
        ("time,F\n0,1\n1,2\n", {"time": "clock"}, 'time = "clock" is set, which the table does not have'),
        ("a,F\nx,1\ny,2\n", {"time": "a"}, "the time column 'a' holds text"),
        ("a,F\n,1\n,2\n", {"time": "a"}, "the time column 'a' holds nothing"),
        ("time,F\n0,1\n1,2\n", {"columns": ("t", "F")}, "columns, but the log names its own: 'time', 'F'"),
        ("0,1\n1,2\n", {"columns": ("t", "F", "G")}, "run.toml names 3 columns, the rows have 2"),
        ("5,1\n4,2\n", {}, "found no time column among 'column 1', 'column 2'"),
        ("F,T\n5,1\n4,2\n", {}, "found no time column among 'F', 'T'"),
        ("0,1\n1,2\n", {"columns": ("F", "G")}, "found no time column among 'F', 'G'"),
        ("clock,F\n1e9,1\n2e9,2\n", {"time": "clock", "units": {"clock": "excel"}}, "is no day of 'excel'"),
    ],
)
def test_settings_that_do_not_fit_are_refused(write, settings, text, keys, match):
    with pytest.raises(FileFormatError, match=re.escape(match)) as caught:
        read_log(write(text), settings(**keys))
    assert "run.toml" in str(caught.value) or "export" in caught.value.remedy


def test_a_log_without_time_is_told_what_to_write(write):
    with pytest.raises(FileFormatError) as caught:
        read_log(write("F,T\n5,1\n4,2.5\n"))
    assert 'set time = "T"' in caught.value.remedy  # F does not go forward
    assert 'rate = "100 Hz"' in caught.value.remedy
    assert caught.value.keys == ("time", "rate")


def test_a_calibration_is_told_from_a_log(write):
    with pytest.raises(FileFormatError, match="it is a calibration of a load cell, not a log"):
        read_log(write("measured,real\n312660.5,200.1\n330461.0,200.1\n"))


def test_microseconds_since_1970_are_exact(write):
    cells = [f"1788588000.{k * 137 % 1_000_000:06}" for k in range(0, 90_000, 601)]
    log = read_log(write("Time,F\n" + "".join(f"{cell},1\n" for cell in cells)))
    exact = [(int(cell[-6:]) - int(cells[0][-6:])) / 1e6 for cell in cells]
    assert only(log).time.tolist() == exact


def test_nanoseconds_since_1970_are_exact(write):
    log = read_log(write("Time,F\n1788588000123456789,1\n1788588000123456790,2\n1788588000123457789,3\n"))
    assert only(log).time.tolist() == [0.0, 1e-9, 1e-6]
    assert log.start == dt.datetime(2026, 9, 5, 6, 0, 0, 123457, tzinfo=dt.UTC)


def test_a_jittered_clock_with_repeats_stays_as_logged(write):
    cells = [f"1494195205.{part}" for part in ("3875", "4125001", "4125001", "4", "4250002")]
    log = read_log(write("time,raw reading\n" + "".join(f"{cell},{k}\n" for k, cell in enumerate(cells))))
    assert only(log).time.tolist() == [0.0, 0.0250001, 0.0250001, 0.0125, 0.0375002]


@pytest.mark.parametrize("word", ["NaN", "LOST", "overflow", "#N/A"])
def test_many_words_for_missing(write, word):
    rows = "".join(f"{k},{word if k % 3 else k},{word}\n" for k in range(3000))
    log = read_log(write("time [s],F,T\n" + rows))
    assert np.isnan(log.channels[0].values).tolist() == [k % 3 > 0 for k in range(3000)]
    assert log.remarks == (
        f"column 'F': 2000 cells {word!r} read as missing, first in line 3",
        f"column 'T': 3000 cells {word!r} read as missing, first in line 2",
    )


def test_a_word_that_is_none_is_found_among_many_that_are(write):
    rows = "".join(f"{k},{'NaN' if k != 1500 else 'loose'}\n" for k in range(3000))
    with pytest.raises(FileFormatError, match="found 'loose' in column 'F'") as caught:
        read_log(write("time [s],F\n" + rows))
    assert caught.value.line == 1502


def test_rows_of_separators_behind_the_data(write):
    log = read_log(write("time;F [N]\n" + "".join(f"{k};{k},5\n" for k in range(40)) + ";\n" * 3000))
    assert only(log).values.tolist() == [k + 0.5 for k in range(40)]


def test_quoted_stamps_with_blanks(write):
    log = read_log(write('time,F\n" 2026-09-05 14:20:00 ",1\n"2026-09-05 14:20:01",2\n'))
    assert only(log).time.tolist() == [0.0, 1.0]


def test_two_tables_side_by_side_are_refused(write, settings):
    path = write("t,F,t,G\n0,1,0.5,2\n1,2,1.5,3\n2,3,2.5,4\n")
    with pytest.raises(
        FileFormatError, match="'t' of the time in column 1 also stands over column 3"
    ) as caught:
        read_log(path)
    assert caught.value.line == 1
    log = read_log(path, settings(columns=("t", "F", "t_G", "G"), skip_rows=1))
    assert [channel.name for channel in log.channels] == ["F", "t_G", "G"]


@pytest.mark.parametrize("header", [",F [N]\n", ""])
def test_a_first_column_without_a_name_that_counts_rows_is_no_time(write, header):
    path = write(header + "".join(f"{row},{50.0 + row % 7}\n" for row in range(40)), "a.csv")
    with pytest.raises(FileFormatError, match="counts the rows, or whole seconds") as refused:
        read_log(path)
    assert 'rate = "100 Hz"' in refused.value.remedy


@pytest.mark.parametrize("header", ["time/ms,F [N]", "time_msec,F [N]", "time [msec],F [N]", "t/ms,F [N]"])
def test_milliseconds_however_written(write, header):
    log = read_log(write(header + "\n" + "".join(f"{10 * row},{row % 7}.5\n" for row in range(40)), "a.csv"))
    assert log.channels[0].time[-1] == pytest.approx(0.39)
