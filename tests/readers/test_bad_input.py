"""One log per mistake, and the message that a technician reads."""

from __future__ import annotations

import pytest

from tethertest.errors import FileFormatError
from tethertest.readers import read_log
from tethertest.records.run import DEFAULT

GOOD = "time [s],F_top [N]\n0.000,5.10\n0.001,5.12\n0.002,5.11\n"


def refused(path, match, settings=DEFAULT):
    with pytest.raises(FileFormatError, match=match) as caught:
        read_log(path, settings)
    assert caught.value.remedy
    return caught.value


def test_missing_log(tmp_path):
    error = refused(tmp_path / "tension.lvm", "the log does not exist")
    assert error.path == str(tmp_path / "tension.lvm")


def test_folder(tmp_path):
    refused(tmp_path, "found a folder, expected a log file")


@pytest.mark.parametrize("text", ["", "\n\n  \n"])
def test_empty_log(write, text):
    refused(write(text), "the log is empty")


def test_header_without_rows(write):
    refused(write("time [s],F_top [N]\n"), "found no rows of numbers, at most a header")


def test_last_row_with_fewer_columns(write):
    error = refused(write(GOOD + "0.003"), "the last row is cut: found 1 of 2 columns")
    assert error.line == 5


def test_last_row_cut_inside_its_last_number(write):
    rows = "".join(f"{k / 1000:.3f},{5 + k / 100:.2f}\n" for k in range(20))
    error = refused(
        write("time [s],F_top [N]\n" + rows + "0.020,5."), "the last row is cut: it has no line end"
    )
    assert error.line == 22


def test_last_row_without_line_end_but_whole_is_read(write):
    rows = "".join(f"{k / 1000:.3f},{5 + k / 100:.2f}\n" for k in range(20))
    log = read_log(write("time [s],F_top [N]\n" + rows + "0.020,5.20"))
    assert log.channels[0].values[-1] == 5.2


def test_row_with_too_many_columns(write):
    error = refused(write(GOOD + "0.003,5.1,7\n0.004,5.1\n"), "found 3 columns, expected 2")
    assert error.line == 5


def test_row_with_too_few_columns_in_the_middle(write):
    error = refused(write(GOOD + "0.003\n0.004,5.1\n"), "found 1 columns, expected 2")
    assert error.line == 5


def test_text_among_numbers(write):
    error = refused(
        write(GOOD + "0.003,touched\n0.004,5.1\n"), "found 'touched' in column 'F_top', expected a number"
    )
    assert error.line == 5


@pytest.mark.parametrize("word", ["True", "FALSE", "0x10", "1_0", "5.1 N"])
def test_words_that_parsers_take_for_numbers(write, word):
    error = refused(write(GOOD + f"0.003,{word}\n0.004,5.1\n"), f"found '{word}' in column 'F_top'")
    assert error.line == 5


def test_quote_that_is_not_closed(write):
    error = refused(write(GOOD + '0.003,"5.1\n0.004,5.1\n'), "a quoted cell is not closed in its row")
    assert error.line == 5


def test_time_column_of_text(write):
    refused(
        write("time,F_top [N]\nmorning,5.1\nnoon,5.2\nevening,5.3\n"), "the time column 'time' holds text"
    )


def test_blank_time(write):
    error = refused(write(GOOD + ",5.1\n0.004,5.1\n"), "the row has no time")
    assert error.line == 5


def test_unknown_unit_of_the_time(write):
    refused(write("time [fortnights],F [N]\n0,1\n1,2\n"), "the time column 'time' has the unit 'fortnights'")


def test_no_time_column(write):
    refused(
        write("measured,real\n312660.5,200.1\n330461.0,200.1\n"),
        "found no time column among 'measured', 'real'",
    )


def test_comma_that_may_be_a_thousands_separator(write):
    error = refused(
        write("time;F_top [N]\n1;1,234\n2;1,235\n3;1,236\n"),
        "found '1,234': its comma may be a decimal sign or a thousands separator",
    )
    assert 'decimal = ","' in error.remedy
    assert error.line == 2


def test_thousands_separators(write):
    refused(
        write("time;F_top [N]\n1;1.234,5\n2;1.235,5\n"),
        r"found '1.234,5': a number with thousands separators",
    )


def test_both_signs_in_one_log(write):
    refused(write("time;F_top [N]\n0.5;1,25\n1.5;1,26\n"), "found '1,25' beside numbers with a decimal point")


def test_a_comma_that_turns_up_later(write):
    rows = "".join(f"{k};5.{k}\n" for k in range(900))
    error = refused(
        write("time;F [N]\n" + rows + "900;5,1\n"), r"found '5,1' in column 'F'.*decimal sign '\.'"
    )
    assert error.line == 902
    assert 'decimal = ","' in error.remedy


def test_date_that_reads_both_ways(write):
    error = refused(
        write("time,F [N]\n05/09/2026 14:20:00,5.1\n05/09/2026 14:20:01,5.2\n"),
        "the date 5/9/... can be read as day/month and as month/day",
    )
    assert "date_order" in error.remedy


def test_date_that_cannot_be(write, settings):
    error = refused(
        write("time,F [N]\n19/05/2026 14:20:00,5.1\n19/05/2026 14:20:01,5.2\n"),
        "there is no day 5 of month 19",
        settings(date_order="mdy"),
    )
    assert error.line == 2


def test_stamp_that_a_spreadsheet_has_cut(write):
    rows = "2026-09-05 14:20:00.1,5.1\n" * 3
    error = refused(
        write("time,F [N]\n" + rows + "20:00.4,5.1\n"), "found '20:00.4', expected a date and time"
    )
    assert error.line == 5


def test_nul_bytes(write):
    rows = "".join(f"{k},5.{k}\n" for k in range(99))
    error = refused(write("time [s],F [N]\n" + rows + "\0" * 50), "found NUL bytes in a text log")
    assert error.line == 101


def test_damaged_gzip(write):
    path = write(GOOD * 50, compression="gz")
    path.write_bytes(path.read_bytes()[:-20])
    refused(path, "the compressed file is damaged or cut")


def test_archive_of_two_files(write, tmp_path):
    import zipfile

    with zipfile.ZipFile(tmp_path / "two.zip", "w") as archive:
        archive.writestr("a.csv", GOOD)
        archive.writestr("b.csv", GOOD)
    refused(tmp_path / "two.zip", "found a zip archive of 2 files")


def test_workbook(tmp_path):
    import zipfile

    with zipfile.ZipFile(tmp_path / "log.xlsx", "w") as archive:
        archive.writestr("xl/workbook.xml", "<x/>")
    refused(tmp_path / "log.xlsx", "the workbook is damaged")


def test_wrong_encoding_in_the_settings(write, settings):
    path = write("time [s],T [°C]\n0,1\n1,2\n", encoding="cp1252")
    error = refused(path, "byte 0xb0 does not belong to the encoding utf-8", settings(encoding="utf-8"))
    assert error.line == 1


def test_unknown_encoding_in_the_settings(write, settings):
    refused(write(GOOD), "encoding 'klingon' is not known", settings(encoding="klingon"))


def test_unknown_time_zone_in_the_settings(write, settings):
    refused(write(GOOD), "time_zone 'Mars/Base' is not known", settings(time_zone="Mars/Base"))


def test_unit_for_a_channel_that_is_not_there(write, settings):
    refused(write(GOOD), "run.toml gives a unit for 'F_topp'", settings(units={"F_topp": "N"}))


def test_header_with_fewer_names_than_columns(write):
    error = refused(
        write("time,force\n0,1,2,5\n1,1,2,6\n2,1,2,7\n"), "the header has 2 names, the rows have 4 columns"
    )
    assert error.line == 1


def test_three_rows_of_names(write):
    refused(
        write("rig,rig,rig\ntime,F_top,F_bottom\nfirst,second,third\n0.0,1.0,2.0\n0.1,1.1,2.1\n"),
        "found 3 rows of names above the data",
    )


def test_spectrum(write):
    text = (
        "7\nCulture: pt-PT \nWavelength Start (nm): 1460,00000\nNumber of Points: 3\n\n"
        + "1,0\t2,0\t3,0\n" * 4
    )
    refused(write(text), "found a spectrum exported from ENLIGHT")


def test_prose(write):
    refused(write("Dear colleague,\nthe log is on the other disk.\n"), "found no rows of numbers")


def test_ascii_in_the_settings_of_a_log_that_is_none(write, settings):
    text = "LabVIEW Measurement\t\nSeparator\tTab\nDescription\t°C\n***End_of_Header***\t\n"
    error = refused(
        write(text, encoding="cp1252"),
        "byte 0xb0 does not belong to the encoding ascii",
        settings(encoding="ascii"),
    )
    assert error.line == 3
