"""Every report is made by one command, which says how it is called."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path

import pytest

import reports

NAMES = sorted(path.parent.name for path in Path(reports.__path__[0]).glob("*/__main__.py"))


@pytest.mark.parametrize("name", NAMES)
def test_a_report_says_how_it_is_called_and_where_it_writes(
    name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as left:
        import_module(f"reports.{name}.__main__").main(["--help"])
    said = capsys.readouterr().out
    assert left.value.code == 0
    assert said.startswith(f"usage: python -m reports.{name} ")
    assert "-o" in said
    assert "folder for the" in said


def test_a_report_writes_its_page_into_the_folder_that_is_named_and_nowhere_else(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    from reports.lost_gratings.__main__ import main

    before = sorted(Path(reports.__path__[0]).rglob("*.md"))
    stamps = [path.stat().st_mtime_ns for path in before]
    assert main(["1", "-o", str(tmp_path / "made")]) == 0
    assert [path.name for path in (tmp_path / "made").iterdir()] == ["README.md"]
    assert (tmp_path / "made" / "README.md").read_text(encoding="utf-8") == capsys.readouterr().out
    assert [path.stat().st_mtime_ns for path in before] == stamps
