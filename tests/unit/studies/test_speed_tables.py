"""Tables and figure of the bench, and time at equal error."""

from __future__ import annotations

import json

from tethertest.render.figures.speed import SpeedCurve, SpeedPanel, speed_against_error
from tethertest.studies.bench import Bench, bench_files
from tethertest.studies.peers import PeerRun, PeerScene
from tethertest.studies.speed import Chosen, Entry, SceneSpeed
from tethertest.studies.stability import Check
from tethertest.studies.targets import Target

RUN = Entry("auto", 40, 0.012, 1.5e-3, -0.02, None)
SCENE = SceneSpeed(
    "taut", "a taut cable", "8 spectral elements", "other discretisation", 0.2,
    Chosen("nonlinear", "leapfrog", "ok", 2e-3, None, None, RUN),
    (Entry("catenary", 0, 0.1, None, None, None),), "a remark",
)  # fmt: skip
PEERS = PeerScene(
    "taut",
    "closed form",
    (
        PeerRun("plain", 25, 1e-3, 4e-3),
        PeerRun("plain", 100, 5e-3, 3e-4),
        PeerRun("extrapolated", 50, 2e-3, 1e-4),
        PeerRun("MoorDyn", 100, 0.8, 4e-3),
        PeerRun("MoorDyn", 400, 6.0, 2e-4),
        PeerRun("MoorDyn", 800, 20.0, 1e-5),
    ),
)


def test_time_at_equal_error_is_that_of_the_cheapest_run_as_good() -> None:
    assert PEERS.ratios() == ((100, 800.0, "plain", 25), (400, 3000.0, "extrapolated", 50))


def test_files_say_what_was_asked_found_and_how_they_were_made() -> None:
    bench = Bench(
        (SCENE,),
        (Target("top", "1 N", "2 N", False),),
        (PEERS,),
        (Check("long", "bounded", "bounded", True),),
    )
    files = bench_files(bench, "tethertest bench", b"png")
    assert {folder: set(content) for folder, content in files.items()} == {
        "speed-vs-error": {"README.md", "speed.csv", "speed.json", "speed.png", "moordyn.md"},
        "stability": {"README.md"},
    }
    page = files["speed-vs-error"]["README.md"].decode()
    assert "Written by `tethertest bench`" in page
    assert "| top | 1 N | 2 N | missed | value |" in page
    assert "lie 20% apart" in page
    assert "| long | bounded | bounded | met |" in files["stability"]["README.md"].decode()
    assert "| 400 | 3000 | extrapolated, 50 |" in files["speed-vs-error"]["moordyn.md"].decode()
    rows = files["speed-vs-error"]["speed.csv"].decode().splitlines()
    assert rows[1] == "taut,8 spectral elements,auto,40,0.012,0.0015,-0.02,"
    assert rows[2] == "taut,8 spectral elements,catenary,0,0.1,,,"
    found = json.loads(files["speed-vs-error"]["speed.json"])
    assert found["scenes"][0]["chosen"]["run"]["error"] == 1.5e-3


def test_figure_has_one_panel_per_scene_and_leaves_out_what_is_no_error() -> None:
    curves = (SpeedCurve("auto", (0.01,), (1e-12,)), SpeedCurve("unheard of", (0.1, 0.2), (1e-2, 1e9)))
    one = speed_against_error([SpeedPanel("first", None, curves)])
    four = speed_against_error([SpeedPanel(str(number), 1e-3, curves) for number in range(4)])
    assert one.png.startswith(b"\x89PNG")
    assert four.height > 1.5 * one.height
