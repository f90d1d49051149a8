from __future__ import annotations

import datetime as dt

import numpy as np
import pytest

from tethertest.errors import FileFormatError
from tethertest.readers import read_log

BOM = b"\xef\xbb\xbf"
META = "ENLIGHT Version: 3.0\nModule Type: Hyperion\nTimestamp Format: Full\nName: \t\t\t\n"
SENSORS = (
    "Timestamp\tfbg1\tfbg2\ttemp\n"
    "2026/5/19 09:38:55.04646\t1510.4662\t1522.4686\t21.5\n"
    "2026/5/19 09:38:55.05646\t1510.4659\t\t21.6\n"
    "2026/5/19 09:38:55.06646\t1510.4672\t1522.4702\t21.7\n"
)


@pytest.mark.parametrize("mark", [BOM, b""])
@pytest.mark.parametrize("meta", [META, ""])
@pytest.mark.parametrize("line_end", [b"\n", b"\r\n"])
def test_sensors(write, mark, meta, line_end):
    log = read_log(write(mark + (meta + SENSORS).encode().replace(b"\n", line_end)))
    assert log.format == "enlight-sensors"
    assert [(channel.name, channel.unit) for channel in log.channels] == [
        ("fbg1", "nm"),
        ("fbg2", "nm"),
        ("temp", ""),
    ]
    assert log.channels[0].values.tolist() == [1510.4662, 1510.4659, 1510.4672]
    assert np.isnan(log.channels[1].values).tolist() == [False, True, False]
    assert log.channels[0].time == pytest.approx([0.0, 0.01, 0.02], abs=1e-12)
    assert log.start == dt.datetime(2026, 5, 19, 9, 38, 55, 46460)
    assert (log.date_order, log.header_line) == ("ymd", 5 if meta else 1)
    assert any("fbg1, fbg2 are wavelengths in nm" in remark for remark in log.remarks)


def test_a_table_of_another_logger_is_not_taken_for_sensors(write):
    text = "Timestamp\tF_top\n2026/5/19 09:38:55.04646\t1.5\n2026/5/19 09:38:55.05646\t1.6\n"
    assert read_log(write(text)).format == "delimited"


def test_sensors_with_decimal_commas(write):
    text = SENSORS.replace(".", ",").replace("55,0", "55.0")
    assert read_log(write(BOM + text.encode())).channels[0].values[0] == 1510.4662


@pytest.mark.parametrize(
    ("culture", "order", "month"), [("en-US", "mdy", 5), ("en-GB", "dmy", 9), ("", None, 0)]
)
def test_the_culture_orders_the_date(write, culture, order, month):
    meta = META + (f"Culture: {culture} \n" if culture else "")
    path = write(BOM + (meta + SENSORS.replace("2026/5/19", "05/09/2026")).encode())
    if order is None:
        with pytest.raises(FileFormatError, match="can be read as day/month and as month/day"):
            read_log(path)
    else:
        log = read_log(path)
        assert (log.date_order, log.start.month) == (order, month)


def test_a_cut_row_of_sensors(write):
    with pytest.raises(FileFormatError, match="the last row is cut: found 2 of 4 columns") as caught:
        read_log(write(BOM + (META + SENSORS)[:-16].encode()))
    assert caught.value.line == 8


def test_a_slipped_row_of_sensors(write):
    text = SENSORS.replace("1510.4659\t\t21.6", "1510.4659\t21.6")
    with pytest.raises(FileFormatError, match="found 3 columns, expected 4") as caught:
        read_log(write(BOM + text.encode()))
    assert caught.value.line == 3


def peaks(
    culture="pt-PT", rows=((2, 1, 1510.1, 1522.2, 1560.3), (1, 1, 1510.1, 1560.4), (2, 0, 1510.2, 1522.3))
):
    comma = culture != "en-US"
    head = f"7\nCulture: {culture} \n{META}" + "".join(f"CH {n} Noise: 3.0\n" for n in range(60))
    lines = []
    for k, row in enumerate(rows):
        day = "19/05/2026" if comma else "05/19/2026"
        cells = [f"{day} 09:38:55.{k}0000", *(str(x) if isinstance(x, int) else f"{x:.5f}" for x in row)]
        lines.append(
            "\t".join(cell.replace(".", ",") if comma and i else cell for i, cell in enumerate(cells))
        )
    return head + "Timestamp\t# CH 1\t# CH 2\n" + "\n".join(lines) + "\n"


@pytest.mark.parametrize(("culture", "order"), [("pt-PT", "dmy"), ("en-US", "mdy")])
@pytest.mark.parametrize("encoding", ["latin-1", "utf-8-sig"])
def test_peaks(write, culture, order, encoding):
    log = read_log(write(peaks(culture), encoding=encoding))
    assert (log.format, log.date_order, log.header_line) == ("enlight-peaks", order, 67)
    assert log.decimal == ("," if order == "dmy" else ".")
    assert log.start == dt.datetime(2026, 5, 19, 9, 38, 55)
    found = {channel.name: channel.values for channel in log.channels}
    assert list(found) == ["CH1 peak1", "CH1 peak2", "CH2 peak1"]
    nan = np.nan
    np.testing.assert_array_equal(found["CH1 peak1"], [1510.1, 1510.1, 1510.2])
    np.testing.assert_array_equal(found["CH1 peak2"], [1522.2, nan, 1522.3])
    np.testing.assert_array_equal(found["CH2 peak1"], [1560.3, 1560.4, nan])
    assert {channel.unit for channel in log.channels} == {"nm"}
    assert "CH1 has 1 to 2 peaks; 1 rows have fewer than 2" in log.remarks


@pytest.mark.parametrize(
    ("row", "match"),
    [
        ((2, 1, 1510.1, 1560.3), "announce 3 wavelengths, found 2"),
        ((1, 0, 1510.1, 1560.3), "announce 1 wavelengths, found 2"),
    ],
)
def test_counts_that_disagree_with_the_row(write, row, match):
    whole = (2, 1, 1510.1, 1522.2, 1560.3)
    with pytest.raises(FileFormatError, match=match) as caught:
        read_log(write(peaks(rows=(whole, row, whole))))
    assert caught.value.line == 69


def test_a_cut_last_row_of_peaks(write):
    text = peaks(rows=((2, 1, 1510.1, 1522.2, 1560.3),) * 3)
    with pytest.raises(FileFormatError, match="the last row is cut") as caught:
        read_log(write(text[: text.rindex("\t")] + "\n"))
    assert caught.value.line == 70


def test_counts_that_a_spreadsheet_has_lost(write):
    with pytest.raises(FileFormatError, match="the number of peaks of a channel is not a whole number"):
        read_log(write(peaks(rows=((1510.1, 1522.2, 1560.3),) * 3)))


def test_no_peak_at_all(write):
    with pytest.raises(FileFormatError, match="no peak in any of them"):
        read_log(write(peaks(rows=((0, 0),) * 3)))


def test_a_grating_that_was_never_seen_is_still_a_wavelength(write):
    lost = SENSORS.replace("1522.4686", "").replace("1522.4702", "0.0000")
    log = read_log(write(BOM + lost.encode()))
    assert [channel.unit for channel in log.channels] == ["nm", "nm", ""]
