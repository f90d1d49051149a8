"""Rules of the house that no other tool checks."""

from __future__ import annotations

import ast
import re
import statistics
import subprocess
import sys
from collections.abc import Iterator
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
LONGEST_FILE = 600  #: a guide: what is longer holds more than one idea
CONTENTS = (ROOT / "reports" / "README.md").read_text(encoding="utf-8")
SOURCES = sorted(
    path
    for folder in ("tethertest", "reports", "datasets", "tests")
    for path in (ROOT / folder).rglob("*.py")
)


@pytest.fixture(scope="module")
def lengths() -> dict[str, int]:
    """Return the number of lines by file."""
    return {
        str(path.relative_to(ROOT)): len(path.read_text(encoding="utf-8").splitlines()) for path in SOURCES
    }


def test_no_file_is_long(lengths: dict[str, int]) -> None:
    assert {name: lines for name, lines in lengths.items() if lines > LONGEST_FILE} == {}


def test_median_file_stays_small(lengths: dict[str, int]) -> None:
    assert statistics.median(lengths.values()) <= 160


def _imported(path: Path, modules: set[str]) -> Iterator[str]:
    """Yield the package's modules that a file imports anywhere, functions and type checking included."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.module:
            for name in (f"{node.module}.{alias.name}" for alias in node.names):
                yield name if name in modules else node.module
        elif isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)


def test_no_modules_import_one_another_in_a_circle() -> None:
    files = {
        ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__"): path
        for path in (ROOT / "tethertest").rglob("*.py")
    }
    imports = {name: set(_imported(path, set(files))) & set(files) for name, path in files.items()}
    assert "tethertest.records.channel" in imports["tethertest.readers.registry"]
    assert len(list(TopologicalSorter(imports).static_order())) == len(files)  # a circle is an error


def test_the_pipeline_never_opens_the_truth() -> None:
    package = [path for path in SOURCES if path.is_relative_to(ROOT / "tethertest")]
    assert not [path for path in package if "truth" in path.read_text(encoding="utf-8").lower()]


REPORTS = sorted(path.parent.name for path in (ROOT / "reports").glob("*/__main__.py"))


@pytest.mark.parametrize("name", REPORTS)
def test_a_report_stands_beside_the_code_that_makes_it(name: str) -> None:
    folder = ROOT / "reports" / name
    assert f"`python -m reports.{name}" in (folder / "README.md").read_text(encoding="utf-8")
    assert f"python -m reports.{name}" in (folder / "__main__.py").read_text(encoding="utf-8")
    row = re.search(rf"\[{name}\]\({name}/README.md\) \| `python -m reports.{name}[ `]", CONTENTS)
    assert row, f"{name} is not in reports/README.md"


@pytest.mark.skipif(not (ROOT / ".git").exists(), reason="git tells what is kept")
def test_reports_of_runs_are_not_kept_and_the_others_are() -> None:
    def ignored(path: str) -> bool:
        return not subprocess.run(["git", "check-ignore", "-q", path], cwd=ROOT, check=False).returncode

    assert ignored("reports/run04/report.html")
    assert ignored("reports/a-run-of-yours/anything.csv")
    assert not [name for name in REPORTS if ignored(f"reports/{name}/README.md")]


def test_help_needs_no_heavy_package() -> None:
    heavy = ("numba", "scipy", "pandas", "pint", "matplotlib", "pydantic", "jinja2")
    code = f"import sys, tethertest.cli; print([m for m in {heavy} if m in sys.modules])"
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT)
    assert said.stdout.strip() == "[]"
