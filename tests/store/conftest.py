"""A short run of two load cells, and a conditioned run with something in every field."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tethertest.records.channel import Channel, ClockFit, ConditionedRun, Finding, Flag, Source, Window
from tethertest.store import StoreHeader

ROOT = Path(__file__).parents[2]
RIGS = ROOT / "rigs"

RUN_FILE = """\
id = "rest-01"
title = "at rest"
rig = "rig3m"
date = 2026-09-05T14:20:00+08:00

[drive]
kind = "none"

[platform]
mode = "free"

[[log]]
file = "tension.csv"
clock = "daq"
"""


def write_run(folder: Path, *, rows: int = 8000, rate: float = 500.0) -> Path:
    """Write a run folder of two load cells with noise, a spike and a hole."""
    folder.mkdir(parents=True)
    (folder / "run.toml").write_text(RUN_FILE, encoding="utf-8")
    chance = np.random.default_rng(7)
    time = np.arange(rows) / rate
    values = chance.normal(0.0, 0.015, (rows, 2)) + np.array([5.0, 3.6])
    values[rows // 2, 0] += 3.0
    lines = ["time [s],tension_top [N],tension_bottom [N]"]
    lines += [
        f"{t:.4f},{top:.5f},{bottom:.5f}" for t, (top, bottom) in zip(time, values.tolist(), strict=True)
    ]
    lines[rows // 3] = lines[rows // 3].rsplit(",", 1)[0] + ","
    (folder / "tension.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
    return folder


@pytest.fixture
def run(tmp_path: Path) -> Path:
    return write_run(tmp_path / "rest-01")


def channel(name: str, size: int, **others: object) -> Channel:
    chance = np.random.default_rng(size)
    values = chance.normal(size=size)
    values[::17] = np.nan
    flags = np.where(np.isnan(values), Flag.MISSING, Flag.NONE).astype(np.uint16)
    flags[: size // 3] |= np.uint16(Flag.HUM)
    time = -3.0 + np.cumsum(chance.uniform(0.9e-3, 1.1e-3, size))
    return Channel(name, "tension", "N", time, values, flags, **others)  # type: ignore[arg-type]


@pytest.fixture
def measured() -> ConditionedRun:
    source = Source("日志.csv", "ab" * 32, "delimited", "mV/V", "daq", ("one step", "Δ second step"))
    channels = (
        channel("拉力/top .*", 40_000, at=1.0, uncertainty=1e-3, noise=0.0151, source=source),
        channel("..", 31, at=0.0, offset_uncertainty=0.25),
        channel("a%2Fb", 5, source=Source("x", "", "lvm", "", "daq")),
        channel("a/b", 1),
    )
    clocks = (
        ClockFit("daq", "daq", 0.0, 0.0, 0.0, 0.0, "reference"),
        ClockFit("fbg/1", "daq", 0.1 + 0.2, 1e-5, -4.2e-5, 1e-7, "strain", ("12 spans", "é")),
    )
    findings = (
        Finding("拉力/top .*", "spike", "isolated", "warning", ((0.1, 0.2), (5.0, 5.0)), 12),
        Finding("fbg/1", "clock_drift", "drift", "fatal"),
        Finding("run.toml", "note", "nothing", "note", ((1.0, 2.0),)),
    )
    return ConditionedRun(
        channels, clocks, findings, Window(0.0, 5.0, "found"), None, Window(8.1, 30.2, "手")
    )


@pytest.fixture
def header() -> StoreHeader:
    return StoreHeader(
        "run07",
        'id = "run07"\ntitle = "拉力"\n',
        "rig3m",
        "# rig\n" * 30_000,
        None,
        {"tethertest": "0.1.0", "numpy": "2.4"},
        (("run.toml", "00" * 32), ("a log.csv", "11" * 32)),
        {"id": "run07", "drive_frequency_Hz": 0.3},
    )
