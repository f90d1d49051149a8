"""Excel workbooks: the parts of the file are checked as text before openpyxl is given them, and bounded."""

from __future__ import annotations

import io
import re
import warnings
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any, Final

from tethertest.errors import FileFormatError
from tethertest.readers.guards.limits import COMPRESSION_RATIO, DECOMPRESSED_BYTES, RATIO_FROM
from tethertest.readers.guards.zips import ZIP_MAGIC, is_workbook, member_stream, opened_zip

_PREFIX: Final = rb"(?:\w+:)?"
#: namespaces of the strict form of the format
_STRICT: Final = b"http://purl.oclc.org/ooxml/spreadsheetml"
#: declarations that can make an XML text grow without end, or lead to other files
_DECLARATION = re.compile(rb"<!(?:DOCTYPE|ENTITY)", re.IGNORECASE)
_ENCODING = re.compile(rb"<\?xml[^>]*?encoding=[\"']([^\"']*)")
_ENCODINGS: Final = {b"utf-8", b"us-ascii", b"ascii"}
_CELL = re.compile(rb"<" + _PREFIX + rb"c\b[^>]*?\br=\"([A-Z]{1,3})(\d{1,7})\"")
_ANY_CELL = re.compile(rb"<" + _PREFIX + rb"c\b")
_FORMULA = (
    rb"<" + _PREFIX + rb"f\b[^>]*?(?:/>|>[^<]*</" + _PREFIX + rb"f>)\s*"
    rb"(?:<" + _PREFIX + rb"v\s*/>|<" + _PREFIX + rb"v>\s*</" + _PREFIX + rb"v>)?\s*</" + _PREFIX + rb"c>"
)
_UNCALCULATED = re.compile(rb"<" + _PREFIX + rb"c\b[^>]*?\br=\"([A-Z]{1,3}\d{1,7})\"[^>/]*>\s*" + _FORMULA)
_ANY_FORMULA = re.compile(rb"<" + _PREFIX + rb"f\b")
#: programs that write formulas and cannot calculate them ask Excel to do so
_PENDING = re.compile(rb"<" + _PREFIX + rb"calcPr\b[^>]*\bfullCalcOnLoad=\"(?:1|true)\"")
_ROW = re.compile(rb"<" + _PREFIX + rb"row\b[^>]*?\br=\"(\d{1,9})\"")
_MERGED = re.compile(
    rb"<" + _PREFIX + rb"mergeCell\b[^>]*?\bref=\"([A-Z]{1,3})(\d{1,7}):([A-Z]{1,3})(\d{1,7})\""
)


@dataclass(frozen=True, slots=True)
class Merged:
    """A block of merged cells; rows and columns count from 1."""

    first_row: int
    last_row: int
    first_column: int
    last_column: int
    name: str  #: as in ``A1:C1``


@contextmanager
def opened_workbook(path: Path) -> Iterator[tuple[Any, dict[str, bytes]]]:
    """Open a workbook for reading; yield it and the texts of its parts.

    Numbers that are formatted as dates come as the numbers that they are: openpyxl would round them to
    milliseconds. Formulas come as the values that the last program to calculate them has left.

    Raises
    ------
    FileFormatError
        openpyxl is not installed; the workbook is damaged, cut, encrypted, declares entities, or unpacks to
        more than a log may hold.
    """
    try:
        import openpyxl
    except ImportError as error:
        message = "found an Excel workbook, and the package openpyxl that reads it is not installed"
        remedy = "pip install 'tethertest[excel]', or save the sheet as CSV (UTF-8)"
        raise FileFormatError(message, remedy, path=path) from error
    parts = _parts(path)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # extensions and styles that openpyxl does not know
            book = openpyxl.load_workbook(_packed(parts), read_only=True, data_only=True, keep_links=False)
            for formats in (book._date_formats, book._timedelta_formats):
                formats.clear()
            yield book, parts
    except FileFormatError:
        raise
    except Exception as error:  # openpyxl and its parsers let errors of many kinds through
        message = f"the workbook is damaged ({error})"
        raise FileFormatError(message, "save it again from Excel", path=path) from error


def is_in(path: Path) -> bool:
    """Return whether a file is a workbook itself; within another compression it is not."""
    with path.open("rb") as stream:
        return stream.read(len(ZIP_MAGIC)) == ZIP_MAGIC and is_workbook(opened_zip(stream, path))


def checked_sheet(path: Path, sheet: str, parts: dict[str, bytes], name: str) -> bytes:
    """Return the text of a sheet if openpyxl will read all of it.

    It passes over rows and cells that stand after a later one, and takes a formula without value for a blank.

    Raises
    ------
    FileFormatError
        Rows or cells are out of order, cells do not say where they stand, or formulas were never calculated.
    """
    text = parts[name]
    formula = _UNCALCULATED.search(text)
    where = f"the formula in {formula[1].decode()} was" if formula else ""
    if any(_PENDING.search(part) for key, part in parts.items() if key.startswith("xl/workbook")):
        where = where or ("its formulas were" if _ANY_FORMULA.search(text) else "")
    if where:
        message = f"sheet {sheet!r}: {where} never calculated"
        remedy = "open the workbook in Excel or LibreOffice, let it calculate, and save it"
        raise FileFormatError(message, remedy, path=path)
    rows = [int(number) for number in _ROW.findall(text)]
    wrong = next((f"row {here}" for before, here in pairwise(rows) if here <= before), "")
    count, last = 0, (0, 0, b"")
    for match in _CELL.finditer(text):
        count += 1
        here = (int(match[2]), len(match[1]), match[1])
        if here <= last and not wrong:
            wrong = f"cell {(match[1] + match[2]).decode()}"
        last = here
    if wrong:
        message = f"sheet {sheet!r}: {wrong} stands after a later one"
    elif count and count != sum(1 for _ in _ANY_CELL.finditer(text)):
        message = f"sheet {sheet!r} holds cells that do not say where they stand"
    else:
        return text
    raise FileFormatError(message, "save the workbook again from Excel", path=path)


def merged_cells(text: bytes) -> list[Merged]:
    """Return the blocks of merged cells of a sheet."""
    return [
        Merged(
            int(match[2]),
            int(match[4]),
            _column(match[1]),
            _column(match[3]),
            match[0].split(b'"')[-2].decode(),
        )
        for match in _MERGED.finditer(text)
    ]


def column_name(column: int) -> str:
    """Return the letters of a column, counted from 1."""
    letters = ""
    while column:
        column, rest = divmod(column - 1, 26)
        letters = chr(65 + rest) + letters
    return letters


def _column(letters: bytes) -> int:
    number = 0
    for letter in letters:
        number = number * 26 + letter - 64
    return number


def _parts(path: Path) -> dict[str, bytes]:
    """Return the XML texts of a workbook; pictures and macros stay where they are."""
    size = path.stat().st_size
    left = min(DECOMPRESSED_BYTES, max(RATIO_FROM, COMPRESSION_RATIO * size))
    parts: dict[str, bytes] = {}
    with path.open("rb") as stream:
        archive = opened_zip(stream, path)
        names = set(archive.namelist())
        for info in archive.infolist():
            if not info.filename.endswith((".xml", ".rels")):
                continue
            if info.filename in parts:
                message = f"the workbook holds the part {info.filename!r} twice"
                raise FileFormatError(message, "save it again from Excel", path=path)
            with member_stream(archive, info, path) as member:
                try:
                    text = member.read(left + 1)
                except FileFormatError:
                    raise
                except Exception as error:  # zipfile and zlib let errors of many kinds through
                    message = f"the workbook is damaged or cut ({error})"
                    raise FileFormatError(message, "copy it again, or save it again", path=path) from error
            left -= len(text)
            if left < 0:
                message = "the workbook unpacks to more than a log of its size holds"
                raise FileFormatError(message, "save the sheet of the log alone", path=path)
            _check_text(path, info.filename, text)
            parts[info.filename] = text
    if _STRICT in parts.get("xl/workbook.xml", b""):
        message = "found a workbook in the form 'Strict Open XML', which openpyxl does not read"
        raise FileFormatError(message, "save it as an ordinary Excel workbook (.xlsx)", path=path)
    if "xl/workbook.bin" in names:
        message = "found a binary Excel workbook (.xlsb)"
        raise FileFormatError(message, "save it as .xlsx, or the sheet as CSV (UTF-8)", path=path)
    return parts


def _check_text(path: Path, name: str, text: bytes) -> None:
    encoding = _ENCODING.match(text.removeprefix(b"\xef\xbb\xbf"))
    if b"\0" in text[:200] or (encoding and encoding[1].lower() not in _ENCODINGS):
        message = f"the part {name!r} of the workbook is not in UTF-8, in which Excel writes"
        raise FileFormatError(message, "save it again from Excel", path=path)
    if _DECLARATION.search(text):
        message = f"the part {name!r} of the workbook declares entities, which no log needs"
        raise FileFormatError(message, "save it again from Excel", path=path)


def _packed(parts: dict[str, bytes]) -> io.BytesIO:
    """Return what was checked as an archive again, so that openpyxl reads this and nothing else."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as archive:
        for name, text in parts.items():
            archive.writestr(zipfile.ZipInfo(name), text)
    buffer.seek(0)
    return buffer
