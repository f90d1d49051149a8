"""What ``inspect --json`` prints is what its published schema says."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import pytest
from pydantic import ValidationError

from tethertest.cli import main
from tethertest.pipeline.ingest import ingest_run
from tethertest.pipeline.inspect import inspected
from tethertest.pipeline.inspect_schema import adapter

ROOT = Path(__file__).parents[2]
RUN = ROOT / "datasets" / "rig3m" / "run04"


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return ingest_run(RUN, tmp_path_factory.mktemp("store") / "run.h5").path


def check(found: dict[str, Any]) -> None:
    adapter().validate_python(json.loads(json.dumps(found, allow_nan=False)), strict=True)


@pytest.mark.parametrize("name", ["tension.lvm", "fbg.txt", "crank.csv", "run.toml", "nothing.csv"])
def test_logs_and_refusals_keep_to_it(name: str) -> None:
    check(inspected(RUN / name))


def test_a_log_of_one_row_keeps_to_it(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("t [s],F [N]\n0,1\n", encoding="utf-8")
    check(inspected(tmp_path / "a.csv"))


def test_a_run_and_its_store_keep_to_it(store: Path) -> None:
    check(inspected(RUN))
    check(inspected(store))


def test_a_key_too_many_or_too_few_is_seen() -> None:
    found = inspected(RUN / "crank.csv")
    for changed in ({**found, "more": 1}, {key: value for key, value in found.items() if key != "reason"}):
        with pytest.raises(ValidationError):
            check(changed)


def test_the_schema_is_printed(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(sys, "argv", ["tethertest", "schema", "inspect"])
    with pytest.raises(SystemExit):
        main()
    said = json.loads(capsys.readouterr().out)
    assert said["$schema"].startswith("https://json-schema.org")
    assert {"Log", "Refusal", "Run", "Store"} <= set(said["$defs"])
