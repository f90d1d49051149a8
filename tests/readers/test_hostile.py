"""Archives that lie about themselves or ask for more than a log holds."""

from __future__ import annotations

import gzip
import io
import struct
import zipfile

import pytest

from tethertest.errors import FileFormatError
from tethertest.readers import read_log
from tethertest.readers.guards import zips

GOOD = "time [s],F [N]\n0.0,1.5\n0.5,2.5\n1.0,3.5\n"


def packed(**files):
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in files.items():
            archive.writestr(name, data)
    return buffer.getvalue()


def test_a_member_is_named(write, settings):
    path = write(packed(**{"a/log.csv": GOOD, "notes.txt": "n"}), "two.zip")
    with pytest.raises(
        FileFormatError, match=r"zip archive of 2 files: 'a/log.csv', 'notes.txt'\n.*table = "
    ):
        read_log(path)
    log = read_log(path, settings(table="a/log.csv"))
    assert (log.path, log.format, log.channels[0].values.tolist()) == (path, "delimited", [1.5, 2.5, 3.5])


@pytest.mark.parametrize("name", ["../x.csv", "/x.csv", "C:\\x.csv"])
def test_names_that_lead_out_are_no_logs(write, settings, name):
    path = write(packed(**{name: GOOD, "a.csv": GOOD, "b.csv": GOOD}), "p.zip")
    with pytest.raises(FileFormatError, match=r"archive of 2 files: 'a.csv', 'b.csv', and run.toml says"):
        read_log(path, settings(table=name))


@pytest.mark.parametrize("pack", [gzip.compress, lambda data: packed(x=data)])
def test_bombs_stop_at_the_ratio(write, pack, monkeypatch):
    monkeypatch.setattr(zips, "RATIO_FROM", 2**16)
    with pytest.raises(FileFormatError, match="unpacks to more than 200 times its size"):
        read_log(write(pack(GOOD.encode() + b"0,1\n" * 10**6), "bomb"))


def test_an_archive_in_an_archive_is_refused(write):
    with pytest.raises(FileFormatError, match="an archive inside another"):
        read_log(write(packed(inner=packed(a=GOOD, b=GOOD)), "nested.zip"))


def test_an_encrypted_member_is_told(write):
    data = bytearray(packed(a=GOOD))
    data[data.rfind(b"PK\x01\x02") + 8] |= 1
    with pytest.raises(FileFormatError, match="'a' in the archive is encrypted"):
        read_log(write(bytes(data), "e.zip"))


def test_a_size_that_is_too_small_is_damage(write):
    data = bytearray(packed(a=GOOD))
    struct.pack_into("<I", data, data.rfind(b"PK\x01\x02") + 24, 10)
    with pytest.raises(FileFormatError, match="damaged or cut"):
        read_log(write(bytes(data), "s.zip"))
