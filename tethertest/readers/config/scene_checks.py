"""What must hold between the keys of a scene file."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from tethertest.readers.config.cable_checks import cable_problems
from tethertest.readers.config.problems import Problem
from tethertest.readers.scenes.ends import geometry_problems, tension_problems, top_problems
from tethertest.readers.scenes.motion import motion_problems
from tethertest.readers.scenes.output import output_problems
from tethertest.readers.scenes.wind import wind_problems
from tethertest.records.scene import Scene


def scene_problems(scene: Scene, folder: Path) -> Iterator[Problem]:
    """Yield everything that is wrong between the keys of a scene and the files it names in `folder`."""
    yield from cable_problems(scene.cable, scene.air)
    yield from motion_problems(scene.bottom, folder)
    yield from geometry_problems(scene)
    yield from top_problems(scene.top)
    yield from tension_problems(scene)
    if scene.air is not None:
        yield from wind_problems(scene.air, folder)
    yield from output_problems(scene)
