"""A scene to be measured, with the series that it reads."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from tethertest.readers import load_scene
from tethertest.readers.config.scene_series import read_motion, read_wind
from tethertest.records.scene import MeasuredMotion, Scene, WindSeries


@dataclass(frozen=True, slots=True, eq=False)
class Case:
    """A scene with the series that it reads."""

    name: str
    scene: Scene
    measured: MeasuredMotion | None = None
    wind: WindSeries | None = None


def load_cases(paths: Sequence[Path]) -> tuple[Case, ...]:
    """Return the scenes of files, named as the files are.

    Raises
    ------
    TethertestError
        A file is no scene.
    """
    found = []
    for path in paths:
        scene = load_scene(path)
        found.append(Case(path.stem, scene, read_motion(scene), read_wind(scene)))
    return tuple(found)
