"""Conditioning in pieces gives what conditioning in memory gives."""

from __future__ import annotations

import errno
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tethertest.conditioning import condition
from tethertest.conditioning.flags.stuck_saturated import plateaus_of, with_plateaus_flagged
from tethertest.conditioning.timestamps.stamps import audit_stamps
from tethertest.errors import DataError, TethertestError
from tethertest.jobs.evaluation import read_logs, rig_priors
from tethertest.jobs.ingest import ingest_run
from tethertest.jobs.long_runs.columns import Column, Scratch, Sizes
from tethertest.jobs.long_runs.gather import gathered
from tethertest.jobs.long_runs.ingest import Sources, ingest_long
from tethertest.jobs.long_runs.record import record_of
from tethertest.jobs.stored import store_header
from tethertest.readers import load_run
from tethertest.records.channel import Channel, ConditionedRun, Flag, RawChannel, RawLog
from tethertest.records.run import Run
from tethertest.signal.noise import quantum_of, white_noise
from tethertest.store import load_store

ROOT = Path(__file__).parents[2]
RIGS = ROOT / "rigs"
CAMPAIGN = ROOT / "datasets" / "rig3m"
#: a campaign run takes some fifteen of these blocks
TINY = Sizes(block=4096, whole=20_000, thinned=1 << 40)


def pieces(log: RawLog, rows: int) -> Iterator[RawLog]:
    size = log.channels[0].time.size
    for start in range(0, size, rows):
        part = slice(start, start + rows)
        channels = (
            replace(channel, time=channel.time[part], values=channel.values[part]) for channel in log.channels
        )
        yield replace(log, channels=tuple(channels))


def both_ways(folder: Path, target: Path, sizes: Sizes) -> tuple[ConditionedRun, ConditionedRun]:
    run = load_run(folder, RIGS)
    logs = read_logs(run)
    long = {log.key for log in run.file.log if not log.file.startswith("fbg")}
    sources = Sources(
        {key: log for key, log in logs.items() if key not in long},
        {key: pieces(logs[key], 3001) for key in long},
    )
    ingest_long(run, sources, target, lambda raws: store_header(run, raws), lambda words, share: None, sizes)
    return load_store(target).measured, condition(run, logs, rig_priors(run))


def assert_equal_but_for_noise(found: ConditionedRun, expected: ConditionedRun, errors: float) -> None:
    assert (found.clocks, found.rest_before, found.steady) == (
        expected.clocks,
        expected.rest_before,
        expected.steady,
    )
    for one, other in zip(found.channels, expected.channels, strict=True):
        assert (one.name, one.kind, one.unit, one.at) == (other.name, other.kind, other.unit, other.at)
        assert np.array_equal(one.time, other.time)
        assert np.array_equal(one.flags, other.flags), one.name
        assert np.allclose(one.values, other.values, rtol=0.0, atol=errors, equal_nan=True), one.name
        assert one.noise == pytest.approx(other.noise, rel=0.2)
        assert one.uncertainty == other.uncertainty
    about = [[(item.subject, item.kind, item.samples) for item in run.findings] for run in (found, expected)]
    assert sorted(about[0]) == sorted(about[1])


@pytest.mark.verify
def test_a_run_with_spikes_hum_and_dropped_rows(tmp_path: Path) -> None:
    found, expected = both_ways(CAMPAIGN / "run21", tmp_path / "run.h5", TINY)
    assert_equal_but_for_noise(found, expected, 1e-12)
    flags = {name: count for channel in found.channels for name, count in channel.flag_counts().items()}
    assert {"spike", "hum", "gap"} <= set(flags)
    assert [one.source for one in found.channels] == [other.source for other in expected.channels]


@pytest.mark.verify
@pytest.mark.parametrize("name", ["run17", "run19", "run20", "run22"])
def test_runs_with_other_faults(name: str, tmp_path: Path) -> None:
    found, expected = both_ways(CAMPAIGN / name, tmp_path / "run.h5", TINY)
    assert_equal_but_for_noise(found, expected, 1e-12)


@pytest.mark.verify
@pytest.mark.parametrize("name", ["run04", "run21"])
def test_constants_of_a_thinned_copy_agree_within_their_errors(name: str, tmp_path: Path) -> None:
    """Means of two samples; knocks need 60 Hz of the motion, which has 100 Hz then."""
    sizes = replace(TINY, whole=5000, thinned=120_000)
    found, expected = both_ways(CAMPAIGN / name, tmp_path / "run.h5", sizes)
    for one, other in zip(found.clocks, expected.clocks, strict=True):
        assert one.offset == pytest.approx(other.offset, abs=4.0 * other.offset_error + 1e-12)
    for one, other in zip(found.channels, expected.channels, strict=True):
        if other.kind in {"tension", "displacement"}:
            both = one.usable & other.usable
            error = 4.0 * other.noise / np.sqrt(500.0)
            assert np.abs(one.values - other.values)[both].max() < error
            assert np.count_nonzero(one.flags != other.flags) == 0


def run_of_tensions(tmp_path: Path, run: Path, time: np.ndarray, values: np.ndarray) -> tuple[Run, RawLog]:
    channel = RawChannel("tension_top", "N", time, values)
    return load_run(run, RIGS), RawLog(tmp_path / "tension.csv", "delimited", None, (channel,))


def dropped_twice(time: np.ndarray) -> np.ndarray:
    return np.insert(np.delete(time, 2500), [1000, 4000], time[[1000, 4000]])


def stood_still(time: np.ndarray) -> np.ndarray:
    changed = time.copy()
    # one of them is the first row of a block of 512
    changed[[4095, 4608, 7000]] = changed[[4094, 4607, 6999]]
    return changed


STAMPS: dict[str, Callable[[np.ndarray], np.ndarray]] = {
    "clean": lambda time: time,
    "gaps": lambda time: np.delete(time, np.r_[100:130, 5000:5001]),
    "repeats": dropped_twice,
    "stood still": stood_still,
    "jitter": lambda time: time + np.random.default_rng(1).normal(0.0, 2e-4, time.size),
    "quantised": lambda time: np.floor(time / 0.0125) * 0.0125,
    "cut to nearly a step": lambda time: np.delete(np.floor(time / 0.00137) * 0.00137, np.r_[3000:3100]),
    "jitter and gaps": lambda time: np.delete(
        time + np.random.default_rng(2).normal(0.0, 1e-4, time.size), np.r_[3000:3100]
    ),
}


@pytest.mark.parametrize("name", STAMPS)
def test_stamps_are_audited_as_in_memory(name: str, run: Path, tmp_path: Path) -> None:
    time = STAMPS[name](np.arange(9000) * 0.002)
    values = np.random.default_rng(3).normal(size=time.size)
    loaded, raw = run_of_tensions(tmp_path, run, time, values)
    expected = audit_stamps(time, raw, "daq")
    sizes = Sizes(block=512, whole=1 << 20)
    with Scratch(tmp_path) as scratch:
        log = gathered(pieces(raw, 700), loaded.file.log[0], loaded, scratch, lambda rows: None)
        record = record_of(log, scratch, sizes)
        (found,) = record.channels(0, record.rows)
    assert np.allclose(found.time, expected.time, rtol=0.0, atol=1e-9)
    assert np.array_equal(found.values, values[expected.rows])
    assert np.array_equal(found.flags, expected.flags)
    told = [item.kind for item in record.findings if item.kind not in {"gap", "no_start"}]
    assert told == [item.kind for item in expected.findings]


def test_what_takes_the_whole_record_is_refused_with_a_remedy(run: Path, tmp_path: Path) -> None:
    step = np.arange(9000) * 0.002
    unsorted = step.copy()
    unsorted[5000:5002] = unsorted[[5001, 5000]]
    holes = np.delete(np.floor(step / 0.0125) * 0.0125, np.arange(1000, 4000, 50))
    for time, said in (
        (unsorted, "backwards at row 5002"),
        (holes, "rows are missing"),
        (step * np.nan, "no stamp"),
    ):
        loaded, raw = run_of_tensions(tmp_path, run, time, np.ones(time.size))
        with Scratch(tmp_path) as scratch:
            log = gathered(pieces(raw, 700), loaded.file.log[0], loaded, scratch, lambda rows: None)
            with pytest.raises(DataError, match=said) as refused:
                record_of(log, scratch, Sizes(block=512, whole=4096))
        assert refused.value.remedy


def plateau_channel(kind: str) -> Channel:
    chance = np.random.default_rng(5)
    values = np.round(np.cumsum(chance.normal(0.0, 0.01, 20_000)) + chance.normal(0.0, 0.005, 20_000), 3)
    values = np.clip(values, *np.quantile(values, (0.05, 0.97)))  # touches its limits often
    values[7000:7900] = np.median(values)  # stuck across block edges, and then a leap
    values[7900:8000] = np.median(values) + 0.4
    values[12_000:12_005] = np.nan
    time = np.arange(20_000) * 1e-3
    return Channel("c", kind, "N", time, values, np.zeros(20_000, dtype=np.uint16))


@pytest.mark.parametrize("kind", ["tension", "displacement"])
@pytest.mark.parametrize("block", [333, 4096, 50_000])
def test_plateaus_across_blocks_are_those_of_the_whole(kind: str, block: int) -> None:
    channel = plateau_channel(kind)

    def read(start: int, stop: int) -> tuple[np.ndarray, np.ndarray]:
        return channel.time[start:stop], channel.values[start:stop]

    expected = with_plateaus_flagged(channel)
    found = plateaus_of(read, 20_000, block, kind)
    flags = np.concatenate(
        [found.flags(channel.values[start : start + block], start) for start in range(0, 20_000, block)]
    )
    assert np.array_equal(flags, expected.flags)
    assert (flags & Flag.STUCK).any()
    assert (flags & Flag.SATURATED).any() == (kind == "tension")


def test_the_step_that_a_long_record_is_rounded_to_is_seen_across_blocks() -> None:
    chance = np.random.default_rng(8)
    rounded = np.round(chance.normal(0.0, 0.02, 600_000) + np.sin(np.arange(600_000) * 1e-3), 3)
    assert quantum_of(lambda start, stop: rounded[start:stop], rounded.size) == pytest.approx(1e-3)
    assert white_noise(rounded) == pytest.approx(0.02, rel=0.02)


def test_a_full_disk_while_scratching_is_told_and_leaves_nothing(
    run: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(self: Column, values: np.ndarray) -> None:
        from tethertest.jobs.long_runs.columns import no_scratch

        raise no_scratch(tmp_path, OSError(errno.ENOSPC, "No space left on device"))

    monkeypatch.setattr(Column, "append", full)
    with pytest.raises(TethertestError, match="no space left") as refused:
        ingest_run(run, tmp_path / "out" / "run.h5", RIGS, largest=1000)
    assert "free" in refused.value.remedy
    assert list((tmp_path / "out").iterdir()) == []


def test_a_log_above_the_limit_is_taken_in_pieces_and_comes_out_the_same(run: Path, tmp_path: Path) -> None:
    whole = ingest_run(run, tmp_path / "whole.h5", RIGS)
    told: list[str] = []
    long = ingest_run(
        run, tmp_path / "long.h5", RIGS, largest=1000, progress=lambda words, share: told.append(words)
    )
    assert long.channels == whole.channels
    assert long.findings == whole.findings
    assert any("writing tension_top" in words for words in told)
    one, other = (load_store(made.path).measured for made in (long, whole))
    for left, right in zip(one.channels, other.channels, strict=True):
        assert np.allclose(left.values, right.values, rtol=0.0, atol=1e-12, equal_nan=True)
        assert np.array_equal(left.flags, right.flags)
