"""A log that is described part by part is described as a whole one."""

from __future__ import annotations

from dataclasses import asdict, replace
from pathlib import Path

import numpy as np
import pytest

from tethertest.jobs import inspect
from tethertest.jobs.describe_log import described
from tethertest.jobs.describe_parts import described_in_parts
from tethertest.readers import read_log
from tethertest.readers.streaming import stream_log
from tethertest.records.inspected import LogSeen

ROWS = 40_000


def log(path: Path, force: np.ndarray, time: np.ndarray | None = None) -> Path:
    time = np.arange(force.size) * 1e-3 if time is None else time
    lines = (f"{t:.3f},{f:.4f},1.5\n" for t, f in zip(time, force, strict=True))
    path.write_text("time [s],F [N],still [N]\n" + "".join(lines))
    return path


def signal(rows: int = ROWS) -> np.ndarray:
    force = 5.0 + np.sin(np.arange(rows) * 2e-3) + np.random.default_rng(3).normal(0.0, 0.02, rows)
    force[[5000, 27_000]] += 4.0
    return force


def assert_alike(found: LogSeen, expected: LogSeen) -> None:
    for one, other in zip(found.channels, expected.channels, strict=True):
        assert replace(one, mean=None, rate=None) == replace(other, mean=None, rate=None)
        assert one.mean == pytest.approx(other.mean, rel=1e-12)
        assert one.rate == pytest.approx(other.rate)
    for one, other in zip(found.time_bases, expected.time_bases, strict=True):
        assert one.flags == other.flags
        numbers = [
            {key: value for key, value in asdict(base).items() if isinstance(value, float | int)}
            for base in (one, other)
        ]
        assert numbers[0] == pytest.approx(numbers[1], rel=1e-6, abs=1e-9)


@pytest.mark.parametrize("rows", [7000, 13_333, ROWS])
def test_spikes_gaps_and_constants_are_those_of_the_whole(rows: int, tmp_path: Path) -> None:
    time = np.arange(ROWS) * 1e-3
    time[7000:] += 0.25  # between two parts of 7000 rows
    time[20_000:] += 1.0
    path = log(tmp_path / "a.csv", signal(), time)
    found, expected = described_in_parts(stream_log(path, rows=rows)), described(read_log(path))
    assert_alike(found, expected)
    assert found.time_bases[0].flags["gap"] == 2
    assert found.channels[0].flags["spike"] == 2
    assert any("constant, all values are 1.5" in text for text in found.remarks)


def test_a_channel_that_rests_for_a_whole_part_is_not_stuck(tmp_path: Path) -> None:
    force = np.round(signal(), 4)
    force[:15_000] = 5.0
    force[15_000:30_000] += 1e-3
    found = described_in_parts(stream_log(log(tmp_path / "a.csv", force), rows=10_000))
    assert found.channels[0].flags["stuck"] <= 5000
    assert not any("'F'" in text and "constant" in text for text in found.remarks)


def test_logs_above_the_limit_are_taken_in_parts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = log(tmp_path / "a.csv", signal())
    whole = inspect.inspect_path(path)
    monkeypatch.setattr(inspect, "is_long", lambda path: True)
    monkeypatch.setattr(inspect, "ROWS", 15_000)
    parts = inspect.inspect_path(path)
    assert isinstance(whole, LogSeen)
    assert isinstance(parts, LogSeen)
    assert_alike(parts, whole)
    assert parts.entry == whole.entry
    assert any("looked at in 3 parts" in text for text in parts.remarks)
