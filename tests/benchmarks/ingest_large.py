"""Time and peak memory of the ingest of a long log: ``python tests/benchmarks/ingest_large.py [--size 2e9]``.

A CSV of two load cells at 1 kHz, at rest, driven, and at rest again, is made in a temporary folder and
ingested in a process of its own. The last line is a row of Markdown.
"""

from __future__ import annotations

import argparse
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

ROOT = Path(__file__).parents[2]
RATE = 1000.0
#: at rest before and after the drive [s], and the drive's frequency [Hz] and amplitude [N]
REST, FREQUENCY, AMPLITUDE = 60.0, 0.3, 1.2
#: rows rendered at once
ROWS = 100_000
#: bytes of a row, about
ROW_BYTES = 25.0

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
    rows = max(round(size / ROW_BYTES), 200_000)
    length = rows / RATE
    chance = np.random.default_rng(11)
    with path.open("w", encoding="ascii") as file:
        file.write("time [s],tension_top [N],tension_bottom [N]\n")
        for start in range(0, rows, ROWS):
            stamp = np.arange(start, min(start + ROWS, rows)) / RATE
            driven = (stamp > REST) & (stamp < length - REST)
            wave = np.where(driven, AMPLITUDE * np.sin(2.0 * np.pi * FREQUENCY * (stamp - REST)), 0.0)
            noise = chance.normal(0.0, 0.015, (2, stamp.size))
            columns = (stamp.tolist(), (5.0 + wave + noise[0]).tolist(), (3.6 + wave + noise[1]).tolist())
            file.write("".join(f"{t:.3f},{a:.5f},{b:.5f}\n" for t, a, b in zip(*columns, strict=True)))
    return rows


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--size", type=float, default=2e9, help="bytes of the log [2e9]")
    parser.add_argument("--folder", type=Path, help="where the temporary folder is made")
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory(dir=asked.folder) as scratch:
        run = Path(scratch) / "long-01"
        run.mkdir()
        (run / "run.toml").write_text(RUN_FILE, encoding="utf-8")
        rows = write_log(run / "tension.csv", asked.size)
        size = (run / "tension.csv").stat().st_size
        store = Path(scratch) / "run.h5"
        command = [sys.executable, "-m", "tethertest.cli", "ingest", str(run), "-o", str(store)]
        start = time.perf_counter()
        done = subprocess.run([*command, "--rigs", str(ROOT / "rigs")], check=False)
        took = time.perf_counter() - start
        peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024.0
        if done.returncode:
            sys.exit(done.returncode)
        print("| log | rows | store | time | peak memory |\n|---|---|---|---|---|")
        print(
            f"| {size / 1e6:.0f} MB | {rows} | {store.stat().st_size / 1e6:.0f} MB | {took:.0f} s | "
            f"{peak:.0f} MiB |"
        )


if __name__ == "__main__":
    main()
