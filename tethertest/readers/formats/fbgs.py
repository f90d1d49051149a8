"""FBGS ILLumiSense exports: stamps to the second, line numbers, an error status, one column per grating."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Final

import numpy as np

from tethertest.errors import FileFormatError
from tethertest.readers.channels import raw_channel, unique_names, with_units
from tethertest.readers.formats.fbgs_clock import line_clock
from tethertest.readers.formats.fbgs_placing import is_wavelength, placed
from tethertest.readers.tables.text.columns import Columns, read_columns
from tethertest.readers.tables.text.document import Head, read_document
from tethertest.readers.tables.text.rows import followed_lines
from tethertest.readers.tables.text.stamps import parse_stamps, time_zone_of
from tethertest.readers.tables.text.table import Rows, check_widths, find_rows
from tethertest.records.arrays import BoolArray, frozen
from tethertest.records.channel import RawLog
from tethertest.records.run import DEFAULT, Log

NAME = "fbgs"
#: keys of a log in run.toml that it takes
USES = frozenset(["encoding", "decimal", "date_order", "time_zone", "units", "rate"])
_NUMBER: Final = "Linenumber"
_STATUS: Final = "Error status"


def sniff(head: Head) -> str | None:
    """Claim files whose first row names the columns ``Linenumber`` and ``Error status``."""
    if head.lines and {_NUMBER, _STATUS} <= {cell.strip() for cell in head.lines[0].split("\t")}:
        return f"the first row names {_NUMBER!r} and {_STATUS!r}"
    return None


def read(path: Path, settings: Log = DEFAULT) -> RawLog:
    """Read an FBGS ILLumiSense export.

    Parameters
    ----------
    path : Path
        The log, plain or in gzip or zip.
    settings : Log
        Settings of the run file: encoding, decimal, date_order, time_zone, rate, units.

    Returns
    -------
    RawLog
        Time is rebuilt from the line numbers. Slipped values are under their own gratings again, or NaN where
        that cannot be told; `as_written` has the columns as they are in the file.

    Raises
    ------
    FileFormatError
        A row is cut or ragged, a cell is no number, line numbers do not increase, or stamps contradict them.
    """
    document = read_document(path, settings.encoding)
    header = document.lines(1)[0].rstrip("\t").split("\t")
    names, renamed = unique_names(cell.strip() for cell in header)
    if _NUMBER not in names or _STATUS not in names:
        message = f"found no columns {_NUMBER!r} and {_STATUS!r} in the first row"
        raise FileFormatError(message, "choose the file that ILLumiSense exported", path=path, line=1)
    width, number, status = len(names), names.index(_NUMBER), names.index(_STATUS)
    stamps_at = [column for column in range(width) if names[column] in {"Date", "Time"}]
    gratings = [column for column in range(width) if column not in {*stamps_at, number, status}]
    if not stamps_at or not gratings:
        missing = "Date or Time" if not stamps_at else "grating"
        message = f"the first row names no column of {missing}"
        raise FileFormatError(message, "export the log again from ILLumiSense", path=path, line=1)
    text = document.from_line(2)
    decimal = settings.decimal
    rows = find_rows(path, text, 2, "\t", decimal or ("," if b"," in text[:20000] else "."))
    check_widths(rows, width, width + 1 if rows.counts[0] > width else width)
    columns = read_columns(rows, width, names, texts={*stamps_at, status}, unused={width})
    cells = [
        " ".join(filter(None, pair)) for pair in zip(*(columns.texts[c] for c in stamps_at), strict=True)
    ]
    stamps = parse_stamps(cells, path, rows.lines, settings.date_order)
    stated = settings.rate
    clock = line_clock(columns.numbers[number], stamps.seconds(), path, rows.lines, stated)
    written = np.column_stack([columns.numbers[column] for column in gratings])
    labels = [names[column] for column in gratings]
    alarmed, remarks = _alarmed(rows, columns, status)
    wavelengths = _with_unseen(is_wavelength(written), written)
    found = placed(written, labels, alarmed, rows.lines, wavelengths)
    channels = []
    for place, label in enumerate(labels):
        channel = raw_channel(label, "nm" if wavelengths[place] else "", clock.time, found.values[:, place])
        if found.flags[:, place].any():
            flags, as_written = frozen(found.flags[:, place], np.uint16), frozen(written[:, place])
            channel = replace(channel, flags=flags, as_written=as_written)
        channels.append(channel)
    return RawLog(
        path=path,
        format=NAME,
        start=stamps.start(time_zone_of(settings.time_zone, path)),
        channels=with_units(path, channels, settings),
        encoding=document.encoding,
        decimal=rows.decimal,
        separator="\t",
        date_order=stamps.date_order,
        row_lines=tuple(followed_lines(rows.lines)),
        header_line=1,
        rate=clock.rate,
        remarks=(*renamed, *columns.remarks, *clock.remarks, *_unit_remarks(wavelengths, settings), *remarks,
                 *found.remarks),
    )  # fmt: skip


def _alarmed(rows: Rows, columns: Columns, status: int) -> tuple[BoolArray, list[str]]:
    """Return the rows whose error status is not all zero, and what the status says."""
    texts = columns.texts[status]
    zero = {text for text in set(texts) if not text.replace(";", "").replace("0", "").strip()}
    alarmed = np.array([text not in zero for text in texts])
    blank = sum(not text.strip() for text in texts)
    remarks = [f"{blank} lines have no error status"] if blank else []
    if alarmed.any():
        first = int(rows.lines[np.argmax(alarmed)])
        count = int(np.count_nonzero(alarmed))
        remarks.append(f"{count} of {len(texts)} lines have an error status, first in line {first}")
    return alarmed, remarks


def _with_unseen(wavelengths: BoolArray, written: np.ndarray) -> BoolArray:
    """Count a column without any value among those before it, the first ones among those behind."""
    result = wavelengths.copy()
    unseen = ~np.any(np.isfinite(written) & (written != 0.0), axis=0)
    known = np.flatnonzero(~unseen)
    for column in np.flatnonzero(unseen):
        before = known[known < column]
        result[column] = bool(known.size) and result[before[-1] if before.size else known[0]]
    return result


def _unit_remarks(wavelengths: BoolArray, settings: Log) -> list[str]:
    if wavelengths.all():
        return [
            "the export states no units; its values lie in an interrogator's band and are wavelengths in nm"
        ]
    others = "the others have" if wavelengths.any() else "its values are no wavelengths and have"
    number = int(np.count_nonzero(wavelengths))
    some = f"{number} columns are wavelengths in nm, " if number else ""
    if settings.units:
        return [f"the export states no units; {some}{others} the unit that the run file gives, if any"]
    return [f"the export states no units; {some}{others} none until run.toml gives units for this log"]
