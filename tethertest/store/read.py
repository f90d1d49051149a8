"""Reading a run store, whole or block by block."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from tethertest.errors import DataError, FileFormatError
from tethertest.records.channel import Channel, ClockFit, ConditionedRun, Finding, Severity, Source, Window
from tethertest.store.guards import (
    checked_series,
    child,
    members,
    number,
    optional_text,
    read_block,
    read_texts,
    refused,
    text,
    texts,
)
from tethertest.store.layout import (
    CHANNEL_FIGURES,
    CLOCK_FIGURES,
    FINDING_TEXTS,
    FORMAT,
    KNOWN_FLAGS,
    SERIES,
    SOURCE_TEXTS,
    VERSION,
    WINDOWS,
    StoredRun,
    StoreHeader,
)
from tethertest.store.names import decoded
from tethertest.store.seal import check_seal, is_sealed
from tethertest.units import KINDS, Kind

#: a run larger than this in memory is read block by block instead [bytes]
LARGEST_IN_MEMORY = 4 << 30
#: bytes that a sample has in memory
_PER_SAMPLE = 18


@dataclass(frozen=True, slots=True, eq=False)
class StoredSeries:
    """A channel in an open store: everything but its samples, and how to read those."""

    about: Channel  #: without samples
    size: int  #: samples
    path: Path
    data: tuple[Any, Any, Any]  #: time, value and flag in the file

    def read(self, start: int = 0, stop: int | None = None) -> Channel:
        """Return the channel with some of its samples.

        Raises
        ------
        FileFormatError
            They are damaged, time does not increase, or a flag has no meaning.
        """
        stop = self.size if stop is None else min(stop, self.size)
        time, values, flags = (read_block(self.path, data, start, stop) for data in self.data)
        unknown = int(np.bitwise_or.reduce(flags, initial=0)) & ~KNOWN_FLAGS
        if unknown:
            raise refused(self.path, self.data[2].name, f"found bits {unknown:#x}, which have no meaning")
        try:
            return replace(self.about, time=time, values=values, flags=flags)
        except DataError as error:
            raise refused(self.path, self.data[0].name, "time does not increase") from error


@dataclass(frozen=True, slots=True, eq=False)
class OpenStore:
    """A store with everything read but the samples."""

    path: Path
    header: StoreHeader
    series: tuple[StoredSeries, ...]
    clocks: tuple[ClockFit, ...]
    findings: tuple[Finding, ...]
    windows: dict[str, Window | None]


def is_store(path: Path) -> bool:
    """Return whether a file is a run store, of any version, damaged or not; HDF5 does not open it."""
    return is_sealed(path)


def load_store(path: Path) -> StoredRun:
    """Read a run store.

    Parameters
    ----------
    path : Path
        As `write_store` makes it.

    Returns
    -------
    StoredRun
        The measured side, bit by bit as it was written, and the texts of its run and rig file.

    Raises
    ------
    FileFormatError
        The file is no store, of another version, cut or damaged, or holds what no store holds; it names the
        object. Nothing outside the file is opened, and no more is read than the file's shapes promise.
    """
    with open_store(path) as store:
        size = _PER_SAMPLE * sum(series.size for series in store.series)
        if size > LARGEST_IN_MEMORY:
            message = f"the run has {size / 1e9:.1f} GB of samples, more than is read at once"
            raise FileFormatError(message, "export it, which reads block by block", path=path)
        channels = tuple(series.read() for series in store.series)
        measured = ConditionedRun(channels, store.clocks, store.findings, **store.windows)
    return StoredRun(store.header, measured)


@contextlib.contextmanager
def open_store(path: Path) -> Iterator[OpenStore]:
    """Open a run store for reading; see `load_store` for what is refused."""
    import h5py

    check_seal(path)
    try:
        file = h5py.File(path, "r")
    except (OSError, RuntimeError, ValueError) as error:
        raise refused(path, "/", "damaged, HDF5 cannot open it") from error
    with file:
        try:
            opened = _opened(path, file)
        except (OSError, RuntimeError, ValueError, KeyError, TypeError) as error:
            raise refused(path, "/", f"damaged ({error})") from error
        yield opened


def _opened(path: Path, file: Any) -> OpenStore:
    _check_version(path, file)
    return OpenStore(
        path,
        _header(path, file),
        _all_series(path, child(path, file, "channels", "group")),
        _clocks(path, child(path, file, "clocks", "group")),
        _findings(path, child(path, file, "findings", "group")),
        _windows(path, child(path, file, "windows", "group")),
    )


def _check_version(path: Path, file: Any) -> None:
    name = text(path, file, "format", "")
    if name != FORMAT:
        found = f"found format {name!r}" if name else "found an HDF5 file of another kind"
        remedy = "name a run store, as ingest writes it"
        raise refused(path, "/@format", f"{found}, expected {FORMAT!r}", remedy)
    version = number(path, file, "format_version")
    if version != VERSION:
        newer = version > VERSION
        remedy = (
            "read it with the tethertest that wrote it (attribute software), or ingest the run again"
            if newer
            else "ingest the run again from its raw logs"
        )
        raise refused(path, "/@format_version", f"found {version:g}, this version reads {VERSION}", remedy)


def _header(path: Path, file: Any) -> StoreHeader:
    software = dict(_split(item) for item in texts(path, file, "software"))
    files, hashes = texts(path, file, "input_files"), texts(path, file, "input_sha256")
    if len(files) != len(hashes):
        raise refused(path, "/@input_sha256", f"found {len(hashes)}, expected {len(files)}")
    return StoreHeader(
        text(path, file, "folder"),
        text(path, file, "run_file"),
        text(path, file, "rig"),
        text(path, file, "rig_file"),
        optional_text(path, file, "prototype_file"),
        software,
        tuple(zip(files, hashes, strict=True)),
    )


def _split(item: str) -> tuple[str, str]:
    name, _, version = item.partition(" ")
    return name, version


def _ordered(path: Path, group: Any) -> tuple[str, ...]:
    """Return the members of a group in the order that it states."""
    order = texts(path, group, "order")
    found = members(path, group)
    if len({decoded(name) for name in found}) != len(found):
        raise refused(path, group.name, "two of its members stand for the same name")
    if sorted(order) != sorted(found):
        listed = ", ".join(sorted(set(order) ^ set(found))[:5])
        raise refused(path, f"{group.name}@order", f"its members are not those that it lists: {listed}")
    return order


def _all_series(path: Path, group: Any) -> tuple[StoredSeries, ...]:
    return tuple(_series(path, child(path, group, name, "group"), name) for name in _ordered(path, group))


def _series(path: Path, group: Any, name: str) -> StoredSeries:
    data = [child(path, group, key, "dataset") for key in SERIES]
    sizes = [checked_series(path, item, dtype) for item, dtype in zip(data, SERIES.values(), strict=True)]
    if len(set(sizes)) != 1:
        found = ", ".join(f"{key} has {size}" for key, size in zip(SERIES, sizes, strict=True))
        raise refused(path, group.name, f"{found} samples, expected as many of each")
    kind = text(path, group, "kind")
    if kind not in KINDS:
        raise refused(path, f"{group.name}@kind", f"found {kind!r}, expected one of {', '.join(KINDS)}")
    source = None
    if "file" in group.attrs:
        words = {key: text(path, group, key) for key in SOURCE_TEXTS}
        source = Source(**words, steps=texts(path, group, "steps"))
    nothing = np.zeros(0)
    about = Channel(
        decoded(name),
        Kind(kind),
        text(path, group, "unit"),
        nothing,
        nothing,
        np.zeros(0, dtype=np.uint16),
        number(path, group, "at") if "at" in group.attrs else None,
        source=source,
        **{key: number(path, group, key) for key in CHANNEL_FIGURES},
    )
    return StoredSeries(about, sizes[0], path, (data[0], data[1], data[2]))


def _clocks(path: Path, group: Any) -> tuple[ClockFit, ...]:
    found: list[ClockFit] = []
    for name in _ordered(path, group):
        item = child(path, group, name, "group")
        figures = {key: number(path, item, key) for key in CLOCK_FIGURES}
        method, remarks = text(path, item, "method"), texts(path, item, "remarks")
        reference = text(path, item, "reference")
        found.append(ClockFit(decoded(name), reference, method=method, remarks=remarks, **figures))
    return tuple(found)


def _findings(path: Path, group: Any) -> tuple[Finding, ...]:
    columns = [read_texts(path, child(path, group, key, "dataset")) for key in FINDING_TEXTS]
    data = {key: child(path, group, key, "dataset") for key in ("samples", "span_of", "spans")}
    sizes = {
        key: checked_series(path, item, *(("<f8", 2) if key == "spans" else ("<i8",)))
        for key, item in data.items()
    }
    count = sizes["samples"]
    if any(len(column) != count for column in columns) or sizes["spans"] != sizes["span_of"]:
        raise refused(path, group.name, "its columns are not equally long")
    samples = read_block(path, data["samples"], 0, count)
    owner = read_block(path, data["span_of"], 0, sizes["span_of"])
    bounds = read_block(path, data["spans"], 0, sizes["spans"])
    spans: list[list[tuple[float, float]]] = [[] for _ in range(count)]
    for index, (start, stop) in zip(owner, bounds, strict=True):
        if not 0 <= index < count:
            raise refused(path, f"{group.name}/span_of", f"found {index}, there are {count} findings")
        spans[int(index)].append((float(start), float(stop)))
    found: list[Finding] = []
    for row, (subject, kind, words, severity) in enumerate(zip(*columns, strict=True)):
        if severity not in tuple(Severity):
            problem = f"found {severity!r}, expected one of {', '.join(Severity)}"
            raise refused(path, f"{group.name}/severity", problem)
        found.append(Finding(subject, kind, words, Severity(severity), tuple(spans[row]), int(samples[row])))
    return tuple(found)


def _windows(path: Path, group: Any) -> dict[str, Window | None]:
    found: dict[str, Window | None] = dict.fromkeys(WINDOWS)
    for name in members(path, group):
        if name not in WINDOWS:
            raise refused(path, f"{group.name}/{name}", f"expected one of {', '.join(WINDOWS)}")
        item = child(path, group, name, "group")
        start, stop = number(path, item, "start"), number(path, item, "stop")
        if not math.isfinite(stop - start) or stop < start:
            raise refused(path, item.name, f"found {start:g} s to {stop:g} s, expected a span of time")
        found[name] = Window(start, stop, text(path, item, "reason"))
    return found
