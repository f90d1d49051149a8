"""What must hold between the keys of a scene's air."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from tethertest.readers.config.problems import Problem
from tethertest.readers.scenes.shared import file_problems
from tethertest.records.cable import Air


def wind_problems(air: Air, folder: Path) -> Iterator[Problem]:
    """Yield what is wrong between the wind's keys and the file they name in `folder`."""
    if air.wind_file is None:
        return
    yield from file_problems(("air", "wind_file"), air.wind_file, folder)
    is_steady = any(air.wind) if isinstance(air.wind, tuple) else air.wind != 0.0
    if is_steady:
        text = "found beside wind_file, expected one of the two"
        yield Problem(("air", "wind"), text, "keep the file, or the steady wind")
