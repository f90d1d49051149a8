"""Pi groups, scale ratios and distortion between a model and its prototype."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from tethertest.records.frames import axes_or_new, table

if TYPE_CHECKING:
    import pandas as pd

    from tethertest.records.frames import Axes


@dataclass(frozen=True, slots=True)
class Variable:
    """A physical variable of the similitude with its values at both scales."""

    name: str  #: e.g. "axial_stiffness"
    unit: str  #: SI
    model: float | None = None
    prototype: float | None = None


@dataclass(frozen=True, slots=True)
class PiGroup:
    """A dimensionless product of variables, with exact exponents."""

    name: str
    exponents: dict[str, Fraction]
    model: float | None = None
    prototype: float | None = None
    ratio: float | None = None  #: model over prototype
    level: str = ""  #: matched, mild, violated or irrelevant
    meaning: str = ""


@dataclass(frozen=True, slots=True)
class Similarity:
    """Model against prototype."""

    groups: tuple[PiGroup, ...]
    ratios: dict[str, float]  #: quantity -> prototype over model
    conflicts: tuple[tuple[str, ...], ...]  #: minimal sets of demands that cannot hold together
    rank: int
    remarks: tuple[str, ...] = ()

    def to_pandas(self) -> pd.DataFrame:
        """Return the groups, one a row, with their values at both scales and how far they are from alike."""
        columns = ("name", "model", "prototype", "ratio", "level", "meaning")
        return table([{key: getattr(group, key) for key in columns} for group in self.groups], columns)

    def plot(self, axes: Axes | None = None) -> Axes:
        """Draw the groups of the model over those of the prototype, 1 where they match; return the axes."""
        used = axes_or_new(axes)
        known = {group.name: group.ratio for group in self.groups if group.ratio is not None}
        used.plot(list(known.values()), list(known), "o")
        used.set_xscale("log")
        used.axvline(1.0, color="0.3", linewidth=1.0)
        used.set_xlabel("group of the model over that of the prototype [1]")
        return used
