"""CSV: one table per time base, with a row of names and a row of units, that `inspect` reads back."""

from __future__ import annotations

import math
from collections.abc import Sequence

from tethertest.jobs.exports.source import Exported, TimeBase
from tethertest.store.whole import WholeFile

#: a cell that starts so is a formula to a spreadsheet
_FORMULA = ("=", "+", "-", "@", "\t", "\r")
#: a strain is told from other pure numbers by its unit
_UNITS = {"strain": "m/m"}
#: suffix of a channel's column of flags
FLAGS = " flags"


def write_csv(file: WholeFile, run: Exported, base: TimeBase) -> None:
    """Write one table: time, then value and flags of each channel.

    Numbers have as many digits as bring them back to the last bit; a missing value is an empty cell; flags
    are the sum of the bits of `Flag`.

    Parameters
    ----------
    file : WholeFile
        An open file.
    run : Exported
        The run; the table itself says all that a CSV can.
    base : TimeBase
        The channels.
    """
    names, units = ["time"], ["s"]
    for series in base.series:
        names += [series.about.name, f"{series.about.name}{FLAGS}"]
        units += [_UNITS.get(series.about.kind, series.about.unit), "1"]
    file.write(f"{_row(names)}{_row(units)}".encode())
    for channels in base.blocks():
        columns: list[list[str]] = [[repr(time) for time in channels[0].time.tolist()]]
        for channel in channels:
            columns.append(["" if math.isnan(value) else repr(value) for value in channel.values.tolist()])
            columns.append([str(flags) for flags in channel.flags.tolist()])
        rows = (",".join(cells) for cells in zip(*columns, strict=True))
        file.write(("\n".join(rows) + "\n").encode())
        file.check()


def _row(cells: Sequence[str]) -> str:
    return ",".join(safe_cell(cell) for cell in cells) + "\n"


def safe_cell(text: str) -> str:
    """Return text as a cell that no program takes for a formula, for two cells or for two rows.

    Parameters
    ----------
    text : str
        A name or a unit. One that would start a formula gets an apostrophe before it.
    """
    plain = " ".join(text.replace("\0", " ").split("\n"))
    if plain.startswith(_FORMULA) or plain.lstrip().startswith(_FORMULA):
        plain = f"'{plain}"
    plain = plain.replace("\r", " ").replace("\t", " ")
    return '"' + plain.replace('"', '""') + '"' if any(sign in plain for sign in ',;"') else plain
