"""Files that no ingest wrote: each is refused with its path and the object, and opens nothing else."""

from __future__ import annotations

import tracemalloc
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

from tethertest.errors import FileFormatError
from tethertest.records.channel import ConditionedRun
from tethertest.store import StoreHeader, is_store, load_store, write_store, written_whole
from tethertest.store.seal import seal

TOP = "channels/a%2Fb"


def _replaced(file: Any, name: str, **settings: Any) -> None:
    del file[name]
    file.create_dataset(name, **settings)


def _set(place: str, key: str, value: Any) -> Callable[[Any], None]:
    def change(file: Any) -> None:
        file[place].attrs[key] = value

    return change


def _without(name: str) -> Callable[[Any], None]:
    def change(file: Any) -> None:
        del file[name]

    return change


def _without_attribute(place: str, key: str) -> Callable[[Any], None]:
    def change(file: Any) -> None:
        del file[place].attrs[key]

    return change


def _link(name: str, link: Any) -> Callable[[Any], None]:
    def change(file: Any) -> None:
        del file[name]
        file[name] = link

    return change


def _virtual(file: Any) -> None:
    layout = h5py.VirtualLayout(shape=(1,), dtype="<f8")
    layout[:] = h5py.VirtualSource("/etc/hostname", "x", shape=(1,))
    del file[f"{TOP}/value"]
    file.create_virtual_dataset(f"{TOP}/value", layout)


def _elsewhere(file: Any) -> None:
    _replaced(file, f"{TOP}/value", shape=(1,), dtype="<f8", external=[("/etc/hostname", 0, 8)])


def sealed_again(path: Path) -> None:
    """Give a changed file a right checksum, as somebody would who means harm."""
    content = path.read_bytes()
    with written_whole(path) as file:
        file.write(content)
        seal(file)


HOSTILE: dict[str, tuple[Callable[[Any], None], str]] = {
    "external link": (_link(f"{TOP}/value", h5py.ExternalLink("/etc/hostname", "/x")), "an external link"),
    "external group": (_link("channels", h5py.ExternalLink("other.h5", "/")), "/channels: found an external"),
    "soft link": (_link(f"{TOP}/time", h5py.SoftLink("/channels/a%2Fb/value")), "time: found a soft link"),
    "dangling link": (_link("windows", h5py.SoftLink("/nowhere")), "/windows: found a soft link"),
    "virtual": (_virtual, "samples lie in another file"),
    "external storage": (_elsewhere, "samples lie in another file"),
    "unequal": (lambda f: _replaced(f, f"{TOP}/time", data=np.arange(3.0)), "time has 3, value has 1"),
    "table": (lambda f: _replaced(f, f"{TOP}/value", data=np.zeros((1, 2))), r"found shape \(1, 2\)"),
    "scalar": (lambda f: _replaced(f, f"{TOP}/value", data=1.0), r"found shape \(\)"),
    "wrong type": (lambda f: _replaced(f, f"{TOP}/value", data=np.zeros(1, "f4")), "found type float32"),
    "text": (lambda f: _replaced(f, f"{TOP}/time", data=["a"]), "found type object"),
    "huge": (
        lambda f: _replaced(f, f"{TOP}/value", shape=(1 << 40,), chunks=(4096,), dtype="<f8"),
        "more than any run has",
    ),
    "declared only": (
        lambda f: _replaced(f, f"{TOP}/value", shape=(1 << 30,), chunks=(1 << 20,), dtype="<f8"),
        "not all of it was written",
    ),
    "declared in one piece": (
        lambda f: _replaced(f, f"{TOP}/value", shape=(1 << 30,), dtype="<f8"),
        "not all of it was written",
    ),
    "filter": (
        lambda f: _replaced(f, f"{TOP}/value", data=np.zeros(1), chunks=(1,), compression="lzf"),
        "found filter 32000",
    ),
    "group for data": (
        lambda f: (_without(f"{TOP}/flag")(f), f.create_group(f"{TOP}/flag")),
        "found a group, expected a dataset",
    ),
    "no time": (_without(f"{TOP}/time"), "/channels/a%2Fb/time: missing"),
    "no clocks": (_without("clocks"), "/clocks: missing"),
    "channel not listed": (lambda f: f.create_group("channels/extra"), "not those that it lists: extra"),
    "channel gone": (_without(TOP), "not those that it lists: a%2Fb"),
    "newer": (_set("/", "format_version", 2), "found 2, this version reads 1"),
    "no version": (_without_attribute("/", "format_version"), "/@format_version: found nothing"),
    "hashes of fewer files": (
        lambda f: f.attrs.__setitem__("input_sha256", ["00" * 32]),
        "/@input_sha256: found 1, expected 2",
    ),
    "other format": (_set("/", "format", "somebody-else"), "found format 'somebody-else'"),
    "kind": (_set(TOP, "kind", "colour"), "found 'colour', expected one of tension"),
    "number is text": (_set(TOP, "noise", "loud"), "/channels/a%2Fb@noise: found 'loud', expected a number"),
    "number is nan": (_set(TOP, "noise", np.nan), "expected a number"),
    "unit is a number": (_set(TOP, "unit", 3), "expected text"),
    "severity": (
        lambda f: _replaced(f, "findings/severity", data=["a", "b", "c"], dtype=h5py.string_dtype()),
        "/findings/severity: found 'a'",
    ),
    "span of nothing": (
        lambda f: _replaced(f, "findings/span_of", data=np.array([0, 9, 2])),
        "/findings/span_of: found 9",
    ),
    "window": (_set("windows/steady", "stop", -1e9), "expected a span of time"),
    "unknown window": (lambda f: f.create_group("windows/lunch"), "/windows/lunch"),
    "unknown flag": (
        lambda f: f["channels/%2E%2E/flag"].__setitem__(3, 0x8000),
        "/channels/%2E%2E/flag: found bits 0x8000",
    ),
    "backwards": (
        lambda f: f["channels/%2E%2E/time"].write_direct(np.arange(31.0)[::-1].copy()),
        "/channels/%2E%2E/time: time does not increase",
    ),
}


@pytest.mark.parametrize("name", HOSTILE)
def test_a_hostile_store_is_refused(
    name: str, tmp_path: Path, measured: ConditionedRun, header: StoreHeader
) -> None:
    path = tmp_path / "run.h5"
    write_store(path, header, measured)
    change, said = HOSTILE[name]
    with h5py.File(path, "r+") as file:
        change(file)
    sealed_again(path)
    tracemalloc.start()
    with pytest.raises(FileFormatError, match=said) as refused:
        load_store(path)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert refused.value.path == str(path)
    assert refused.value.remedy
    assert peak < 20e6


@pytest.mark.parametrize("kept", [0, 1, 8, 96, 2000, 100_000, -1])
@pytest.mark.parametrize("sealed", [False, True])
def test_a_cut_store_is_refused(
    kept: int, sealed: bool, tmp_path: Path, measured: ConditionedRun, header: StoreHeader
) -> None:
    path = tmp_path / "run.h5"
    write_store(path, header, measured)
    path.write_bytes(path.read_bytes()[: kept if not sealed or kept > 0 else 5000])
    if sealed:
        sealed_again(path)
    with pytest.raises(FileFormatError, match=r"no HDF5 file|cut or changed|damaged"):
        load_store(path)


def test_no_changed_byte_passes(tmp_path: Path, measured: ConditionedRun, header: StoreHeader) -> None:
    """Not even in a number that would read as well as the right one."""
    path = tmp_path / "run.h5"
    write_store(path, header, measured)
    content = path.read_bytes()
    for place in range(len(content) - 1, 8, -(len(content) // 50)):
        changed = bytearray(content)
        changed[place] ^= 0x01
        path.write_bytes(changed)
        with pytest.raises(FileFormatError, match=r"damaged or was changed|cut or changed"):
            load_store(path)


def test_damaged_samples_are_found_by_gzip_too(
    tmp_path: Path, measured: ConditionedRun, header: StoreHeader
) -> None:
    path = tmp_path / "run.h5"
    write_store(path, header, measured)
    with h5py.File(path) as file:
        chunk = file["channels/%E6%8B%89%E5%8A%9B%2Ftop .%2A/value"].id.get_chunk_info(1)
    content = bytearray(path.read_bytes())
    content[chunk.byte_offset + chunk.size // 2] ^= 0x10
    path.write_bytes(content)
    sealed_again(path)
    with pytest.raises(FileFormatError, match=r"/value: damaged, samples 0 to 40000"):
        load_store(path)


def test_what_is_no_store_is_none(tmp_path: Path, measured: ConditionedRun, header: StoreHeader) -> None:
    store = tmp_path / "run.h5"
    write_store(store, header, measured)
    other = tmp_path / "other.h5"
    with h5py.File(other, "w") as file:
        file["x"] = 1
    text = tmp_path / "log.csv"
    text.write_text("t,F\n")
    found = [is_store(path) for path in (store, other, text, tmp_path, tmp_path / "nothing")]
    assert found == [True, False, False, False, False]
    with pytest.raises(FileFormatError, match="no run store"):
        load_store(other)
    with pytest.raises(FileFormatError, match="cannot be read"):
        load_store(tmp_path / "nothing")
