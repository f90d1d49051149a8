"""Archives and workbooks that lie, lead out, or unpack to far more than they are."""

from __future__ import annotations

import gzip
import io
import struct
import zipfile
import zlib
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Final

import h5py
import numpy as np
import openpyxl

from reports.hostile_input.case import GOOD, INSPECT, SECRET, Case

ROW: Final = b"0.0,0.0\n"
#: with the member that a run file would name
MEMBER: Final = (*INSPECT, "--set", "table=a.csv")


def packed(*members: tuple[str, str | bytes], method: int = zipfile.ZIP_DEFLATED) -> bytes:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", method) as archive:
        for name, data in members:
            archive.writestr(zipfile.ZipInfo(name), data, method)
    return buffer.getvalue()


def writes(make: Callable[[], bytes]) -> Callable[[Path], object]:
    return lambda path: path.write_bytes(make())


def changed(data: bytes, *changes: tuple[bytes, int, str, int]) -> bytes:
    """Return an archive with numbers changed: behind which mark, how far, as what, to what."""
    found = bytearray(data)
    for mark, offset, form, number in changes:
        struct.pack_into(form, found, found.rfind(mark) + offset, number)
    return bytes(found)


def zeros(count: int, line: bytes = ROW, head: bytes = b"time [s],F [N]\n") -> bytes:
    """Return so many rows as one gzip stream, made in pieces."""
    machine = zlib.compressobj(9, zlib.DEFLATED, 31)
    block = line * 100_000
    parts = [machine.compress(head)] + [machine.compress(block) for _ in range(count // 100_000)]
    return b"".join([*parts, machine.flush()])


def zip_bomb() -> bytes:
    buffer = io.BytesIO()
    with (
        zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive,
        archive.open("log.csv", "w") as member,
    ):
        member.write(b"time [s],F [N]\n")
        for _ in range(1000):
            member.write(ROW * 125_000)
    return buffer.getvalue()


def layers(count: int) -> bytes:
    data = packed(("log.csv", GOOD))
    for number in range(count):
        data = packed((f"{number}.zip", data))
    return data


def overlapping() -> bytes:
    """Return an archive of 1,000 entries that all are the same packed megabyte."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("a.csv", GOOD.encode() + ROW * 125_000)
        first = archive.infolist()[0]
        for number in range(1000):
            again = zipfile.ZipInfo(f"{number}.csv")
            for key in ("header_offset", "compress_type", "CRC", "compress_size", "file_size"):
                setattr(again, key, getattr(first, key))
            archive.filelist.append(again)
    return buffer.getvalue()


def quine() -> bytes:
    """Return an archive whose only member is the archive itself, as its own lists say."""
    data = bytearray(packed(("r.zip", b"x" * 200), method=zipfile.ZIP_STORED))
    body = 30 + len("r.zip")
    data[body : body + 200] = data[:200]
    return bytes(data)


def hdf5_in_gzip() -> bytes:
    buffer = io.BytesIO()
    with h5py.File(buffer, "w") as file:
        file["t"] = np.arange(50.0)
    return zeros(100_000_000, b"\0" * 10, buffer.getvalue())


def workbook(
    change: Callable[[str, bytes], bytes] = lambda name, text: text, extra: Mapping[str, bytes] | None = None
) -> bytes:
    """Return a sound workbook with its parts changed and others added."""
    book, source = openpyxl.Workbook(), io.BytesIO()
    for row in [("time [s]", "F [N]"), *((0.5 * row, 1.5 + row) for row in range(20))]:
        book.active.append(row)
    book.save(source)
    with zipfile.ZipFile(source) as archive:
        texts = {name: archive.read(name).replace(b'fullCalcOnLoad="1"', b"") for name in archive.namelist()}
    parts = [(name, change(name, text)) for name, text in texts.items()]
    return packed(*parts, *(extra or {}).items())


def in_sheet(old: bytes, new: bytes) -> Callable[[str, bytes], bytes]:
    return lambda name, text: text.replace(old, new, 1) if name == "xl/worksheets/sheet1.xml" else text


_LAUGHS: Final = b"<!DOCTYPE z [<!ENTITY a0 'ha'>" + b"".join(
    b"<!ENTITY a%d '%s'>" % (n, b"&a%d;" % (n - 1) * 10) for n in range(1, 10)
)
_FORMULA: Final = b"<f>cmd|'/C calc'!A0</f><v>%s</v>"
_LINKS: Final = {
    "xl/externalLinks/externalLink1.xml": b"<externalLink/>",
    "xl/externalLinks/_rels/externalLink1.xml.rels": (
        b'<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship '
        b'Id="rId1" Type="http://schemas.openxmlformats.org/officeDocument/2006/relationships/externalLinkPath"'
        b' Target="file:///etc/passwd" TargetMode="External"/></Relationships>'
    ),
}


def _zip(name: str, attack: str, make: Callable[[], bytes], said: str, **keys: Any) -> Case:
    return Case("zip", name, attack, "log.zip", writes(make), said, **keys)


def _excel(name: str, attack: str, make: Callable[[], bytes], said: str, **keys: Any) -> Case:
    return Case("Excel", name, attack, "log.xlsx", writes(make), said, never=str(SECRET)[:6], **keys)


CASES: Final = (
    Case(
        "gzip",
        "1 GB of rows in 1 MB",
        "memory",
        "log.csv.gz",
        writes(lambda: zeros(125_000_000)),
        "unpacks to more than 200 times",
        slow=True,
    ),
    Case(
        "gzip",
        "HDF5, and 1 GB of zeros behind",
        "memory",
        "log.h5.gz",
        writes(hdf5_in_gzip),
        "unpacks to more than 200 times",
        slow=True,
    ),
    Case(
        "gzip",
        "JSON of empty lists",
        "memory",
        "log.json.gz",
        writes(lambda: zeros(40_000_000, b"[],", b"[")),
        "unpacks to more than",
        slow=True,
    ),
    Case(
        "gzip",
        "gzip in gzip",
        "hides a bomb",
        "log.gz",
        writes(lambda: gzip.compress(gzip.compress(GOOD.encode()))),
        "found .*, expected a log",
    ),
    Case(
        "gzip",
        "cut",
        "reads a part",
        "log.gz",
        writes(lambda: gzip.compress(GOOD.encode() * 100)[:-20]),
        "damaged or cut",
    ),
    _zip("1 GB of rows in 1 MB", "memory", zip_bomb, "unpacks to more than 200 times", slow=True),
    _zip("five archives in each other", "hides a bomb", lambda: layers(5), "an archive inside another"),
    _zip("a quine", "never ends", quine, "an archive inside another|damaged or cut"),
    _zip(
        "a member ../../x.csv",
        "leaves the folder",
        lambda: packed(("../../x.csv", GOOD), ("a.csv", GOOD), ("b.csv", GOOD)),
        "archive of 2 files: 'a.csv', 'b.csv', and",
        command=(*INSPECT, "--set", "table=../../x.csv"),
    ),
    _zip(
        "absolute members",
        "leaves the folder",
        lambda: packed(("/tmp/x.csv", GOOD), ("C:\\x.csv", GOOD), ("\\\\host\\x.csv", GOOD)),
        "archive of 0 files",
    ),
    _zip(
        "a member that is a link",
        "leaves the folder",
        lambda: changed(packed(("a.csv", "/etc/passwd")), (b"PK\x01\x02", 38, "<I", 0o120777 << 16)),
        "no rows of numbers",
    ),
    _zip(
        "an encrypted member",
        "waits for a password",
        lambda: changed(packed(("a.csv", GOOD)), (b"PK\x01\x02", 8, "<H", 1)),
        "is encrypted",
    ),
    _zip(
        "a member packed by LZMA",
        "memory",
        lambda: packed(("a.csv", GOOD), method=zipfile.ZIP_LZMA),
        "packed by method 14",
    ),
    _zip(
        "20,000 members",
        "time and memory",
        lambda: packed(*((f"{number}.csv", b"") for number in range(20_000))),
        "lists more than 10000",
    ),
    _zip(
        "a list of 4 GB",
        "memory",
        lambda: changed(packed(("a.csv", GOOD)), (b"PK\x05\x06", 12, "<I", 2**32 - 2)),
        "lists more than 10000",
    ),
    _zip(
        "a size that is too small",
        "reads a part",
        lambda: changed(packed(("a.csv", GOOD)), (b"PK\x01\x02", 24, "<I", 10)),
        "damaged or cut",
    ),
    _zip(
        "a size of 4 GB",
        "memory",
        lambda: changed(packed(("a.csv", GOOD)), (b"PK\x01\x02", 24, "<I", 2**32 - 2)),
        '"name": "F_top"',
        refused=False,
    ),
    _zip("1,000 names of one member", "memory", overlapping, "archive of 1001 files"),
    _zip(
        "one of 1,000 names of one member",
        "memory",
        overlapping,
        '"name": "F_top"',
        refused=False,
        command=MEMBER,
    ),
    _zip(
        "two members of one name",
        "shows another one",
        lambda: packed(("a.csv", GOOD), ("b.csv", GOOD)).replace(b"b.csv", b"a.csv"),
        "two files of one name",
        command=MEMBER,
    ),
    _zip(
        "a name with escape signs",
        "the terminal",
        lambda: packed(("\x1b[2J.csv", GOOD), ("b\n.csv", GOOD)),
        r"'\\\\x1b\[2J.csv'",
    ),
    _excel(
        "1 GB of blanks in a sheet",
        "memory",
        lambda: workbook(in_sheet(b"<sheetData>", b"<sheetData>" + b" " * 3 * 10**8)),
        "unpacks to more",
        slow=True,
    ),
    _excel(
        "billion laughs",
        "memory",
        lambda: workbook(in_sheet(b"<worksheet", _LAUGHS + b"]><worksheet")),
        "declares entities",
    ),
    _excel(
        "an entity of a file",
        "reads another file",
        lambda: workbook(
            in_sheet(b"<worksheet", b"<!DOCTYPE z [<!ENTITY a SYSTEM 'file:///etc/passwd'>]><worksheet")
        ),
        "declares entities",
    ),
    _excel(
        "entities in UTF-16",
        "hides entities",
        lambda: workbook(lambda name, text: text.decode().encode("utf-16") if "sheet1" in name else text),
        "not in UTF-8",
    ),
    _excel(
        "=cmd|... never calculated",
        "runs a program",
        lambda: workbook(in_sheet(b"<v>1.5</v>", _FORMULA % b"")),
        "never calculated",
    ),
    _excel(
        "=cmd|... with a value",
        "runs a program",
        lambda: workbook(in_sheet(b"<v>1.5</v>", _FORMULA % b"1.5")),
        '"minimum": 1.5',
        refused=False,
    ),
    _excel(
        "links to other workbooks",
        "reads another file",
        lambda: workbook(extra=_LINKS),
        '"minimum": 1.5',
        refused=False,
    ),
    _excel(
        "a macro",
        "runs a program",
        lambda: workbook(extra={"xl/vbaProject.bin": bytes(10_000)}),
        '"minimum": 1.5',
        refused=False,
    ),
    _excel(
        "cells at the far corner",
        "memory",
        lambda: workbook(
            in_sheet(b"</sheetData>", b'<row r="1048576"><c r="XFD1048576"><v>1</v></c></row></sheetData>')
        ),
        "a blank row within the table",
        slow=True,
    ),
    _excel(
        "10,000 merged blocks",
        "time",
        lambda: workbook(
            in_sheet(
                b"</sheetData>",
                b"</sheetData><mergeCells>"
                + b"".join(b'<mergeCell ref="D%d:XFD1048576"/>' % row for row in range(1, 10_001))
                + b"</mergeCells>",
            )
        ),
        '"minimum": 1.5',
        refused=False,
    ),
    _excel(
        "100,000 levels of XML",
        "the stack",
        lambda: workbook(in_sheet(b"</sheetData>", b"<a>" * 100_000 + b"</a>" * 100_000 + b"</sheetData>")),
        '"minimum": 1.5',
        refused=False,
    ),
)
