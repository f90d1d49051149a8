"""Raw logs of a run folder into one file of its conditioned channels."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Annotated

from tethertest.errors import TethertestError
from tethertest.jobs.analysis_options import Options
from tethertest.jobs.evaluation import Evaluation, open_run
from tethertest.jobs.long_runs.columns import Sizes
from tethertest.jobs.long_runs.ingest import Progress, Sources, ingest_long
from tethertest.jobs.memory import LARGEST_WHOLE, is_long
from tethertest.jobs.stored import store_header
from tethertest.readers import read_log
from tethertest.readers.streaming import stream_log
from tethertest.records.channel import Finding, Severity
from tethertest.records.described import Doc
from tethertest.records.run import Run
from tethertest.store import is_store, write_store

#: name of a run's store in its folder of reports
STORE_NAME = "run.h5"


@dataclass(frozen=True, slots=True)
class Ingested:
    """What was written."""

    run: Annotated[str, Doc("its id")]
    path: Annotated[Path, Doc("of the run store")]
    size: Annotated[int, Doc("of the file [bytes]")]
    channels: Annotated[dict[str, int], Doc("name -> samples")]
    findings: Annotated[dict[Severity, int], Doc("severity -> how many")]


def default_store(folder: Path) -> Path:
    """Return where the store of a run goes unless it is told: beside its report, not among raw logs."""
    return Path("reports") / folder.resolve().name / STORE_NAME


def ingest_run(
    folder: Path,
    output: Path | None = None,
    rigs: Path | None = None,
    *,
    largest: int = LARGEST_WHOLE,
    progress: Progress = lambda words, share: None,
) -> Ingested:
    """Condition a run and write its store.

    Parameters
    ----------
    folder : Path
        Run folder; nothing in it is changed.
    output : Path, optional
        The store; `default_store` if absent.
    rigs : Path, optional
        Folder of rig files; found upwards from the run folder if absent.
    largest : int, optional
        Logs larger than this [bytes] are conditioned in pieces.
    progress : callable, optional
        Is told what is being done with logs in pieces, and which share of it is done where that is known.

    Raises
    ------
    TethertestError
        Anything in the files that the user can mend, or a store that cannot be written there.
    """
    evaluation = open_run(folder, Options(rigs=rigs))
    run = evaluation.run
    target = default_store(run.folder) if output is None else output
    check_target(target, run)
    with evaluation.errors_placed():
        samples, findings = _ingested(evaluation, target, largest, progress)
    severities = [finding.severity for finding in findings]
    counts = {severity: severities.count(severity) for severity in dict.fromkeys(severities)}
    return Ingested(run.file.id, target, target.stat().st_size, samples, counts)


def _ingested(
    evaluation: Evaluation, target: Path, largest: int, progress: Progress
) -> tuple[dict[str, int], Sequence[Finding]]:
    """Write the store, and return samples by channel and the findings."""
    run = evaluation.run
    long = {log.key: run.folder / log.file for log in run.file.log if is_long(run.folder / log.file, largest)}
    if long:
        whole = {log.key: read_log(run.folder / log.file, log) for log in run.file.log if log.key not in long}
        pieces = {log.key: stream_log(long[log.key], log) for log in run.file.log if log.key in long}
        sources = Sources(whole, pieces)
        return ingest_long(run, sources, target, partial(store_header, run), progress, Sizes())
    measured = evaluation.conditioned
    write_store(target, store_header(run, evaluation.logs), measured)
    return {channel.name: channel.time.size for channel in measured.channels}, measured.findings


def check_target(target: Path, run: Run) -> None:
    """Refuse to write a store over anything but an older store.

    Raises
    ------
    TethertestError
        Something else stands there, such as a raw log.
    """
    whole = target.resolve()
    inputs = {(run.folder / log.file).resolve() for log in run.file.log} | {
        (run.folder / "run.toml").resolve(),
        run.rig_path.resolve(),
    }
    if whole in inputs:
        message = "that is a file of the run itself"
        raise TethertestError(message, "name another file with -o", path=target)
    if os.path.exists(whole) and not is_store(whole):  # noqa: PTH110 - a name too long is told when written
        message = "something else than a run store stands here, and is left alone"
        raise TethertestError(message, "remove it, or name another file with -o", path=target)
