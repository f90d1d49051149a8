"""Every mistake in a scene or its series: exit code 2, one message with its remedy, nothing written."""

from __future__ import annotations

import re
import shutil
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from tethertest.cli import main

SCENES = Path(__file__).parents[2] / "rigs" / "scenes"
MOTION = re.compile(r'motion = "harmonic".*?(?=\n\[top\])', re.DOTALL)
MEASURED = """\
motion = "measured"
direction = "vertical"
file = "heave.csv"
time_column = "time_s"
displacement_column = "heave_mm"
unit = "mm\""""


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    """A scene with a measured motion and a wind file, all of it good."""
    path = tmp_path / "in" / "scene.toml"
    path.parent.mkdir()
    shutil.copy(SCENES / "snap-150m.toml", path)
    text = MOTION.sub(MEASURED, path.read_text(encoding="utf-8"))
    air = '[air]\ndensity = "1.2 kg/m^3"\nnormal_drag = 1.2\nwind_file = "gust.csv"\n[output]'
    path.write_text(text.replace("[output]", air), encoding="utf-8")
    time = np.arange(1001) * 0.05
    write(path.with_name("heave.csv"), "time_s,heave_mm", time, 100.0 * np.sin(time))
    write(path.with_name("gust.csv"), "time_s,wind_x_m_s", time, 5.0 + np.sin(time))
    return path


def write(path: Path, names: str, *columns: np.ndarray) -> None:
    rows = [",".join(f"{value:.9g}" for value in row) for row in np.column_stack(columns)]
    path.write_text("\n".join([names, *rows, ""]), encoding="utf-8")


def line_of(path: Path, start: str) -> int:
    lines = path.read_text(encoding="utf-8").splitlines()
    return next(number for number, line in enumerate(lines, start=1) if line.startswith(start))


def edit(path: Path, old: str, new: str) -> None:
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new, 1), encoding="utf-8")


def negative_stiffness(scene: Path) -> None:
    edit(scene, '"10.02 kN"', '"-10.02 kN"')


def no_motion_file(scene: Path) -> None:
    scene.with_name("heave.csv").unlink()


def no_wind_file(scene: Path) -> None:
    scene.with_name("gust.csv").unlink()


def folder_as_motion_file(scene: Path) -> None:
    no_motion_file(scene)
    scene.with_name("heave.csv").mkdir()


def link_out_of_the_folder(scene: Path) -> None:
    scene.with_name("heave.csv").rename(scene.parents[1] / "heave.csv")
    scene.with_name("heave.csv").symlink_to(scene.parents[1] / "heave.csv")


def hole_in_the_motion(scene: Path) -> None:
    path = scene.with_name("heave.csv")
    lines = path.read_text(encoding="utf-8").splitlines(keepends=True)
    path.write_text("".join(lines[:100] + lines[120:]), encoding="utf-8")


def empty_wind(scene: Path) -> None:
    scene.with_name("gust.csv").write_bytes(b"")


def short_wind(scene: Path) -> None:
    edit(scene, '"40 s"', '"45 s"')
    time = np.arange(801) * 0.05
    write(scene.with_name("gust.csv"), "time_s,wind_x_m_s", time, time)


def column_of_another_name(scene: Path) -> None:
    edit(scene, '"heave_mm"', '"heave"')


def unit_of_another_size(scene: Path) -> None:
    edit(scene, 'unit = "mm"', 'unit = "cm"')


def unknown_key(scene: Path) -> None:
    edit(scene, "time_column", "time_colum")


CASES: dict[Callable[[Path], None], str] = {
    negative_stiffness: r"scene\.toml:{axial_stiffness}: cable\.axial_stiffness: .*expected more than 0 N",
    no_motion_file: r"scene\.toml:{file}: bottom\.file: .*no such file beside the scene",
    no_wind_file: r"scene\.toml:{wind_file}: air\.wind_file: .*no such file beside the scene",
    folder_as_motion_file: r"scene\.toml:{file}: bottom\.file: .*no such file",
    link_out_of_the_folder: r"scene\.toml:{file}: bottom\.file: .*inside the scene's folder",
    hole_in_the_motion: r"heave\.csv:101: found a hole of 1\.05 s",
    empty_wind: r"gust\.csv: the log is empty",
    short_wind: r"gust\.csv:802: the record ends 40 s after its first row, expected 45 s",
    column_of_another_name: r"heave\.csv:1: .*displacement_column = 'heave' .*time_s, heave_mm.*did you mean",
    unit_of_another_size: r"heave\.csv:1: column 'heave_mm' is in mm, but \[bottom\] unit is 'cm'",
    unknown_key: r"line {time_colum}, bottom\.time_colum: unknown key\s+fix: did you mean 'time_column'",
}


def solved(
    scene: Path, output: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> tuple[int, str, str]:
    monkeypatch.setattr(sys, "argv", ["tethertest", "solve", str(scene), "-o", str(output)])
    with pytest.raises(SystemExit) as left:
        main()
    said = capsys.readouterr()
    return int(left.value.code or 0), said.out, said.err


@pytest.mark.parametrize("spoil", list(CASES), ids=lambda case: case.__name__)
def test_bad_input_is_one_message_with_place_and_remedy_and_nothing_written(
    spoil: Callable[[Path], None],
    scene: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    spoil(scene)
    code, out, err = solved(scene, tmp_path / "out" / "response.csv", monkeypatch, capsys)
    assert (code, out) == (2, "")
    assert err.startswith("error: ")
    assert "Traceback" not in err
    assert "fix: " in err
    pattern = re.sub(r"\{(\w+)\}", lambda key: str(line_of(scene, key[1])), CASES[spoil])
    assert re.search(pattern, err, re.DOTALL), err
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("name", ["heave.csv", "gust.csv"])
def test_a_series_of_the_scene_is_not_written_over(
    name: str, scene: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    before = scene.with_name(name).read_bytes()
    code, _, err = solved(scene, scene.parent / ".." / "in" / name, monkeypatch, capsys)
    assert code == 2
    assert "is a file that the scene reads" in err
    assert scene.with_name(name).read_bytes() == before


def test_the_scene_is_read_before_it_is_spoiled(scene: Path) -> None:
    from tethertest.readers import load_scene
    from tethertest.readers.config.scene_series import read_motion, read_wind

    read = load_scene(scene)
    motion, wind = read_motion(read), read_wind(read)
    assert motion is not None
    assert wind is not None
    assert np.max(np.abs(motion.displacement)) == pytest.approx(0.1, rel=1e-3)
    assert np.mean(wind.velocity[:, 0]) == pytest.approx(5.0, abs=0.1)
