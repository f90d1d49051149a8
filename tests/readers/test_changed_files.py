"""A log that changes while it is read: refused, whatever the reader made of it."""

import os
import pickle

import pytest

from tethertest.errors import FileFormatError
from tethertest.readers import read_log
from tethertest.readers.formats import delimited
from tethertest.readers.streaming import stream_log
from tethertest.records.run import DEFAULT

TEXT = "time [s],F [N]\n" + "".join(f"{row / 10},{row % 7}\n" for row in range(60))
CHANGED = "changed while it was read"


@pytest.fixture
def log(write):
    return write(TEXT)


def append(path, text="6.0,5\n"):
    with path.open("a") as stream:
        stream.write(text)


def rewrite(path):
    """Change one digit and nothing else that a listing of the folder shows but the time."""
    with path.open("r+") as stream:
        stream.write("Time")
    status = path.stat()
    os.utime(path, ns=(status.st_atime_ns, status.st_mtime_ns + 1000))


CHANGES = {"it grows": append, "it is written again": rewrite, "it is removed": lambda path: path.unlink()}


@pytest.fixture(params=CHANGES)
def change(request):
    return CHANGES[request.param]


@pytest.fixture
def meddled(monkeypatch, log):
    """Change the file once the reader has read it."""

    def meddle(change, *, refuse=False):
        read = delimited.read

        def slow(path, settings=DEFAULT):
            result = read(path, settings)
            change(path)
            if refuse:
                message = "the last row is cut"
                raise FileFormatError(message, "copy the log again", path=path)
            return result

        monkeypatch.setattr(delimited, "read", slow)
        return log

    return meddle


def test_a_file_that_changes_under_the_reader_is_refused(meddled, change):
    path = meddled(change)
    with pytest.raises(FileFormatError, match=r"(changed|was removed) while it was read") as caught:
        read_log(path)
    assert "wait until the logger" in caught.value.remedy


def test_the_change_is_said_instead_of_what_it_looks_like(meddled):
    path = meddled(append, refuse=True)
    with pytest.raises(FileFormatError, match=rf"{CHANGED}; it had 375 bytes and has 381"):
        read_log(path)


def test_a_mistake_in_a_file_that_stays_is_said_as_it_is(meddled):
    path = meddled(lambda path: None, refuse=True)
    with pytest.raises(FileFormatError, match="the last row is cut"):
        read_log(path)


def test_pieces_of_a_file_that_grows_are_refused_at_the_end(log):
    pieces = stream_log(log, rows=20)
    next(pieces)
    append(log)
    with pytest.raises(FileFormatError, match=CHANGED):
        list(pieces)


def test_the_hash_of_another_file_is_not_given(log, change):
    read = read_log(log)
    change(log)
    with pytest.raises(FileFormatError, match=r"changed while it was read|can no longer be read"):
        _ = read.sha256


def test_a_hash_once_taken_is_kept(log, change):
    read = read_log(log)
    digest = read.sha256
    change(log)
    assert read.sha256 == digest
    assert pickle.loads(pickle.dumps(read)).sha256 == digest


def test_a_reader_called_by_itself_takes_no_hash(log):
    assert delimited.read(log).sha256 == ""
