from __future__ import annotations

import datetime as dt
import io

import numpy as np
import pytest
from nptdms import ChannelObject, RootObject, TdmsWriter

from tethertest.errors import FileFormatError
from tethertest.readers import read_log

START = np.datetime64("2026-09-05T06:20:00.250000")


def waveform(group, name, values, *, increment=0.001, start=START, unit="count"):
    properties = {
        "wf_start_time": start,
        "wf_increment": increment,
        "wf_start_offset": 0.0,
        "unit_string": unit,
    }
    return ChannelObject(group, name, values, properties=properties)


def content(*channels):
    buffer = io.BytesIO()
    with TdmsWriter(buffer) as writer:
        writer.write_segment([RootObject(properties={"name": "rig"}), *channels])
    return buffer.getvalue()


@pytest.mark.parametrize("compression", ["", "gz", "zip"])
def test_counts_stay_counts_and_the_start_is_utc(write, compression):
    counts = np.array([-5, 0, 7, 8_388_607], dtype=np.int32)
    log = read_log(write(content(waveform("Bridges", "F_top", counts)), "t.tdms", compression=compression))
    channel = log.channels[0]
    assert (channel.name, channel.unit) == ("F_top", "count")
    assert channel.values.tolist() == counts.tolist()
    assert channel.time.tolist() == [0.0, 0.001, 0.002, 0.003]
    assert log.start == dt.datetime(2026, 9, 5, 6, 20, 0, 250000, tzinfo=dt.UTC)
    assert (log.format, log.rate) == ("tdms", 1000.0)


def test_channels_of_two_rates_and_starts(write):
    fast = waveform("G", "fast", np.arange(10.0))
    slow = waveform("G", "slow", np.arange(3.0), increment=0.5, start=START + np.timedelta64(250, "ms"))
    log = read_log(write(content(fast, slow), "t.tdms"))
    assert log.channels[1].time.tolist() == [0.25, 0.75, 1.25]
    assert log.channels[0].time[-1] == pytest.approx(0.009)
    assert log.rate is None
    assert any("2 rates: 2 Hz, 1000 Hz" in remark for remark in log.remarks)


def test_a_channel_of_stamps_is_the_time(write):
    ticks = START + np.array([0, 10, 20, 15, 30]) * np.timedelta64(1, "ms")
    log = read_log(
        write(content(ChannelObject("G", "Time", ticks), ChannelObject("G", "F", np.arange(5.0))), "t.tdms")
    )
    assert [channel.name for channel in log.channels] == ["F"]
    assert log.channels[0].time.tolist() == [0.0, 0.01, 0.02, 0.015, 0.03]
    assert log.start == dt.datetime(2026, 9, 5, 6, 20, 0, 250000, tzinfo=dt.UTC)


def test_a_channel_of_seconds_is_the_time(write):
    channels = ChannelObject("G", "Time", np.array([0.5, 1.0])), ChannelObject("G", "F", np.array([1.0, 2.0]))
    log = read_log(write(content(*channels), "t.tdms"))
    assert log.channels[0].time.tolist() == [0.5, 1.0]
    assert log.start is None


def test_a_channel_without_time_is_refused(write):
    with pytest.raises(FileFormatError, match="channel 'F' has neither wf_increment nor a time channel"):
        read_log(write(content(ChannelObject("G", "F", np.arange(5.0))), "t.tdms"))


def test_one_name_in_two_groups_carries_its_group(write):
    log = read_log(
        write(content(waveform("A", "F", np.arange(3.0)), waveform("B", "F", np.arange(3.0))), "t.tdms")
    )
    assert [channel.name for channel in log.channels] == ["A/F", "B/F"]


def test_text_channels_are_left_out_with_a_remark(write):
    log = read_log(
        write(content(waveform("G", "F", np.arange(3.0)), ChannelObject("G", "note", ["a", "b"])), "t.tdms")
    )
    assert [channel.name for channel in log.channels] == ["F"]
    assert "channel 'note' holds no numbers and is left out" in log.remarks


@pytest.mark.parametrize("lost", [40, 3000, 7900])
def test_a_cut_file_is_refused(write, lost):
    data = content(waveform("G", "F", np.arange(1000.0)))
    with pytest.raises(FileFormatError, match=r"the TDMS file is (cut|damaged)"):
        read_log(write(data[:-lost], "t.tdms"))


def test_a_file_without_data_is_refused(write):
    with pytest.raises(FileFormatError, match="the log has no data"):
        read_log(write(content(waveform("G", "F", np.array([], dtype=np.float64))), "t.tdms"))


def test_the_start_is_shown_in_the_zone_of_the_settings(write, settings):
    log = read_log(write(content(waveform("G", "F", np.arange(3.0))), "t.tdms"), settings(time_zone="+08:00"))
    assert log.start.isoformat() == "2026-09-05T14:20:00.250000+08:00"


def test_a_cut_file_is_one_message_and_nothing_of_the_library(write, caplog):
    data = content(waveform("G", "F", np.arange(1000.0)))
    with pytest.raises(FileFormatError, match="cut"):
        read_log(write(data[: len(data) // 2], "t.tdms"))
    with pytest.raises(FileFormatError, match="empty or was cut"):
        read_log(write(data[:100], "t.tdms"))
    assert not caplog.records
