"""Text logs of unknown make: columns, signs, names, units and time are found by content and reported."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from tethertest.errors import FileFormatError
from tethertest.readers.channels import raw_channel, unique_names, with_units
from tethertest.readers.text.document import Head, file_sha256, read_document
from tethertest.readers.text.layout import Layout, find_layout
from tethertest.readers.text.table import Columns, Rows, check_widths, find_rows, read_columns
from tethertest.readers.text.timeaxis import columns_named_time, find_time, read_time
from tethertest.records.channel import RawLog
from tethertest.records.run import Log

NAME = "delimited"


def sniff(head: Head) -> str | None:
    """Claim any text; the registry asks this reader only when no format reader claims the file."""
    return "text that no format reader claims" if head.lines else None


def read(path: Path, settings: Log | None = None) -> RawLog:
    """Read a CSV, TSV or space-aligned text log.

    Parameters
    ----------
    path : Path
        The log, plain or in gzip or zip.
    settings : Log, optional
        Settings of the run file; they are needed only where the file is ambiguous.

    Returns
    -------
    RawLog
        Numeric columns as channels; a counter of seconds is kept as written, stamps count from the first one.

    Raises
    ------
    FileFormatError
        The log is empty, cut or ragged, has text among numbers, or can be read in two ways.
    """
    document = read_document(path, settings.encoding if settings is not None else None)
    layout = find_layout(document, settings)
    names, remarks = unique_names(layout.names)
    layout = replace(layout, names=names)
    text = document.from_line(layout.first_line)
    rows = find_rows(path, text, layout.first_line, layout.separator, layout.decimal, quotes=True)
    rows = _without_comments(rows)
    check_widths(rows, layout.width, layout.width + 1 if rows.counts[0] > layout.width else layout.width)
    time_columns = find_time(layout, path)
    texts = {
        column for column, kind in enumerate(layout.kinds) if kind in {"text", "date", "time", "datetime"}
    }
    width = int(rows.counts.max())
    columns = read_columns(rows, width, [*names, "after the last name"], texts=texts | {layout.width})
    _refuse_extra_cells(rows, columns, layout)
    axis = read_time(rows, columns, layout, time_columns, settings)
    used = {*time_columns.stamps, time_columns.counter}
    blank = {column for column in columns_named_time(layout) if layout.kinds[column] == "blank"}
    channels = [
        raw_channel(names[column], layout.units[column], axis.time, columns.numbers[column])
        for column in range(layout.width)
        if column not in texts and column not in used and column not in blank
    ]
    if not channels:
        message = "the log has a time but no channels"
        raise FileFormatError(
            message, "choose the file that holds the data", path=path, line=layout.header_line
        )
    unused = [
        f"column {names[column]!r} holds {'text' if layout.kinds[column] == 'text' else 'stamps'}"
        " and is not a channel"
        for column in sorted(texts - used)
    ]
    no_header = ["the log has no header; its columns are numbered"] if layout.header_line is None else []
    return RawLog(
        path=path,
        format=NAME,
        sha256=file_sha256(path),
        start=axis.start,
        channels=with_units(path, channels, settings, names),
        encoding=document.encoding,
        decimal=layout.decimal,
        separator=layout.separator,
        date_order=axis.date_order,
        header_line=layout.header_line,
        remarks=(*no_header, *remarks, *axis.remarks, *columns.remarks, *unused),
    )


def _without_comments(rows: Rows) -> Rows:
    """Leave out comment lines between the rows."""
    if b"\n#" not in rows.body:
        return rows
    parts = rows.body.split(b"\n")[:-1]
    return rows.keep(np.array([not part.startswith(b"#") for part in parts]))


def _refuse_extra_cells(rows: Rows, columns: Columns, layout: Layout) -> None:
    """Refuse values behind the last name; a mere separator at the end of a row is harmless."""
    for row, cell in enumerate(columns.texts.get(layout.width, [])):
        if cell.strip():
            message = f"found {cell!r} behind the last named column"
            remedy = "set separator or decimal for this log in run.toml"
            raise FileFormatError(message, remedy, path=rows.path, line=int(rows.lines[row]))
