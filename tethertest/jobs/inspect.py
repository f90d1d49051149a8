"""What a bare log, a run folder or a run store is."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from tethertest.errors import TethertestError
from tethertest.jobs.describe_log import described
from tethertest.jobs.describe_parts import ROWS, described_in_parts
from tethertest.jobs.memory import is_long
from tethertest.jobs.read_bare import check_no_pipe, read_bare, settings_of_a_run, stream_bare
from tethertest.jobs.store_summary import describe_store
from tethertest.readers import load_run, read_log
from tethertest.readers.config.given import given_settings, settings_toml
from tethertest.readers.registry import identified
from tethertest.readers.streaming import stream_log
from tethertest.records.inspected import Inspected, LogSeen, Refusal, RunSeen
from tethertest.records.run import DEFAULT, Log
from tethertest.store import is_store


def inspect_path(path: Path, rigs: Path | None = None, words: Sequence[str] = ()) -> Inspected:
    """Describe a log, a run store, or every log of a run folder.

    Parameters
    ----------
    path : Path
        A log or a run store (no rig needed), or a run folder.
    rigs : Path, optional
        Folder of rig files.
    words : sequence of str
        Settings of a bare log as ``KEY=VALUE``.

    Returns
    -------
    LogSeen, RunSeen or StoreSeen
        A run folder's logs that cannot be read are told as `refusal` does.

    Raises
    ------
    TethertestError
        A bare log, a store or a run file cannot be read, or a setting is wrong.
    """
    check_no_pipe(path)
    if words and (path.is_dir() or is_store(path)):
        raise settings_of_a_run(path)
    if is_store(path):
        return describe_store(path)
    if not path.is_dir():
        if path.is_file() and is_long(path):
            return described_in_parts(stream_bare(path, words, ROWS), settings_toml(words))
        return described(read_bare(path, words), settings_toml(words))
    if not (path / "run.toml").is_file():
        message = "the folder has no run.toml"
        raise TethertestError(message, "name a run folder, or single logs", path=path)
    run = load_run(path, rigs)
    logs = tuple(_log_of_run(run.folder / log.file, log) for log in run.file.log)
    return RunSeen(run.file.id, run.rig.name, any(log.refused for log in logs), logs)


def inspected(path: Path, rigs: Path | None = None, words: Sequence[str] = ()) -> Inspected:
    """Return what `inspect_path` says, or the refusal of a file that cannot be read.

    Raises
    ------
    TethertestError
        A setting is wrong, whatever the file.
    """
    settings = given_settings(path, words)
    if words and (path.is_dir() or (path.is_file() and is_store(path))):
        raise settings_of_a_run(path)
    try:
        return inspect_path(path, rigs, words)
    except TethertestError as error:
        return refusal(path, error, settings)


def refusal(path: Path, error: TethertestError, settings: Log = DEFAULT) -> Refusal:
    """Return why a file is refused, with the keys of a log that was read where they are known.

    Parameters
    ----------
    path : Path
        The file.
    error : TethertestError
        What the reader said.
    settings : Log, optional
        What it was read with.
    """
    name, reason = None, None
    if path.is_file():
        try:
            reader, reason = identified(path, settings)
            name = reader.NAME
        except TethertestError:
            pass  # no reader claims the file: that is what the error says
    elsewhere = error.path is not None and error.path != str(path)
    return Refusal(
        path=str(path),
        refused=True,
        format=name,
        reason=reason,
        line=error.line,
        message=f"{error.path}: {error.problem}" if elsewhere else error.problem,
        remedy=error.remedy,
    )


def _log_of_run(path: Path, log: Log) -> LogSeen | Refusal:
    try:
        if path.is_file() and is_long(path):
            return described_in_parts(stream_log(path, log, rows=ROWS))
        return described(read_log(path, log))
    except TethertestError as error:
        return refusal(path, error, log)
