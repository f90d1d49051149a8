"""A file appears whole or not at all, and what a dead process left goes with the next write."""

from __future__ import annotations

import os
import resource
import stat
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from tethertest.errors import TethertestError
from tethertest.records.channel import ConditionedRun
from tethertest.store import StoreHeader, load_store, write_store, written_whole
from tethertest.store.whole import WholeFile, remove_stale


def names(folder: Path) -> set[str]:
    return {path.name for path in folder.iterdir()}


@contextmanager
def largest_file(size: int) -> Iterator[None]:
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


def test_until_the_end_the_old_file_stands(tmp_path: Path) -> None:
    target = tmp_path / "deep" / "run.h5"
    for text in (b"old", b"new"):
        with written_whole(target) as file:
            before = target.read_bytes() if target.exists() else None
            file.write(text)
            assert (target.read_bytes() if target.exists() else None) == before
        assert target.read_bytes() == text
    assert names(target.parent) == {"run.h5"}


def test_an_error_inside_leaves_the_old_file_and_no_trace(tmp_path: Path) -> None:
    target = tmp_path / "run.h5"
    target.write_bytes(b"old")
    with pytest.raises(ZeroDivisionError), written_whole(target) as file:
        file.write(bytes(1 // (file.write(b"half") - 4)))
    assert (names(tmp_path), target.read_bytes()) == ({"run.h5"}, b"old")


def test_the_store_is_never_half_at_any_file_size(
    tmp_path: Path, measured: ConditionedRun, header: StoreHeader
) -> None:
    target = tmp_path / "run.h5"
    write_store(target, header, measured)
    size = target.stat().st_size
    old = ConditionedRun((), (), (), None, None, None)
    write_store(target, header, old)
    before = target.read_bytes()
    for limit in (0, 1, 100, *range(2048, size, size // 23), size - 1):
        with largest_file(limit), pytest.raises(TethertestError, match="cannot be written") as refused:
            write_store(target, header, measured)
        assert "ulimit" in refused.value.remedy
        assert (names(tmp_path), target.read_bytes()) == ({"run.h5"}, before), limit
    with largest_file(size):
        write_store(target, header, measured)
    assert load_store(target).measured.findings == measured.findings


def test_a_failed_write_is_kept_and_told_at_the_next_check() -> None:
    with WholeFile("/dev/full", "r+b") as file:
        assert file.write(b"x" * 10_000) == 10_000
        with pytest.raises(OSError, match="No space left"):
            file.check()


def test_what_a_killed_process_left_goes_and_nothing_else(tmp_path: Path) -> None:
    code = (
        "import os, pathlib, sys\nfrom tethertest.store import written_whole\n"
        f"with written_whole(pathlib.Path({str(tmp_path / 'run.h5')!r})) as file:\n"
        "    file.write(b'x' * 100)\n    print('writing', flush=True)\n    sys.stdin.read()\n"
    )
    process = subprocess.Popen(
        [sys.executable, "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    assert process.stdout is not None
    assert process.stdin is not None
    assert process.stdout.readline() == "writing\n"
    (partial,) = names(tmp_path)
    others = {".run.h5.123.partial", ".notes.partial", "run.h5.0123456789abcdef.partial", "tension.csv"}
    for name in others:
        (tmp_path / name).write_bytes(b"mine")
    remove_stale(tmp_path)
    assert names(tmp_path) == others | {partial}  # it is still being written
    process.kill()
    process.wait()
    process.stdin.close()
    process.stdout.close()
    with written_whole(tmp_path / "other.csv") as file:
        file.write(b"next")
    assert names(tmp_path) == others | {"other.csv"}


def test_of_two_writers_the_last_one_wins_whole(tmp_path: Path) -> None:
    target = tmp_path / "run.h5"
    with written_whole(target) as first:
        first.write(b"first, and longer")
        with written_whole(target) as second:
            second.write(b"second")
        assert target.read_bytes() == b"second"
    assert (names(tmp_path), target.read_bytes()) == ({"run.h5"}, b"first, and longer")


def test_a_link_keeps_pointing_to_the_file(tmp_path: Path) -> None:
    (tmp_path / "there").mkdir()
    (tmp_path / "link.h5").symlink_to(tmp_path / "there" / "run.h5")
    with written_whole(tmp_path / "link.h5") as file:
        file.write(b"x")
    assert (tmp_path / "link.h5").is_symlink()
    assert (tmp_path / "there" / "run.h5").read_bytes() == b"x"


def test_places_that_cannot_be_written_are_told_with_a_remedy(tmp_path: Path) -> None:
    (tmp_path / "file").write_bytes(b"")
    (tmp_path / "folder").mkdir()
    for target in (tmp_path / "file" / "run.h5", tmp_path / "folder", tmp_path / ("n" * 300)):
        with pytest.raises(TethertestError) as refused, written_whole(target):
            pass
        assert refused.value.remedy
        assert "-o" in refused.value.remedy
    assert names(tmp_path) == {"file", "folder"}


def test_what_reaches_the_name_has_reached_the_disk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The order is: file synchronised, renamed, folder synchronised."""
    seen: list[str] = []
    sync, rename = os.fsync, Path.replace

    def noted_sync(descriptor: int) -> None:
        seen.append("folder" if stat.S_ISDIR(os.fstat(descriptor).st_mode) else "file")
        sync(descriptor)

    def noted_rename(self: Path, target: Path) -> Path:
        seen.append("rename")
        return rename(self, target)

    monkeypatch.setattr(os, "fsync", noted_sync)
    monkeypatch.setattr(Path, "replace", noted_rename)
    with written_whole(tmp_path / "run.h5") as file:
        file.write(b"x")
    assert seen == ["file", "rename", "folder"]
