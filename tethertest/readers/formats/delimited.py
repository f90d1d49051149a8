"""Text logs of unknown make: columns, signs, names, units and time are found by content and reported."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from tethertest.readers.channels import raw_channel, with_units
from tethertest.readers.tables.text.document import Head
from tethertest.readers.tables.text.rows import Growing, Tally, followed_lines, regrouped
from tethertest.readers.tables.text.table_log import TableLog, open_table
from tethertest.readers.tables.text.textlog import Progress
from tethertest.records.arrays import FloatArray, frozen
from tethertest.records.channel import RawLog
from tethertest.records.run import DEFAULT, Log

NAME = "delimited"
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
        "columns",
        "time",
        "rate",
    ]
)
#: characters of the first line that a person is shown
_SHOWN = 60


def sniff(head: Head) -> str | None:
    """Claim any text; the registry asks this reader only when no format reader claims the file."""
    if not head.lines:
        return None
    first = next((line.strip() for line in head.lines if line.strip()), "")
    shown = first if len(first) <= _SHOWN else f"{first[:_SHOWN]}..."
    return f"text that no format reader claims; it begins with {shown!r}"


def read(path: Path, settings: Log = DEFAULT) -> RawLog:
    """Read a CSV, TSV or space-aligned text log.

    Parameters
    ----------
    path : Path
        The log, plain or in gzip or zip.
    settings : Log
        Settings of the run file; they are needed only where the file is ambiguous.

    Returns
    -------
    RawLog
        Numeric columns as channels; a counter of seconds is kept as written, stamps and counters since 1970
        count from the first one.

    Raises
    ------
    FileFormatError
        The log is empty, cut or ragged, has text among numbers, or can be read in two ways.
    """
    table = open_table(path, settings)
    tally = Tally(table.plan.names)
    columns = [Growing(table.expected_rows) for _ in range(1 + len(table.channels))]
    encoding = table.text.encoding
    row_lines: list[tuple[int, int]] = []
    row = line = 0
    for block in table.blocks():
        row_lines += followed_lines(block.lines, row, line)
        row, line = row + len(block.lines), int(block.lines[-1])
        for column, part in zip(columns, (block.time, *block.values), strict=True):
            column.extend(part)
        tally.add(block)
        encoding = block.encoding
    arrays = [column.array() for column in columns]
    remarks = (*table.remarks_before, *tally.remarks(), *table.remarks_after)
    return replace(_log(table, settings, arrays, encoding, remarks), row_lines=tuple(row_lines))


def stream(path: Path, settings: Log, rows: int, progress: Progress | None = None) -> Iterator[RawLog]:
    """Yield the log in pieces of so many rows; together they are what `read` returns.

    Raises
    ------
    FileFormatError
        As `read`, once the mistake is reached.
    """
    table = open_table(path, settings)
    before, after = table.remarks_before, table.remarks_after
    for block in regrouped(table.blocks(progress), rows):
        tally = Tally(table.plan.names)
        tally.add(block)
        remarks = (*before, *tally.remarks(), *after)
        before = after = ()
        yield _log(table, settings, (block.time, *block.values), block.encoding, remarks)


def _log(
    table: TableLog,
    settings: Log,
    arrays: Sequence[FloatArray],
    encoding: str,
    remarks: tuple[str, ...],
) -> RawLog:
    """Return the record; the first of the arrays is the time."""
    layout, scale, path = table.layout, table.scale, table.text.path
    time = frozen(arrays[0])
    channels = [
        raw_channel(layout.names[column], layout.units[column], time, values)
        for column, values in zip(table.channels, arrays[1:], strict=True)
    ]
    return RawLog(
        path=path,
        format=NAME,
        start=scale.start,
        channels=with_units(path, channels, settings, layout.names),
        encoding=encoding,
        decimal=layout.decimal,
        separator=layout.separator,
        date_order=scale.date_order,
        header_line=layout.header_line,
        rate=scale.choice.rate,
        remarks=remarks,
    )
