from __future__ import annotations

import datetime as dt

import numpy as np
import pytest

from tethertest.errors import FileFormatError
from tethertest.readers import read_log

ENVIRONMENT = '"TOA5","rig","CR1000X","12342","CR1000X.Std.03.02","CPU:rig.CR1X","2438","Fast"'
HEADER = '"TIMESTAMP","RECORD","F_top","T_air"\n"TS","RN","N","Deg C"\n"","","Smp","Avg"\n'
ROWS = (
    '"2026-09-05 14:20:00",7,12.5,21.25\n'
    '"2026-09-05 14:20:00.05",8,"NAN",21.5\n'
    '"2026-09-05 14:20:00.1",9,-0.75,"INF"\n'
)
TEXT = f"{ENVIRONMENT}\n{HEADER}{ROWS}"


@pytest.mark.parametrize("line_end", ["\n", "\r\n"])
@pytest.mark.parametrize("encoding", ["latin-1", "utf-8-sig", "utf-16"])
@pytest.mark.parametrize("compression", ["", "gz", "zip"])
@pytest.mark.parametrize("quoted", [True, False])
def test_round_trip(write, line_end, encoding, compression, quoted):
    text = TEXT if quoted else TEXT.replace('"', "")
    log = read_log(
        write(text.replace("Deg C", "°C"), encoding=encoding, line_end=line_end, compression=compression)
    )
    assert (log.format, log.header_line, log.date_order, log.separator) == ("toa5", 2, "ymd", ",")
    assert log.start == dt.datetime(2026, 9, 5, 14, 20)
    force, air = log.channels
    assert (force.name, force.unit, air.name, air.unit) == ("F_top", "N", "T_air", "°C")
    np.testing.assert_array_equal(force.values, [12.5, np.nan, -0.75])
    np.testing.assert_array_equal(air.values, [21.25, 21.5, np.nan])
    assert force.time.tolist() == [0.0, 0.05, 0.1]
    assert "column 'F_top': 1 cells 'NAN' read as missing, first in line 6" in log.remarks
    assert "no plain samples, but processed by the logger: T_air (Avg)" in log.remarks
    assert log.remarks[0].startswith("station rig, model CR1000X, serial number 12342")


@pytest.mark.parametrize("mutate", [
    lambda text: "\ufeff" + text, lambda text: text + "\n", lambda text: text.rstrip("\n"),
    lambda text: text + "\n \n",
    lambda text: text.replace('",', '" ,'), lambda text: text.replace(",9,", ", 9 ,"),
])  # fmt: skip
def test_what_means_nothing_changes_nothing(write, mutate):
    plain, other = read_log(write(TEXT, "a.dat")), read_log(write(mutate(TEXT), "b.dat"))
    for one, two in zip(plain.channels, other.channels, strict=True):
        np.testing.assert_array_equal(two.values, one.values)
        np.testing.assert_array_equal(two.time, one.time)
        assert (two.name, two.unit) == (one.name, one.unit)


def test_stamps_that_repeat_or_go_back_are_kept_and_counted(write):
    stamps = ("00", "01", "01", "03", "02", "04")
    rows = "".join(f'"2026-09-05 14:20:{stamp}",{n},{n}.5,20\n' for n, stamp in enumerate(stamps))
    log = read_log(write(f"{ENVIRONMENT}\n{HEADER}{rows}"))
    assert log.channels[0].time.tolist() == [0.0, 1.0, 1.0, 3.0, 2.0, 4.0]
    assert log.channels[0].values.tolist() == [0.5, 1.5, 2.5, 3.5, 4.5, 5.5]
    assert "1 rows repeat the stamp before them, first in line 7; they are kept as they are" in log.remarks
    assert "1 rows go back in time, first in line 9; they are kept as they are" in log.remarks


def test_records_that_are_missing_or_start_again(write):
    numbers = (5, 6, 9, 10, 0, 1)
    rows = "".join(f'"2026-09-05 14:20:0{n}",{number},1.5,20\n' for n, number in enumerate(numbers))
    log = read_log(write(f"{ENVIRONMENT}\n{HEADER}{rows}"))
    assert "2 records are missing, first before line 7" in log.remarks
    assert "the record number does not increase 1 times, first in line 9" in log.remarks
    assert [channel.name for channel in log.channels] == ["F_top", "T_air"]


def test_a_table_that_a_spreadsheet_has_saved(write, settings):
    text = (
        "HEADER,,\nTIMESTAMP,Range1,F\nTS,RN,kN\n1:00:00,,\n"
        "1/1/2026 22:00,1,0.5\n1/1/2026 23:00,2,-999\n1/2/2026 0:00,3,0.25\n"
    )
    path = write(text)
    with pytest.raises(FileFormatError, match="can be read as day/month and as month/day") as caught:
        read_log(path)
    assert caught.value.line == 5
    log = read_log(path, settings(date_order="mdy"))
    assert log.reason == "the second row begins with 'TIMESTAMP' and the third with 'TS', as in TOA5"
    assert [channel.name for channel in log.channels] == ["Range1", "F"]
    assert [channel.unit for channel in log.channels] == [
        "",
        "kN",
    ]  # RN marks a record's number, no ronnanewton
    assert log.channels[1].time.tolist() == [0.0, 3600.0, 7200.0]
    assert any("the first cell is 'HEADER', not 'TOA5'" in remark for remark in log.remarks)


def test_further_stamps_are_no_channel(write):
    text = TEXT.replace('"T_air"', '"F_TMx"').replace('"Deg C"', '"TS"').replace('"Avg"', '"TMx"')
    for value in ("21.25", "21.5", '"INF"'):
        text = text.replace(value, '"2026-09-05 14:19:59.95"')
    log = read_log(write(text))
    assert [channel.name for channel in log.channels] == ["F_top"]
    assert "column 'F_TMx' holds stamps and is not a channel" in log.remarks


@pytest.mark.parametrize(
    ("mutate", "match", "line"),
    [
        (lambda text: text.replace(',"Deg C"', ""), "the row of units has 3 cells", 3),
        (lambda text: text.replace('"","","Smp","Avg"', '"","","Smp"'), "the row of process has 3 cells", 4),
        (lambda text: text.replace('"T_air"', '"F_top"'), "the name 'F_top' stands over columns 3 and 4", 2),
        (lambda text: text.replace('"T_air"', '""'), "column 4 has no name", 2),
        (lambda text: text.replace('"TIMESTAMP"', '"Station"'), "the first name is 'Station'", 2),
        (lambda text: "\n".join(text.split("\n")[:3]), "found 3 of 4 rows, expected a row of process", 4),
        (lambda text: text.replace(",8,", ","), "found 3 columns, expected 4", 6),
        (lambda text: text.replace(",8,", ",8,1,"), "found 5 columns, expected 4", 6),
        (lambda text: text[: text.rindex(",")], "the last row is cut: found 3 of 4 columns", 7),
        (lambda text: text.replace("12.5", "broken"), "found 'broken' in column 'F_top'", 5),
        (lambda text: text.replace("12.5", '"12,5"'), "found '12,5' in column 'F_top'", 5),
        (lambda text: text.replace('"2026-09-05 14:20:00.05"', '"NAN"'), "found 'NAN', expected "
                                                                         "a date and time", 6),
        (lambda text: text.replace(ROWS, ""), "a header but no data rows", None),
        (lambda text: text.replace(',"F_top","T_air"', "").replace(',"N","Deg C"', "")
         .replace(',"Smp","Avg"', "")
         .replace(",12.5,21.25", "").replace(',"NAN",21.5', "").replace(',-0.75,"INF"', ""),
         "stamps but no channels", 2),
    ],
)  # fmt: skip
def test_refusals(write, mutate, match, line):
    with pytest.raises(FileFormatError, match=match) as caught:
        read_log(write(mutate(TEXT)))
    if line is not None:
        assert caught.value.line == line


def test_the_settings_give_zone_and_units(write, settings):
    log = read_log(write(TEXT), settings(time_zone="+08:00", units={"F_top": "kN"}))
    assert log.channels[0].unit == "kN"
    assert log.start.utcoffset() == dt.timedelta(hours=8)


def test_the_unit_of_stamps_over_numbers(write):
    text = TEXT.replace('"TS","RN","N"', '"N","RN","TS"')
    with pytest.raises(FileFormatError, match=r"'F_top' has the unit TS, .* '12\.5'") as caught:
        read_log(write(text))
    assert caught.value.line == 5


def test_a_name_outside_its_quotes(write):
    with pytest.raises(FileFormatError, match="expected a name in quotes") as caught:
        read_log(write(TEXT.replace('"F_top"', '\t"F_top"')))
    assert caught.value.line == 2


def test_a_row_of_the_header_that_a_carriage_return_splits(write):
    with pytest.raises(FileFormatError, match="the row of environment has a stray carriage return") as caught:
        read_log(write(TEXT.replace('"TOA5","rig"', '"TOA5",\r"rig"')))
    assert caught.value.line == 1
