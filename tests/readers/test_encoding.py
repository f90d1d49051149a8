from __future__ import annotations

import pytest

from tethertest.errors import FileFormatError
from tethertest.readers import read_log
from tethertest.readers.tables.text.encoding import detect_encoding, encoding_of_blocks

CHINESE = "时间(s),拉力(千牛),应变(微应变)\n"


@pytest.mark.parametrize(
    ("text", "written", "found"),
    [
        ("time,F\n0,1\n", "ascii", "ascii"),
        ("Längenänderung [µm]\n", "utf-8", "utf-8"),
        ("time,F\n", "utf-8-sig", "utf-8-sig"),
        ("time\tF\n0\t1\n", "utf-16", "utf-16"),
        ("time\tF\n0\t1\n", "utf-16-le", "utf-16-le"),
        ("time\tF\n0\t1\n", "utf-16-be", "utf-16-be"),
        ("Temperatur [°C]\tDehnung [µm/m]\n", "cp1252", "cp1252"),
        ("Größe [mm], créé à Évreux\n", "cp1252", "cp1252"),
        ("時間[s],張力[N]\n", "cp932", "cp932"),
        ("Größe ‚a‘ … ƒ\n", "cp1252", "cp1252"),
        (CHINESE, "gb18030", "gb18030"),
        ("温度(℃)\t拉力(N)\n", "gb18030", "gb18030"),
    ],
)
def test_encoding_is_found_by_content(text, written, found):
    assert detect_encoding(text.encode(written)) == found


def test_a_beginning_that_stops_inside_a_character():
    data = ("a" * 9 + "µ").encode()
    assert detect_encoding(data[:-1]) == "cp1252"
    assert detect_encoding(data[:-1], complete=False) == "utf-8"


def test_binary_is_no_text():
    assert detect_encoding(b"\x7fELF" + bytes(range(32)) * 20) is None


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be", "gb18030"])
@pytest.mark.parametrize("line_end", ["\n", "\r\n", "\r"])
def test_chinese_logs_in_every_encoding(write, encoding, line_end):
    rows = "0.0,5.25,-12.5\n0.1,5.50,-13.5\n"
    log = read_log(write(CHINESE + rows, encoding=encoding, line_end=line_end))
    assert [channel.name for channel in log.channels] == ["拉力", "应变"]
    assert [channel.unit for channel in log.channels] == ["千牛", "微应变"]
    assert log.channels[1].values.tolist() == [-12.5, -13.5]
    assert log.channels[0].time.tolist() == [0.0, 0.1]
    assert log.encoding == encoding
    assert log.header_line == 1


def test_western_units_in_a_table_of_an_old_logger(write):
    log = read_log(write("time [s];T [°C];e [µm/m]\n0,0;20,5;-1,5\n0,1;20,6;-1,6\n", encoding="cp1252"))
    assert [channel.unit for channel in log.channels] == ["°C", "µm/m"]
    assert (log.encoding, log.decimal, log.separator) == ("cp1252", ",", ";")


def test_a_byte_that_turns_up_after_the_beginning(write):
    rows = "".join(f"{k}\t{k % 7}.5\n" for k in range(20000))
    data = ("time [s]\tF [N]\n" + rows).encode() + b"# 20 \xb0C\n" + b"20000\t1.5\n"
    log = read_log(write(data))
    assert log.encoding == "cp1252"
    assert log.channels[0].values.size == 20001


def test_a_codec_that_is_not_for_text_is_refused(write, settings):
    path = write("time [s];heave [mm]\n0;1\n1;2\n")
    with pytest.raises(FileFormatError, match="idna"):
        read_log(path, settings(encoding="idna"))


@pytest.mark.parametrize("size", [1, 2, 3, 5, 8, 100])
@pytest.mark.parametrize(
    ("text", "written"),
    [
        ("time,F\n0,1\n", "ascii"), ("Längenänderung [µm]\n", "utf-8"), ("°C: ÀÁ\n", "cp1252"),
        ("Größe [mm], créé à Évreux\n", "cp1252"), (CHINESE, "utf-8"), (CHINESE, "gb18030"),
        ("時間[s],張力[N]\n", "cp932"), ("荷重 ソ", "cp932"),
        ("°C ÀÁ 20 °", "cp1252"), ("温度(℃)\t拉力", "gb18030"),
    ],
)  # fmt: skip
def test_an_encoding_that_shows_late_is_that_of_the_whole_text(text, written, size):
    data = b"0,1\n" * 5 + text.encode(written)
    blocks = [data[begin : begin + size] for begin in range(0, len(data), size)]
    assert encoding_of_blocks(blocks) == detect_encoding(data) == written


@pytest.mark.parametrize(("encoding", "lost"), [("utf-8", 1), ("utf-16-le", 1), ("gb18030", 1)])
def test_a_log_that_is_cut_inside_a_character_is_refused(write, encoding, lost):
    data = (CHINESE + "0.0,5.25,-12.5\n0.1,5.50,-13.5\n" * 6000 + "# 拉").encode(encoding)
    with pytest.raises(FileFormatError, match="does not belong to the encoding") as caught:
        read_log(write(data[:-lost]))
    assert caught.value.line == 12002


def test_a_byte_of_another_encoding_far_down_names_its_line(write):
    data = CHINESE.encode() + b"0.0,5.25,-12.5\n" * 9000 + b"# 20 \xb0C\n" + b"0.0,5.25,-12.5\n"
    with pytest.raises(FileFormatError, match="byte 0xb0 does not belong to the encoding utf-8") as caught:
        read_log(write(data))
    assert caught.value.line == 9002
