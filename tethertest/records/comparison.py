"""Measured against replayed, metric by metric, and the verdict of a run."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum


class Verdict(Enum):
    """Outcome of a run or a metric; the value is the key in JSON."""

    PASS = "pass"
    FAIL = "fail"
    UNDECIDED = "undecided"
    INFORMATIVE = "informative"  #: a metric without a limit


@dataclass(frozen=True, slots=True)
class Metric:
    """One number that compares measured and replayed."""

    name: str  #: e.g. "peak_tension", "order_amplitude 1", "sprague_geers"
    channel: str
    unit: str
    measured: float | None
    replayed: float | None
    error: float  #: relative, or in rad for a phase; what the limit applies to
    uncertainty: float  #: standard uncertainty of `error` (numerical, input and data together)
    limit: float | None
    verdict: Verdict
    reason: str


@dataclass(frozen=True, slots=True)
class Comparison:
    """All metrics of a run and what follows from them."""

    metrics: tuple[Metric, ...]
    verdict: Verdict
    reasons: tuple[str, ...]
