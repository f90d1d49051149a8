"""Damaged logs are refused or read as they stand, and harmless changes change nothing."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Final

import fuzz_judge
import fuzz_seeds
import pytest

SEEDS: Final = fuzz_seeds.seeds()
#: faults that are known and open, by reader: the rows that a header counts, and names that it does not
OPEN: Final = {
    "lvm": r"Delta_X is",
    "catman": r"MAXLINES is",
    "toa5": r"is not in the row of names",
}


def new_failures(reader: str, count: int, path: Path) -> list[str]:
    failures = fuzz_judge.run(SEEDS[reader], range(count), path).failures
    known = OPEN.get(reader, r"(?!)")
    return [failure for failure in failures if not re.search(known, failure)]


@pytest.mark.parametrize("reader", SEEDS)
def test_damage_is_refused_or_read_as_it_stands(reader, tmp_path):
    assert new_failures(reader, 200, tmp_path / "log.txt") == []


@pytest.mark.verify
@pytest.mark.parametrize("reader", SEEDS)
def test_damage_is_refused_or_read_as_it_stands_at_length(reader, tmp_path):
    assert new_failures(reader, 5000, tmp_path / "log.txt") == []


@pytest.mark.parametrize(
    "seed",
    [
        seed
        for seeds in SEEDS.values()
        for seed in seeds
        if seed.is_text and seed.reader != "enlight-spectrum"
    ],
    ids=lambda seed: f"{seed.reader} {seed.kind}",
)
def test_what_means_nothing_changes_nothing(seed, tmp_path):
    assert fuzz_judge.benign(seed, tmp_path / "log.txt") == []
