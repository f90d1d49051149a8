"""Lets the tests here import the modules beside them: pytest's importlib mode adds no folder to the path."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from tethertest.readers.containers import rehearsal

sys.path.insert(0, str(Path(__file__).parent))


@pytest.fixture(autouse=True)
def impatience(monkeypatch):
    """Give the process that reads first little time: the logs here have some kilobytes."""
    monkeypatch.setattr(rehearsal, "_PATIENCE", 3.0)
