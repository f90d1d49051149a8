"""Peak memory and time of the commands on long logs: ``python tests/benchmarks/memory.py [--sizes 1e8,3e8]``.

A CSV of two load cells at 1 kHz, at rest, driven, and at rest again, is made in a temporary folder together
with its run folder. Every command works in a process of its own; from its peak the peak of a process is taken
that only imports the same modules. The log counts as the float64 arrays of the channels used: its time and
two columns. A row of Markdown is printed for each command.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

import numpy as np

ROOT = Path(__file__).parents[2]
RATE = 1000.0
#: at rest before and after the drive [s], and the drive's frequency [Hz] and amplitude [N]
REST, FREQUENCY, AMPLITUDE = 60.0, 0.3, 1.2
#: rows rendered at once
ROWS = 100_000
#: bytes of a row, about, and float64 arrays that hold what is used of it
ROW_BYTES, ARRAYS = 25.0, 3
#: commands that are measured, with what they are given; {folder} is the run, {log} its log alone
COMMANDS = {
    "inspect": ["inspect", "{log}", "--json"],
    "analyze": ["analyze", "{log}", "--drive-frequency", f"{FREQUENCY}", "--json"],
    "ingest": ["ingest", "{folder}", "-o", "{out}/run.h5"],
    "report": ["report", "{folder}", "-o", "{out}", "--json"],
}
#: a log of so many bytes shows which modules a command imports
SMALL = 2e6
RUN_IT = "import sys; from tethertest.cli import main; sys.argv[0] = 'tethertest'"
NAMES_IT = f"{RUN_IT}\ntry:\n    main()\nexcept SystemExit:\n    print(*sys.modules, file=sys.stderr)"
IMPORT_IT = """
import contextlib, importlib, sys
for name in sys.stdin.read().split():
    with contextlib.suppress(Exception):
        importlib.import_module(name)
"""

RUN_FILE = """\
id = "long-01"
title = "Synthetic: a long log of two load cells"
rig = "rig3m"
date = 2026-09-05T14:20:00+08:00

[drive]
kind = "crank-slider"
frequency = "0.3 Hz"
radius = "0.1 m"

[platform]
mode = "hold"

[[log]]
file = "tension.csv"
clock = "daq"
"""


def write_log(path: Path, size: float) -> int:
    """Write about so many bytes, and return the rows."""
    rows = max(round(size / ROW_BYTES), 80_000)
    length = rows / RATE
    rest = min(REST, length / 4.0)
    chance = np.random.default_rng(11)
    with path.open("w", encoding="ascii") as file:
        file.write("time [s],tension_top [N],tension_bottom [N]\n")
        for start in range(0, rows, ROWS):
            stamp = np.arange(start, min(start + ROWS, rows)) / RATE
            driven = (stamp > rest) & (stamp < length - rest)
            wave = np.where(driven, AMPLITUDE * np.sin(2.0 * np.pi * FREQUENCY * (stamp - rest)), 0.0)
            noise = chance.normal(0.0, 0.015, (2, stamp.size))
            columns = (stamp.tolist(), (5.0 + wave + noise[0]).tolist(), (3.6 + wave + noise[1]).tolist())
            file.write("".join(f"{t:.3f},{a:.5f},{b:.5f}\n" for t, a, b in zip(*columns, strict=True)))
    return rows


def write_run(folder: Path, size: float) -> int:
    """Write a run folder whose log has about so many bytes, and return the log's rows."""
    folder.mkdir()
    (folder / "run.toml").write_text(RUN_FILE, encoding="utf-8")
    return write_log(folder / "tension.csv", size)


def arguments(command: str, folder: Path, out: Path) -> list[str]:
    """Return the command line on a run folder."""
    given = [item.format(folder=folder, log=folder / "tension.csv", out=out) for item in COMMANDS[command]]
    return [*given, "--rigs", str(ROOT / "rigs")] if str(folder) in given else given


def peak_of(command: Sequence[str], words: str = "") -> tuple[int, float]:
    """Return the peak memory [bytes] and the time [s] of a process of its own."""
    began = time.perf_counter()
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True) as child:
        if child.stdin is not None:
            child.stdin.write(words)
            child.stdin.close()
        _, status, used = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
    if child.returncode not in {0, 1, 4}:
        sys.exit(f"{' '.join(command)}: exit code {child.returncode}")
    return used.ru_maxrss * 1024, time.perf_counter() - began


def imports_of(command: str, folder: Path, out: Path) -> int:
    """Return the peak memory of a process that imports what a command imports [bytes]."""
    small = [sys.executable, "-c", NAMES_IT, *arguments(command, folder, out)]
    names = subprocess.run(small, check=False, capture_output=True, text=True).stderr.splitlines()[-1]
    return peak_of([sys.executable, "-c", IMPORT_IT], names)[0]


def main() -> None:
    """Print one row per command and size."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sizes", default="1e8,3e8", help="bytes of the logs [%(default)s]")
    parser.add_argument("--commands", default=",".join(COMMANDS), help="[%(default)s]")
    parser.add_argument("--folder", type=Path, help="where the temporary folder is made")
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory(dir=asked.folder) as scratch:
        small, out = Path(scratch) / "small", Path(scratch) / "out"
        write_run(small, SMALL)
        imports = {command: imports_of(command, small, out) for command in asked.commands.split(",")}
        print(
            "| command | log | arrays | above imports | times the arrays | time |\n|---|---|---|---|---|---|"
        )
        for number, size in enumerate(asked.sizes.split(",")):
            folder = Path(scratch) / f"long-{number}"
            rows = write_run(folder, float(size))
            arrays = 8.0 * ARRAYS * rows
            for command, before in imports.items():
                program = [sys.executable, "-c", f"{RUN_IT}\nmain()"]
                peak, took = peak_of([*program, *arguments(command, folder, out)])
                print(
                    f"| {command} | {float(size) / 1e6:.0f} MB | {arrays / 1e6:.0f} MB | "
                    f"{(peak - before) / 1e6:.0f} MB | {(peak - before) / arrays:.2f} | {took:.0f} s |",
                    flush=True,
                )
            (folder / "tension.csv").unlink()


if __name__ == "__main__":
    main()
