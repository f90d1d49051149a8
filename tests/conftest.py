"""What all tests of one run of pytest share, whatever process they run in."""

from __future__ import annotations

import fcntl
import os
import pickle
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.kernel_warm_up import compile_share
from tethertest.jobs.report import make_report
from tethertest.records.report import Report


@pytest.fixture(scope="session", autouse=True)
def compiled_kernels(tmp_path_factory: pytest.TempPathFactory) -> None:
    """Share the compiling of kernels: each of two processes would compile all of them at the same time."""
    count = int(os.environ.get("PYTEST_XDIST_WORKER_COUNT", "1"))
    if count > 1:
        number = int(os.environ["PYTEST_XDIST_WORKER"].removeprefix("gw"))
        compile_share(number, count, tmp_path_factory.mktemp("kernels"))


@pytest.fixture(scope="session")
def campaign_report(tmp_path_factory: pytest.TempPathFactory) -> Callable[[Path], Report]:
    """Return the report of a run's folder, made once for all tests; each test has its own copy."""
    base = tmp_path_factory.getbasetemp()
    shared = base.parent if "PYTEST_XDIST_WORKER" in os.environ else base

    def get(folder: Path) -> Report:
        kept = shared / f"{folder.name}.pickle"
        with (shared / f"{folder.name}.lock").open("w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            if not kept.exists():
                kept.write_bytes(pickle.dumps(make_report(folder)))
        report: Report = pickle.loads(kept.read_bytes())
        return report

    return get
