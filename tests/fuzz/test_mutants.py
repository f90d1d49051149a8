"""Damaged logs are refused or read as they stand, and harmless changes change nothing."""

from __future__ import annotations

from typing import Final

import pytest

from reports.fuzzing import judge, seeds
from tethertest.readers.registry import READERS

SEEDS: Final = seeds.seeds()


def test_every_reader_has_a_log_to_damage():
    assert set(SEEDS) == {reader.NAME for reader in READERS}


@pytest.mark.parametrize("reader", SEEDS)
def test_damage_is_refused_or_read_as_it_stands(reader, tmp_path):
    assert judge.run(SEEDS[reader], range(200), tmp_path / "log.txt").failures == []


@pytest.mark.verify
@pytest.mark.parametrize("reader", SEEDS)
def test_damage_is_refused_or_read_as_it_stands_at_length(reader, tmp_path):
    assert judge.run(SEEDS[reader], range(5000), tmp_path / "log.txt").failures == []


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
    assert judge.benign(seed, tmp_path / "log.txt") == []
