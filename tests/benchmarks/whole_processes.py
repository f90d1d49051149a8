#!/usr/bin/env python3
"""Time the commands as whole processes and weigh the page; prints medians, asserts nothing."""

from __future__ import annotations

import argparse
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).parents[2]
COMMAND = [sys.executable, "-m", "tethertest.cli"]
RUN = ROOT / "datasets" / "rig3m" / "run02"  # 90 s at 1 kHz


def timed(arguments: list[str], repeats: int) -> list[float]:
    """Return wall times [s] of a command after one warm-up."""
    seconds = []
    for repeat in range(repeats + 1):
        began = time.perf_counter()
        subprocess.run([*COMMAND, *arguments], check=False, stdout=subprocess.DEVNULL, cwd=ROOT)
        if repeat:
            seconds.append(time.perf_counter() - began)
    return seconds


def main() -> None:
    """Print one row per command."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeats", type=int, default=5)
    repeats = parser.parse_args().repeats
    with tempfile.TemporaryDirectory() as folder:
        rows = {
            "tethertest --help": ["--help"],
            "tethertest inspect run02": ["inspect", str(RUN)],
            "tethertest report run02 (90 s, 1 kHz)": ["report", str(RUN), "-o", folder],
        }
        print(f"{'command':<40} {'median s':>9} {'min s':>7} {'max s':>7}")
        for name, arguments in rows.items():
            seconds = timed(arguments, repeats)
            print(f"{name:<40} {statistics.median(seconds):9.2f} {min(seconds):7.2f} {max(seconds):7.2f}")
        page = Path(folder) / "report.html"
        print(f"{'page':<40} {page.stat().st_size / 1e6:9.2f} MB")


if __name__ == "__main__":
    main()
