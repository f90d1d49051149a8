from __future__ import annotations

import hashlib
import importlib
import inspect
import pkgutil
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from tethertest.errors import FileFormatError
from tethertest.readers import READERS, formats, identify, read_log, registry
from tethertest.readers.tables.text.document import Head, read_head
from tethertest.records.run import DEFAULT

LVM_HEAD = "LabVIEW Measurement\t\nWriter_Version\t2\n"


def test_every_module_with_a_name_is_registered_once():
    modules = [
        importlib.import_module(f"tethertest.readers.formats.{found.name}")
        for found in pkgutil.iter_modules(formats.__path__)
    ]
    named = {module.NAME for module in modules if hasattr(module, "NAME")}
    registered = [reader.NAME for reader in READERS]
    assert sorted(named) == sorted(registered)


@pytest.mark.parametrize("reader", READERS, ids=lambda reader: reader.NAME)
def test_readers_share_one_signature(reader):
    sniff, read = inspect.signature(reader.sniff), inspect.signature(reader.read)
    assert list(sniff.parameters) == ["head"]
    assert list(read.parameters) == ["path", "settings"]
    assert read.parameters["settings"].default is DEFAULT
    assert read.return_annotation == "RawLog"


def test_the_generic_reader_is_last():
    assert READERS[-1] is registry.GENERIC
    assert READERS[-1].NAME == "delimited"


def test_two_claims_are_an_error_that_names_both(write, monkeypatch):
    twin = SimpleNamespace(NAME="twin", USES=frozenset(), sniff=lambda head: "it looks like mine", read=None)
    monkeypatch.setattr(registry, "READERS", (twin, *READERS))
    path = write(LVM_HEAD)
    with pytest.raises(FileFormatError, match=r"more than one reader claims.*'twin'.*'lvm'"):
        identify(path)


def test_the_settings_choose_among_two_claims(write, monkeypatch, settings):
    twin = SimpleNamespace(NAME="twin", USES=frozenset(), sniff=lambda head: "it looks like mine", read=None)
    monkeypatch.setattr(registry, "READERS", (twin, *READERS))
    assert identify(write(LVM_HEAD), settings(format="lvm")).NAME == "lvm"


def test_a_format_that_does_not_fit_names_the_right_one(write, settings):
    with pytest.raises(FileFormatError, match=r"says format 'catman', but the file is lvm"):
        read_log(write(LVM_HEAD), settings(format="catman"))


def test_an_unknown_format_lists_the_known_ones(write, settings):
    with pytest.raises(FileFormatError, match=r"format 'labview' is not known\n  fix: use one of lvm, tdms"):
        read_log(write(LVM_HEAD), settings(format="labview"))


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1\0\0", "an old Office document"),
        (bytes(range(256)) * 4, "a binary file of unknown kind"),
    ],
)
def test_binary_files_are_refused_by_what_they_are(write, data, words):
    with pytest.raises(FileFormatError, match=f"found {words}, expected a log"):
        read_log(write(data, "log.bin"))


@pytest.mark.parametrize(
    ("head", "name"),
    [
        ('"TOA5","Logger","CR1000X"\n"TIMESTAMP","RECORD","F"\n"TS","RN","N"\n"","","Min"\n', "toa5"),
        ("Date\tTime\tLinenumber\tError status\tW-01\n2022-04-14\t\t1\t0;0\t108.8\n", "fbgs"),
    ],
)
def test_layouts_that_the_generic_reader_would_misread_have_their_own(write, head, name):
    assert name == identify(write(head)).NAME


@pytest.mark.parametrize("compression", ["", "gz", "zip"])
def test_a_file_is_recognised_by_content_through_compression(write, compression):
    path = write(LVM_HEAD, "renamed.csv", compression=compression)
    assert identify(path).NAME == "lvm"


def test_a_header_of_104_lines_is_passed(write):
    meta = "".join(f"CH {n} Configuration: Threshold=2.0 Minimum=1525.0 Maximum=1555.0\n" for n in range(104))
    path = write(meta + "Timestamp\t# CH 1\n2026/5/19 09:38:55.04646\t1\t1550.1\n")
    assert identify(path).NAME == "enlight-peaks"


def test_the_head_holds_lines_without_ends(write):
    head = read_head(write("a,b\r\n1,2\r\n"))
    assert isinstance(head, Head)
    assert head.lines[:2] == ("a,b", "1,2")
    assert head.encoding == "ascii"


def test_the_log_keeps_the_hash_of_the_file_on_disk_and_the_reason(write):
    path = write("time [s],F [N]\n0,1\n1,2\n", compression="gz")
    log = read_log(path)
    assert log.sha256 == hashlib.sha256(path.read_bytes()).hexdigest()
    assert log.reason == "text that no format reader claims; it begins with 'time [s],F [N]'"


def test_channels_are_read_only(write):
    channel = read_log(write("time [s],F [N]\n0,1\n1,2\n")).channels[0]
    assert channel.values.dtype == np.float64
    with pytest.raises(ValueError, match="read-only"):
        channel.values[0] = 3.0


def test_heavy_packages_wait_until_a_log_is_read():
    script = (
        "import sys, tethertest.readers;"
        "print([name for name in ('pandas', 'nptdms', 'pint', 'scipy') if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


@pytest.mark.parametrize(
    ("name", "keys"),
    [
        ("tdms", {"decimal": ","}),
        ("tdms", {"encoding": "cp1252"}),
        ("lvm", {"skip_rows": 3}),
        ("lvm", {"rate": 100.0}),
        ("catman", {"separator": ";"}),
        ("toa5", {"skip_rows": 1}),
        ("fbgs", {"separator": ";"}),
    ],
)
def test_a_key_that_a_reader_would_pass_over_is_refused(settings, name, keys):
    reader = next(reader for reader in READERS if name == reader.NAME)
    (key,) = keys
    with pytest.raises(FileFormatError, match=rf"{key} is set, which the reader of {name} logs does not use"):
        registry.refuse_keys(Path("log.txt"), reader, settings(**keys))


@pytest.mark.parametrize(
    ("name", "keys"),
    [
        ("delimited", {"decimal": ",", "separator": ";", "skip_rows": 3, "date_order": "dmy"}),
        ("lvm", {"decimal": ",", "separator": "tab", "date_order": "dmy", "encoding": "cp1252"}),
        ("catman", {"decimal": ",", "date_order": "dmy", "rate": 50.0}),
        ("tdms", {"time_zone": "+08:00", "units": {"F": "N"}}),
        ("archive", {"decimal": ",", "table": "a.csv"}),
    ],
)
def test_the_keys_that_a_reader_uses_are_not_refused(settings, name, keys):
    reader = next(reader for reader in READERS if name == reader.NAME)
    registry.refuse_keys(Path("log.txt"), reader, settings(**keys))


KEYS = {
    "encoding": "cp1252", "decimal": ",", "separator": ";", "date_order": "dmy", "skip_rows": 1, "table": "a",
    "time_zone": "UTC", "units": {"F": "N"}, "columns": ("t", "F"), "time": "t", "rate": 1.0,
}  # fmt: skip


@pytest.mark.parametrize("key", KEYS)
@pytest.mark.parametrize("reader", READERS, ids=lambda reader: reader.NAME)
def test_a_reader_takes_the_keys_that_it_says_and_refuses_the_others(settings, reader, key):
    assert set(KEYS) >= reader.USES
    given = settings(**{key: KEYS[key]})
    if key in reader.USES:
        registry.refuse_keys(Path("log"), reader, given)
        return
    with pytest.raises(FileFormatError, match=f"{key} is set, which the reader of") as caught:
        registry.refuse_keys(Path("log"), reader, given)
    assert caught.value.keys == (key,)
