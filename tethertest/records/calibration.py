"""A load cell's calibration: the pairs of output and force behind its newtons."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from tethertest.records.described import Doc
from tethertest.records.quantity import SI

_REFERENCE = (
    "standard uncertainty of all reference forces together, relative (one set of weights, one reference cell)"
)


@dataclass(frozen=True, slots=True)
class Calibration:
    """How a load cell's output becomes force: pairs of output and force, in a log or written here."""

    log: Annotated[str, Doc("file of ``measured,real`` pairs beside the rig file")] | None = None
    units: Annotated[tuple[str, str], Doc("units of the log's two columns, where it names none")] | None = (
        None
    )
    points: Annotated[tuple[tuple[str, str], ...], Doc("pairs of output and force, text with units")] = ()
    order: Annotated[int, Doc("order of the fitted polynomial; else straight lines")] | None = None
    reference: Annotated[float, SI("1", _REFERENCE, minimum=0.0, maximum=0.1)] | None = None


@dataclass(frozen=True, slots=True)
class CalibrationPoint:
    """One pair of a calibration."""

    measured: float  #: output, in the SI unit of `CalibrationData.kind`
    force: float  #: reference force [N]
    uncertainty: float | None  #: standard uncertainty of this force alone [N]; None where none is stated
    place: str  #: where it is written, e.g. "line 4"


@dataclass(frozen=True, slots=True)
class CalibrationData:
    """The pairs of one load cell, in the order in which they were taken."""

    kind: str  #: "ratio", "voltage" or "count": what the output is
    points: tuple[CalibrationPoint, ...]
    source: str  #: file and the start of its SHA-256, or "rig file"
