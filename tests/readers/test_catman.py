from __future__ import annotations

import datetime as dt

import numpy as np
import pytest

from tethertest.errors import FileFormatError
from tethertest.readers import read_log

ROWS = [(0.0, -19.79, 0.5), (0.02, -19.67, 0.25), (0.04, -19.5, -0.125)]
NAMES = ("Time DEVICE_1", "Load", "FTG1")
LAST_OF_HEADER = 38  #: lines


def catman(
    rows=ROWS, stated=None, decimal=".", names=NAMES, intervals="20 ms", separator="\t", code=None,
    starts="10.11.17 16:53:58", units=None, further=22, date="2017-11-10-17:06",
):  # fmt: skip
    count = len(names)

    def row(cells):
        return separator.join([cells] * count if isinstance(cells, str) else cells)

    def each(prefix, cells):
        return row(f"{prefix}{cells}" if isinstance(cells, str) else [f"{prefix}{cell}" for cell in cells])

    head = [
        "HBM_CATMAN_DATAFILE_40", "", "2017-11-13", "11:24", f"CHANNELS: {count}",
        f"SEPARATOR: {ord(separator) if code is None else code}",
        f"MAXLINES: {len(rows) if stated is None else stated}              ", "",
        separator.join(f"{name} CH={n}" for n, name in enumerate(names, start=1)),
        separator.join(units or ["s" if name.startswith(("Time", "Zeit")) else "µm/m" for name in names]),
        row(date), row(""), each("T0 =", starts),
    ]  # fmt: skip
    head += [each("dt =", intervals)] if intervals else []
    head += [row(f"CH {n}") for n in range(further)] + [row("Cable length correction Not available"), ""]
    body = [
        separator.join("" if value is None else f"{value:.3f}" for value in values).replace(".", decimal)
        for values in rows
    ]
    return "\n".join(head + body) + "\n"


@pytest.mark.parametrize("decimal", [".", ","])
@pytest.mark.parametrize("line_end", ["\n", "\r\n"])
@pytest.mark.parametrize("separator", ["\t", ";"])
@pytest.mark.parametrize(
    ("encoding", "found"), [("latin-1", "cp1252"), ("utf-8", "utf-8"), ("utf-8-sig", "utf-8-sig")]
)
def test_round_trip(write, decimal, line_end, separator, encoding, found):
    text = catman(decimal=decimal, separator=separator)
    log = read_log(write(text, encoding=encoding, line_end=line_end))
    assert [channel.name for channel in log.channels] == ["Load", "FTG1"]
    assert log.channels[0].unit == "µm/m"
    assert log.channels[0].time.tolist() == [0.0, 0.02, 0.04]
    assert log.channels[0].values.tolist() == [-19.79, -19.67, -19.5]
    assert log.channels[1].values.tolist() == [0.5, 0.25, -0.125]
    assert log.start == dt.datetime(2017, 11, 10, 16, 53, 58)
    assert (log.format, log.decimal, log.date_order, log.rate) == ("catman", decimal, "dmy", 50.0)
    assert (log.encoding, log.header_line, log.separator) == (found, 9, separator)


def rows_end_with(text, ending):
    lines = text.split("\n")
    return "\n".join([*lines[:LAST_OF_HEADER], *(line + ending for line in lines[LAST_OF_HEADER:])])


@pytest.mark.parametrize("further", [0, 1, 22, 60])
def test_headers_of_other_lengths(write, further):
    log = read_log(write(catman(further=further)))
    assert log.channels[1].values.tolist() == [0.5, 0.25, -0.125]


@pytest.mark.parametrize("mutate", [
    lambda text: text + "\n", lambda text: text + "\n\n", lambda text: text.rstrip("\n"),
    lambda text: text.replace(f"MAXLINES: {len(ROWS)}", f"MAXLINES:{len(ROWS)}"),
    lambda text: rows_end_with(text, "  "),
    lambda text: rows_end_with(text, "\t"),
    lambda text: text.replace("SEPARATOR: 9\n", "\n"), lambda text: text.replace("CH=", " CH = "),
])  # fmt: skip
def test_what_means_nothing_changes_nothing(write, mutate):
    plain, other = read_log(write(catman(), "a.asc")), read_log(write(mutate(catman()), "b.asc"))
    for one, two in zip(plain.channels, other.channels, strict=True):
        np.testing.assert_array_equal(two.values, one.values)
        np.testing.assert_array_equal(two.time, one.time)
        assert (two.name, two.unit) == (one.name, one.unit)


def test_times_follow_dt_without_a_time_channel(write):
    rows = [values[1:] for values in ROWS]
    log = read_log(write(catman(rows, names=("Load", "FTG1"))))
    assert log.channels[0].time.tolist() == [0.0, 0.02, 0.04]


@pytest.mark.parametrize(
    ("text", "step"), [("0.02 s", 0.02), ("0,02 s", 0.02), ("20000 µs", 0.02), ("1E2 ms", 0.1)]
)
def test_ways_to_write_dt(write, text, step):
    log = read_log(write(catman([values[1:] for values in ROWS], names=("Load", "FTG1"), intervals=text)))
    assert log.channels[0].time == pytest.approx([0.0, step, 2 * step], abs=1e-15)


def test_each_channel_takes_the_time_channel_left_of_it(write):
    names = ("Time 1", "Load", "Time 2", "FTG1")
    rows = [(0.02 * k, k, 0.1 * k if k < 2 else None, 5.0 + k if k < 2 else None) for k in range(10)]
    log = read_log(write(catman(rows, names=names, intervals=("20 ms", "20 ms", "100 ms", "100 ms"))))
    assert log.channels[0].time == pytest.approx(0.02 * np.arange(10), abs=1e-12)
    assert log.channels[1].time.tolist() == [0.0, 0.1]
    assert log.channels[1].values.tolist() == [5.0, 6.0]
    assert log.rate is None


def test_a_time_channel_in_another_language_and_unit(write):
    names, units = ("Zeit  1 - Standardmessrate", "Kraft"), ["ms", "N"]
    log = read_log(write(catman([(0.0, 1.0), (20.0, 2.0), (40.0, 3.0)], names=names, units=units)))
    assert [channel.name for channel in log.channels] == ["Kraft"]
    assert log.channels[0].time == pytest.approx([0.0, 0.02, 0.04], abs=1e-15)


@pytest.mark.parametrize("packed", [True, False])
def test_a_slower_channel_without_a_time_channel(write, packed):
    place = {k if packed else 5 * k: 7.0 + k for k in range(4)}
    rows = [(float(k), place.get(k)) for k in range(20)]
    log = read_log(write(catman(rows, names=("Load", "FTG1"), intervals=("20 ms", "100 ms"))))
    assert log.channels[0].time == pytest.approx(0.02 * np.arange(20), abs=1e-15)
    assert log.channels[1].time == pytest.approx(0.1 * np.arange(4), abs=1e-15)
    assert log.channels[1].values.tolist() == [7.0, 8.0, 9.0, 10.0]


def test_a_slower_channel_with_too_few_values(write):
    rows = [(float(k), 1.0 if k < 2 else None) for k in range(20)]
    with pytest.raises(
        FileFormatError, match="'FTG1' has 2 values in 20 rows, its dt of 100 ms asks for 4"
    ) as caught:
        read_log(write(catman(rows, names=("Load", "FTG1"), intervals=("20 ms", "100 ms"))))
    assert caught.value.line == 14


def test_channels_that_start_apart(write):
    starts = ("10.11.17 16:53:58", "10.11.17 16:53:58", "10.11.17 16:54:00")
    log = read_log(write(catman(starts=starts)))
    assert [channel.time[0] for channel in log.channels] == [0.0, 2.0]
    assert "the channels start up to 2 s apart, by their T0" in log.remarks


@pytest.mark.parametrize(
    ("text", "order"),
    [("11/10/2017 16:53:58", "mdy"), ("10/11/2017 16:53:58", "dmy"), ("2017/11/10 16:53:58", "ymd")],
)
def test_a_date_with_slashes_is_read_as_the_plain_date_of_the_header(write, text, order):
    log = read_log(write(catman(starts=text)))
    assert (log.start, log.date_order) == (dt.datetime(2017, 11, 10, 16, 53, 58), order)


def test_a_date_with_slashes_and_nothing_to_read_it_by(write):
    with pytest.raises(FileFormatError, match="can be read as day/month and as month/day"):
        read_log(write(catman(starts="10/11/2017 16:53:58", date="")))


def test_a_rate_that_the_run_file_states_stands_above_dt(write, settings):
    path = write(catman(intervals="10 ms"))
    with pytest.raises(
        FileFormatError, match=r"dt states 10 ms between samples, .* steps by 20 ms"
    ) as caught:
        read_log(path)
    assert caught.value.line == 14
    log = read_log(path, settings(rate=50.0))
    assert log.channels[0].time.tolist() == [0.0, 0.02, 0.04]


def test_a_cut_row_names_its_line_what_stands_there_and_how_much_is_whole(write):
    with pytest.raises(FileFormatError) as caught:
        read_log(write(catman(stated=38730)[:-8]))
    assert caught.value.line == 41
    assert caught.value.problem == (
        "the last row is cut: found 2 of 3 columns (0.040, -19.500); before it the log "
        "has 2 whole rows of the 38730 "
        "that MAXLINES states"
    )
    assert "delete this one and set MAXLINES to 2 in a copy of the log" in caught.value.remedy


def test_what_the_message_on_a_cut_row_advises_reads_the_whole_rows(write):
    text = catman(stated=2)
    log = read_log(write(text[: text.rindex("0.040")]))
    assert log.channels[0].values.tolist() == [-19.79, -19.67]


def neither():
    return catman([values[1:] for values in ROWS], names=("Load", "FTG1"), intervals="")


@pytest.mark.parametrize(
    ("text", "match", "line"),
    [
        (neither(), "channel 'Load' has neither a time channel nor dt", 9),
        (catman(stated=9), "the log is cut: MAXLINES states 9 rows, found 3", 41),
        (
            catman(stated=2),
            "the log has more rows than its header states: MAXLINES states 2 rows, found 3",
            40,
        ),
        (catman()[:300], "the header of the catman file is incomplete", None),
        (
            catman().replace("CHANNELS: 3", "CHANNELS: 4"),
            "CHANNELS states 4 channels, the row of names has 3",
            9,
        ),
        (catman().replace("CHANNELS: 3", "CHANNELS: x"), "CHANNELS is 'x', expected a whole number", 5),
        (catman().replace("MAXLINES: 3", "MAXLINES: ?"), r"MAXLINES is '\?', expected a whole number", 7),
        (catman(code=59), "SEPARATOR states character 59, but '.t' separates the names", 9),
        (catman(units=["s", "µm/m"]), "the row of units has 2 cells, the row of names has 3", 10),
        (catman(intervals=("20 ms", "20 ms")), "the row of dt has 2 cells, expected 3", 14),
        (catman(intervals="20 furlongs"), "found 'dt =20 furlongs', expected a time between samples", 14),
        (catman(intervals="0 ms"), "found 'dt =0 ms', expected a time between samples", 14),
        (catman(starts="soon"), "found 'soon', expected a date and time", 13),
        (catman().replace("-19.670", "tap"), "found 'tap' in column 'Load'", 40),
        (catman().replace("0.020\t-19.670", "0.020"), "found 2 columns, expected 3", 40),
        (catman().replace("0.020\t", "\t"), "'Load' has a value where its time channel is blank", 40),
        (catman([(0.0,), (0.02,)], names=("Time 1",)), "the log has a time but no channels", 9),
    ],
)
def test_refusals(write, text, match, line):
    with pytest.raises(FileFormatError, match=match) as caught:
        read_log(write(text))
    if line is not None:
        assert caught.value.line == line
