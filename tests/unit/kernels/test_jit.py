"""Kernels are cached where that is possible, and a stale cache is never used."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numba
import pytest

import tethertest
from tethertest.kernels import jit
from tethertest.kernels.record import widen

NOWHERE = """
import numba.core.caching
numba.core.caching.CacheImpl._locator_classes = []
"""
SMALL = """
import numpy as np
from tethertest.kernels.record import widen
highest, lowest = np.zeros(2), np.zeros(2)
widen(np.array([1.0, -1.0]), highest, lowest)
print(highest, lowest)
"""


@pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="make plain compiles nothing")
def test_the_cache_is_named_after_all_kernels(monkeypatch) -> None:  # type: ignore[no-untyped-def]
    def probe() -> None:
        """Do nothing."""

    def cached() -> str:
        return str(jit.compiled(probe)._cache._impl.filename_base)  # type: ignore[attr-defined]

    before = cached()
    monkeypatch.setattr(jit, "_digest", lambda: "0123456789ab")
    assert cached() != before
    assert "0123456789ab" in cached()


def test_a_kernel_keeps_its_name() -> None:
    assert widen.__qualname__ == "widen"


def test_a_machine_where_nothing_can_be_cached_still_solves() -> None:
    """Numba knows no place for a cache at all."""
    environment = {**os.environ, "PYTHONPATH": str(Path(tethertest.__file__).parent.parent)}
    answer = subprocess.run(
        [sys.executable, "-c", NOWHERE + SMALL],
        env=environment,
        capture_output=True,
        text=True,
        check=False,
        timeout=120,
    )
    assert answer.returncode == 0, answer.stderr
    assert answer.stdout.split() == ["[1.", "0.]", "[", "0.", "-1.]"]
