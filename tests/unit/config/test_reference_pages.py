"""The reference pages say of every key what the schema says."""

from __future__ import annotations

import runpy
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[3] / "docs"
REFERENCE = runpy.run_path(str(DOCS / "reference.py"))


@pytest.mark.parametrize("kind", ["run", "rig", "prototype", "scene"])
def test_pages_are_fresh(kind: str) -> None:
    assert (DOCS / "reference" / f"{kind}.md").read_text(encoding="utf-8") == REFERENCE["page"](kind)


def test_every_key_of_a_rig_is_described() -> None:
    rows = [line.split(" | ") for line in REFERENCE["page"]("rig").splitlines() if line.startswith("| `")]
    assert len(rows) > 40
    assert [row for row in rows if len(row) != 3 or not row[2].strip(" |")] == []
    keys = {row[0].strip("| `") for row in rows}
    assert {"at", "length_state", "decision", "order_amplitude", "order_phase", "rod_ratio"} <= keys
