"""ASAM MDF files of version 3 and 4, through asammdf: each group of channels has a time of its own."""

from __future__ import annotations

import contextlib
import datetime as dt
import io
import logging
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final

from tethertest.errors import FileFormatError
from tethertest.readers.channels import with_units
from tethertest.readers.containers.table import refuse_settings
from tethertest.readers.formats.mdf_channels import channels_of
from tethertest.readers.guards.mdf_blocks import check_level_3, check_level_4
from tethertest.readers.guards.sandboxed_read import read_in_sandbox
from tethertest.readers.text.document import Head, read_bytes
from tethertest.readers.text.stamps import time_zone_of
from tethertest.records.channel import RawLog
from tethertest.records.run import Log

NAME = "mdf"
_MAGIC: Final = b"MDF     "
#: what a logger writes until it closes the file
_UNFINISHED: Final = b"UnFinMF "
_IDENTIFICATION: Final = 64  #: bytes


def sniff(head: Head) -> str | None:
    """Claim files that begin as MDF does."""
    return "the first bytes are 'MDF'" if head.data.startswith((_MAGIC, _UNFINISHED)) else None


def read(path: Path, settings: Log | None = None) -> RawLog:
    """Read an ASAM MDF file.

    Parameters
    ----------
    path : Path
        The log, plain or in gzip or zip.
    settings : Log, optional
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
    refuse_settings(path, settings, "an MDF log")
    with opened(path) as file:
        wanted = settings.table if settings is not None else None
        channels, remarks = channels_of(path, file, wanted)
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
        channels_of(path, file, None)


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


def _start(path: Path, file: Any, settings: Log | None) -> dt.datetime | None:
    """Return when the time is 0: in UTC or with the file's own zone, or without one as version 3 has it."""
    zone = time_zone_of(settings.time_zone if settings is not None else None, path)
    found: dt.datetime = file.start_time
    if found.year <= 1970:
        return None
    if file.version < "4":
        return found.replace(tzinfo=zone)
    if found.tzinfo is None:
        return found.replace(tzinfo=zone)
    return found if zone is None else found.astimezone(zone)
