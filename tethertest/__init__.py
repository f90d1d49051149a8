"""Experiment-data analysis and similitude for ship-borne tethered UAVs."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from tethertest.api import analyze, condition, read_log, report, scale
    from tethertest.errors import TethertestError
    from tethertest.readers import load_prototype, load_rig, load_run, load_scene
    from tethertest.records.cable import Air, Cable
    from tethertest.records.scene import (
        Accuracy,
        Bottom,
        Geometry,
        MeasuredMotion,
        Output,
        Scene,
        Top,
        WindSeries,
    )
    from tethertest.records.similarity import Variable
    from tethertest.similitude import pi_groups
    from tethertest.solver import solve

__version__ = "0.1.0"

__all__ = [
    "Accuracy",
    "Air",
    "Bottom",
    "Cable",
    "Geometry",
    "MeasuredMotion",
    "Output",
    "Scene",
    "TethertestError",
    "Top",
    "Variable",
    "WindSeries",
    "__version__",
    "analyze",
    "condition",
    "load_prototype",
    "load_rig",
    "load_run",
    "load_scene",
    "pi_groups",
    "read_log",
    "report",
    "scale",
    "solve",
]

_SCENE = ("Accuracy", "Bottom", "Geometry", "MeasuredMotion", "Output", "Scene", "Top", "WindSeries")
#: name -> module that has it, imported when it is first asked for: the command line must start fast
_HOMES = {
    **dict.fromkeys(("analyze", "condition", "read_log", "report", "scale"), "tethertest.api"),
    **dict.fromkeys(("load_prototype", "load_rig", "load_run", "load_scene"), "tethertest.readers"),
    **dict.fromkeys(_SCENE, "tethertest.records.scene"),
    **dict.fromkeys(("Air", "Cable"), "tethertest.records.cable"),
    "TethertestError": "tethertest.errors",
    "Variable": "tethertest.records.similarity",
    "pi_groups": "tethertest.similitude",
    "solve": "tethertest.solver",
}


def __getattr__(name: str) -> Any:
    """Import one of the names that a script needs."""
    from importlib import import_module

    if name not in _HOMES:
        message = f"module {__name__!r} has no attribute {name!r}"
        raise AttributeError(message)
    return getattr(import_module(_HOMES[name]), name)
