"""Text logs whose rows the generic reader would misread: recognised, and refused."""

from __future__ import annotations

from pathlib import Path

from tethertest.errors import FileFormatError
from tethertest.readers.text.document import Head, read_head
from tethertest.records.channel import RawLog
from tethertest.records.run import Log

NAME = "foreign"
_TOA5 = "a Campbell TOA5 table, whose four header rows hold more than names and units"
_FBGS = "an FBGS ILLumiSense export, whose columns slip when a grating is lost"


def sniff(head: Head) -> str | None:
    """Claim Campbell TOA5 tables and FBGS ILLumiSense exports."""
    if not head.lines:
        return None
    if head.lines[0].startswith(('"TOA5"', "TOA5,")):
        return _TOA5
    return _FBGS if {"Linenumber", "Error status"} <= set(head.lines[0].split("\t")) else None


def read(path: Path, settings: Log | None = None) -> RawLog:
    """Refuse the file.

    Raises
    ------
    FileFormatError
        Always.
    """
    encoding = settings.encoding if settings is not None else None
    message = f"found {sniff(read_head(path, encoding)) or 'no log'}"
    raise FileFormatError(message, "export the channels as plain CSV with one row of names", path=path)
