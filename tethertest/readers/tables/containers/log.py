"""From a table of a container to a log: names, time, units, numbers as float64."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from tethertest.errors import FileFormatError
from tethertest.readers.channels import raw_channel, with_units
from tethertest.readers.tables.containers.table import Column, Numbers, Table, listed, with_column_names
from tethertest.readers.tables.text.layout import SHOWN_ROWS
from tethertest.readers.tables.text.stamps import characters_of
from tethertest.readers.tables.time_scale import Midnights, TimeCells, TimeScale, counting_of, settle_scale
from tethertest.readers.tables.time_search import (
    STEP_TOLERANCE,
    ColumnHead,
    TableHead,
    TimeChoice,
    find_time,
    kind_of,
    no_channels,
    summed,
)
from tethertest.records.arrays import FloatArray
from tethertest.records.channel import RawChannel, RawLog
from tethertest.records.run import Log

#: whole numbers beyond this are not all float64
_EXACT = 2**53
#: remarks that an error repeats
_SHOWN = 8


def log_of(name: str, table: Table, settings: Log, *, encoding: str = "") -> RawLog:
    """Return a table as a log.

    Parameters
    ----------
    name : str
        NAME of the reader.
    table : Table
        The one table that was chosen.
    settings : Log
        The log's entry in run.toml.
    encoding : str
        Encoding of a file of text.

    Raises
    ------
    FileFormatError
        The mapping does not fit the table, its time is not evident, or it has no channels.
    """
    written = settings.columns or tuple(table.names)
    table = with_column_names(table, settings)
    if table.length == 0:
        message = "the table has no rows"
        raise table.error(message, "the logger was stopped before its first sample; choose another file")
    head = _head(table, written)
    choice = find_time(head, settings)
    held = no_channels(head)
    scale, time = _time(table, head, choice, settings)
    channels: list[RawChannel] = []
    remarks: list[str] = []
    for place, column in enumerate(table.columns):
        if place in choice.used:
            continue
        if column.remark:
            remarks.append(column.remark)
        if place in held or isinstance(column.cells, list):
            what = held.get(place, "nothing")
            remarks.append(f"column {column.name!r} holds {what} and is not a channel")
        else:
            channels.append(raw_channel(column.name, column.unit, time, _numbers(column, remarks)))
    if not channels:
        message = f"the table has a time but no channels; its columns are {listed(table.names)}"
        message = "; ".join([message, *(*table.remarks, *remarks)[:_SHOWN]])
        raise table.error(message, "choose the table that holds the data")
    return RawLog(
        path=table.path,
        format=name,
        encoding=encoding,
        start=scale.start,
        channels=with_units(table.path, channels, settings, table.names),
        date_order=scale.date_order,
        rate=choice.rate,
        remarks=(*table.remarks, *scale.remarks, *_step_remarks(table, choice, time), *remarks),
    )


def _head(table: Table, written: Sequence[str]) -> TableHead:
    """Return what the search for the time is shown."""
    columns = tuple(
        ColumnHead(
            column.name, column.unit, shown := column.cells[:SHOWN_ROWS], kind_of(shown, column.unit), name
        )
        for column, name in zip(table.columns, written, strict=True)
    )
    return TableHead(table.path, columns, table.named, table.facts)


def _time(table: Table, head: TableHead, choice: TimeChoice, settings: Log) -> tuple[TimeScale, FloatArray]:
    """Return the scale of the time and the time of every row; an error names the row as the file counts."""
    counting = counting_of(head, choice, settings)
    columns = [table.columns[place].cells for place in choice.columns]
    lines = np.arange(table.length)
    fraction = None if choice.fraction is None else np.asarray(table.columns[choice.fraction].cells)
    if counting is None:
        texts = [characters_of(cells) for cells in columns if isinstance(cells, list)]
        cells = TimeCells(lines, stamps=texts, fraction=fraction)
    else:
        exact = _exact(summed([np.asarray(column) for column in columns]))
        cells = TimeCells(lines, exact, exact, fraction=fraction)
    try:
        scale = settle_scale(head, choice, counting, settings, cells)
        time = scale.seconds(cells)
    except FileFormatError as error:
        raise table.error(error.problem, error.advice, *error.keys, row=error.line) from error
    return scale, Midnights().passed(time) if scale.dateless else time


def _exact(values: Numbers) -> Numbers:
    """Return whole numbers as int64, so that differences are not rounded."""
    if values.dtype.kind == "u" and values.dtype.itemsize == 8 and np.any(values >= 2**63):
        return values.astype(np.float64)
    return values.astype(np.int64) if values.dtype.kind in "iu" else values.astype(np.float64)


def _step_remarks(table: Table, choice: TimeChoice, time: FloatArray) -> list[str]:
    """Return a remark where the file states another step than its time has."""
    step = table.facts.step
    usual = float(np.median(np.diff(time))) if time.size > 1 else None
    if step is None or usual is None or choice.rate or abs(usual - step) <= STEP_TOLERANCE * step:
        return []
    return [f"the file says {table.facts.source}, but its time steps by {usual:g} s"]


def _numbers(column: Column, remarks: list[str]) -> FloatArray:
    written = np.asarray(column.cells)
    is_long = written.dtype.kind in "iu" and written.dtype.itemsize == 8 and written.size > 0
    if is_long and max(int(written.max()), -int(written.min())) > _EXACT:
        remarks.append(f"column {column.name!r} holds whole numbers beyond 2^53, which are rounded")
    values: FloatArray = written.astype(np.float64)
    infinite = np.isinf(values)
    if np.any(infinite):
        count = np.count_nonzero(infinite)
        remarks.append(f"column {column.name!r}: {count} infinite values read as missing")
        values = np.where(infinite, np.nan, values)
    return values
