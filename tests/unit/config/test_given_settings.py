"""Settings of a log from the command line, and what must hold within them wherever they stand."""

from __future__ import annotations

from pathlib import Path

import pytest

from tethertest.errors import RunFileError
from tethertest.readers.config.given import given_settings
from tethertest.readers.config.log_checks import setting_problems
from tethertest.readers.config.structure import structure
from tethertest.records.run import DEFAULT, Log

PATH = Path("folder/daq.csv")


def test_without_words_nothing_is_set():
    assert given_settings(PATH, ()) is DEFAULT


@pytest.mark.parametrize(
    ("words", "toml"),
    [
        (
            ["date_order=dmy", "decimal=,", "separator=;"],
            {"date_order": "dmy", "decimal": ",", "separator": ";"},
        ),
        (["rate=100 Hz", "columns=t,F top"], {"rate": "100 Hz", "columns": ["t", "F top"]}),
        (['columns=["a,b", "c"]'], {"columns": ["a,b", "c"]}),
        (["units.F=kN", "units.Load CH=3=N"], {"units": {"F": "kN", "Load CH=3": "N"}}),
        (['units."F.top"=kN'], {"units": {"F.top": "kN"}}),
        (['units={ F = "kN" }'], {"units": {"F": "kN"}}),
        (["skip_rows=3", "time_zone=+08:00"], {"skip_rows": 3, "time_zone": "+08:00"}),
        (['separator="\\t"'], {"separator": "\t"}),
        (["separator=\t"], {"separator": "\t"}),
        (["table=daq/data", "time='t'"], {"table": "daq/data", "time": "t"}),
    ],
)
def test_words_give_what_the_same_keys_give_in_run_toml(words, toml):
    expected, problems = structure(Log, {"file": "daq.csv", "clock": "none", **toml})
    assert not problems
    assert given_settings(PATH, words) == expected


@pytest.mark.parametrize(
    ("words", "problem", "remedy"),
    [
        (
            ["date_order=dym"],
            "--set date_order: found 'dym', expected one of ymd, dmy, mdy",
            "did you mean 'ymd'?",
        ),
        (["datorder=dmy"], "--set datorder: unknown key", "did you mean 'date_order'?"),
        (["dmy"], "--set: found 'dmy', expected KEY=VALUE", "such as --set date_order=dmy"),
        (["=dmy"], "--set: found '=dmy', expected KEY=VALUE", "such as"),
        (["units.F"], "--set: found 'units.F', expected units.NAME=UNIT", "--set units.F_top=kN"),
        (["units=kN"], "--set units: found 'kN', which names no column", "units.NAME=UNIT"),
        (["units.F=smoots"], "--set units.F: unit 'smoots' is not known", "use a unit such as N"),
        (
            ["rate=100"],
            "--set rate: found '100' without a unit, expected a quantity in Hz",
            'add the unit: "100 Hz"',
        ),
        (["rate=0 Hz"], "--set rate: found '0 Hz', expected more than 0 Hz", "correct"),
        (["skip_rows=two"], "--set skip_rows: found 'two', expected a whole number", "correct"),
        (["skip_rows=-1"], "--set skip_rows: found -1, expected 0 or more rows", "count the rows"),
        (["skip_rows=99999999999999999999"], "--set skip_rows: found 99999999999999999999", "count the rows"),
        (["columns=[1"], "--set columns: found '[1', which is not written as in TOML", '["t", "F_top"]'),
        (["decimal=.", "decimal=,"], "--set decimal: found ',' after '.'", "each key once"),
        (["clock=daq"], "--set clock: a log that is read by itself has none", "write clock into run.toml"),
        (["channels.F=F_top"], "--set channels: a log that is read by itself has none", "run.toml"),
        (["time=t", "rate=1 Hz"], "--set rate: found rate beside time", "remove rate"),
        (["encoding=rot13"], "--set encoding: found 'rot13', which is no known encoding", "utf-8"),
        (["separator=;;"], "--set separator: found ';;', expected the one sign", "tab"),
    ],
)
def test_a_mistake_names_the_key_what_was_found_and_what_is_allowed(words, problem, remedy):
    with pytest.raises(RunFileError) as caught:
        given_settings(PATH, words)
    assert caught.value.problem.startswith(problem)
    assert remedy in caught.value.remedy


def test_all_mistakes_are_told_at_once():
    with pytest.raises(RunFileError) as caught:
        given_settings(PATH, ["encoding=klingon", "time_zone=Mars"])
    assert caught.value.problem.startswith("2 problems")
    assert "--set encoding: found 'klingon'" in caught.value.problem
    assert "--set time_zone: found 'Mars'" in caught.value.problem


@pytest.mark.parametrize("encoding", ["utf-8", "utf-16", "utf-32", "gb18030", "cp1252", "big5"])
def test_encodings_of_loggers_are_known(encoding):
    assert not [*setting_problems((), Log("a", "daq", encoding=encoding))]


@pytest.mark.parametrize(
    "encoding", ["", "rot13", "hex", "a\0b", "undefined", "unicode_escape", "idna", "punycode"]
)
def test_what_turns_no_bytes_into_text_is_no_encoding(encoding):
    (problem,) = setting_problems(("log", 0), Log("a", "daq", encoding=encoding))
    assert problem.key == ("log", 0, "encoding")


@pytest.mark.parametrize("separator", [",", ";", "\t", "|", " ", "tab", "\\t", "comma"])
def test_one_sign_or_its_name_separates(separator):
    assert not [*setting_problems((), Log("a", "daq", separator=separator))]


@pytest.mark.parametrize("separator", ["", ";;", "5", "e", "\n", "\0", ".", '"', "-"])
def test_what_cells_hold_or_two_signs_separate_nothing(separator):
    (problem,) = setting_problems((), Log("a", "daq", separator=separator))
    assert problem.key == ("separator",)


@pytest.mark.parametrize("separator", [",", "comma"])
def test_a_decimal_comma_separates_nothing(separator):
    (problem,) = setting_problems((), Log("a", "daq", separator=separator, decimal=","))
    assert "decimal sign" in problem.text
