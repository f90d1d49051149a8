"""A file that hangs or kills the library that reads it is refused, and the next one is read."""

from __future__ import annotations

import io
import os
import struct
import textwrap
from pathlib import Path

import h5py
import numpy as np
import pytest

from tethertest.errors import FileFormatError
from tethertest.readers import read_log
from tethertest.readers.guards import sandboxed_read

#: a reader that never ends on "hang", dies on "die", refuses "bad", and is done with anything else
READER = textwrap.dedent("""
    import os, time
    from tethertest.errors import FileFormatError

    def read_everything(path):
        if path.name == "hang":
            time.sleep(60)
        if path.name == "die":
            os._exit(139)
        if path.name == "bad":
            raise FileFormatError("it is bad", "mend it", path=path)
""")


@pytest.fixture
def reader(tmp_path, monkeypatch):
    """Return the name of a module that another process can run."""
    (tmp_path / "odd_reader.py").write_text(READER)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path) + os.pathsep + os.environ.get("PYTHONPATH", ""))
    for name in ("hang", "die", "bad", "Größe ok"):
        (tmp_path / name).touch()
    yield "odd_reader"
    if "odd_reader" in sandboxed_read._children:
        sandboxed_read._end("odd_reader")


def test_the_same_process_serves_every_file(reader, tmp_path):
    sandboxed_read.read_in_sandbox(tmp_path / "Größe ok", reader, "json")
    first = sandboxed_read._children[reader].pid
    sandboxed_read.read_in_sandbox(tmp_path / "Größe ok", reader, "json")
    assert sandboxed_read._children[reader].pid == first


@pytest.mark.parametrize(("name", "words"), [("hang", "did not end in 1 s"), ("die", "died of it")])
def test_what_hangs_or_dies_is_refused_and_the_next_file_is_read(reader, tmp_path, monkeypatch, name, words):
    sandboxed_read.read_in_sandbox(tmp_path / "Größe ok", reader, "json")
    monkeypatch.setattr(sandboxed_read, "_PATIENCE", 1.0)
    with pytest.raises(FileFormatError, match=words):
        sandboxed_read.read_in_sandbox(tmp_path / name, reader, "json")
    monkeypatch.undo()
    assert reader not in sandboxed_read._children


def test_what_the_other_process_refuses_is_refused(reader, tmp_path):
    with pytest.raises(FileFormatError, match="it is bad") as caught:
        sandboxed_read.read_in_sandbox(tmp_path / "bad", reader, "json")
    assert caught.value.remedy == "mend it"
    sandboxed_read.read_in_sandbox(tmp_path / "Größe ok", reader, "json")


def test_a_reader_that_does_not_start_is_told(tmp_path):
    (tmp_path / "log").touch()
    with pytest.raises(FileFormatError, match="did not start"):
        sandboxed_read.read_in_sandbox(tmp_path / "log", "no_such_reader", "json")
    assert "no_such_reader" not in sandboxed_read._children


def test_a_process_that_was_killed_from_outside_is_replaced(reader, tmp_path):
    sandboxed_read.read_in_sandbox(tmp_path / "Größe ok", reader, "json")
    sandboxed_read._children[reader].kill()
    sandboxed_read._children[reader].wait()
    sandboxed_read.read_in_sandbox(tmp_path / "Größe ok", reader, "json")


def test_an_address_that_leads_hdf5_in_a_circle_is_refused(tmp_path, monkeypatch):
    """The heap of texts of variable length says that its next object is 0 bytes further on."""
    buffer = io.BytesIO()
    with h5py.File(buffer, "w") as file:
        force = file.create_dataset("force", data=np.arange(50.0))
        force.attrs["unit"] = "N"
    data = bytearray(buffer.getvalue())
    heap = data.index(b"GCOL")
    assert data.count(b"GCOL") == 1
    data[heap + 16 : heap + 48] = bytes(32)
    path = tmp_path / "log.h5"
    path.write_bytes(data)
    monkeypatch.setattr(sandboxed_read, "_PATIENCE", 2.0)
    with pytest.raises(FileFormatError, match="reading it did not end in 2 s"):
        read_log(path)


def with_unit(path):
    buffer = io.BytesIO()
    with h5py.File(buffer, "w") as file:
        file.create_dataset("time", data=np.arange(50.0)).attrs["unit"] = "s"
        file["force"] = np.arange(50.0)
    data = bytearray(buffer.getvalue())
    path.write_bytes(data)
    return data


@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="no memory of a process to look up")
def test_a_text_that_says_it_has_two_gigabytes_does_not_get_them(tmp_path):
    """The length of a text of variable length lies in the header of its attribute."""
    path = tmp_path / "log.h5"
    data = with_unit(path)
    assert [channel.name for channel in read_log(path).channels] == ["force"]
    place = data.index(struct.pack("<IQI", 1, data.index(b"GCOL"), 1))
    data[place + 3] = 0x80
    path.write_bytes(data)
    with pytest.raises(FileFormatError, match=r"allocat|memory"):
        read_log(path)
    pid = sandboxed_read._children["tethertest.readers.formats.hdf5"].pid
    status = Path(f"/proc/{pid}/status").read_text(encoding="ascii").splitlines()
    peak = next(line for line in status if line.startswith("VmHWM"))
    assert int(peak.split()[1]) < 1_300_000
