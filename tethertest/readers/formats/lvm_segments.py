"""The segments of a LabVIEW measurement file: where each header and its rows are, and what it states."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal, TypeAlias

import numpy as np

from tethertest.errors import FileFormatError
from tethertest.readers.tables.text.document import Document
from tethertest.records.arrays import FloatArray

XColumns: TypeAlias = Literal["no", "one", "multi"]
#: seconds and numbers of samples in a header stay far below
_LARGEST: Final = 1e15
#: units of X that are seconds, where one is stated
_SECONDS: Final = frozenset(["", "s", "sec", "second", "seconds"])
_END = "***End_of_Header***"


@dataclass(frozen=True, slots=True)
class Segment:
    """One segment: its header, and the span of its rows."""

    names: tuple[str, ...]  #: of the channels
    column_names: tuple[str, ...]  #: as in the row of names, without the comment column
    units: tuple[str, ...]
    samples: tuple[int, ...]
    starts: tuple[str, ...]  #: date and time of each channel, "" where absent
    origins: tuple[float, ...]  #: X0 [s]
    intervals: tuple[float, ...]  #: Delta_X [s]
    x_columns: XColumns
    comment: bool  #: the row of names ends with a comment column
    counts_rows: bool  #: `samples` counts the rows of this segment, not of one packet
    names_line: int
    first_line: int
    rows: bytes

    @property
    def width(self) -> int:
        """Columns of a full row."""
        return len(self.column_names) + self.comment

    def time(self, channel: int, size: int) -> FloatArray:
        """Return times [s] of a channel that has no X column."""
        place = np.arange(size, dtype=np.float64)
        return self.origins[channel] + self.intervals[channel] * place


def find_segments(document: Document, separator: str, header: dict[str, str]) -> list[Segment]:
    """Find all segments by their ``Channels`` lines.

    Raises
    ------
    FileFormatError
        The file has no segment, or a segment's header is cut.
    """
    body = document.body
    mark = f"Channels{separator}".encode()
    begins = []
    place = body.find(mark)
    while place >= 0:
        if place == 0 or body[place - 1 : place] == b"\n":
            begins.append(place)
        place = body.find(mark, place + 1)
    if not begins:
        message = "the log has a header but no segment"
        raise FileFormatError(
            message, "the logger was stopped before its first sample; choose another file", path=document.path
        )
    x_columns = header.get("X_Columns", "One").lower()
    if x_columns not in {"no", "one", "multi"}:
        message = f"X_Columns is {x_columns!r}, expected No, One or Multi"
        raise FileFormatError(message, "export the log again", path=document.path)
    single = header.get("Multi_Headings", "Yes").lower() == "no"
    ends = [*begins[1:], len(body)]
    return [
        _segment(document, begin, end, separator, x_columns, single)  # type: ignore[arg-type]
        for begin, end in zip(begins, ends, strict=True)
    ]


def _segment(
    document: Document, begin: int, end: int, separator: str, x_columns: XColumns, single: bool
) -> Segment:
    line = document.body.count(b"\n", 0, begin) + 1
    keys: dict[str, list[str]] = {}
    place = begin
    while True:
        stop = document.body.find(b"\n", place, end)
        text = document.body[place : stop if stop >= 0 else end].decode()
        place, line = stop + 1, line + 1
        if stop < 0:
            message = "the header of a segment is cut"
            raise FileFormatError(
                message, "copy the whole file from the logger again", path=document.path, line=line - 1
            )
        if text.startswith(_END):
            break
        key, *cells = text.split(separator)
        keys[key.strip()] = [cell.strip() for cell in cells]
    stop = document.body.find(b"\n", place, end)
    names_line = line
    row = document.body[place : stop if stop >= 0 else end].decode().split(separator)
    first_byte = stop + 1 if stop >= 0 else end
    comment = row[-1].strip().lower() == "comment"
    column_names = tuple(name.strip() for name in (row[:-1] if comment else row))
    step = 2 if x_columns == "multi" else 1
    names = column_names[1::step]
    count = len(names)
    stated = keys.get("Channels", [""])[0]
    if stated.isdecimal() and int(stated) != count:
        message = f"the segment states {stated} channels and has names for {count}"
        remedy = "copy the whole file from the logger again"
        raise FileFormatError(message, remedy, path=document.path, line=names_line)
    numbers = {
        key: _numbers(document, keys.get(key, []), count, step, names_line)
        for key in ("X0", "Delta_X", "Samples")
    }
    _refuse_other_abscissa(document, keys, count, step, names_line)
    dates, times = (_spread(keys.get(key, []), count, step) for key in ("Date", "Time"))
    return Segment(
        names=names,
        column_names=column_names,
        units=tuple(_spread(keys.get("Y_Unit_Label", []), count, step)),
        samples=tuple(int(value) for value in numbers["Samples"]),
        starts=tuple(
            f"{date} {time}".strip() if date else "" for date, time in zip(dates, times, strict=True)
        ),
        origins=tuple(numbers["X0"]),
        intervals=tuple(numbers["Delta_X"]),
        x_columns=x_columns,
        comment=comment,
        counts_rows=not single,
        names_line=names_line,
        first_line=names_line + 1,
        rows=document.body[first_byte:end],
    )


def _refuse_other_abscissa(
    document: Document, keys: dict[str, list[str]], count: int, step: int, line: int
) -> None:
    dimensions, units = (_spread(keys.get(key, []), count, step) for key in ("X_Dimension", "X_Unit_Label"))
    for dimension, unit in zip(dimensions, units, strict=True):
        if dimension.lower() not in {"", "time"} or unit.lower() not in _SECONDS:
            message = f"the segment stands over {dimension or 'X'} [{unit or '?'}], expected Time in seconds"
            raise FileFormatError(message, "export the samples in time", path=document.path, line=line)


def _spread(cells: list[str], count: int, step: int) -> list[str]:
    """Return one cell per channel; with an X column each, every second cell is a channel's."""
    chosen = cells[::step]
    return [*chosen, *[""] * count][:count]


def _numbers(document: Document, cells: list[str], count: int, step: int, line: int) -> list[float]:
    result = []
    for cell in _spread(cells, count, step):
        try:
            number = float(cell.replace(",", ".")) if cell else 0.0
            if not abs(number) < _LARGEST:
                raise ValueError
            result.append(number)
        except ValueError as error:
            message = f"found {cell!r} in the header of a segment, expected a number"
            raise FileFormatError(message, "export the log again", path=document.path, line=line) from error
    return result
