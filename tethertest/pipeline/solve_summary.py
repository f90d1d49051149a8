"""What ``solve --json`` prints, and its JSON schema."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from tethertest.records.response import Response
from tethertest.solver.nonlinear.snap_peak import SNAP_WINDOW, running_peaks


@dataclass(frozen=True, slots=True)
class ErrorSummary:
    """Relative errors of the gauges' tension, null where not known."""

    numerical: float | None
    model: float | None
    spread: float | None
    peak: float | None  #: of the largest 20 ms mean, where the cable goes slack
    #: lowest and highest peak over the nominal one, of the members that tell the spread
    peak_range: tuple[float, float] | None


@dataclass(frozen=True, slots=True)
class GaugeSummary:
    """Tension at one gauge over the record [N], null where the solution left the range of numbers."""

    at: float
    minimum: float | None
    mean: float | None
    maximum: float | None
    #: of the running mean over 20 ms; null below 100 rows a second where the cable stays taut
    smoothed_maximum: float | None


@dataclass(frozen=True, slots=True)
class SolveSummary:
    """Answer of ``tethertest solve``, in SI; `slack` has the spans of zero tension [s] by gauge."""

    scene: str
    status: str
    advice: str
    fidelity: str
    scheme: str
    cells: int
    time_step: float
    native_times: bool
    wall_s: float
    error: ErrorSummary
    gauges: tuple[GaugeSummary, ...]
    slack: dict[str, tuple[tuple[float, float], ...]]
    warnings: tuple[str, ...]
    numbers: dict[str, float | None]


def solve_summary(response: Response) -> SolveSummary:
    """Return status, scheme, error, slack, extremes and warnings of a response."""
    error = response.error
    return SolveSummary(
        scene=response.scene.name,
        status=response.status.name.lower(),
        advice=response.status.value,
        fidelity=response.fidelity,
        scheme=response.scheme,
        cells=response.cells,
        time_step=response.time_step,
        native_times=response.native_times,
        wall_s=response.wall,
        error=ErrorSummary(
            _finite(error.numerical),
            _finite(error.model),
            _finite(error.spread),
            None if response.snap is None else _finite(response.snap.error),
            error.peak_range,
        ),
        gauges=tuple(
            GaugeSummary(
                float(at),
                _finite(tension.min()),
                _finite(tension.mean()),
                _finite(tension.max()),
                _smoothed_maximum(response, gauge),
            )
            for gauge, (at, tension) in enumerate(zip(response.gauges, response.tension.T, strict=True))
        ),
        slack={f"{gauge:g}": spans for gauge, spans in response.slack.items()},
        warnings=response.warnings,
        numbers={name: _finite(value) for name, value in response.numbers.items()},
    )


def solve_schema() -> dict[str, Any]:
    """Return the JSON Schema 2020-12 of `SolveSummary`."""
    from pydantic import TypeAdapter

    schema = TypeAdapter(SolveSummary).json_schema()
    dialect = "https://json-schema.org/draft/2020-12/schema"
    return {"$schema": dialect, **schema, "title": "tethertest solve --json"}


def _smoothed_maximum(response: Response, gauge: int) -> float | None:
    """Return the largest running mean over 20 ms: the steadier figure where a cable snaps."""
    if response.snap is not None:
        return _finite(float(response.snap.tension[gauge]))
    time, tension = response.time, response.tension[:, gauge : gauge + 1]
    rows = round(SNAP_WINDOW / float(time[1] - time[0])) if time.size > 1 else 0
    if rows < 2 or len(tension) < rows or not np.all(np.isfinite(tension)):
        return None
    return float(running_peaks(time, tension)[0])


def _finite(value: float | None) -> float | None:
    """Return a number that JSON has, else None."""
    return float(value) if value is not None and np.isfinite(value) else None
