"""The driver of `make mutants`: what is drawn, what is left alone, and how it is counted."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

pytest.importorskip("cosmic_ray", reason="of the extra `mutants`")

from reports.mutants import hand_made, table
from reports.mutants.sites import Mutant, sample
from reports.mutants.trial import Outcome, relevant_first

SOURCE = '''"""A module."""

from dataclasses import dataclass

LIMIT: float | None = 3.0


@dataclass(frozen=True)
class Pair:
    left: int | None


def kept(value: float | None) -> float | None:
    return value + 1.0 if value is not None and value < LIMIT else None
'''


@pytest.fixture
def root(tmp_path: Path) -> Path:
    folder = tmp_path / "tethertest" / "some"
    folder.mkdir(parents=True)
    (folder / "module.py").write_text(SOURCE, encoding="utf-8")
    return tmp_path


def test_a_seed_draws_the_same_mutants_and_each_changes_one_line(root: Path) -> None:
    found = sample(root, "some", 100, seed=1)
    assert found == sample(root, "some", 100, seed=1)
    for item in found:
        assert item.path == Path("tethertest/some/module.py")
        assert SOURCE.splitlines()[item.line - 1].strip() == item.before != item.after
        assert ast.dump(ast.parse(item.source)) != ast.dump(ast.parse(SOURCE))
    assert len(sample(root, "some", 3, seed=1)) == 3


def test_types_and_decorators_are_left_alone(root: Path) -> None:
    lines = {item.line for seed in range(20) for item in sample(root, "some", 100, seed)}
    assert lines == {5, 14}
    assert all("int | None" in item.source for item in sample(root, "some", 100, 1))


def test_a_fault_by_hand_stands_where_its_text_stands_once(
    root: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    listed = root / "list.toml"
    listed.write_text(
        "[[mutant]]\npackage = 'some'\nbefore = 'value + 1.0'\nafter = 'value - 1.0'\n"
        "[[mutant]]\npackage = 'some'\nbefore = 'value'\nafter = 'other'\n"
        "[[mutant]]\npackage = 'else'\nbefore = 'x'\nafter = 'y'\n"
    )
    monkeypatch.setattr(hand_made, "FILE", listed)
    (found,), gone = hand_made.hand_made(root, ("some",))
    assert (found.line, "value - 1.0" in found.after) == (14, True)
    assert gone == ["some: value"]


def test_files_that_know_the_module_come_first(root: Path) -> None:
    for name, text in (
        ("test_a.py", "nothing"),
        ("test_b.py", "from module import kept\nkept(1)"),
        ("test_module.py", ""),
    ):
        (root / name).write_text(text, encoding="utf-8")
    mutant = sample(root, "some", 1, 1)[0]
    assert [Path(path).name for path in relevant_first(mutant, [str(root)])] == [
        "test_module.py",
        "test_b.py",
        "test_a.py",
    ]


def test_equivalent_mutants_are_named_and_do_not_count(monkeypatch: pytest.MonkeyPatch) -> None:
    def outcome(line: int, killer: str) -> Outcome:
        return Outcome(Mutant("some", Path("tethertest/some/m.py"), line, f"x{line}", "y", ""), killer, 1.0)

    monkeypatch.setattr(table, "reasons", lambda: {("m.py", "x1", "y"): "no result depends on it"})
    text = table.table(
        [outcome(1, ""), outcome(2, ""), outcome(3, "test_z"), outcome(4, "test_z")], "T", "H", "c"
    )
    assert "| some | 4 | 2 | 1 | 1 | 67% |" in text
    assert "1 went unnoticed" in text
    assert "`x1`" in text.split("## Equivalent")[1]
    assert "no result depends on it" in text
