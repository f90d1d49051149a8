"""ASAM MDF files of version 3 and 4, through asammdf: each group of channels has a time of its own."""

from __future__ import annotations

import contextlib
import datetime as dt
import io
import logging
import warnings
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Final

import numpy as np

from tethertest.errors import FileFormatError
from tethertest.readers.channels import raw_channel, unique_names, with_units
from tethertest.readers.guards.mdf_blocks import VIRTUAL, check_level_3, check_level_4
from tethertest.readers.guards.sandboxed_read import read_in_sandbox
from tethertest.readers.tables.containers.table import listed, toml_text
from tethertest.readers.tables.text.document import Head, read_bytes
from tethertest.readers.tables.text.stamps import time_zone_of
from tethertest.readers.tables.time_units import SECONDS
from tethertest.records.arrays import FloatArray, frozen
from tethertest.records.channel import RawChannel, RawLog
from tethertest.records.run import DEFAULT, Log

NAME = "mdf"
#: keys of a log in run.toml that it takes
USES = frozenset(["time_zone", "units", "table"])
_MAGIC: Final = b"MDF     "
#: what a logger writes until it closes the file
_UNFINISHED: Final = b"UnFinMF "
_IDENTIFICATION: Final = 64  #: bytes
#: times are seconds from the start of a log, or since an epoch
_LATEST: Final = 1e11
#: what the master of a group counts, and conversions by a formula in the file, in version 4 and 3
_TIME: Final = 1
_FORMULA: Final = {True: 3, False: 10}
#: remarks on single channels before they are only counted
_SHOWN: Final = 8


def sniff(head: Head) -> str | None:
    """Claim files that begin as MDF does."""
    return "the first bytes are 'MDF'" if head.data.startswith((_MAGIC, _UNFINISHED)) else None


def read(path: Path, settings: Log = DEFAULT) -> RawLog:
    """Read an ASAM MDF file.

    Parameters
    ----------
    path : Path
        The log, plain or in gzip or zip.
    settings : Log
        Its `table` is the name of one group of channels (of its acquisition, or ``"group 2"``); without it
        all groups are read, each with its own time.

    Returns
    -------
    RawLog
        Physical values by the file's conversions; values that the file marks as invalid are missing, counted
        in a remark. Channels of text, with a formula as conversion, or without a time are left out and named.

    Raises
    ------
    FileFormatError
        asammdf is not installed; the file is damaged, cut, not finalised or larger than a log may be; no
        channel has numbers and a time.
    """
    with opened(path) as file:
        channels, remarks = _channels_of(path, file, settings.table)
        start = _start(path, file, settings)
    return RawLog(
        path=path,
        format=NAME,
        start=start,
        channels=with_units(path, channels, settings),
        remarks=tuple(remarks),
    )


def read_everything(path: Path) -> None:
    """Read each channel."""
    with opened(path, in_sandbox=True) as file:
        _channels_of(path, file, None)


@contextlib.contextmanager
def opened(path: Path, *, in_sandbox: bool = False) -> Iterator[Any]:
    """Open an MDF file whose blocks are sound; another process reads it first, unless this is it.

    Raises
    ------
    FileFormatError
        As `read`.
    """
    try:
        from asammdf import MDF
    except ImportError as error:
        message = "found an ASAM MDF measurement, and the package asammdf that reads it is not installed"
        remedy = "pip install 'tethertest[mdf]', or export the log as text, TDMS or HDF5"
        raise FileFormatError(message, remedy, path=path) from error
    data = read_bytes(path)
    _check(path, data)
    if not in_sandbox:
        read_in_sandbox(path, __name__, "asammdf")
    logging.getLogger("asammdf").setLevel(logging.CRITICAL)  # what it would print is in our own message
    try:
        # it prints what it makes of a damaged file, among the answers of this program
        with warnings.catch_warnings(), contextlib.redirect_stdout(io.StringIO()):
            warnings.simplefilter("ignore")
            with MDF(io.BytesIO(data)) as file:
                yield file
    except (FileFormatError, MemoryError):
        raise
    except Exception as error:  # asammdf lets errors of many kinds through
        message = f"the MDF file is damaged or cut ({type(error).__name__}: {error})"
        raise FileFormatError(message, "copy the whole file again, or export it again", path=path) from error


def _check(path: Path, data: bytes) -> None:
    if len(data) < _IDENTIFICATION:
        message = "the MDF file is damaged or cut: its identification is not whole"
        raise FileFormatError(message, "copy the whole file again", path=path)
    version = data[8:16].split(b"\0")[0].strip().decode("latin-1")
    if data.startswith(_UNFINISHED) or data[60:64] != b"\0\0\0\0":
        message = "the MDF file was not finalised: the logger stopped while it wrote"
        raise FileFormatError(message, "finalise it with the logger's tool", path=path)
    if version.startswith("4."):
        check_level_4(path, data)
    elif version.startswith("3."):
        check_level_3(path, data)
    else:
        message = f"found MDF of version {version[:8]!r}, expected 3 or 4"
        raise FileFormatError(message, "export the log as MDF 4", path=path)


def _start(path: Path, file: Any, settings: Log) -> dt.datetime | None:
    """Return when the time is 0: in UTC or with the file's own zone, or without one as version 3 has it."""
    zone = time_zone_of(settings.time_zone, path)
    found: dt.datetime = file.start_time
    if found.year <= 1970:
        return None
    if file.version < "4":
        return found.replace(tzinfo=zone)
    if found.tzinfo is None:
        return found.replace(tzinfo=zone)
    return found if zone is None else found.astimezone(zone)


@dataclass(frozen=True, slots=True, eq=False)
class _Group:
    number: int
    name: str
    channels: list[int]
    trouble: str  #: why none of it is read


def _channels_of(path: Path, file: Any, wanted: str | None) -> tuple[list[RawChannel], list[str]]:
    """Return the channels with numbers and a time, and remarks on all others.

    Parameters
    ----------
    path : Path
        The file, for messages.
    file : asammdf.MDF
        The opened file.
    wanted : str, optional
        Name of the only group to be read.

    Raises
    ------
    FileFormatError
        There is no such group, or no such channel.
    """
    groups = _groups(file)
    if wanted is not None and wanted not in {group.name for group in groups}:
        known = listed(group.name for group in groups)
        message = f"run.toml says table = {toml_text(wanted)}, the MDF file has {known}"
        lines = " or ".join(f"table = {toml_text(group.name)}" for group in groups[:4])
        raise FileFormatError(message, f"write for this log in run.toml: {lines}", path=path)
    found: list[tuple[str, RawChannel]] = []
    remarks: list[str] = []
    for group in groups:
        if wanted in {None, group.name}:
            if group.trouble:
                remarks.append(f"the channels of {group.name!r} are left out: {group.trouble}")
            else:
                found += [(group.name, channel) for channel in _read(path, file, group, remarks)]
    if not found:
        told = "; ".join(remarks[:_SHOWN]) or "it is empty"
        message = f"the MDF file has no channel with numbers and a time: {told}"
        raise FileFormatError(message, "export the log again with its time", path=path)
    more = len(remarks) - 2 * _SHOWN
    remarks = [*remarks[: 2 * _SHOWN], *([f"{more} more remarks of this kind"] if more > 0 else [])]
    if wanted is None and len({name for name, _ in found}) > 1:
        remarks.append(f"groups with a time of their own: {listed(dict(found))}")
    return _with_names(found, remarks), remarks


def _groups(file: Any) -> list[_Group]:
    written = [_name(group) for group in file.groups]
    repeated = Counter(written)
    found = []
    for number, group in enumerate(file.groups):
        name = written[number]
        if not name or repeated[name] > 1:
            name = f"group {number + 1}"
        master = file.masters_db.get(number)
        own = file.virtual_groups_map.get(number, number)
        trouble = ""
        if own != number:
            trouble = "their time is in another group, a layout that is not read"
        elif master is None or getattr(group.channels[master], "sync_type", _TIME) != _TIME:
            trouble = "the group has no time"
        elif _is_nothing(group.channels[master]) and not getattr(group.channels[master], "sampling_rate", 0):
            trouble = "their time has no bits in the records"  # asammdf would count it in seconds
        elif _time_unit(group.channels[master]) not in SECONDS:
            trouble = f"their time has the unit {group.channels[master].unit[:20]!r}"
        elif not group.channel_group.cycles_nr:
            trouble = "the group has no samples"
        found.append(_Group(number, name, [k for k in range(len(group.channels)) if k != master], trouble))
    return found


def _name(group: Any) -> str:
    """Return the name of the acquisition, or the first line of version 3's comment."""
    block = group.channel_group
    text = str(getattr(block, "acq_name", "") or (getattr(block, "comment", "") if _is_old(group) else ""))
    return text.strip().split("\n")[0][:80]


def _is_old(group: Any) -> bool:
    """Return whether a group is one of version 3."""
    return not hasattr(group.channel_group, "acq_name")


def _read(path: Path, file: Any, group: _Group, remarks: list[str]) -> list[RawChannel]:
    source = file.groups[group.number]
    kept = []
    for index in group.channels:
        channel = source.channels[index]
        if _has_formula(channel.conversion, _FORMULA[not _is_old(source)]):
            remarks.append(f"channel {channel.name!r} has a formula as conversion and is left out")
        elif _is_nothing(channel):
            remarks.append(f"channel {channel.name!r} has no bits in the records and is left out")
        else:
            kept.append(index)
    signals = file.select([(None, group.number, index) for index in kept], copy_master=False) if kept else []
    found = []
    time: FloatArray | None = None
    for signal in signals:
        samples = np.asarray(signal.samples)
        if samples.dtype.kind not in "biuf" or samples.ndim != 1:
            remarks.append(f"channel {signal.name!r} holds no single numbers and is left out")
            continue
        if time is None:  # channels of one group share the array
            factor = SECONDS[_time_unit(source.channels[file.masters_db[group.number]])]
            time = frozen(np.asarray(signal.timestamps, dtype=np.float64) * factor)
            sound = np.abs(time) < _LATEST
            if not np.all(sound):
                row = int(np.argmin(sound))
                message = f"sample {row + 1} of {signal.name!r} has the time {time[row]:g} s: it is damaged"
                raise FileFormatError(message, "copy the whole file again", path=path)
        values = samples.astype(np.float64)
        invalid = signal.invalidation_bits
        if invalid is not None and np.any(bad := np.asarray(invalid, dtype=bool)):
            values[bad] = np.nan
            count = np.count_nonzero(bad)
            remarks.append(f"channel {signal.name!r}: {count} values marked as invalid read as missing")
        found.append(raw_channel(signal.name, str(signal.unit or "").strip(), time, values))
    return found


def _is_nothing(channel: Any) -> bool:
    """Return whether a channel takes no bits of a record and is not one that is computed from its number."""
    return channel.bit_count == 0 and channel.channel_type not in VIRTUAL


def _time_unit(channel: Any) -> str:
    """Return the unit of a group's time, which the standard says is a second."""
    return str(getattr(channel, "unit", "") or "").strip().lower() or "s"


def _has_formula(conversion: Any, kind: int) -> bool:
    """Return whether a conversion, or one that it refers to, is a formula: nothing of a file is evaluated."""
    if conversion is None:
        return False
    if getattr(conversion, "conversion_type", None) == kind:
        return True
    inner = getattr(conversion, "referenced_blocks", None) or {}
    return any(_has_formula(block, kind) for block in inner.values() if hasattr(block, "conversion_type"))


def _with_names(found: list[tuple[str, RawChannel]], remarks: list[str]) -> list[RawChannel]:
    repeated = Counter(channel.name for _, channel in found)
    names, renamed = unique_names(
        f"{group}/{channel.name}" if repeated[channel.name] > 1 else channel.name for group, channel in found
    )
    remarks += renamed
    return [replace(channel, name=name) for name, (_, channel) in zip(names, found, strict=True)]
