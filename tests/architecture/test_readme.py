"""Every command of the README can be typed as it stands."""

from __future__ import annotations

import re
import shlex
import subprocess
from pathlib import Path

import pytest
from typer.main import get_command
from typer.testing import CliRunner

from tethertest.cli import app

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^```\n(.*?)^```", README, re.DOTALL | re.MULTILINE)
TYPED = [line for block in BLOCKS for line in block.splitlines() if line.startswith("tethertest ")]
TABLE = re.findall(r"^\| `tethertest (\w+)([^`]*)`(.*)", README, re.MULTILINE)


def test_the_table_names_every_command() -> None:
    commands = get_command(app).commands  # type: ignore[attr-defined]
    assert sorted(name for name, _, _ in TABLE) == sorted(commands)


@pytest.mark.parametrize(("name", "words", "text"), TABLE, ids=[name for name, _, _ in TABLE])
def test_options_of_the_table_are_options(name: str, words: str, text: str) -> None:
    done = CliRunner().invoke(app, [name, "--help"], env={"COLUMNS": "200"})
    assert done.exit_code == 0
    for option in re.findall(r"(?<![\w-])--?[a-z]+", f"{words} {' '.join(re.findall('`([^`]*)`', text))}"):
        assert re.search(rf"(?<![\w-]){option}\b", done.stdout), option


def test_examples_run_one_after_the_other(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("datasets", "rigs"):
        (tmp_path / name).symlink_to(ROOT / name)
    monkeypatch.chdir(tmp_path)
    assert len(TYPED) >= 7
    for line in TYPED:
        done = CliRunner().invoke(app, shlex.split(line)[1:])
        assert done.exit_code == 0, (line, done.output)
    assert {"solved.csv", "run04.h5", "run04.mat"} <= {path.name for path in tmp_path.iterdir()}


def test_every_target_of_make_is_one() -> None:
    targets = set(re.findall(r"(?:`|^)make ([a-z-]+)", README, re.MULTILINE))
    assert {"report", "test", "lock", "plain", "oldest", "verify"} <= targets
    made = set(re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE))
    assert targets <= made


def test_files_that_the_readme_names_are_there() -> None:
    links = re.findall(r"\]\(([^)#:]+)\)", README)
    named = [word for line in README.splitlines() for word in re.findall(r"requirements[\w-]*\.lock", line)]
    assert named
    assert [name for name in {*links, *named} if not (ROOT / name).exists()] == []


def test_plain_pip_installs_what_make_does() -> None:
    done = subprocess.run(
        ["make", "--dry-run", "--always-make", "setup-report"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    )
    for words in ("--require-hashes", "requirements.lock", "--no-build-isolation --editable ."):
        assert words in done.stdout
        assert words in README
