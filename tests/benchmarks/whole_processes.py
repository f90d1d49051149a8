#!/usr/bin/env python3
"""Time the commands as whole processes against the bare imports, and weigh the page; asserts nothing.

A report is held against ``python -c "import numpy, scipy.signal, matplotlib.pyplot"`` in the same minute, in
turn, pair by pair: the ratio stays when the machine's speed drifts. Processor time is printed beside the time
on the clock, for a machine that does something else as well.
"""

from __future__ import annotations

import argparse
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[2]
COMMAND = [sys.executable, "-m", "tethertest.cli"]
BARE = [sys.executable, "-c", "import numpy, scipy.signal, matplotlib.pyplot"]
RUNS = ROOT / "datasets" / "rig3m"
REPORTED = ("run02", "run04", "run12")


class Took(NamedTuple):
    """What one process took [s]."""

    clock: float
    processor: float


def timed(command: list[str]) -> Took:
    """Return what a process takes from its start to its end."""
    before, began = os.times(), time.perf_counter()
    subprocess.run(command, check=False, stdout=subprocess.DEVNULL, cwd=ROOT)
    clock, after = time.perf_counter() - began, os.times()
    processor = after.children_user + after.children_system - before.children_user - before.children_system
    return Took(clock, processor)


def paired(arguments: list[str], pairs: int) -> tuple[Took, Took]:
    """Return the medians of a command's times and of its ratios to the bare imports, after a warm-up."""
    timed([*COMMAND, *arguments])
    timed(BARE)
    times, ratios = [], []
    for _ in range(pairs):
        ours, bare = timed([*COMMAND, *arguments]), timed(BARE)
        times.append(ours)
        ratios.append(Took(ours.clock / bare.clock, ours.processor / bare.processor))
    return _medians(times), _medians(ratios)


def _medians(found: list[Took]) -> Took:
    return Took(*(statistics.median(column) for column in zip(*found, strict=True)))


def main() -> None:
    """Print one row per command."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--pairs", type=int, default=5)
    pairs = parser.parse_args().pairs
    with tempfile.TemporaryDirectory() as folder:
        rows = {
            "tethertest --help": ["--help"],
            "tethertest solve paper-1.1": ["solve", str(ROOT / "rigs" / "scenes" / "paper-1.1.toml")],
            "tethertest inspect run02": ["inspect", str(RUNS / "run02")],
            **{f"tethertest report {run}": ["report", str(RUNS / run), "-o", folder] for run in REPORTED},
        }
        print(f"{'medians':<32} {'clock s':>8} {'cpu s':>8} {'clock ratio':>12} {'cpu ratio':>10}")
        for name, arguments in rows.items():
            took, ratio = paired(arguments, pairs)
            seconds = f"{took.clock:8.2f} {took.processor:8.2f}"
            print(f"{name:<32} {seconds} {ratio.clock:12.2f} {ratio.processor:10.2f}")
        page = Path(folder) / "report.html"
        print(f"{'page of the last':<32} {page.stat().st_size / 1e6:8.2f} MB")


if __name__ == "__main__":
    main()
