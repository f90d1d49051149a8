from __future__ import annotations

import datetime as dt

import numpy as np
import pytest

from tethertest.errors import FileFormatError
from tethertest.readers import read_log

TOP = np.array([5.125, 5.25, -0.5, 6.0])
BOTTOM = np.array([1.5, 2.5, 3.5, 4.5])


def file_header(x_columns="No", decimal=".", multi="Yes", extra=""):
    keys = f"Writer_Version\t2\nReader_Version\t2\nSeparator\tTab\n{extra}Multi_Headings\t{multi}\n"
    return (
        f"LabVIEW Measurement\t\n{keys}X_Columns\t{x_columns}\nTime_Pref\tAbsolute\nDate\t2026/09/05\n"
        f"Time\t14:20:00{decimal}1970510124996275989\n***End_of_Header***\t\n\t\n"
    )


def segment(
    x_columns="No",
    decimal=".",
    clock="14:20:00.5",
    samples=(4, 4),
    start=0.0,
    comments=None,
    rows=4,
    step=0.25,
):
    each = 2 if x_columns == "Multi" else 1
    gap = "\t" * each

    def line(key, *cells):
        return key + "\t" + gap.join(cells) + "\t\n"

    head = (
        line("Channels", "2")
        + line("Samples", *map(str, samples))
        + line("Date", "2026/09/05", "2026/09/05")
        + line("Time", clock, clock)
        + line("Y_Unit_Label", "mV/V", "N")
        + line("X_Dimension", "Time", "Time")
        + line("X0", "0.0E+0", "0.0E+0")
        + line("Delta_X", f"{step}", f"{step}")
        + "***End_of_Header***\t\t\n"
    )
    names = "X_Value\tF_top\tX_Value\tF_bottom" if each == 2 else "X_Value\tF_top\tF_bottom"
    body = names + "\tComment\n"
    for k in range(rows):
        x = "" if x_columns == "No" else f"{start + k * step:.6f}"
        second = f"{BOTTOM[k]:.6f}" if k < samples[1] else ""
        cells = [x, f"{TOP[k]:.6f}", *([x] if each == 2 else []), second]
        if comments and comments.get(k):
            cells.append(comments[k])
        body += "\t".join(cells) + "\n"
    return (head + body).replace(".", decimal) if decimal == "," else head + body


@pytest.mark.parametrize("x_columns", ["No", "One", "Multi"])
@pytest.mark.parametrize("decimal", [".", ","])
@pytest.mark.parametrize("stated", [True, False])
@pytest.mark.parametrize("line_end", ["\n", "\r\n"])
def test_round_trip(write, x_columns, decimal, stated, line_end):
    extra = f"Decimal_Separator\t{decimal}\n" if stated else ""
    text = file_header(x_columns, decimal, extra=extra) + segment(x_columns, decimal)
    log = read_log(write(text, line_end=line_end))
    assert [channel.name for channel in log.channels] == ["F_top", "F_bottom"]
    assert [channel.unit for channel in log.channels] == ["mV/V", "N"]
    assert log.channels[0].values.tolist() == TOP.tolist()
    assert log.channels[1].values.tolist() == BOTTOM.tolist()
    for channel in log.channels:
        assert channel.time.tolist() == [0.0, 0.25, 0.5, 0.75]
    assert log.start == dt.datetime(2026, 9, 5, 14, 20, 0, 500000)
    assert (log.format, log.decimal, log.rate, log.header_line) == ("lvm", decimal, 4.0, 21 + stated)
    sign = {".": "point", ",": "comma"}[decimal]
    unsaid = f"the header states no Decimal_Separator; the numbers have a decimal {sign}"
    assert (unsaid in log.remarks) is not stated


def test_text_events_become_remarks_and_move_no_value(write):
    text = file_header() + segment(comments={1: "LOST COMMUNICATION", 3: "tap"})
    log = read_log(write(text))
    assert [remark for remark in log.remarks if "line" in remark] == [
        "line 23: LOST COMMUNICATION",
        "line 25: tap",
    ]
    assert log.channels[1].values.tolist() == BOTTOM.tolist()


def test_a_quote_in_a_comment_is_only_a_character(write):
    log = read_log(write(file_header() + segment(comments={1: 'moved by 2"'})))
    assert log.channels[1].values.tolist() == BOTTOM.tolist()
    assert 'line 23: moved by 2"' in log.remarks


def test_segments_keep_their_own_starts(write):
    text = file_header() + segment() + "\n" + segment(clock="14:20:03.0")
    log = read_log(write(text))
    assert log.channels[0].time.tolist() == [0.0, 0.25, 0.5, 0.75, 2.5, 2.75, 3.0, 3.25]
    assert any("2 segments" in remark for remark in log.remarks)


def test_segments_of_other_channels_are_refused(write):
    text = file_header() + segment() + "\n" + segment(clock="14:20:03.0").replace("F_bottom", "F_side")
    with pytest.raises(FileFormatError, match="segment 2 has the channels") as caught:
        read_log(write(text))
    assert caught.value.line == 36


def test_a_channel_without_samples_is_empty(write):
    log = read_log(write(file_header() + segment(samples=(4, 0))))
    assert log.channels[1].values.size == 0
    assert log.channels[0].values.size == 4
    assert "channel 'F_bottom' has no samples" in log.remarks


def test_fewer_rows_than_the_segment_states(write):
    with pytest.raises(FileFormatError, match="the segment states 4 samples and has 3 rows") as caught:
        read_log(write(file_header() + segment(rows=3)))
    assert caught.value.line == 24


def test_packets_under_one_heading_may_have_more_rows(write):
    text = file_header("One", multi="No") + segment("One").replace("Samples\t4\t4", "Samples\t1\t1")
    log = read_log(write(text))
    assert log.channels[0].values.tolist() == TOP.tolist()
    assert log.channels[1].values.tolist() == BOTTOM.tolist()


def test_a_cut_row(write):
    text = file_header() + segment()
    with pytest.raises(FileFormatError, match="the last row is cut: found 2 of 3 to 4 columns") as caught:
        read_log(write(text[: text.rindex("\t")]))
    assert caught.value.line == 25


def test_a_cut_file_header(write):
    with pytest.raises(FileFormatError, match="the file header has no end"):
        read_log(write(file_header()[:90]))


def test_a_cut_segment_header(write):
    with pytest.raises(FileFormatError, match="the header of a segment is cut"):
        read_log(write(file_header() + segment()[:60]))


def test_no_segment(write):
    with pytest.raises(FileFormatError, match="a header but no segment"):
        read_log(write(file_header()))


def test_no_rows(write):
    with pytest.raises(FileFormatError, match="a header but no data rows"):
        read_log(write(file_header(multi="No") + segment(rows=0)))


def test_latin_units(write):
    text = (file_header() + segment()).replace("mV/V", "°C")
    log = read_log(write(text, encoding="latin-1"))
    assert (log.channels[0].unit, log.encoding) == ("°C", "cp1252")


def test_a_name_used_twice_is_numbered(write):
    log = read_log(write(file_header() + segment().replace("F_bottom", "F_top")))
    assert [channel.name for channel in log.channels] == ["F_top", "F_top (2)"]
    assert any("'F_top' is used again" in remark for remark in log.remarks)


def test_the_run_file_gives_units_and_zone(write, settings):
    log = read_log(
        write(file_header() + segment()), settings(units={"F_top": "uV/V"}, time_zone="Asia/Shanghai")
    )
    assert log.channels[0].unit == "uV/V"
    assert log.start.utcoffset() == dt.timedelta(hours=8)


@pytest.mark.parametrize(
    ("old", "new", "words", "line"),
    [
        ("Samples\t4\t4", "Samples\t3\t3", "states 3 samples and has 4 rows", 25),
        ("Channels\t2", "Channels\t3", "states 3 channels and has names for 2", 21),
        ("5.250000", "5.2\r50000", "a carriage return inside a row", 23),
    ],
)
def test_rows_that_contradict_the_header_are_refused(tmp_path, old, new, words, line):
    text = file_header() + segment()
    assert old in text
    path = tmp_path / "log.lvm"
    path.write_bytes(text.replace(old, new).encode())
    with pytest.raises(FileFormatError, match=words) as caught:
        read_log(path)
    assert caught.value.line == line


def test_a_channel_with_more_values_than_it_states(write):
    text = (file_header() + segment()).replace("Samples\t4\t4", "Samples\t4\t2")
    with pytest.raises(FileFormatError, match="'F_bottom' has values in 4 rows, the segment states 2"):
        read_log(write(text))


@pytest.mark.parametrize("x_columns", ["One", "Multi"])
def test_an_even_x_column_that_contradicts_the_sampling_interval(write, x_columns):
    text = (file_header(x_columns) + segment(x_columns)).replace("Delta_X\t0.25", "Delta_X\t0.26")
    with pytest.raises(FileFormatError, match=r"Delta_X is 0.26 for 'F_top', its X column steps by 0.25"):
        read_log(write(text))


def test_an_uneven_x_column_is_the_time_whatever_the_sampling_interval(write):
    text = (file_header("One") + segment("One")).replace("0.500000\t", "0.450000\t")
    text = text.replace("Delta_X\t0.25\t0.25", "Delta_X\t1\t1")
    assert read_log(write(text)).channels[0].time.tolist() == [0.0, 0.25, 0.45, 0.75]


@pytest.mark.parametrize("step", ["0", "-0.25"])
def test_samples_without_any_time(write, step):
    text = (file_header() + segment()).replace("Delta_X\t0.25\t0.25", f"Delta_X\t{step}\t{step}")
    with pytest.raises(FileFormatError, match="there is no X column: the samples have no time"):
        read_log(write(text))


@pytest.mark.parametrize("x", ["1e308", ""])
def test_an_x_value_that_is_no_time(write, x):
    text = (file_header("One") + segment("One")).replace("\n0.500000\t", f"\n{x}\t")
    with pytest.raises(FileFormatError, match="no X value that is a time") as caught:
        read_log(write(text))
    assert caught.value.line == 24


def test_a_header_key_that_is_cut_before_its_value(write):
    text = (file_header() + segment()).replace("Writer_Version\t2", "Writer_Version")
    assert read_log(write(text)).channels[0].values.tolist() == TOP.tolist()


def test_numbers_of_the_header_that_are_none(write):
    text = (file_header() + segment()).replace("Samples\t4", "Samples\tnan")
    with pytest.raises(FileFormatError, match="found 'nan' in the header of a segment"):
        read_log(write(text))


def test_segments_in_other_units_are_refused(write):
    text = file_header() + segment() + "\n" + segment(clock="14:30:00.5").replace("mV/V", "V/V")
    with pytest.raises(FileFormatError, match="segment 2 has 'F_top' in V/V, the first one in mV/V"):
        read_log(write(text))


@pytest.mark.parametrize(
    ("label", "found"), [("X_Dimension\tFrequency\tFrequency", "Frequency"), ("X_Unit_Label\tms\tms", "ms")]
)
def test_what_does_not_stand_over_seconds_is_refused(write, label, found):
    text = file_header() + segment().replace("X_Dimension\tTime\tTime", label)
    with pytest.raises(FileFormatError, match=rf"stands over .*{found}.*, expected Time in seconds"):
        read_log(write(text))


def test_x_since_1904_counts_from_its_first_value(write):
    since = 3871437600.0
    text = file_header("One") + segment("One", start=since)
    text += "\n" + segment("One", start=since + 600.0, clock="14:30:00.5")
    log = read_log(write(text))
    expected = np.concatenate((np.arange(4) * 0.25, 600.0 + np.arange(4) * 0.25))
    np.testing.assert_allclose(log.channels[0].time, expected, atol=1e-6)
    assert log.start == dt.datetime(2026, 9, 5, 14, 20, 0, 500000)
    assert any("since 1904" in remark for remark in log.remarks)
