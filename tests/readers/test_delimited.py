from __future__ import annotations

import datetime as dt

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st

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
