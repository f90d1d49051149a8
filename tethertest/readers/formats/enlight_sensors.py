"""ENLIGHT "Sensors" exports: a stamp and one value per sensor, tab separated."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from tethertest.errors import FileFormatError
from tethertest.readers.channels import INTERROGATOR_BAND, raw_channel, unique_names, with_units
from tethertest.readers.formats.enlight import find_preamble, has_mark
from tethertest.readers.tables.text.cells import split_unit
from tethertest.readers.tables.text.columns import read_columns
from tethertest.readers.tables.text.document import HEAD_BYTES, Head, read_document
from tethertest.readers.tables.text.rows import followed_lines
from tethertest.readers.tables.text.stamps import parse_stamps, time_zone_of
from tethertest.readers.tables.text.table import check_widths, find_rows
from tethertest.records.arrays import FloatArray
from tethertest.records.channel import RawLog
from tethertest.records.run import DEFAULT, Log

NAME = "enlight-sensors"
#: keys of a log in run.toml that it takes
USES = frozenset(["encoding", "decimal", "date_order", "time_zone", "units"])


def sniff(head: Head) -> str | None:
    """Claim files with ENLIGHT's keys or byte-order mark above a row ``Timestamp<tab>sensor...``."""
    preamble = find_preamble(head.lines)
    if preamble is None or len(preamble.names) < 2 or preamble.names[1].startswith("# CH"):
        return None
    if preamble.keys_found:
        return "ENLIGHT's keys stand above a row that begins with 'Timestamp'"
    if any("FBG" in name.upper() for name in preamble.names):
        return "a row of gratings (FBG) begins with 'Timestamp'"
    if has_mark(head) and preamble.names_line == 1:
        return "a byte-order mark and a row that begins with 'Timestamp'"
    return None


def read(path: Path, settings: Log = DEFAULT) -> RawLog:
    """Read an ENLIGHT Sensors export.

    Parameters
    ----------
    path : Path
        The log, plain or in gzip or zip.
    settings : Log
        Settings of the run file: encoding, decimal, date_order, time_zone, units.

    Returns
    -------
    RawLog
        Blank cells are NaN. The export states no units: values in the interrogator's band are nm, the rest
        have none.

    Raises
    ------
    FileFormatError
        A row is cut or ragged, a cell is no number, or a date can be read two ways.
    """
    document = read_document(path, settings.encoding)
    preamble = find_preamble(document.body[:HEAD_BYTES].decode(errors="replace").split("\n"))
    if preamble is None:
        message = "found no row of names that begins with 'Timestamp'"
        raise FileFormatError(message, "export the sensors again from ENLIGHT", path=path)
    text = document.from_line(preamble.names_line + 1)
    decimal = preamble.decimal(text.split(b"\n", 1)[0].decode(), settings)
    rows = find_rows(path, text, preamble.names_line + 1, "\t", decimal)
    names, renamed = unique_names(preamble.names)
    width = len(names)
    check_widths(rows, width, width + 1 if rows.counts[0] > width else width)
    columns = read_columns(rows, width, names, texts={0}, unused={width})
    stamps = parse_stamps(columns.texts[0], path, rows.lines, preamble.date_order(settings))
    time = stamps.seconds()
    channels = []
    assumed = []
    in_band = [_in_band(columns.numbers[column]) for column in range(1, width)]
    for column in range(1, width):
        name, unit = split_unit(names[column])
        values = columns.numbers[column]
        # a grating that was never seen is one like those beside it
        never_seen = any(in_band) and not np.any(np.isfinite(values) & (values > 0.0))
        if not unit and (in_band[column - 1] or never_seen):
            unit = "nm"
            assumed.append(name)
        channels.append(raw_channel(name, unit, time, values))
    remark = [f"the export states no units; {', '.join(assumed)} are wavelengths in nm"] if assumed else []
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
        remarks=(*renamed, *columns.remarks, *remark),
    )


def _in_band(values: FloatArray) -> bool:
    finite = values[np.isfinite(values)]
    return finite.size > 0 and bool(INTERROGATOR_BAND[0] <= np.median(finite) <= INTERROGATOR_BAND[1])
