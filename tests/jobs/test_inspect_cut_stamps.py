"""What inspect says of stamps that are cut to nearly the step of the rows."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tethertest.jobs.inspect import inspect_path
from tethertest.render.as_json import as_json


def cut(path: Path, time: np.ndarray) -> Path:
    rows = zip(np.floor(time / 0.01) * 0.01, np.sin(time), strict=True)
    path.write_text("t [s],F [N]\n" + "".join(f"{when:.3f},{force:.3f}\n" for when, force in rows))
    return path


def test_stamps_cut_to_nearly_a_step_have_the_rate_of_the_rows(tmp_path: Path) -> None:
    """Steps of 10 ms and 20 ms of rows every 14.3 ms: neither jitter nor gaps, nor 100 Hz."""
    time = np.arange(2000) / 70.0
    path = cut(tmp_path / "a.csv", time)
    found = as_json(inspect_path(path))
    (base,) = found["time_bases"]
    assert base["step"] == pytest.approx(1.0 / 70.0, rel=1e-5)
    assert base["quantum"] == pytest.approx(0.01, rel=1e-3)
    assert base["text"].endswith("every 14.29 ms; stamps cut to 10 ms")
    assert base["flags"]["gap"] == 0
    assert found["channels"][0]["rate"] == pytest.approx(70.0, rel=1e-5)


def test_a_gap_among_stamps_that_are_cut_is_told(tmp_path: Path) -> None:
    time = np.arange(2000) / 70.0 + 3.7 * (np.arange(2000) >= 1000)
    path = cut(tmp_path / "a.csv", time)
    (base,) = as_json(inspect_path(path))["time_bases"]
    assert "; stamps cut to 10 ms; 1 gap, the longest 3.7" in base["text"]
    assert base["flags"]["gap"] == 1
