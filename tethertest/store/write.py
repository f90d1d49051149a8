"""Writing a run store, channel by channel and block by block."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from tethertest.records.arrays import FlagArray, FloatArray
from tethertest.records.channel import Channel, ClockFit, ConditionedRun, Finding, Flag, Window
from tethertest.store.layout import (
    CHANNEL_FIGURES,
    CHUNK,
    CLOCK_FIGURES,
    COMPRESSION,
    FINDING_TEXTS,
    FORMAT,
    SERIES,
    SOURCE_TEXTS,
    VERSION,
    StoreHeader,
)
from tethertest.store.names import encoded, plain
from tethertest.store.seal import seal
from tethertest.store.whole import WholeFile, written_whole

#: the oldest HDF5 that can read the file is 1.10, as old MATLAB and HDFView have it
_LIBRARY_VERSIONS = ("earliest", "v110")


def write_store(target: Path, header: StoreHeader, measured: ConditionedRun) -> None:
    """Write a conditioned run as one file, whole or not at all.

    Parameters
    ----------
    target : Path
        The store; an older one is replaced in one step.
    header : StoreHeader
        The run's files and what they were read with.
    measured : ConditionedRun
        The measured side.

    Raises
    ------
    TethertestError
        The file cannot be written; an older store is then as it was.
    """
    with new_store(target, header) as store:
        for channel in measured.channels:
            series = store.channel(channel.name)
            series.append(channel.time, channel.values, channel.flags)
            series.describe(channel)
        store.conclude(
            measured.clocks,
            measured.findings,
            {
                "rest_before": measured.rest_before,
                "rest_after": measured.rest_after,
                "steady": measured.steady,
            },
        )


@contextlib.contextmanager
def new_store(target: Path, header: StoreHeader) -> Iterator[StoreWriter]:
    """Open a new store that takes its name when the block ends without an error.

    Raises
    ------
    TethertestError
        The file cannot be written; an older store is then as it was.
    """
    import h5py

    with written_whole(target) as whole:
        file = h5py.File(whole, "w", libver=_LIBRARY_VERSIONS)
        try:
            yield StoreWriter(file, whole, header)
        finally:
            file.close()
        whole.check()
        seal(whole)


class StoreWriter:
    """A store that is being written."""

    def __init__(self, file: Any, whole: WholeFile, header: StoreHeader) -> None:
        self._file = file
        self._whole = whole
        self._names: list[str] = []
        _head(file, header)

    def channel(self, name: str) -> ChannelWriter:
        """Begin a channel; channels come back in the order in which they are begun."""
        group = self._file.create_group(f"channels/{encoded(name)}", track_order=False)
        self._names.append(encoded(name))
        return ChannelWriter(group, self._whole)

    def conclude(
        self, clocks: Sequence[ClockFit], findings: Sequence[Finding], windows: dict[str, Window | None]
    ) -> None:
        """Write what is known of the whole run."""
        _texts(self._file.require_group("channels"), "order", self._names)
        group = self._file.create_group("clocks")
        _texts(group, "order", [encoded(clock.clock) for clock in clocks])
        for clock in clocks:
            _clock(group.create_group(encoded(clock.clock)), clock)
        _findings(self._file.create_group("findings"), findings)
        group = self._file.create_group("windows")
        for name, window in windows.items():
            if window is not None:
                part = group.create_group(name)
                part.attrs.update(start=float(window.start), stop=float(window.stop), units="s")
                _text(part, "reason", window.reason)
        self._whole.check()


class ChannelWriter:
    """A channel that is being written, block by block."""

    def __init__(self, group: Any, whole: WholeFile) -> None:
        self._group = group
        self._whole = whole
        self._data: dict[str, Any] = {}

    def append(self, time: FloatArray, values: FloatArray, flags: FlagArray) -> None:
        """Add the samples that follow.

        Parameters
        ----------
        time, values, flags : ndarray
            (n,) each, as in `Channel`.
        """
        blocks: tuple[npt.NDArray[Any], ...] = (time, values, flags)
        for name, block in zip(SERIES, blocks, strict=True):
            if name not in self._data:
                self._data[name] = self._group.create_dataset(
                    name,
                    shape=(0,),
                    maxshape=(None,),
                    dtype=SERIES[name],
                    chunks=(min(CHUNK, max(block.size, 1)),),
                    track_times=False,
                    **COMPRESSION,
                )
            data = self._data[name]
            size = data.shape[0]
            data.resize((size + block.size,))
            data[size:] = block
        self._whole.check()

    def describe(self, channel: Channel) -> None:
        """Write what a channel says beside its samples.

        Parameters
        ----------
        channel : Channel
            Its own samples are not looked at.
        """
        attributes = self._group.attrs
        for key, text in (("name", channel.name), ("kind", channel.kind), ("unit", channel.unit)):
            _text(self._group, key, text)
        for key in CHANNEL_FIGURES:
            attributes[key] = float(getattr(channel, key))
        if channel.at is not None:
            attributes["at"] = float(channel.at)
        source = channel.source
        if source is not None:
            for key in SOURCE_TEXTS:
                _text(self._group, key, getattr(source, key))
            _texts(self._group, "steps", source.steps)
        self._data["time"].attrs["units"] = "s"
        _text(self._data["value"], "units", channel.unit)
        flags = [flag for flag in Flag if flag]
        self._data["flag"].attrs["flag_masks"] = np.array(flags, dtype=np.uint16)
        self._data["flag"].attrs["flag_meanings"] = " ".join((flag.name or "").lower() for flag in flags)


def _head(file: Any, header: StoreHeader) -> None:
    file.attrs["format"] = FORMAT
    file.attrs["format_version"] = VERSION
    for key in ("folder", "rig", "run_file", "rig_file", "prototype_file"):
        text = getattr(header, key)
        if text is not None:
            _text(file, key, text)
    for name, value in header.described.items():
        if isinstance(value, str):
            _text(file, name, value)
        else:
            file.attrs[name] = float(value)
    _texts(file, "software", [f"{name} {version}" for name, version in header.software.items()])
    _texts(file, "input_files", [name for name, _ in header.inputs])
    _texts(file, "input_sha256", [digest for _, digest in header.inputs])


def _clock(group: Any, clock: ClockFit) -> None:
    for key in ("clock", "reference", "method"):
        _text(group, key, getattr(clock, key))
    for key in CLOCK_FIGURES:
        group.attrs[key] = float(getattr(clock, key))
    _texts(group, "remarks", clock.remarks)


def _findings(group: Any, findings: Sequence[Finding]) -> None:
    """Write findings as columns; their spans as rows, each with the number of its finding, from 0."""
    import h5py

    for key in FINDING_TEXTS:
        column = np.array([plain(getattr(finding, key)) for finding in findings], dtype=object)
        group.create_dataset(
            key, data=column, shape=(len(findings),), dtype=h5py.string_dtype(), track_times=False
        )
    samples = np.array([finding.samples for finding in findings], dtype=np.int64)
    group.create_dataset("samples", data=samples, track_times=False)
    spans = [(number, *span) for number, finding in enumerate(findings) for span in finding.spans]
    group.create_dataset(
        "span_of", data=np.array([number for number, _, _ in spans], dtype=np.int64), track_times=False
    )
    bounds = np.array([span for _, *span in spans], dtype=np.float64).reshape(-1, 2)
    group.create_dataset("spans", data=bounds, track_times=False).attrs["units"] = "s"


def _text(item: Any, key: str, text: str) -> None:
    item.attrs[key] = plain(text)


def _texts(item: Any, key: str, texts: Sequence[str]) -> None:
    import h5py

    column = np.array([plain(text) for text in texts], dtype=object)
    item.attrs.create(key, column, shape=(len(texts),), dtype=h5py.string_dtype())
