"""Crash safety of the run store: a real ingest is killed at random instants and starved of disk.

Half of the instants are random times over the
whole life of an ingest, which begins with its libraries loaded; half are random steps of the writing phase,
before, in the middle of or after a write, a synchronisation or the rename. After each, the store must be the
old one or the new one to the byte, and raw logs as they were. Then file-size limits from nothing to just
enough, each of which must end in a plain message.
"""

from __future__ import annotations

import hashlib
import io
import multiprocessing
import os
import random
import runpy
import shutil
import signal
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from pathlib import Path
from typing import Any, Final

from tethertest.store import load_store
from tethertest.store.whole import WholeFile

#: a limit below the store's size must be refused; so many are tried
LIMITS = 50
#: where the instants come from
SEED = 20
#: each ingest is a process of its own, forked from one that has loaded the libraries
_FORKS: Final = multiprocessing.get_context("forkserver")
_FORKS.set_forkserver_preload(
    [
        *("tethertest.jobs.ingest", "tethertest.cli.ingest", "tethertest.kernels.fields"),
        *("numba", "pandas", "pint", "pydantic", "nptdms", "h5py"),
        *(
            "scipy.signal",
            "scipy.interpolate",
            "scipy.fft",
            "scipy.ndimage",
            "reports.crash_safety.warmed",
        ),
    ]
)
#: after so many kills the next ingest is let end, to see that it takes left-overs away
_CLEANED = 5
_BAD_INPUT = 2


@dataclass(slots=True)
class Tally:
    """What was seen."""

    outcomes: Counter[tuple[str, str]] = field(default_factory=Counter)  #: (phase, outcome) -> how often
    faults: list[str] = field(default_factory=list)
    steps: int = 0  #: of the writing phase of one ingest


class Battery:
    """A run, its old and its new store, and what ingest must keep."""

    def __init__(self, run: Path, rigs: Path, scratch: Path) -> None:
        self.rigs = rigs
        self.scratch = scratch
        self.store = scratch / "stores" / "run.h5"
        self.store.parent.mkdir()
        self.run = scratch / "run"
        shutil.copytree(run, self.run)
        self.raw = self._raw()
        self.new = self._reference("new")
        older = self.run / "run.toml"
        text = older.read_text(encoding="utf-8")
        older.write_text(f"# the run file as it was before\n{text}", encoding="utf-8")
        self.old = self._reference("old")
        older.write_text(text, encoding="utf-8")

    def _raw(self) -> dict[str, str]:
        return {
            path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in sorted(self.run.iterdir())
        }

    def _reference(self, name: str) -> bytes:
        made = self.scratch / f"{name}.h5"
        for _ in range(2):  # the first one waits until the libraries are loaded
            made.unlink(missing_ok=True)
            start = time.perf_counter()
            code, said = self.ended(made)
            self.life = time.perf_counter() - start  #: of the latest undisturbed ingest [s]
            if code:
                message = f"an ingest that nobody disturbs ends with exit {code}: {said}"
                raise RuntimeError(message)
        return made.read_bytes()

    def started(self, store: Path, *, step: int | None = None, limit: int | None = None) -> BaseProcess:
        """Start an ingest, which kills itself at a step, or may write no file beyond a limit in bytes."""
        words = ["ingest", str(self.run), "--rigs", str(self.rigs), "-o", str(store)]
        self._said, said = _FORKS.Pipe(duplex=False)
        process = _FORKS.Process(target=_ingest, args=(words, said, step, limit))
        process.start()
        said.close()
        return process

    def ended(self, store: Path, **settings: int) -> tuple[int | None, str]:
        """Let one ingest end; return its exit code and what it said."""
        process = self.started(store, **settings)
        with open(self._said.fileno(), encoding="utf-8", closefd=False) as pipe:
            said = pipe.read()
        process.join()
        return process.exitcode, said

    def put_old(self) -> None:
        """Put the old store where the new one goes."""
        self.store.write_bytes(self.old)

    def left(self) -> list[str]:
        """Return what is in the folder beside the store."""
        return sorted(path.name for path in self.store.parent.iterdir() if path != self.store)

    def state(self) -> str:
        """Return which store stands there, after reading it."""
        content = self.store.read_bytes() if self.store.exists() else b""
        if content not in (self.old, self.new):
            return "neither"
        load_store(self.store)
        return "old" if content == self.old else "new"

    def look(self, tally: Tally, phase: str, where: str) -> None:
        """Note what a kill left."""
        state = self.state()
        tally.outcomes[phase, state] += 1
        tally.outcomes[phase, "left-over"] += bool(self.left())
        if state == "neither":
            tally.faults.append(f"{where}: the store is neither the old nor the new one")
        if self._raw() != self.raw:
            tally.faults.append(f"{where}: raw files changed")

    def clean(self, tally: Tally, where: str) -> None:
        """Let the next ingest end, and see that it took the left-overs away."""
        code, _ = self.ended(self.store)
        if code or self.left() or self.state() != "new":
            tally.faults.append(f"{where}: the next ingest left {self.left()}, exit {code}")


def kill_at_random(battery: Battery, instants: int, chance: random.Random, tally: Tally) -> None:
    """Kill ingests: at random times, and at random steps of the writing phase, by turns."""
    battery.put_old()
    _, said = battery.ended(battery.store, step=sys.maxsize)
    tally.steps = int(said.rsplit(maxsplit=1)[-1])
    for instant in range(instants):
        battery.put_old()
        if instant % 2:
            step = chance.randrange(tally.steps)
            code, _ = battery.ended(battery.store, step=step)
            if code != -signal.SIGKILL:
                tally.faults.append(f"step {step}: exit {code}, expected a kill")
            battery.look(tally, "step of the writing phase", f"step {step}")
        else:
            delay = chance.uniform(0.0, 1.1 * battery.life)
            process = battery.started(battery.store)
            time.sleep(delay)
            process.kill()
            process.join()
            battery.look(tally, "time in the process's life", f"{delay:.3f} s")
        if len(battery.left()) > 1:
            tally.faults.append(f"instant {instant}: left-overs pile up")
        if instant % _CLEANED == _CLEANED - 1 or instant == instants - 1:
            battery.clean(tally, f"instant {instant}")


def starve(battery: Battery, limits: int, tally: Tally) -> None:
    """Ingest under file-size limits: every one below the store's size is refused in plain words."""
    size = len(battery.new)
    for number in range(limits):
        limit = size * number // limits if number + 1 < limits else size - 1
        battery.put_old()
        code, said = battery.ended(battery.store, limit=limit)
        plain = code == _BAD_INPUT and "fix:" in said and "Traceback" not in said
        tally.outcomes["file-size limit", "plain message"] += plain
        tally.outcomes["file-size limit", battery.state()] += 1
        tally.outcomes["file-size limit", "left-over"] += bool(battery.left())
        if not plain or battery.state() != "old" or battery.left():
            tally.faults.append(f"limit {limit}: exit {code}, {said[-200:]!r}")


def run_battery(run: Path, rigs: Path, instants: int, limits: int) -> Tally:
    """Run the whole battery on a copy of a run folder."""
    tally = Tally()
    with tempfile.TemporaryDirectory() as scratch:
        battery = Battery(run, rigs, Path(scratch))
        kill_at_random(battery, instants, random.Random(SEED), tally)
        starve(battery, limits, tally)
    return tally


def _ingest(words: list[str], said: Connection, step: int | None, limit: int | None) -> None:
    """Run the command line in this process; what it says goes into a pipe."""
    import resource

    pipe = io.FileIO(said.fileno(), "w", closefd=False)
    sys.stdout = sys.stderr = io.TextIOWrapper(pipe, encoding="utf-8", write_through=True)
    sys.argv = ["tethertest", *words]
    if limit is not None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
    if step is None:
        _type_it()
    else:
        _die_at(step, _type_it)


def _type_it() -> None:
    """Run ``python -m tethertest.cli`` within this process."""
    runpy.run_module("tethertest.cli", run_name="__main__")


def _die_at(step: int, work: Callable[[], object]) -> None:
    """Do the work and kill the process at a step of the writing phase; say how many there were."""
    taken = 0

    def count() -> None:
        nonlocal taken
        if taken == step:
            os.kill(os.getpid(), signal.SIGKILL)
        taken += 1

    write, sync, rename = WholeFile.write, os.fsync, Path.replace

    def counted_write(self: WholeFile, data: Any) -> int:
        half = memoryview(data).cast("B")[: memoryview(data).nbytes // 2]
        count()
        if taken == step:  # the kill comes with half of the data in the file
            write(self, half)
        count()
        return write(self, data)

    def counted_sync(descriptor: int) -> None:
        count()
        sync(descriptor)
        count()

    def counted_rename(self: Path, target: Any) -> Path:
        count()
        renamed = rename(self, target)
        count()
        return renamed

    WholeFile.write, os.fsync, Path.replace = counted_write, counted_sync, counted_rename  # type: ignore[method-assign,assignment]
    try:
        work()
    finally:
        sys.stderr.write(f"steps {taken}\n")
