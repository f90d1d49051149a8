"""Logs of some kilobytes need little patience."""

from __future__ import annotations

import pytest

from reports.fuzzing.__main__ import PATIENCE
from tethertest.readers.containers import rehearsal


@pytest.fixture(autouse=True)
def impatience(monkeypatch):
    """Give the process that reads first little time."""
    monkeypatch.setattr(rehearsal, "_PATIENCE", PATIENCE)
