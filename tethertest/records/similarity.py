"""Pi groups, scale ratios and distortion between a model and its prototype."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Annotated

from tethertest.records.described import Doc
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

    name: Annotated[str, Doc("of the group")]
    exponents: Annotated[dict[str, Fraction], Doc("variable -> exact exponent, such as -1/2")]
    model: Annotated[float | None, Doc("value on the rig")] = None
    prototype: Annotated[float | None, Doc("value on the prototype")] = None
    ratio: Annotated[float | None, Doc("model over prototype")] = None
    level: Annotated[str, Doc("matched, mild, violated or irrelevant")] = ""
    meaning: Annotated[str, Doc("in words")] = ""


@dataclass(frozen=True, slots=True)
class Similarity:
    """Model against prototype."""

    groups: Annotated[tuple[PiGroup, ...], Doc("dimensionless products of the variables")]
    ratios: Annotated[dict[str, float], Doc("quantity -> prototype over model")]
    conflicts: Annotated[tuple[tuple[str, ...], ...], Doc("least demands that exclude each other")]
    rank: Annotated[int, Doc("of the matrix of dimensions")]
    remarks: Annotated[tuple[str, ...], Doc("what a person should know")] = ()

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
