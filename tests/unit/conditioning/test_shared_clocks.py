"""Logs that run.toml puts on one clock are held against each other."""

from __future__ import annotations

import re
from dataclasses import replace

import pytest

from tethertest.conditioning import condition
from tethertest.records.run import ClockOffset

from .conftest import FILES, Bench, make_bench


@pytest.fixture(scope="module")
def bench() -> Bench:
    return make_bench(3)


def findings(bench: Bench, clocks: dict[str, str], **changes: object) -> list[tuple[str, str, str]]:
    """Condition the run with some files on other clocks; return what is found of shared ones."""
    entries = tuple(replace(log, clock=clocks.get(log.file, log.clock)) for log in bench.run.file.log)
    result = condition(bench.with_file(log=entries, **changes), bench.logs(), bench.priors)
    return [
        (item.subject, item.severity, item.text) for item in result.findings if item.kind == "clock_shared"
    ]


def test_a_clock_of_its_own_for_every_log_is_right(bench: Bench) -> None:
    assert findings(bench, {}) == []


def test_two_instruments_on_one_clock_are_found(bench: Bench) -> None:
    found = findings(bench, {FILES["interrogator"]: "encoder"})
    assert [(subject, severity) for subject, severity, _ in found] == [("encoder", "fatal")]
    (encoder, _), (interrogator, _) = (bench.relative(name) for name in ("encoder", "interrogator"))
    said = re.search(r"puts it (\S+) s", found[0][2])
    assert said is not None
    assert float(said[1]) == pytest.approx(encoder - interrogator, abs=0.01)
    assert "a clock of its own" in found[0][2]


@pytest.mark.parametrize("instrument", ["encoder", "interrogator"])
def test_an_instrument_on_the_reference_clock_is_found(bench: Bench, instrument: str) -> None:
    found = findings(bench, {FILES[instrument]: "daq"})
    assert [(subject, severity) for subject, severity, _ in found] == [("daq", "fatal")]
    assert FILES[instrument] in found[0][2]


@pytest.mark.parametrize("instrument", ["encoder", "interrogator"])
def test_two_files_of_one_logger_are_right(instrument: str) -> None:
    same = make_bench(3, shared=(instrument,))
    assert findings(same, {FILES[instrument]: "daq"}) == []


def test_offsets_by_hand_are_not_judged(bench: Bench) -> None:
    offset = ClockOffset(bench.relative("encoder")[0], "by eye", 0.001)
    by_hand = replace(bench.run.file.override, clock_offset={"encoder": offset})
    assert findings(bench, {FILES["interrogator"]: "encoder"}, override=by_hand) == []
