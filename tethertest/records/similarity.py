"""Pi groups, scale ratios and distortion between a model and its prototype."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction


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
