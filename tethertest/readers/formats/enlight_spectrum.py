"""ENLIGHT spectrum exports: recognised, and refused, because a spectrum is no log over time."""

from __future__ import annotations

from pathlib import Path

from tethertest.errors import FileFormatError
from tethertest.readers.formats.enlight import find_preamble
from tethertest.readers.tables.text.document import Head
from tethertest.records.channel import RawLog
from tethertest.records.run import DEFAULT, Log

NAME = "enlight-spectrum"
#: keys of a log in run.toml that it takes
USES = frozenset(["encoding", "decimal", "separator", "date_order", "skip_rows", "time_zone", "units"])


def sniff(head: Head) -> str | None:
    """Claim files with the keys ``Wavelength Start (nm)`` and ``Number of Points``."""
    keys = {line.partition(":")[0].strip() for line in head.lines}
    if {"Wavelength Start (nm)", "Number of Points"} <= keys and find_preamble(head.lines) is None:
        return "the keys 'Wavelength Start (nm)' and 'Number of Points' of a spectrum"
    return None


def read(path: Path, settings: Log = DEFAULT) -> RawLog:
    """Refuse the file.

    Raises
    ------
    FileFormatError
        Always.
    """
    message = "found a spectrum exported from ENLIGHT, expected wavelengths over time"
    raise FileFormatError(
        message, "export Sensors or Peaks from ENLIGHT and name that file in run.toml", path=path
    )
