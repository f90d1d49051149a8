"""The keys of a log that map its columns, before the file is opened."""

import pytest

from tethertest.readers.config.mapping_checks import mapping_problems
from tethertest.records.run import Log


@pytest.mark.parametrize(
    ("keys", "place", "words"),
    [
        ({"time": "t", "rate": 100.0}, ("rate",), "beside time"),
        ({"columns": ("t", "F", "t")}, ("columns",), "found 't' 2 times"),
        ({"columns": ("t", "")}, ("columns", 1), "name of a column"),
        ({"table": " "}, ("table",), "empty name"),
        ({"time": "t", "channels": {"t": "F_top"}}, ("channels", "t"), "which is the time"),
        ({"time": "t", "units": {"t": "N"}}, ("units", "t"), "expected a unit of time"),
        ({"time": "t", "units": {"F": "datenum"}}, ("units", "F"), "not the time"),
    ],
)
def test_a_mapping_that_cannot_be_is_told(keys, place, words):
    (problem,) = mapping_problems(("log", 0), Log(file="a", clock="daq", **keys))
    assert problem.key == ("log", 0, *place)
    assert words in problem.text


def test_a_calendar_on_the_time_is_right():
    log = Log(file="a", clock="daq", time="t", units={"t": "datenum"}, columns=("t", "F"))
    assert not [*mapping_problems(("log", 0), log)]
