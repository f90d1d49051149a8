"""Imported once before ingests are forked: it loads what takes each of them longest, units and kernels."""

from __future__ import annotations

from pathlib import Path

from tethertest.readers.tables.text.blocks import RowPlan, parse_block
from tethertest.readers.tables.text.textlog import TextBlock
from tethertest.units.registry import registry

registry()
_ROWS = b"0,1\n1,2\n"
parse_block(
    TextBlock(_ROWS, len(_ROWS), "ascii", last=True, newline_at_end=True, before=b""),
    RowPlan(Path("log.csv"), ",", ".", ("time", "F"), numbers=(0, 1)),
)
