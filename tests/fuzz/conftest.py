"""Logs of some kilobytes need little patience."""

from __future__ import annotations

import pytest

from reports.fuzzing.__main__ import PATIENCE
from tethertest.readers.guards import sandboxed_read


@pytest.fixture(autouse=True)
def impatience(monkeypatch):
    """Give the process that reads first little time."""
    monkeypatch.setattr(sandboxed_read, "_PATIENCE", PATIENCE)
