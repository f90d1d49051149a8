"""Tables and figure of the bench."""

from __future__ import annotations

import json

from tethertest.bench.files import speed_files
from tethertest.bench.speed import Chosen, Entry, SceneSpeed
from tethertest.render.figures.speed import SpeedCurve, SpeedPanel, speed_against_error

RUN = Entry("auto", 40, 0.012, 1.5e-3, -0.02, None)
SCENE = SceneSpeed(
    "taut", "a taut cable", "8 spectral elements", "other discretisation", 0.2,
    Chosen("nonlinear", "leapfrog", "ok", 2e-3, None, None, RUN),
    (Entry("catenary", 0, 0.1, None, None, None),), "a remark",
)  # fmt: skip


def test_files_say_what_was_found_and_how_they_were_made() -> None:
    files = speed_files([SCENE], "tethertest bench", page=("## More", "to say"), more={"more": [RUN]})
    assert files.keys() == {"README.md", "speed.csv", "speed.json", "speed.png"}
    page = files["README.md"].decode()
    assert "Written by `tethertest bench`" in page
    assert "## More\n\nto say\n\n## Every model" in page
    assert "lie 20% apart" in page
    rows = files["speed.csv"].decode().splitlines()
    assert rows[1] == "taut,8 spectral elements,auto,40,0.012,0.0015,-0.02,"
    assert rows[2] == "taut,8 spectral elements,catenary,0,0.1,,,"
    found = json.loads(files["speed.json"])
    assert found["scenes"][0]["chosen"]["run"]["error"] == 1.5e-3
    assert found["more"][0]["cells"] == 40


def test_figure_has_one_panel_per_scene_and_leaves_out_what_is_no_error() -> None:
    curves = (SpeedCurve("auto", (0.01,), (1e-12,)), SpeedCurve("unheard of", (0.1, 0.2), (1e-2, 1e9)))
    one = speed_against_error([SpeedPanel("first", None, curves)])
    four = speed_against_error([SpeedPanel(str(number), 1e-3, curves) for number in range(4)])
    assert one.png.startswith(b"\x89PNG")
    assert four.height > 1.5 * one.height
