"""What takes longest to import stays away from the commands that do without it."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
#: of every shipped run and scene; each takes a tenth of a second or more
SELDOM = ("pint", "scipy.signal", "scipy.stats", "scipy.interpolate", "matplotlib.pyplot")


@pytest.mark.parametrize(
    ("arguments", "absent"),
    [
        (["--help"], (*SELDOM, "numpy", "pandas", "numba", "matplotlib", "pydantic")),
        (["solve", "rigs/scenes/paper-1.1.toml", "-o", "{folder}/solved.csv"], (*SELDOM, "matplotlib")),
        (["report", "datasets/rig3m/run04", "-o", "{folder}"], SELDOM),
    ],
    ids=["help", "solve", "report"],
)
def test_a_command_does_not_import(arguments: list[str], absent: tuple[str, ...], tmp_path: Path) -> None:
    code = (
        "import sys\n"
        "from tethertest.cli import main\n"
        "try: main()\n"
        f"finally: print('imported:', *sorted(set({absent!r}) & set(sys.modules)))\n"
    )
    command = [sys.executable, "-c", code, *(part.format(folder=tmp_path) for part in arguments)]
    said = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert said.stdout.splitlines()[-1].split() == ["imported:"], said.stderr
