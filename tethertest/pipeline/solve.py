"""The solver alone: a scene file in, time series at the gauges out."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np

from tethertest.errors import DataError
from tethertest.readers import load_scene, read_log
from tethertest.records.response import Response
from tethertest.records.scene import MeasuredMotion, Scene
from tethertest.solver import Fidelity, solve
from tethertest.units import channel_scale


def solve_scene(path: Path, fidelity: Fidelity = "auto", tolerance: float | None = None) -> Response:
    """Solve a scene file.

    Parameters
    ----------
    path : Path
        Scene file.
    fidelity : {"auto", "linear", "nonlinear"}
        Model wanted.
    tolerance : float, optional
        Relative error wanted; the scene's own if absent.

    Raises
    ------
    TethertestError
        The file, the motion it names, or the scene cannot be solved.
    """
    scene = load_scene(path)
    return solve(scene, measured=_measured_motion(scene, path), fidelity=fidelity, tolerance=tolerance)


def response_csv(response: Response) -> str:
    """Return the response as CSV: ``time_s,tension_N@0,...,strain@0,...``, one row per output time."""
    gauges = [f"{gauge:g}" for gauge in response.gauges]
    names = ["time_s", *(f"tension_N@{g}" for g in gauges), *(f"strain@{g}" for g in gauges)]
    table = np.column_stack([response.time, response.tension, response.strain])
    text = io.StringIO()
    np.savetxt(text, table, fmt="%.9g", delimiter=",", header=",".join(names), comments="")
    return text.getvalue()


def response_summary(response: Response) -> dict[str, Any]:
    """Return what ``solve --json`` prints: status, scheme, error, slack, extremes, warnings."""
    error = response.error
    return {
        "scene": response.scene.name,
        "status": response.status.name.lower(),
        "advice": response.status.value,
        "fidelity": response.fidelity,
        "scheme": response.scheme,
        "cells": response.cells,
        "time_step": response.time_step,
        "wall_s": response.wall,
        "error": {
            "numerical": error.numerical if np.isfinite(error.numerical) else None,
            "model": error.model,
            "spread": error.spread,
        },
        "gauges": [
            {
                "at": float(gauge),
                "minimum": float(response.tension[:, g].min()),
                "mean": float(response.tension[:, g].mean()),
                "maximum": float(response.tension[:, g].max()),
            }
            for g, gauge in enumerate(response.gauges)
        ],
        "slack": {f"{gauge:g}": [list(span) for span in spans] for gauge, spans in response.slack.items()},
        "warnings": list(response.warnings),
    }


def _measured_motion(scene: Scene, path: Path) -> MeasuredMotion | None:
    bottom = scene.bottom
    if bottom.motion != "measured" or bottom.file is None:
        return None
    log = read_log(path.parent / bottom.file)
    found = next((c for c in log.channels if c.name == bottom.displacement_column), None)
    if found is None:
        names = ", ".join(channel.name for channel in log.channels)
        message = f"column {bottom.displacement_column!r} is not in {bottom.file}; it has {names}"
        raise DataError(message, "correct [bottom] displacement_column", path=path)
    scale = channel_scale(bottom.unit or found.unit or "m", "displacement")
    return MeasuredMotion(found.time - found.time[0], scale.factor * (found.values - found.values[0]))
