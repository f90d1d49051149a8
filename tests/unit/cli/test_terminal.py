from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from tethertest.cli.terminal import printable


def inspected(path: Path | bytes) -> subprocess.CompletedProcess[bytes]:
    command = [sys.executable, "-m", "tethertest.cli", "inspect", path]
    return subprocess.run(command, capture_output=True, check=False)


def test_control_characters_are_spelt_and_text_is_kept():
    found = {"name": "F\x1b[31m\u202e µm/m", "notes": ["a\nb\tc", 1.5, None]}
    assert printable(found) == {"name": "F\\x1b[31m\\u202e µm/m", "notes": ["a\nb\tc", 1.5, None]}


def test_names_are_no_markup_and_move_no_cursor(tmp_path):
    path = tmp_path / "a.csv"
    rows = "".join(f"{row / 10:.1f},{row % 7}.5,{row % 5}.5\n" for row in range(40))
    path.write_text("time [s],F[/b] (N),\x1b[2JG[nope] (N)\n" + rows, encoding="utf-8")
    done = inspected(path)
    assert done.returncode == 0
    said = done.stdout.decode()
    assert "F[/b]" in said
    assert "\\x1b[2JG[nope]" in said
    assert "\x1b" not in said


def test_a_name_of_a_file_that_is_no_text_is_shown(tmp_path):
    path = bytes(tmp_path) + b"/log\xff.csv"
    Path(path.decode(errors="surrogateescape")).write_text("a\n", encoding="utf-8")
    done = inspected(path)
    assert done.returncode == 2
    assert b"log\\udcff.csv" in done.stderr
