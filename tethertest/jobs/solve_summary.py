"""What ``solve --json`` prints."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from tethertest.records.described import Doc
from tethertest.records.response import Response
from tethertest.solver.nonlinear.snap_peak import SNAP_WINDOW, running_peaks


@dataclass(frozen=True, slots=True)
class ErrorSummary:
    """Relative errors of the gauges' tension, null where not known."""

    numerical: Annotated[float | None, Doc("from successive meshes")]
    model: Annotated[float | None, Doc("against the next fidelity")]
    spread: Annotated[float | None, Doc("from unknown damping and straightness, where the cable goes slack")]
    peak: Annotated[float | None, Doc("of the largest 20 ms mean, where the cable goes slack")]
    peak_range: Annotated[
        tuple[float, float] | None,
        Doc("of the members that tell the spread, over the nominal one"),
    ]


@dataclass(frozen=True, slots=True)
class GaugeSummary:
    """Tension at one gauge over the record [N], null where the solution left the range of numbers."""

    at: Annotated[float, Doc("fraction of the length from the bottom")]
    minimum: Annotated[float | None, Doc("smallest tension")]
    mean: Annotated[float | None, Doc("of all rows")]
    maximum: Annotated[float | None, Doc("largest tension")]
    smoothed_maximum: Annotated[
        float | None,
        Doc("of the 20 ms mean; null: too few rows a second"),
    ]


@dataclass(frozen=True, slots=True)
class SolveSummary:
    """Answer of ``tethertest solve``, in SI."""

    scene: Annotated[str, Doc("name in the scene file")]
    status: Annotated[str, Doc("ok, or what is wrong with the answer")]
    advice: Annotated[str, Doc("the status in words")]
    fidelity: Annotated[str, Doc("catenary, linear or nonlinear")]
    scheme: Annotated[str, Doc("of the model")]
    cells: Annotated[int, Doc("of the mesh; 0 without one")]
    time_step: Annotated[float, Doc("[s]", null="no steps")]
    native_times: Annotated[bool, Doc("the series are at the scheme's own time levels, not t = k/rate")]
    wall_s: Annotated[float, Doc("time that the solve took [s]")]
    error: ErrorSummary
    gauges: Annotated[tuple[GaugeSummary, ...], Doc("in the order of the scene")]
    slack: Annotated[dict[str, tuple[tuple[float, float], ...]], Doc("gauge -> spans of zero tension [s]")]
    warnings: Annotated[tuple[str, ...], Doc("what the solver does not vouch for")]
    numbers: Annotated[
        dict[str, float | None],
        Doc("frequency ratios, strain and others that chose the model"),
    ]


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
