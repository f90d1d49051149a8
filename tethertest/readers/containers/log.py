"""From a table of a container to a log: names, time, units, numbers as float64."""

from __future__ import annotations

import numpy as np

from tethertest.readers.channels import raw_channel, with_units
from tethertest.readers.containers.table import Column, Table, listed, with_column_names
from tethertest.readers.containers.time import time_axis
from tethertest.readers.text.stamps import stamp_kind
from tethertest.readers.text.table import is_number
from tethertest.readers.timeunits import CALENDARS
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
    table = with_column_names(table, settings)
    if table.length == 0:
        message = "the table has no rows"
        raise table.error(message, "the logger was stopped before its first sample; choose another file")
    axis = time_axis(table, settings)
    channels: list[RawChannel] = []
    remarks: list[str] = []
    for column in table.columns:
        if column.name in axis.used:
            continue
        if column.remark:
            remarks.append(column.remark)
        if isinstance(column.cells, list):
            remarks.append(f"column {column.name!r} holds {_text_kind(column.cells)} and is no channel")
        elif column.unit in CALENDARS:
            remarks.append(f"column {column.name!r} holds dates and is no channel")
        else:
            channels.append(raw_channel(column.name, column.unit, axis.time, _numbers(column, remarks)))
    if not channels:
        message = f"the table has a time but no channels; its columns are {listed(table.names)}"
        message = "; ".join([message, *(*table.remarks, *remarks)[:_SHOWN]])
        raise table.error(message, "choose the table that holds the data")
    return RawLog(
        path=table.path,
        format=name,
        encoding=encoding,
        start=axis.start,
        channels=with_units(table.path, channels, settings, table.names),
        date_order=axis.date_order,
        rate=axis.rate,
        remarks=(*table.remarks, *axis.remarks, *remarks),
    )


def _text_kind(cells: list[str]) -> str:
    filled = [cell.strip() for cell in cells if cell.strip()]
    if filled and all(is_number(cell, ".") or is_number(cell, ",") for cell in filled):
        return "numbers written as text"
    return "stamps" if filled and all(stamp_kind(cell) for cell in filled[:200]) else "text"


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
