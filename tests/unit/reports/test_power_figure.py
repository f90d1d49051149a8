"""The power of the line search as a figure: exact binomial intervals, the theory's curve, one table."""

from __future__ import annotations

import csv
import io

import numpy as np
import pytest

from reports.line_calibration.files import calibration_files
from reports.line_calibration.power import Found, binomial_interval, theoretical_power


def found(amplitude: float, count: int, records: int = 200) -> Found:
    return Found(amplitude, records, count, count, 1, theoretical_power(amplitude), -0.01, 0.02)


def test_binomial_intervals_of_clopper_and_pearson() -> None:
    assert binomial_interval(0, 10) == pytest.approx((0.0, 1.0 - 0.025**0.1))
    assert binomial_interval(10, 10) == pytest.approx((0.025**0.1, 1.0))
    low, high = binomial_interval(81, 263)  # R. G. Newcombe, Statist. Med. 17 (1998) 857-872
    assert (low, high) == pytest.approx((0.2527, 0.3676), abs=2e-4)


def test_intervals_hold_the_true_share_95_times_in_100_or_more() -> None:
    random = np.random.default_rng(1)
    for share in (0.03, 0.5, 0.97):
        ends = [binomial_interval(int(count), 60) for count in random.binomial(60, share, 400)]
        assert sum(low <= share <= high for low, high in ends) >= 366  # 0.95 less 3.1 standard errors


def test_the_theory_rises_from_the_level_to_certainty() -> None:
    powers = [theoretical_power(amplitude) for amplitude in (1e-9, 1.0, 3.0, 5.0, 10.0)]
    assert powers[0] == pytest.approx(0.01 / 7.0, rel=1e-6)
    assert np.all(np.diff(powers) > 0.0)
    assert powers[-1] > 0.999999


def test_the_files_hold_counts_and_intervals() -> None:
    files = calibration_files("# tables\n", [found(3.0, 58), found(7.0, 197)])
    assert files.keys() == {"README.md", "power.csv", "power.png"}
    assert files["power.png"].startswith(b"\x89PNG")
    rows = list(csv.DictReader(io.StringIO(files["power.csv"].decode())))
    assert [(row["amplitude"], row["found"], row["records"]) for row in rows] == [
        ("3", "58", "200"),
        ("7", "197", "200"),
    ]
    for row in rows:
        low, high = binomial_interval(int(row["found"]), 200)
        assert float(row["share_low"]) == pytest.approx(low, rel=1e-5)
        assert float(row["share_high"]) == pytest.approx(high, rel=1e-5)
        assert float(row["f_test"]) == pytest.approx(theoretical_power(float(row["amplitude"])), rel=1e-5)
