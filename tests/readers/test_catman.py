from __future__ import annotations

import datetime as dt

import pytest

from tethertest.errors import FileFormatError
from tethertest.readers import read_log

ROWS = [(0.0, -19.79, 0.5), (0.02, -19.67, 0.25), (0.04, -19.5, -0.125)]


def catman(rows=ROWS, stated=None, decimal=".", names=("Time DEVICE_1", "Load", "FTG1"), interval="20 ms"):
    count = len(names)

    def row(first, other=None):
        return "\t".join([first, *[first if other is None else other] * (count - 1)])

    head = [
        "HBM_CATMAN_DATAFILE_40", "", "2017-11-13", "11:24", f"CHANNELS: {count}", "SEPARATOR: 9",
        f"MAXLINES: {len(rows) if stated is None else stated}              ", "",
        "\t".join(f"{name} CH={n}" for n, name in enumerate(names, start=1)),
        "\t".join(["s" if name.startswith("Time") else "µm/m" for name in names]),
        row("2017-11-10-17:06"), row("", ""), row("T0 =10.11.17 16:53:58"),
    ]  # fmt: skip
    head += [row(f"dt ={interval}")] if interval else []
    head += [row(f"CH {n}") for n in range(22)] + [row("Cable length correction Not available"), ""]
    body = ["\t".join(f"{value:.3f}" for value in values).replace(".", decimal) for values in rows]
    return "\n".join(head + body) + "\n"


@pytest.mark.parametrize("decimal", [".", ","])
@pytest.mark.parametrize("line_end", ["\n", "\r\n"])
def test_round_trip(write, decimal, line_end):
    log = read_log(write(catman(decimal=decimal), encoding="latin-1", line_end=line_end))
    assert [channel.name for channel in log.channels] == ["Load", "FTG1"]
    assert log.channels[0].unit == "µm/m"
    assert log.channels[0].time.tolist() == [0.0, 0.02, 0.04]
    assert log.channels[1].values.tolist() == [0.5, 0.25, -0.125]
    assert log.start == dt.datetime(2017, 11, 10, 16, 53, 58)
    assert (log.format, log.decimal, log.date_order, log.rate) == ("catman", decimal, "dmy", 50.0)
    assert (log.encoding, log.header_line) == ("cp1252", 9)


def test_times_follow_dt_without_a_time_channel(write):
    rows = [values[1:] for values in ROWS]
    log = read_log(write(catman(rows, names=("Load", "FTG1"))))
    assert log.channels[0].time.tolist() == [0.0, 0.02, 0.04]


def test_each_channel_takes_the_time_channel_left_of_it(write):
    names = ("Time 1", "Load", "Time 2", "FTG1")
    rows = [(0.0, 1.0, 0.0, 5.0), (0.02, 2.0, 0.1, 6.0)]
    log = read_log(write(catman(rows, names=names)))
    assert [channel.time.tolist() for channel in log.channels] == [[0.0, 0.02], [0.0, 0.1]]


def test_neither_time_nor_dt(write):
    with pytest.raises(FileFormatError, match="channel 'Load' has neither a time channel nor dt"):
        read_log(write(catman([values[1:] for values in ROWS], names=("Load", "FTG1"), interval="")))


def test_fewer_rows_than_maxlines(write):
    with pytest.raises(FileFormatError, match="the log is cut: MAXLINES states 9 rows, found 3") as caught:
        read_log(write(catman(stated=9)))
    assert caught.value.line == 41


def test_a_cut_row_names_its_line(write):
    with pytest.raises(FileFormatError, match="the last row is cut: found 2 of 3 columns") as caught:
        read_log(write(catman()[:-8]))
    assert caught.value.line == 41


def test_a_cut_header(write):
    with pytest.raises(FileFormatError, match="the header of the catman file is incomplete"):
        read_log(write(catman()[:300]))


def test_names_that_do_not_match_channels(write):
    with pytest.raises(FileFormatError, match="CHANNELS states 4 channels, the row of names has 3"):
        read_log(write(catman().replace("CHANNELS: 3", "CHANNELS: 4")))


def test_text_in_a_channel(write):
    with pytest.raises(FileFormatError, match="found 'tap' in column 'Load'") as caught:
        read_log(write(catman().replace("-19.670", "tap")))
    assert caught.value.line == 40
