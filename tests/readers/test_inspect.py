from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tethertest.jobs.inspect import described
from tethertest.readers import read_log
from tethertest.readers.inspect import described_channels
from tethertest.records.inspected import ChannelSeen
from tethertest.render.as_json import as_json

TEXT = (
    "time [s],F_top [kN],e [µm/m],T [degC],x [smoots]\n"
    "0.0,0.5,100,20,1\n0.1,1.5,-100,21,2\n0.2,,0,22,3\n0.2,2.5,50,20,4\n0.1,0.5,0,20,5\n0.2,0.5,0,20,6\n0.9,1.0,0,20,7\n"
)


def test_channels_are_described_in_si_with_what_is_wrong_with_them(write):
    path = write(TEXT)
    (force, strain, temperature, odd), remarks = described_channels(read_log(path))
    assert force == ChannelSeen(
        name="F_top",
        kind="tension",
        unit_as_written="kN",
        unit="N",
        n=7,
        rate=pytest.approx(10.0),
        duration=0.9,
        minimum=500.0,
        mean=pytest.approx(6500 / 6),
        maximum=2500.0,
        flags={"missing": 1},
    )
    assert (strain.kind, strain.minimum) == ("strain", pytest.approx(-1e-4))
    assert (temperature.kind, temperature.maximum) == ("temperature", pytest.approx(295.15))
    assert (odd.kind, odd.unit, odd.maximum) == ("other", "smoots", 7.0)
    assert any("unit 'smoots' is not known" in remark for remark in remarks)


def test_the_object_is_json_and_says_why_the_reader_was_chosen(write):
    path = write("# start: 2026-09-05T14:20:00+08:00\n" + TEXT)
    found = as_json(described(read_log(path)))
    assert found["path"] == str(path)
    assert (found["format"], found["encoding"]) == ("delimited", "utf-8")
    assert found["start"] == "2026-09-05T14:20:00+08:00"
    said = "text that no format reader claims; it begins with '# start: 2026-09-05T14:20:00+08:00'"
    assert found["reason"] == said


def test_an_empty_channel_has_no_numbers(write):
    _, channel = described_channels(read_log(write("time [s],F [N],T [degC]\n0.0,1,\n0.5,2,\n")))[0]
    assert (channel.minimum, channel.mean, channel.flags["missing"]) == (None, None, 2)


def test_rows_without_a_stamp_count_and_span_nothing(write):
    read = read_log(write("time [s],F [N]\n0.0,1\n0.1,2\n0.2,3\n0.3,4\n0.4,5\n"))
    (channel,) = read.channels
    time = channel.time.copy()
    time[[0, 2]] = np.nan
    (said,), _ = described_channels(replace(read, channels=(replace(channel, time=time),)))
    assert said.n == 5
    assert said.duration == pytest.approx(0.3)
    assert said.rate == pytest.approx(1.0 / np.median([0.2, 0.1]))


def test_a_channel_without_any_stamp_has_no_rate(write):
    read = read_log(write("time [s],F [N]\n0.0,1\n0.1,2\n0.2,3\n"))
    (channel,) = read.channels
    log = replace(read, channels=(replace(channel, time=np.full(3, np.nan)),))
    (said,), _ = described_channels(log)
    assert (said.rate, said.duration, said.maximum) == (None, 0.0, 3.0)
