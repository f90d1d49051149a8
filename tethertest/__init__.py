"""Experiment-data analysis and similitude for ship-borne tethered UAVs."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from tethertest.readers import load_scene
    from tethertest.records.cable import Air, Cable
    from tethertest.records.scene import Accuracy, Bottom, Geometry, Output, Scene, Top
    from tethertest.solver import solve

__version__ = "0.1.0"

__all__ = [
    "Accuracy",
    "Air",
    "Bottom",
    "Cable",
    "Geometry",
    "Output",
    "Scene",
    "Top",
    "__version__",
    "load_scene",
    "solve",
]

#: name -> module that has it, imported when it is first asked for: the command line must start fast
_HOMES = {
    "load_scene": "tethertest.readers",
    "solve": "tethertest.solver",
    "Air": "tethertest.records.cable",
    "Cable": "tethertest.records.cable",
    **dict.fromkeys(("Accuracy", "Bottom", "Geometry", "Output", "Scene", "Top"), "tethertest.records.scene"),
}


def __getattr__(name: str) -> Any:
    """Import one of the names that a script needs."""
    from importlib import import_module

    if name not in _HOMES:
        message = f"module {__name__!r} has no attribute {name!r}"
        raise AttributeError(message)
    return getattr(import_module(_HOMES[name]), name)
