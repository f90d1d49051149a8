"""Logs, rig, run and scene files into records."""

from tethertest.readers.config.load import load_prototype, load_prototype_of, load_rig, load_run, load_scene
from tethertest.readers.registry import READERS, identify, read_log

__all__ = [
    "READERS",
    "identify",
    "load_prototype",
    "load_prototype_of",
    "load_rig",
    "load_run",
    "load_scene",
    "read_log",
]
