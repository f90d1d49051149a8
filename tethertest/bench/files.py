"""The files that say what the bench found: a page, every run in CSV and JSON, and the figure."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

from tethertest.bench.speed import SceneSpeed
from tethertest.bench.tables import speed_csv, speed_page
from tethertest.render.as_json import as_json
from tethertest.render.blocks import Picture


def speed_files(
    scenes: Sequence[SceneSpeed],
    command: str,
    *,
    page: Sequence[str] = (),
    more: dict[str, Sequence[Any]] | None = None,
) -> dict[str, bytes]:
    """Return file name -> content.

    Parameters
    ----------
    scenes : sequence of SceneSpeed
        At least one.
    command : str
        What measured them.
    page : sequence of str
        Paragraphs that stand before the tables of single scenes.
    more : dict, optional
        Named lists of results beside the scenes.
    """
    lists = {"scenes": scenes, **(more or {})}
    results = {name: [as_json(result) for result in found] for name, found in lists.items()}
    return {
        "README.md": speed_page(scenes, command, page).encode(),
        "speed.csv": speed_csv(scenes).encode(),
        "speed.json": (json.dumps(results, ensure_ascii=False, allow_nan=False) + "\n").encode(),
        "speed.png": speed_figure(scenes).png,
    }


def speed_figure(scenes: Sequence[SceneSpeed]) -> Picture:
    """Return error against wall time, one panel per scene."""
    from tethertest.render.figures.speed import SpeedCurve, SpeedPanel, speed_against_error

    panels = []
    for scene in scenes:
        curves: dict[str, list[tuple[float, float]]] = {}
        for run in (*scene.entries, scene.chosen.run):
            if run.error is not None:
                curves.setdefault(run.curve, []).append((run.wall, run.error))
        drawn = (
            SpeedCurve(name, tuple(wall for wall, _ in points), tuple(error for _, error in points))
            for name, points in curves.items()
        )
        panels.append(SpeedPanel(scene.scene, scene.reference_error, tuple(drawn)))
    return speed_against_error(panels)
