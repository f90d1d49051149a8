"""What is installed: locked versions, one version number, types, and no module that one system alone has."""

from __future__ import annotations

import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

import tethertest

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
BUILD = PROJECT["build-system"]["requires"]
NEEDED = {
    "requirements.lock": PROJECT["project"]["dependencies"] + BUILD,
    "requirements-dev.lock": PROJECT["project"]["dependencies"]
    + PROJECT["project"]["optional-dependencies"]["dev"]
    + BUILD,
}
POSIX = ("fcntl", "grp", "pwd", "resource", "termios")


def locked(name: str) -> dict[str, list[str]]:
    """Return versions by package, as a lock has them for the systems it knows."""
    found: dict[str, list[str]] = {}
    for package, version in re.findall(
        r"^([\w.-]+)==([\w.+!]+)", (ROOT / name).read_text(encoding="utf-8"), re.MULTILINE
    ):
        found.setdefault(canonicalize_name(package), []).append(version)
    return found


@pytest.mark.parametrize("name", NEEDED)
def test_a_lock_has_what_is_needed_within_its_bounds(name: str) -> None:
    versions = locked(name)
    for need in map(Requirement, NEEDED[name]):
        has = versions.get(canonicalize_name(need.name), [])
        assert has, f"{need}: run make lock"
        assert all(need.specifier.contains(version) for version in has), f"{need}: run make lock"


@pytest.mark.parametrize("name", NEEDED)
def test_every_locked_version_has_hashes_and_no_host(name: str) -> None:
    text = (ROOT / name).read_text(encoding="utf-8")
    assert "://" not in text
    for entry in re.split(r"\n(?=[\w.-]+==)", text)[1:]:
        assert "--hash=sha256:" in entry, entry


def test_a_report_runs_with_the_versions_that_are_tested() -> None:
    tested = locked("requirements-dev.lock")
    runtime = locked("requirements.lock")
    assert {name: tested.get(name) for name in runtime} == runtime
    assert not {"mypy", "playwright", "pytest", "ruff", "asammdf"} & set(runtime)


def test_the_build_group_is_the_build_system() -> None:
    assert set(BUILD) <= set(PROJECT["dependency-groups"]["build"])
    assert all("==" in requirement for requirement in BUILD)


def test_the_version_stands_in_one_place() -> None:
    assert "version" in PROJECT["project"]["dynamic"]
    assert PROJECT["tool"]["hatch"]["version"]["path"] == "tethertest/__init__.py"
    assert re.fullmatch(r"\d+\.\d+\.\d+", tethertest.__version__)


def test_the_package_says_that_it_is_typed() -> None:
    assert (Path(tethertest.__file__).parent / "py.typed").is_file()


def test_commands_need_no_module_that_windows_lacks(tmp_path: Path) -> None:
    run = "datasets/rig3m/run04"
    commands = [
        ["report", run, "-o", str(tmp_path / "report")],
        ["inspect", run],
        ["analyze", f"{run}/crank.csv", "-o", str(tmp_path / "analysis")],
        ["solve", "rigs/scenes/taut-vertical-jump.toml"],
        ["scale", "rigs/rig3m.toml"],
    ]
    code = (
        f"import sys; sys.modules.update(dict.fromkeys({POSIX}))\n"
        "from typer.testing import CliRunner\n"
        "from tethertest.cli import app\n"
        f"for words in {commands}:\n"
        "    done = CliRunner().invoke(app, words)\n"
        "    print(words[0], done.exit_code, done.exception, done.stderr)\n"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    said = [f"{words[0]} 0 None" for words in commands]
    assert [line.strip() for line in done.stdout.splitlines() if line.strip()] == said
