"""TDMS files in which a channel begins again, and channels that say what time is."""

import io

import numpy as np
import pytest
from nptdms import ChannelObject, TdmsWriter

from tethertest.errors import FileFormatError
from tethertest.readers import read_log
from tethertest.readers.streaming import stream_log

START = np.datetime64("2026-09-05T01:10:00")
OWN = {"wf_start_time": START, "wf_increment": 0.01, "unit_string": "N"}


def later(seconds, **changes):
    return {**OWN, "wf_start_time": START + np.timedelta64(round(seconds * 1e6), "us"), **changes}


def recorded(*segments, group="G", name="F"):
    """Return a file of one channel; each segment has its number of samples and properties."""
    stream = io.BytesIO()
    with TdmsWriter(stream) as writer:
        for number, (count, properties) in enumerate(segments, 1):
            values = np.full(count, float(number))
            writer.write_segment([ChannelObject(group, name, values, properties=properties)])
    return stream.getvalue()


def timed(unit, values, **more):
    """Return a file in which a channel of numbers is the time of another."""
    stream, said = io.BytesIO(), {"unit_string": unit} if unit else {}
    with TdmsWriter(stream) as writer:
        for group, shift in more.get("groups", {"G": 0.0}).items():
            writer.write_segment([
                ChannelObject(group, "Time", values + shift, properties=said),
                ChannelObject(group, "F", np.ones(len(values)), properties={"unit_string": "N"}),
            ])  # fmt: skip
    return stream.getvalue()


def time_of(log):
    return log.channels[0].time


@pytest.mark.parametrize("pieces", [None, 30, 100, 1000])
def test_an_appended_recording_keeps_its_own_start(write, pieces):
    path = write(recorded((100, OWN), (50, later(600.0))))
    logs = [read_log(path)] if pieces is None else list(stream_log(path, rows=pieces))
    expected = np.concatenate((np.arange(100) * 0.01, 600.0 + np.arange(50) * 0.01))
    np.testing.assert_allclose(np.concatenate([time_of(log) for log in logs]), expected, atol=1e-9)
    assert str(logs[0].start) == "2026-09-05 01:10:00+00:00"
    assert logs[0].remarks == (
        "channel 'F' holds 2 recordings; others begin with sample 101 at 2026-09-05T01:20:00.000 UTC",
    )


def test_an_appended_recording_keeps_its_own_rate(write):
    log = read_log(write(recorded((100, OWN), (50, later(5.0, wf_increment=0.001)))))
    expected = np.concatenate((np.arange(100) * 0.01, 5.0 + np.arange(50) * 0.001))
    np.testing.assert_allclose(time_of(log), expected, atol=1e-9)
    assert log.rate is None


@pytest.mark.parametrize("next_start", [1.0, 1.004, 0.0])
def test_segments_that_go_on_or_say_the_same_are_one_recording(write, next_start):
    log = read_log(write(recorded((100, OWN), (50, later(next_start)))))
    np.testing.assert_allclose(time_of(log), np.arange(150) * 0.01, atol=1e-9)
    assert log.remarks == ()
    assert log.rate == 100.0


@pytest.mark.parametrize("pause", [0.0, 30.0])
def test_segments_stamped_by_the_computers_clock_are_even(write, pause):
    random = np.random.default_rng(0)
    segments = [
        (100, later(number + random.normal(0.0, 0.03) + (pause if number >= 40 else 0.0)))
        for number in range(60)
    ]
    segments[0] = (100, OWN)
    log = read_log(write(recorded(*segments)))
    steps = np.diff(time_of(log))
    assert np.count_nonzero(np.abs(steps - 0.01) > 1e-9) == (1 if pause else 0)
    assert abs(float(np.max(steps)) - 0.01 - pause) < 0.2
    assert any("computer's clock" in remark for remark in log.remarks)


def test_what_is_said_after_the_samples_holds_for_all_of_them(write):
    bare = {"wf_increment": 0.01}
    log = read_log(
        write(recorded((100, bare), (20, {}), (30, {"unit_string": "kN"}), (0, {"wf_start_time": START})))
    )
    assert log.channels[0].unit == "kN"
    assert str(log.start) == "2026-09-05 01:10:00+00:00"
    np.testing.assert_allclose(time_of(log), np.arange(150) * 0.01, atol=1e-9)


def test_a_property_corrected_at_the_end_is_no_second_recording(write):
    log = read_log(write(recorded((100, OWN), (0, {**OWN, "unit_string": "kN"}))))
    assert log.channels[0].unit == "kN"


@pytest.mark.parametrize(("key", "value"), [("unit_string", "kN"), ("NI_Scale[0]_Linear_Slope", 2.0)])
def test_another_unit_or_scaling_in_one_channel_is_refused(write, key, value):
    own = {**OWN, "NI_Scale[0]_Linear_Slope": 1.0}
    path = write(recorded((100, own), (50, {**own, **later(2.0), key: value})))
    with pytest.raises(FileFormatError, match=r"changes from sample 101 on: .* appended to another"):
        read_log(path)


def test_recordings_of_which_one_has_no_start_are_refused(write):
    path = write(
        recorded((100, {**OWN, "wf_start_time": np.datetime64("1904-01-01T00:00:00")}), (50, later(9.0)))
    )
    with pytest.raises(FileFormatError, match="not all say when they began"):
        read_log(path)


@pytest.mark.parametrize(
    ("unit", "scale"), [("s", 1.0), ("ms", 1e3), ("us", 1e6), ("min", 1 / 60), ("", 1.0)]
)
def test_a_time_channel_counts_in_its_unit(write, unit, scale):
    log = read_log(write(timed(unit, np.arange(100) * 0.01 * scale)))
    np.testing.assert_allclose(time_of(log), np.arange(100) * 0.01, atol=1e-9)
    assert any("taken as seconds" in remark for remark in log.remarks) == (not unit)


def test_a_time_channel_in_another_unit_is_refused(write):
    with pytest.raises(FileFormatError, match="the time channel 'Time' has the unit 'V'"):
        read_log(write(timed("V", np.arange(100.0))))


@pytest.mark.parametrize(("unit", "count"), [("s", 3871415400.0), ("s", 1788570600.0), ("ms", 1788570600e3)])
def test_counts_of_labview_and_unix_are_instants(write, unit, count):
    step = 0.01 if unit == "s" else 10.0
    log = read_log(write(timed(unit, count + np.arange(100) * step)))
    assert str(log.start) == "2026-09-05 01:10:00+00:00"
    np.testing.assert_allclose(time_of(log), np.arange(100) * 0.01, atol=1e-6)


def test_groups_that_begin_apart_stay_apart(write):
    log = read_log(write(timed("s", 1788570600.0 + np.arange(10.0), groups={"A": 5.0, "B": 0.0})))
    assert [channel.time[0] for channel in log.channels] == [5.0, 0.0]


def test_stamps_of_groups_that_begin_apart_stay_apart(write):
    stream = io.BytesIO()
    with TdmsWriter(stream) as writer:
        for group, late in (("A", 5), ("B", 0)):
            stamps = START + np.timedelta64(late, "s") + np.arange(10) * np.timedelta64(1, "s")
            writer.write_segment(
                [ChannelObject(group, "Time", stamps), ChannelObject(group, "F", np.ones(10))]
            )
    log = read_log(write(stream.getvalue()))
    assert [channel.time[0] for channel in log.channels] == [5.0, 0.0]


def test_a_waveform_over_milliseconds_is_in_seconds(write):
    log = read_log(
        write(recorded((4, {**OWN, "wf_increment": 10.0, "wf_xname": "Time", "wf_xunit_string": "ms"})))
    )
    np.testing.assert_allclose(time_of(log), [0.0, 0.01, 0.02, 0.03])


def test_an_appended_recording_over_milliseconds_goes_on(write):
    over = {"wf_increment": 10.0, "wf_xname": "Time", "wf_xunit_string": "ms"}
    log = read_log(write(recorded((100, {**OWN, **over}), (50, later(1.0, **over)))))
    np.testing.assert_allclose(time_of(log), np.arange(150) * 0.01, atol=1e-9)
    assert log.remarks == ()


def test_a_spectrum_is_no_time_series(write):
    stream = io.BytesIO()
    over = {"wf_increment": 0.5, "wf_xname": "Frequency", "wf_xunit_string": "Hz"}
    with TdmsWriter(stream) as writer:
        writer.write_segment([
            ChannelObject("G", "F", np.ones(10), properties=OWN),
            ChannelObject("G", "PSD", np.ones(10), properties=over),
        ])  # fmt: skip
    log = read_log(write(stream.getvalue()))
    assert [channel.name for channel in log.channels] == ["F"]
    assert log.remarks == ("channel 'PSD' stands over Frequency [Hz], not over time, and is left out",)
    with pytest.raises(FileFormatError, match="stands over Frequency"):
        read_log(write(recorded((4, over)), "spectrum.tdms"))
