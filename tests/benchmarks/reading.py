#!/usr/bin/env python3
"""Time and weigh the reading of large logs against pandas and npTDMS; prints a table, asserts nothing.

Times are medians of one process in which the two sides take turns; memory is the peak of a process of its own
above what it holds after a small log of the same kind, as a multiple of the arrays that come out. A log is
hashed (SHA-256) when its hash is first asked for; in the columns "hashed" both sides take it.
"""

from __future__ import annotations

import argparse
import hashlib
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pandas as pd
from nptdms import ChannelObject, TdmsFile, TdmsWriter

from tethertest.readers import read_log

COLUMNS = 8
WEIGH = """
import sys
from tethertest.readers import read_log
from tethertest.readers.streaming import stream_log
def memory(key):
    for line in open("/proc/self/status", encoding="ascii"):
        if line.startswith(key):
            return int(line.split()[1]) / 1024
what, small, large = sys.argv[1:]
read_log(small)
before, arrays = memory("VmRSS"), {}
if what == "whole":
    for channel in read_log(large).channels:
        arrays |= {id(part.base): part.nbytes for part in (channel.time, channel.values)}
else:
    for piece in stream_log(large):
        del piece
print(memory("VmHWM") - before, sum(arrays.values()) / 2**20)
"""


def csv_rows(count: int) -> Iterator[str]:
    """Yield the text of a log: time, two forces, three accelerations, two strains, a temperature."""
    random = np.random.default_rng(0)
    yield "time,F_top,F_bottom,a_x,a_y,a_z,strain_1,strain_2,T\ns,N,N,m/s2,m/s2,m/s2,um/m,um/m,degC\n"
    form = "%.3f" + ",%.6f" * 5 + ",%.5f,%.5f,%.4f\n"
    for begin in range(0, count, 20_000):
        time_s = np.arange(begin, min(begin + 20_000, count)) / 1000
        values = 5 + random.normal(size=(len(time_s), COLUMNS)) * [1, 1, 3, 3, 3, 100, 100, 0.1]
        yield "".join(form % tuple(row) for row in np.column_stack([time_s, values]).tolist())


def write_csv(path: Path, count: int, encoding: str = "utf-8", *, decimal: str = ".") -> Path:
    """Write a log; with a decimal comma its columns are separated by semicolons."""
    with path.open("w", encoding=encoding) as stream:
        for text in csv_rows(count):
            stream.write(text if decimal == "." else text.replace(",", ";").replace(".", ","))
    return path


def write_tdms(path: Path, count: int, dtype: type, segments: int) -> Path:
    """Write a log of so many samples a channel."""
    random = np.random.default_rng(0)
    properties = {"wf_increment": 0.001, "wf_start_time": np.datetime64("2026-09-05T06:20:00")}
    with TdmsWriter(path) as writer:
        for _ in range(segments):
            writer.write_segment([
                ChannelObject("G", f"c{column}", (1e5 * random.normal(size=count // segments)).astype(dtype),
                              properties={**properties, "unit_string": "N"})
                for column in range(COLUMNS)
            ])  # fmt: skip
    return path


def turns(ours: Callable[[], object], theirs: Callable[[], object], repeats: int) -> tuple[float, float]:
    """Return the median times [s] of two functions that take turns, after one call of each."""
    seconds: tuple[list[float], list[float]] = ([], [])
    for repeat in range(repeats + 1):
        for function, times in zip((ours, theirs), seconds, strict=True):
            began = time.perf_counter()
            kept = function()
            if repeat:
                times.append(time.perf_counter() - began)
            del kept
    return statistics.median(seconds[0]), statistics.median(seconds[1])


def weighed(what: str, small: Path, large: Path) -> tuple[float, float]:
    """Return the peak memory [MB] of a process above its start, and the arrays [MB]."""
    command = [sys.executable, "-c", WEIGH, what, str(small), str(large)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    peak, arrays = map(float, done.stdout.split())
    return peak, arrays


def frame(path: Path, **options: object) -> pd.DataFrame:
    """Read a log as a person would who knows it by heart."""
    return pd.read_csv(path, skiprows=2, header=None, engine="c", dtype=np.float64, **options)  # type: ignore


def samples(path: Path) -> list[np.ndarray]:
    """Read the channels of a TDMS file."""
    file = TdmsFile.read(path)
    return [np.asarray(c[:], dtype=np.float64) for group in file.groups() for c in group.channels()]


def digest(path: Path) -> str:
    """Return what every log here is known by."""
    with path.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def main() -> None:
    """Print one row per kind of log."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--megabytes", type=int, default=100)
    options = parser.parse_args()
    print(
        "| log | MB | here s | there s | ratio | here hashed s | ratio hashed | peak / arrays | stream MB |"
    )
    print("|---|---:|---:|---:|---:|---:|---:|---:|---:|")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        rows, samples_of = options.megabytes * 12_500, options.megabytes * 15_600
        comma = {"sep": ";", "decimal": ",", "encoding": "gb18030"}
        for title, path, there in (
            ("CSV", write_csv(folder / "a.csv", rows), frame),
            ("CSV, decimal comma, GB 18030", write_csv(folder / "b.csv", rows, "gb18030", decimal=","),
             lambda path: frame(path, **comma)),
            ("TDMS, doubles", write_tdms(folder / "a.tdms", samples_of, np.float64, 128), samples),
            ("TDMS, counts", write_tdms(folder / "b.tdms", 2 * samples_of, np.int32, 1500), samples),
        ):  # fmt: skip
            writer = write_csv if path.suffix == ".csv" else lambda p, n: write_tdms(p, n, np.float64, 1)
            small = writer(folder / f"small{path.suffix}", 100)
            ours, theirs = turns(lambda: read_log(path), lambda: there(path), options.repeats)  # noqa: B023
            hashed, hashing = turns(lambda: read_log(path).sha256, lambda: digest(path), options.repeats)  # noqa: B023
            peak, arrays = weighed("whole", small, path)
            streamed, _ = weighed("stream", small, path)
            ratios = f"{ours / theirs:.2f} | {hashed:.3f} | {hashed / (theirs + hashing):.2f}"
            size, weights = path.stat().st_size / 1e6, f"{peak / arrays:.2f} | {streamed:.0f}"
            print(f"| {title} | {size:.0f} | {ours:.3f} | {theirs:.3f} | {ratios} | {weights} |")


if __name__ == "__main__":
    main()
