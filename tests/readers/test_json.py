from __future__ import annotations

import json

import pytest

from tethertest.errors import FileFormatError
from tethertest.readers import read_log

ROWS = [[k / 4, 5.0 + k % 3, -k] for k in range(8)]


def test_bare_rows_are_numbered_and_the_first_column_that_rises_is_the_time(write):
    log = read_log(write(json.dumps({"data": ROWS, "dt": 0.25}), "log.csv"))
    assert (log.format, [channel.name for channel in log.channels]) == ("json", ["column 2", "column 3"])
    assert log.channels[0].time.tolist() == [k / 4 for k in range(8)]
    assert log.channels[1].values.tolist() == [-k for k in range(8)]
    assert "steps as the file says (dt = 0.25)" in log.remarks[0]


def test_a_step_that_disagrees_is_no_evidence(write):
    with pytest.raises(FileFormatError, match=r"steps by 0.25, but the file says dt = 0.5"):
        read_log(write(json.dumps({"data": ROWS, "dt": 0.5})))


def test_line_numbers_are_no_time_until_the_rate_is_given(write, settings):
    path = write(json.dumps([[k, 5.0 + (k % 3)] for k in range(8)]))
    with pytest.raises(FileFormatError, match=r"counts the rows, or whole seconds.*\n.*rate = \"100 Hz\""):
        read_log(path)
    log = read_log(path, settings(columns=("number", "F"), rate=100.0, units={"F": "N"}))
    assert [(channel.name, channel.unit) for channel in log.channels] == [("number", ""), ("F", "N")]
    assert log.channels[1].time[-1] == pytest.approx(0.07)


def test_an_object_of_lists_and_a_list_of_objects_agree(write):
    lists = read_log(write(json.dumps({"time [ms]": [0, 4, 8], "F [kN]": [1.5, None, 2]}), "a.json"))
    rows = [{"time [ms]": 0, "F [kN]": 1.5}, {"time [ms]": 4, "F [kN]": None}, {"time [ms]": 8, "F [kN]": 2}]
    objects = read_log(write(json.dumps(rows), "b.json"))
    for log in (lists, objects):
        (channel,) = log.channels
        assert (channel.name, channel.unit) == ("F", "kN")
        assert channel.time.tolist() == [0.0, 0.004, 0.008]
        assert channel.values[[0, 2]].tolist() == [1.5, 2.0]
        assert channel.values[1] != channel.values[1]


def test_two_tables_are_listed_and_run_toml_names_one(write, settings):
    one = {"t": [0, 1, 2], "F": [1, 2, 3]}
    path = write(json.dumps({"daq": one, "fbg": one}))
    with pytest.raises(
        FileFormatError, match=r"2 tables that may be the log: 'daq'.*'fbg'.*\n.*table = \"daq\""
    ):
        read_log(path)
    assert read_log(path, settings(table="fbg")).channels[0].values.tolist() == [1, 2, 3]
    with pytest.raises(FileFormatError, match=r"table = \"fgb\", but the JSON log holds 'daq', 'fbg'"):
        read_log(path, settings(table="fgb"))


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        (
            {"time": "tt"},
            r"time = \"tt\" is set, which the table does not have\n.*'column 1', 'column 2', 'column 3'",
        ),
        ({"columns": ("t", "F")}, "names 2 columns, 'data' has 3"),
        ({"decimal": ","}, "decimal is set, which the reader of json logs does not use"),
    ],
)
def test_a_mapping_that_does_not_fit_lists_what_is_there(write, settings, keys, words):
    with pytest.raises(FileFormatError, match=words):
        read_log(write(json.dumps({"data": ROWS})), settings(**keys))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('{"t": [0, 1], "t": [0, 2]}', "the key 't' stands twice"),
        ('{"a": ' + "[" * 100_000, "nested too deep"),
        ("[[0, 1], [1, 2], [2]]", "row 3: found 1 values, expected 2"),
        ('{"t": [0, 1, 2], "F": [1, "x", 2]}', "row 2: found 'x' in 'F'"),
        ('{"t": [0, 1, 2], "F": [1, 2', "the JSON is damaged or cut"),
        ("[" + ",".join("[" + ",".join("1" * 30_000) + "]" for _ in range(2)) + "]", "30000 columns"),
    ],
)
def test_what_is_damaged_or_hostile_is_refused(write, text, words):
    with pytest.raises(FileFormatError, match=words):
        read_log(write(text))


def test_infinity_and_numbers_beyond_float_are_missing_and_told(write):
    log = read_log(write('{"t": [0, 1, 2, 3], "F": [1, Infinity, NaN, ' + "9" * 5000 + "]}"))
    assert "column 'F': 2 infinite values read as missing" in log.remarks


def test_the_encoding_is_told(write):
    assert read_log(write(json.dumps(ROWS), encoding="utf-16")).encoding == "utf-16"


def test_units_beside_the_data_hold_for_it(write):
    text = '{"units": {"time": "ms", "F": "kN"}, "data": {"time": [0, 10, 20, 30], "F": [1, 2, 3, 4]}}'
    log = read_log(write(text))
    assert log.channels[0].time.tolist() == [0.0, 0.01, 0.02, 0.03]
    assert log.channels[0].unit == "kN"
    assert log.remarks == ()
