"""What commands print keeps to the published schemas, and the schemas say what every key means."""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.schema_check import faults
from tethertest.bench.speed import Chosen, Entry, Measured, SceneSpeed
from tethertest.cli.schemas import COMMANDS, FILES, schema_of
from tethertest.jobs.draft_text import written_draft
from tethertest.jobs.export import export
from tethertest.jobs.ingest import Ingested, ingest_run
from tethertest.jobs.inspect import inspected
from tethertest.jobs.new_run import new_run
from tethertest.jobs.scale import scale_rig
from tethertest.render.as_json import as_json

ROOT = Path(__file__).parents[2]
RUN = ROOT / "datasets" / "rig3m" / "run04"
RIGS = ROOT / "rigs"


@pytest.fixture(scope="module")
def ingested(tmp_path_factory: pytest.TempPathFactory) -> Ingested:
    return ingest_run(RUN, tmp_path_factory.mktemp("store") / "run.h5")


@pytest.mark.parametrize("kind", [*FILES, *COMMANDS])
def test_committed_schemas_are_fresh(kind: str) -> None:
    folder = RIGS if kind in FILES else ROOT / "docs"
    committed = json.loads((folder / "schema" / f"{kind}.schema.json").read_text(encoding="utf-8"))
    assert committed == schema_of(kind), "run `make schema`"


@pytest.mark.parametrize("kind", [*FILES, *COMMANDS])
def test_every_key_is_described(kind: str) -> None:
    assert [key for key, schema in _keys(schema_of(kind)) if not _is_described(schema)] == []


def _keys(schema: dict[str, Any]) -> Iterator[tuple[str, dict[str, Any]]]:
    for name, table in {"": schema, **schema.get("$defs", {})}.items():
        if "enum" not in table:
            yield name, {"description": table.get("description"), "anyOf": table.get("anyOf", [])}
        for key, described in table.get("properties", {}).items():
            yield f"{name}.{key}", described


def _is_described(schema: dict[str, Any]) -> bool:
    """Tell whether a key, or the table that it holds, or one of its forms is described."""
    return (
        bool(schema.get("description"))
        or "$ref" in schema
        or any(map(_is_described, schema.get("anyOf", ())))
    )


@pytest.mark.parametrize("name", ["tension.lvm", "fbg.txt", "crank.csv", "run.toml", "nothing.csv", ""])
def test_inspect_of_logs_refusals_and_runs(name: str) -> None:
    assert faults(as_json(inspected(RUN / name)), schema_of("inspect")) == []


@pytest.mark.parametrize("rows", ["", "0,1\n", "0,1\n0,1\n"])
def test_inspect_of_a_log_of_few_stamps(tmp_path: Path, rows: str) -> None:
    (tmp_path / "a.csv").write_text(f"t [s],F [N]\n{rows}", encoding="utf-8")
    assert faults(as_json(inspected(tmp_path / "a.csv")), schema_of("inspect")) == []


def test_ingest_export_and_inspect_of_the_store(ingested: Ingested, tmp_path: Path) -> None:
    assert faults(as_json(ingested), schema_of("ingest")) == []
    assert faults(as_json(inspected(ingested.path)), schema_of("inspect")) == []
    assert faults(as_json(export(ingested.path, "csv", tmp_path / "run.csv")), schema_of("export")) == []


def test_scale() -> None:
    found = as_json(scale_rig(RIGS / "rig3m.toml", None, "0.3 Hz", "0.1 m", "soft"))
    assert faults(found, schema_of("scale")) == []
    assert all(isinstance(power, str) for group in found["groups"] for power in group["exponents"].values())


def test_new(tmp_path: Path) -> None:
    shutil.copy(RUN / "crank.csv", tmp_path)
    found = as_json(written_draft(*new_run(tmp_path, rigs=RIGS)))
    assert faults(found, schema_of("new")) == []
    assert found["rig"] == "rig3m"


def test_bench() -> None:
    run = Entry("auto", 40, 0.012, float("nan"), -0.02, None)
    chosen = Chosen("nonlinear", "leapfrog", "ok", 2e-3, None, None, run)
    scene = SceneSpeed("taut", "a taut cable", "8 spectral elements", "others", 0.2, chosen, (run,))
    assert faults(as_json(Measured((scene,))), schema_of("bench")) == []


def test_a_key_too_many_or_too_few_is_seen() -> None:
    found = as_json(inspected(RUN / "crank.csv"))
    assert faults({**found, "more": 1}, schema_of("inspect")) == [".more is not in the schema"]
    del found["reason"]
    assert faults(found, schema_of("inspect")) == [".reason is missing"]


def test_keys_of_files_say_what_the_program_would_ask() -> None:
    tables = schema_of("rig")["$defs"]
    assert "at rest" in tables["Cable"]["properties"]["length_state"]["description"]
    assert "its uncertainty" in tables["Limits"]["properties"]["decision"]["description"]
    assert "over the length of its rod" in tables["RigDrive"]["properties"]["rod_ratio"]["description"]
