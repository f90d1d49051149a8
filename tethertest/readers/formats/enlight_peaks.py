"""ENLIGHT "Peaks" exports: a stamp, the number of peaks of each channel, then all their wavelengths."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from tethertest.errors import FileFormatError
from tethertest.readers.channels import raw_channel, with_units
from tethertest.readers.formats.enlight import find_preamble
from tethertest.readers.guards.limits import COLUMNS
from tethertest.readers.tables.text.columns import Columns, read_columns
from tethertest.readers.tables.text.document import HEAD_BYTES, Head, read_document
from tethertest.readers.tables.text.rows import followed_lines
from tethertest.readers.tables.text.stamps import parse_stamps, time_zone_of
from tethertest.readers.tables.text.table import Rows, check_widths, find_rows
from tethertest.records.arrays import FloatArray
from tethertest.records.channel import RawLog
from tethertest.records.run import DEFAULT, Log

NAME = "enlight-peaks"
#: keys of a log in run.toml that it takes
USES = frozenset(["encoding", "decimal", "date_order", "time_zone", "units"])


def sniff(head: Head) -> str | None:
    """Claim files with a row ``Timestamp<tab># CH 1``."""
    preamble = find_preamble(head.lines)
    if preamble is not None and len(preamble.names) > 1 and preamble.names[1].startswith("# CH"):
        return "a row begins with 'Timestamp' and '# CH'"
    return None


def read(path: Path, settings: Log = DEFAULT) -> RawLog:
    """Read an ENLIGHT Peaks export.

    Parameters
    ----------
    path : Path
        The log, plain or in gzip or zip.
    settings : Log
        Settings of the run file: encoding, decimal, date_order, time_zone, units.

    Returns
    -------
    RawLog
        Channels ``CH1 peak1``, ... in nm, as many as the row with most peaks has; NaN where a row has fewer.
        Where a peak is lost, its later neighbours move up one place, in the file and here.

    Raises
    ------
    FileFormatError
        Counts and width of a row disagree, a count is no whole number, or a date can be read two ways.
    """
    document = read_document(path, settings.encoding)
    preamble = find_preamble(document.body[:HEAD_BYTES].decode(errors="replace").split("\n"))
    if preamble is None:
        message = "found no row that begins with 'Timestamp' and '# CH'"
        raise FileFormatError(message, "export the peaks again from ENLIGHT", path=path)
    text = document.from_line(preamble.names_line + 1)
    decimal = preamble.decimal(text.split(b"\n", 1)[0].decode(), settings)
    rows = find_rows(path, text, preamble.names_line + 1, "\t", decimal)
    labels = [name.removeprefix("#").replace(" ", "") for name in preamble.names[1:]]
    fibres = len(labels)
    widest = int(rows.counts.max())
    check_widths(rows, 1 + fibres, widest)
    cells = [*preamble.names, *(f"wavelength {place + 1}" for place in range(widest - 1 - fibres))]
    columns = read_columns(rows, widest, cells, texts={0})
    counts = _counts(rows, columns, fibres)
    wavelengths = _wavelengths(rows, columns, counts, 1 + fibres)
    stamps = parse_stamps(columns.texts[0], path, rows.lines, preamble.date_order(settings))
    time = stamps.seconds()
    before = np.cumsum(counts, axis=1) - counts
    channels = []
    remarks = []
    for fibre, label in enumerate(labels):
        most, fewest = int(counts[:, fibre].max()), int(counts[:, fibre].min())
        if most > fewest:
            lacking = int(np.count_nonzero(counts[:, fibre] < most))
            remarks.append(f"{label} has {fewest} to {most} peaks; {lacking} rows have fewer than {most}")
        for peak in range(most):
            place = np.minimum(before[:, fibre] + peak, wavelengths.shape[1] - 1)
            value = np.take_along_axis(wavelengths, place[:, None], axis=1)[:, 0]
            values = np.where(peak < counts[:, fibre], value, np.nan)
            channels.append(raw_channel(f"{label} peak{peak + 1}", "nm", time, values))
    if not channels:
        message = "the log has rows but no peak in any of them"
        raise FileFormatError(
            message, "check the fibre and the thresholds, or choose another file", path=path
        )
    return RawLog(
        path=path,
        format=NAME,
        start=stamps.start(time_zone_of(settings.time_zone, path)),
        channels=with_units(path, channels, settings),
        encoding=document.encoding,
        decimal=decimal,
        separator="\t",
        date_order=stamps.date_order,
        row_lines=tuple(followed_lines(rows.lines)),
        header_line=preamble.names_line,
        remarks=(*columns.remarks, *remarks),
    )


def _counts(rows: Rows, columns: Columns, fibres: int) -> np.ndarray[tuple[int, int], np.dtype[np.int64]]:
    """Return (n, fibres) numbers of peaks."""
    counts = np.column_stack([columns.numbers[1 + fibre] for fibre in range(fibres)])
    wrong = np.any(~((counts >= 0) & (counts <= COLUMNS) & (counts == np.rint(counts))), axis=1)
    if np.any(wrong):
        message = "the number of peaks of a channel is not a whole number"
        remedy = "export the peaks again from ENLIGHT; a file saved by a spreadsheet may have lost its counts"
        raise FileFormatError(message, remedy, path=rows.path, line=int(rows.lines[np.argmax(wrong)]))
    return counts.astype(np.int64)


def _wavelengths(
    rows: Rows, columns: Columns, counts: np.ndarray[tuple[int, int], np.dtype[np.int64]], first: int
) -> FloatArray:
    """Return (n, m) wavelengths from the left of each row, after checking the row's width."""
    widest = int(rows.counts.max())
    values = np.full((len(rows.lines), max(widest - first, 1)), np.nan)
    for column in range(first, widest):
        values[:, column - first] = columns.numbers[column]
    total = counts.sum(axis=1)
    found = np.sum(np.isfinite(values), axis=1)
    places = np.arange(values.shape[1])
    gaps = np.any(np.isnan(values) & (places < total[:, None]), axis=1)
    wrong = (found != total) | gaps
    if np.any(wrong):
        row = int(np.argmax(wrong))
        message = f"the counts of the row announce {total[row]} wavelengths, found {found[row]}"
        if row == len(rows.lines) - 1 and found[row] < total[row]:
            message = f"the last row is cut: {message}"
        remedy = "copy the file again from the interrogator; do not open and save it with a spreadsheet"
        raise FileFormatError(message, remedy, path=rows.path, line=int(rows.lines[row]))
    return values
