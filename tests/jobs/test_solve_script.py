"""A scene in ten lines of Python, as the how-to shows it, and what importing the package costs."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


def script() -> str:
    text = (ROOT / "docs" / "how-to.md").read_text(encoding="utf-8")
    (block,) = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    return str(block)


def test_the_script_is_ten_lines_that_solve_and_plot(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import matplotlib as mpl

    mpl.use("Agg")
    monkeypatch.chdir(tmp_path)
    assert len([line for line in script().splitlines() if line.strip()]) == 10
    names: dict[str, object] = {}
    exec(compile(script(), "how-to.md", "exec"), names)
    assert names["response"].status.name == "OK"  # type: ignore[attr-defined]
    assert (tmp_path / "tension.png").read_bytes().startswith(b"\x89PNG")


def test_importing_the_package_imports_nothing_else_of_it() -> None:
    code = (
        "import sys, tethertest; "
        "print([name for name in sys.modules if name.split('.')[0] in {'numpy', 'tethertest'}])"
    )
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT)
    assert said.stdout.strip() == "['tethertest']"


def test_every_public_name_is_there() -> None:
    import tethertest

    assert all(getattr(tethertest, name) is not None for name in tethertest.__all__)
    with pytest.raises(AttributeError, match="no attribute 'sovle'"):
        _ = tethertest.sovle
