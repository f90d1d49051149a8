"""The tests of a package against a mutant, each in a process of its own that plants it at import.

No file is touched, so that several mutants are tried at once and an interrupted run leaves nothing behind.
"""

from __future__ import annotations

import importlib.abc
import importlib.machinery
import importlib.util
import multiprocessing
import os
import signal
import sys
import time
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from pathlib import Path
from types import ModuleType
from typing import Final

from reports.mutants.sites import Mutant

#: imported once before processes are forked: each mutant would load them again
HEAVY: Final = (
    *("numpy", "scipy.signal", "scipy.optimize", "scipy.interpolate", "pandas", "numba", "h5py"),
    *("pint", "pydantic", "pytest", "nptdms"),
)
SURVIVED: Final = ""
TIMED_OUT: Final = "timed out"

_FORK = multiprocessing.get_context("fork")


@dataclass(frozen=True, slots=True)
class Outcome:
    """What became of a mutant."""

    mutant: Mutant
    killer: str  #: first test that failed; `SURVIVED` where none did, `TIMED_OUT` where they never ended
    seconds: float


def preload() -> None:
    """Import what every mutant needs and none changes."""
    for name in HEAVY:
        importlib.import_module(name)


def try_all(
    mutants: Iterable[Mutant], tests: dict[str, list[str]], jobs: int, limit: float
) -> Iterator[Outcome]:
    """Try mutants, `jobs` at a time, and yield outcomes as they come.

    Parameters
    ----------
    mutants : iterable of Mutant
        To be tried.
    tests : dict
        Package -> test files and folders.
    jobs : int
        Processes at a time.
    limit : float
        Time for the tests of one mutant [s]; an endless loop is a mutant noticed.
    """
    waiting = list(mutants)[::-1]
    running: dict[Connection, tuple[Mutant, BaseProcess, float]] = {}
    while waiting or running:
        while waiting and len(running) < jobs:
            item = waiting.pop()
            receiver, sender = _FORK.Pipe(duplex=False)
            process: BaseProcess = _FORK.Process(
                target=_test, args=(item, relevant_first(item, tests[item.package]), sender)
            )
            process.start()
            sender.close()
            running[receiver] = item, process, time.monotonic()
        ready = wait(list(running), timeout=0.2)
        for receiver, (item, process, begun) in list(running.items()):
            seconds = time.monotonic() - begun
            if receiver in ready:
                killer = _received(receiver)
            elif seconds > limit:
                killer = TIMED_OUT
            else:
                continue
            del running[receiver]
            _end(process)
            yield Outcome(item, killer, seconds)


def relevant_first(mutant: Mutant, places: Sequence[str]) -> list[str]:
    """Return test files, those first whose text or name knows the module: most mutants end there."""
    files = [
        path
        for place in map(Path, places)
        for path in ([place] if place.is_file() else sorted(place.rglob("test_*.py")))
    ]
    stem = mutant.path.stem
    public = _public_names(mutant.source) | {stem}

    def knows(path: Path) -> tuple[bool, int]:
        text = path.read_text(encoding="utf-8")
        return stem not in path.stem, -sum(text.count(name) for name in public)

    return [str(path) for path in sorted(files, key=knows)]


def _public_names(source: str) -> set[str]:
    """Return functions and classes that others may import."""
    heads = (line.split() for line in source.splitlines() if line.startswith(("def ", "class ")))
    names = (words[1].split("(")[0].rstrip(":") for words in heads)
    return {name for name in names if not name.startswith("_")}


class _Planted(importlib.abc.MetaPathFinder, importlib.abc.Loader):
    """Gives one module its changed source; everything else is imported as ever."""

    def __init__(self, mutant: Mutant) -> None:
        parts = mutant.path.with_suffix("").parts
        self.name = ".".join(parts).removesuffix(".__init__")
        self.package = mutant.path.name == "__init__.py"
        self.path, self.source = str(mutant.path.absolute()), mutant.source

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> importlib.machinery.ModuleSpec | None:
        if fullname != self.name:
            return None
        folders = [str(Path(self.path).parent)] if self.package else None
        return importlib.util.spec_from_file_location(
            fullname, self.path, loader=self, submodule_search_locations=folders
        )

    def exec_module(self, module: ModuleType) -> None:
        exec(compile(self.source, self.path, "exec"), module.__dict__)


class _FirstFailure:
    """Notes the first test that failed."""

    name = SURVIVED

    def pytest_runtest_logreport(self, report: object) -> None:
        self._note(report)

    def pytest_collectreport(self, report: object) -> None:
        self._note(report)

    def _note(self, report: object) -> None:
        if getattr(report, "failed", False) and not self.name:
            self.name = str(getattr(report, "nodeid", "collection"))


def _test(mutant: Mutant, files: list[str], sender: Connection) -> None:
    import pytest

    os.setsid()
    silence = os.open(os.devnull, os.O_WRONLY)
    os.dup2(silence, 1)
    os.dup2(silence, 2)
    sys.meta_path.insert(0, _Planted(mutant))
    first = _FirstFailure()
    options = ["-x", "-q", "-m", "not browser and not verify", "-p", "no:cacheprovider", "-p", "no:xdist"]
    code = pytest.main([*options, *files], plugins=[first])
    sender.send(first.name or (SURVIVED if code == 0 else f"pytest ended with {int(code)}"))


def _received(receiver: Connection) -> str:
    try:
        return str(receiver.recv())
    except EOFError:
        return "the process died"


def _end(process: BaseProcess) -> None:
    """End a process and whatever its tests started."""
    if process.pid is not None:
        try:
            os.killpg(process.pid, signal.SIGKILL)
        except ProcessLookupError:
            process.kill()
    process.join()
