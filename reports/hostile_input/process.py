"""Runs a command in a process of its own, and measures it with all the processes that it starts."""

from __future__ import annotations

import contextlib
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Final

ROOT: Final = Path(__file__).parents[2]
#: between two looks at the processes [s]
_PACE: Final = 0.005
#: a command that takes longer is ended [s]
LONGEST: Final = 40.0


@dataclass(frozen=True)
class Done:
    """What came of a command."""

    code: int
    output: str  #: standard output
    error: str  #: standard error
    seconds: float
    peak: float  #: sum of the largest memories of all its processes [bytes]; 0 where /proc does not tell


def run(words: tuple[str, ...], folder: Path, longest: float = LONGEST) -> Done:
    """Run ``tethertest`` with these words in a folder."""
    command = [sys.executable, "-m", "tethertest.cli", *words]
    peaks: dict[int, int] = {}
    with tempfile.TemporaryFile() as output, tempfile.TemporaryFile() as error:
        began = time.perf_counter()
        child = subprocess.Popen(command, cwd=folder, stdin=subprocess.DEVNULL, stdout=output, stderr=error)
        while child.poll() is None:
            for process in _family(child.pid):
                peaks[process] = max(peaks.get(process, 0), _peak(process))
            if time.perf_counter() - began > longest:
                child.kill()
            time.sleep(_PACE)
        seconds = time.perf_counter() - began
        output.seek(0)
        error.seek(0)
        said, complained = (stream.read().decode(errors="replace") for stream in (output, error))
    return Done(child.returncode, said, complained, seconds, float(sum(peaks.values())))


def _family(process: int) -> list[int]:
    """Return a process and all below it."""
    found, waiting = [], [process]
    while waiting:
        here = waiting.pop()
        found.append(here)
        with contextlib.suppress(OSError):
            for task in Path(f"/proc/{here}/task").iterdir():
                waiting += map(int, (task / "children").read_text().split())
    return found


def _peak(process: int) -> int:
    """Return the most memory that a process has had so far [bytes]."""
    with contextlib.suppress(OSError):
        for line in Path(f"/proc/{process}/status").read_text().splitlines():
            if line.startswith("VmHWM:"):
                return int(line.split()[1]) * 1024
    return 0
