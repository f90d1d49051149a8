"""A run folder or a run store into the files of other programs."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Annotated

from tethertest.errors import TethertestError
from tethertest.jobs.analysis_options import Options
from tethertest.jobs.evaluation import open_run
from tethertest.jobs.exports.csv import write_csv
from tethertest.jobs.exports.matlab import write_mat
from tethertest.jobs.exports.parquet import check_parquet, write_parquet
from tethertest.jobs.exports.sep005 import write_sep005
from tethertest.jobs.exports.source import Exported, SeriesInMemory, time_bases
from tethertest.jobs.stored import run_of, store_header
from tethertest.records.described import Doc
from tethertest.store import is_store, open_store, written_whole
from tethertest.store.whole import WholeFile

#: what can be written -> ending of its files
FORMATS = {"csv": ".csv", "parquet": ".parquet", "mat": ".mat", "sep005": ".json"}


@dataclass(frozen=True, slots=True)
class Export:
    """What was written."""

    run: Annotated[str, Doc("its id")]
    format: Annotated[str, Doc("csv, parquet, mat or sep005")]
    paths: Annotated[tuple[Path, ...], Doc("files that were written")]


def export(path: Path, form: str, output: Path | None = None, rigs: Path | None = None) -> Export:
    """Write the conditioned channels of a run for another program.

    Parameters
    ----------
    path : Path
        A run folder, or a run store.
    form : str
        A key of `FORMATS`. ``csv`` and ``parquet`` have one table per time base: with more than one the
        clock's name is put before the ending.
    output : Path, optional
        The file; ``reports/RUN/run.*`` if absent.
    rigs : Path, optional
        Folder of rig files, for a run folder.

    Raises
    ------
    TethertestError
        Anything in the files that the user can mend, or a file that cannot be written there.
    """
    if form == "parquet":
        check_parquet()
    with _opened(path, rigs) as run:
        if not run.series:
            message = "the run has no channels"
            raise TethertestError(message, "ingest it again from its raw logs", path=path)
        target = output or Path("reports") / run.header.folder / f"run{FORMATS[form]}"
        jobs = _jobs(run, form, target)
        for one in jobs:
            _check_target(one, path)
        for one, write in jobs.items():
            with written_whole(one) as file:
                write(file)
    return Export(run.run, form, tuple(jobs))


def _jobs(run: Exported, form: str, target: Path) -> dict[Path, Callable[[WholeFile], None]]:
    """Return the files of an export, and what writes each."""
    whole = {"mat": write_mat, "sep005": write_sep005}
    if form in whole:
        return {target: partial(whole[form], run=run)}
    write = write_csv if form == "csv" else write_parquet
    bases = time_bases(run.series)
    names = [f"-{base.name}" if len(bases) > 1 else "" for base in bases]
    return {
        target.with_name(f"{target.stem}{name}{target.suffix}"): partial(write, run=run, base=base)
        for name, base in zip(names, bases, strict=True)
    }


@contextlib.contextmanager
def _opened(path: Path, rigs: Path | None) -> Iterator[Exported]:
    """Open a store, or condition a run folder."""
    if path.is_file() and is_store(path):
        with open_store(path) as store:
            file = run_of(store.header, path).file
            yield Exported(file.id, file.title, file.date, store.header, store.series)
        return
    if path.is_file() and path.name != "run.toml":
        message = "found a file that is no run store"
        raise TethertestError(message, "name a run folder, or a run store as ingest writes it", path=path)
    evaluation = open_run(path, Options(rigs=rigs))
    with evaluation.errors_placed():
        series = tuple(SeriesInMemory(channel) for channel in evaluation.conditioned.channels)
    run = evaluation.run
    yield Exported(run.file.id, run.file.title, run.file.date, store_header(run, evaluation.logs), series)


def _check_target(target: Path, source: Path) -> None:
    """Refuse to write over a file of a run folder, or over what is exported."""
    whole = target.resolve()
    if not os.path.exists(whole):  # noqa: PTH110 - a name too long is told when written
        return
    if whole == source.resolve() or (whole.parent / "run.toml").exists():
        message = "that is a file of a run, and is left alone"
        raise TethertestError(message, "name another file with -o", path=target)
