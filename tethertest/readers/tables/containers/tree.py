"""Files that hold arrays under names: HDF5, MATLAB and JSON, as one tree without its values."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from tethertest.readers.tables.containers.table import Column, Numbers
from tethertest.readers.tables.time_units import Facts

#: what a file calls a number that says how far its samples are apart, without blanks and signs, in lower case
_RATES: Final = frozenset([
    "fs", "rate", "samplerate", "samplingrate", "samplefrequency", "samplingfrequency", "samplefreq",
    "samplingfreq", "sampleratehz", "samplingratehz",
])  # fmt: skip
_STEPS: Final = frozenset([
    "dt", "timestep", "deltat", "sampleinterval", "samplinginterval", "sampleperiod", "samplingperiod",
    "wfincrement",
])  # fmt: skip
_TIME_UNITS: Final = frozenset(["timeunit", "timeunits"])
#: what a file calls the list of the names of a matrix' columns
NAME_LISTS: Final = ("columns", "names", "column_names", "channels", "channel_names", "labels", "header")
UNIT_KEYS: Final = ("unit", "units", "Unit", "Units")


@dataclass(frozen=True, slots=True, eq=False)
class Leaf:
    """One array: a vector, or a matrix whose rows or columns are the samples."""

    name: str
    shape: tuple[int, ...]  #: one or two lengths
    load: Callable[[], Numbers | list[str] | Column]  #: returns the values, of that shape
    unit: str = ""
    units: tuple[str, ...] = ()  #: of the columns of a matrix
    names: tuple[str, ...] = ()  #: of the columns of a matrix
    rows_first: bool = False  #: the first axis is known to be the samples
    remark: str = ""  #: what is done to the values as they are loaded


@dataclass(frozen=True, slots=True, eq=False)
class Records:
    """One array of records: a table of its own."""

    name: str
    length: int
    names: tuple[str, ...]
    load: Callable[[], tuple[Column, ...]]


@dataclass(frozen=True, slots=True, eq=False)
class Branch:
    """One group, struct or object with the arrays directly in it."""

    path: str  #: "" for the file itself
    leaves: tuple[Leaf, ...]
    records: tuple[Records, ...] = ()
    facts: Facts = field(default_factory=Facts)


@dataclass(frozen=True, slots=True, eq=False)
class Tree:
    """All that a file holds."""

    path: Path
    what: str  #: as in "an HDF5 file"
    separator: str  #: between the parts of a path
    branches: tuple[Branch, ...]
    left_out: Mapping[str, str] = field(default_factory=dict)  #: path of what cannot be read -> why

    def joined(self, branch: Branch, name: str) -> str:
        """Return the path of something in a branch."""
        return f"{branch.path}{self.separator}{name}" if branch.path else name


def facts_of(scalars: Mapping[str, object]) -> Facts:
    """Return what single values beside the arrays say of the time.

    Parameters
    ----------
    scalars : mapping of str to object
        Numbers and texts by name; names such as ``fs``, ``dt`` and ``time units`` are known. Two that
        disagree say nothing.
    """
    found: list[tuple[float, str]] = []
    unit = ""
    for name, value in scalars.items():
        key = "".join(letter for letter in name.lower() if letter.isalnum())
        if isinstance(value, str):
            unit = value.strip() if key in _TIME_UNITS else unit
        elif isinstance(value, int | float) and not isinstance(value, bool) and value > 0:
            if key in _STEPS:
                found.append((float(value), f"{name} = {value:g}"))
            elif key in _RATES:
                found.append((1.0 / float(value), f"{name} = {value:g}"))
    steps = [step for step, _ in found]
    if not found or max(steps) - min(steps) > 1e-6 * max(steps):
        return Facts(time_unit=unit)
    return Facts(found[0][0], found[0][1], unit)
