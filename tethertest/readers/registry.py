"""All readers of logs, and which of them reads a given file."""

from __future__ import annotations

from dataclasses import fields, replace
from pathlib import Path
from typing import Final, Protocol

from tethertest.errors import FileFormatError
from tethertest.readers.fingerprint import unchanged
from tethertest.readers.formats import (
    catman,
    delimited,
    enlight_peaks,
    enlight_sensors,
    enlight_spectrum,
    excel,
    fbgs,
    hdf5,
    json_log,
    lvm,
    matlab,
    mdf,
    tdms,
    toa5,
)
from tethertest.readers.formats.archive import ArchiveReader
from tethertest.readers.tables.text.document import Head, nul_bytes, read_head
from tethertest.readers.tables.text.encoding import detect_encoding
from tethertest.records.channel import RawLog
from tethertest.records.run import DEFAULT, Log


class Reader(Protocol):
    """What every reader module offers."""

    NAME: str
    USES: frozenset[str]

    def sniff(self, head: Head) -> str | None:
        """Return why this reader claims the file, or None."""
        ...

    def read(self, path: Path, settings: Log = DEFAULT) -> RawLog:
        """Read the whole log."""
        ...


def _read_member(path: Path, settings: Log) -> RawLog:
    """Read what was packed in an archive."""
    return read_log(path, settings)


#: every reader; the generic one stands last and is asked only when no other claims the file
READERS: Final[tuple[Reader, ...]] = (
    lvm,
    tdms,
    catman,
    enlight_sensors,
    enlight_peaks,
    enlight_spectrum,
    fbgs,
    toa5,
    hdf5,
    matlab,
    mdf,
    json_log,
    excel,
    ArchiveReader(_read_member),
    delimited,
)
GENERIC: Final[Reader] = delimited
#: settings of a log that a reader may or may not take; the others say which log it is
_SETTINGS: Final = frozenset(field.name for field in fields(Log)) - {"file", "clock", "channels", "format"}
#: files that people have at hand and no reader here can use
_FOREIGN: Final = (
    (b"%PDF", "a PDF document"),
    (b"\x89PNG", "a picture"),
    (b"\xff\xd8\xff", "a picture"),
    (b"\xd0\xcf\x11\xe0", "an old Office document"),
)


def identify(path: Path | str, settings: Log = DEFAULT) -> Reader:
    """Return the reader of a file.

    Parameters
    ----------
    path : Path or str
        The log.
    settings : Log
        Its `format` names a reader; that reader must recognise the file.

    Raises
    ------
    FileFormatError
        No reader or more than one claims the file, or the one that the settings name does not.
    """
    return identified(path, settings)[0]


def identified(path: Path | str, settings: Log = DEFAULT) -> tuple[Reader, str]:
    """Return the reader of a file and why it was chosen; see `identify`."""
    head = read_head(Path(path), settings.encoding)
    claims = [
        (reader, reason) for reader in READERS if reader is not GENERIC and (reason := reader.sniff(head))
    ]
    wanted = settings.format
    if wanted is not None:
        return _forced(head, wanted, claims)
    if len(claims) > 1:
        both = " and ".join(f"{reader.NAME!r} ({reason})" for reader, reason in claims)
        message = f"more than one reader claims the file: {both}"
        raise FileFormatError(message, "set format for this log in run.toml to one of them", path=head.path)
    if claims:
        return claims[0]
    reason = GENERIC.sniff(head)
    if reason is None:
        raise _unknown(head)
    return GENERIC, reason


def read_log(path: Path | str, settings: Log = DEFAULT) -> RawLog:
    """Read a log with the reader that recognises it.

    Parameters
    ----------
    path : Path or str
        The log, plain or in gzip or zip.
    settings : Log
        The log's entry in run.toml; its settings are needed only where the file itself is ambiguous.

    Returns
    -------
    RawLog
        Channels as logged, with what was concluded from the content.

    Raises
    ------
    FileFormatError
        The file is missing, empty, cut, ambiguous, changes while it is read, or belongs to no reader.
    """
    with unchanged(Path(path)) as before:
        reader, reason = identified(path, settings)
        refuse_keys(Path(path), reader, settings)
        return replace(reader.read(Path(path), settings), reason=reason, fingerprint=before)


def refuse_keys(path: Path, reader: Reader, settings: Log) -> None:
    """Refuse keys of run.toml that the reader does not use."""
    for key in sorted(_SETTINGS - reader.USES):
        if getattr(settings, key) != getattr(DEFAULT, key):
            message = f"{key} is set, which the reader of {reader.NAME} logs does not use"
            raise FileFormatError(message, f"remove {key}", path=path, keys=(key,))


def _forced(head: Head, wanted: str, claims: list[tuple[Reader, str]]) -> tuple[Reader, str]:
    reader = next((reader for reader in READERS if wanted == reader.NAME), None)
    if reader is None:
        names = ", ".join(reader.NAME for reader in READERS)
        message = f"format {wanted!r} is not known"
        raise FileFormatError(message, f"use one of {names}", path=head.path)
    if reader.sniff(head) is None:
        found = " or ".join(reader.NAME for reader, _ in claims) or "none of the instrument formats"
        message = f"run.toml says format {wanted!r}, but the file is {found}"
        raise FileFormatError(message, "remove or correct format for this log in run.toml", path=head.path)
    return reader, f"run.toml says format {wanted!r}"


def _unknown(head: Head) -> FileFormatError:
    text, nul, _ = head.data.partition(b"\0")
    if nul and b"\n" in text and detect_encoding(text) is not None:
        return nul_bytes(head.path, text.count(b"\n") + 1)
    names = ", ".join(reader.NAME for reader in READERS)
    what = next(
        (text for magic, text in _FOREIGN if head.data.startswith(magic)), "a binary file of unknown kind"
    )
    message = f"found {what}, expected a log"
    return FileFormatError(
        message, f"export it from the logger as text or TDMS; readers: {names}", path=head.path
    )
