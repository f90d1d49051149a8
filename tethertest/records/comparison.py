"""Measured against replayed, metric by metric, and the verdict of a run."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import Annotated

from tethertest.records.described import Doc


class Verdict(Enum):
    """Outcome of a run or a metric; the value is the key in JSON."""

    PASS = "pass"
    FAIL = "fail"
    UNDECIDED = "undecided"
    INFORMATIVE = "informative"  #: a metric without a limit


@dataclass(frozen=True, slots=True)
class Metric:
    """One number that compares measured and replayed."""

    name: Annotated[str, Doc("what is compared, such as peak_tension, order_amplitude 1, sprague_geers")]
    channel: Annotated[str, Doc("sensor of the rig")]
    unit: Annotated[str, Doc("of measured and replayed, SI")]
    measured: Annotated[float | None, Doc("null where the metric has no such number")]
    replayed: Annotated[float | None, Doc("null where the metric has no such number")]
    error: Annotated[float, Doc("relative; of a phase in rad", null="not known")]
    uncertainty: Annotated[float, Doc("standard uncertainty of the error", null="not known")]
    limit: Annotated[float | None, Doc("largest error that passes; null: none")]
    verdict: Annotated[Verdict, Doc("error and uncertainty against the limit")]
    reason: Annotated[str, Doc("the verdict in words, with the numbers")]


@dataclass(frozen=True, slots=True)
class Comparison:
    """All metrics of a run and what follows from them."""

    metrics: tuple[Metric, ...]
    verdict: Verdict
    reasons: tuple[str, ...]
