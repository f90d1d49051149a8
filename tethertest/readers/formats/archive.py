"""Zip archives of several files: run.toml names the one that is the log."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

from tethertest.errors import FileFormatError
from tethertest.readers.guards.zips import ZIP_MAGIC, member_stream, members, opened_zip
from tethertest.readers.tables.containers.table import listed, toml_text
from tethertest.readers.tables.containers.workbook import is_in
from tethertest.readers.tables.text.document import Head
from tethertest.records.channel import RawLog
from tethertest.records.run import DEFAULT, Log

NAME = "archive"
#: keys of a log in run.toml that it takes
USES = frozenset(
    [
        "encoding",
        "decimal",
        "separator",
        "date_order",
        "skip_rows",
        "time_zone",
        "units",
        "table",
        "columns",
        "time",
        "rate",
    ]
)


class ArchiveReader:
    """The reader of zip archives, given what reads their members: they may have any format."""

    NAME = NAME
    USES = USES

    def __init__(self, read_member: Callable[[Path, Log], RawLog]) -> None:
        self._read_member = read_member

    def sniff(self, head: Head) -> str | None:
        """Claim zip archives that are no workbooks and do not hold one log alone, which needs no name."""
        is_archive = head.data.startswith(ZIP_MAGIC) and not is_in(head.path)
        return "the first bytes are a zip archive's" if is_archive else None

    def read(self, path: Path, settings: Log = DEFAULT) -> RawLog:
        """Read one member of a zip archive.

        Parameters
        ----------
        path : Path
            The archive.
        settings : Log
            Its `table` is the member, or ``member/table`` where the member is a container itself.

        Returns
        -------
        RawLog
            As the member's reader returns it, with the archive's path.

        Raises
        ------
        FileFormatError
            No member is named or there is none of that name; the archive is damaged, encrypted, in
            another archive, or unpacks to more than a log may hold.
        """
        with _named_member(path, settings) as (name, member, of_member):
            try:
                log = self._read_member(member, of_member)
            except FileFormatError as error:
                place = f"{path}:{name}"
                raise FileFormatError(error.problem, error.remedy, path=place, line=error.line) from error
            remarks = (f"{name!r} of the archive is read: {log.reason}", *log.remarks)
            return replace(log, path=path, remarks=remarks)


@contextmanager
def _named_member(path: Path, settings: Log) -> Iterator[tuple[str, Path, Log]]:
    """Unpack the member that the settings name; yield its name, where it lies and its own settings."""
    with path.open("rb") as stream:
        if stream.read(len(ZIP_MAGIC)) != ZIP_MAGIC:
            raise _nested(path)
        archive = opened_zip(stream, path)
        listed_members = members(archive)
        found = {info.filename: info for info in listed_members}
        if len(found) < len(listed_members):
            message = "the zip archive holds two files of one name"
            raise FileFormatError(message, "unpack it and name the file that is the log", path=path)
        if len(found) == 1:
            raise _nested(path)
        wanted = settings.table
        name = next((name for name in found if wanted == name or (wanted or "").startswith(f"{name}/")), None)
        if name is None:
            asked = f", and run.toml says table = {toml_text(wanted)}" if wanted else ""
            message = f"found a zip archive of {len(found)} files: {listed(found) or 'none is a log'}{asked}"
            lines = " or ".join(f"table = {toml_text(known)}" for known in list(found)[:4])
            remedy = f"write for this log in run.toml: {lines}" if lines else "pack the log again"
            raise FileFormatError(message, remedy, path=path)
        with (
            tempfile.TemporaryDirectory() as folder,
            member_stream(archive, found[name], path) as inner,
        ):
            member = Path(folder) / "member"
            try:
                member.write_bytes(inner.read())
            except FileFormatError:
                raise
            except Exception as error:  # zipfile and zlib let errors of many kinds through
                message = f"the compressed file is damaged or cut ({error})"
                raise FileFormatError(message, "copy it again from the logger", path=path) from error
            if member.read_bytes()[: len(ZIP_MAGIC)] == ZIP_MAGIC:
                raise _nested(path)
            rest = (wanted or "")[len(name) + 1 :]
            yield name, member, replace(settings, table=rest or None)


def _nested(path: Path) -> FileFormatError:
    message = "found an archive inside another"
    return FileFormatError(message, "unpack the outer one and name what is in it", path=path)
